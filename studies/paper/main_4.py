"""Main Fig. 4: roughness, and the local work of adhesion that it is equivalent to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from pydantic import Field, model_validator
from scipy.fft import fft2, fftfreq
from scipy.ndimage import maximum_filter

from crackfront.core.adhesion import AdhesionMap, rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, LATERAL, VERTICAL, variable
from crackfront.plots.parts import HEIGHT_LABEL, LENGTH_LABEL, label_panel
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, explain, house_style
from crackfront.sweep.section import Section, section_error
from crackfront.validation import Count, Fraction, Positive, Seed
from studies.paper.checks import Check, close_to
from studies.paper.drawing import DOTTED, write_next_to
from studies.paper.figure import Figure, Integers
from studies.paper.rough import rough_spectrum
from studies.paper.tile_sizes import tile_mean_square
from studies.progress import Progress

_X, _Y, _BAND, _PLACE = "x", "y", "band", "coordinate"

_ALIGNMENT = 2 * math.sqrt(2) / math.pi
"""Correlation of w_loc with heights of one scale: mean of Re sqrt(i q_x + |q_y|) / sqrt(q)."""

_FEWEST_MODES = 100
"""Modes of a band that is compared."""

_CORRELATION_TOLERANCE = 0.015
"""Largest deviation of a correlation in a band, of which so few modes are a sample."""

_ROUND_OFF = 1e-9
"""Largest difference of numbers that are equal but for round-off."""


class MappingParameters(Section):
    """What Fig. 4 shows."""

    seed: Seed  # of the surface
    short_cutoff: Positive  # spectrum of the heights (reduced lateral length, the last 1)
    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]
    elastic_energy: Fraction  # of full conformity (w_int)
    side: Positive  # of the periodic tile (reduced lateral length)
    patch: Positive  # side of the part that is shown
    n_point: Count  # points along a side of the tile

    @model_validator(mode="after")
    def _usable(self) -> MappingParameters:
        _ = self.spectrum  # raises if the roll-off is below the cutoff
        if not 4 * self.short_cutoff <= self.patch <= self.side:
            raise section_error(
                f"patch is {self.patch:g}; it must have at least four short cutoffs "
                f"({4 * self.short_cutoff:g}) and fit into the side of the tile ({self.side:g})"
            )
        if self.short_cutoff < 2 * self.side / self.n_point * (1 - 1e-12):
            raise section_error(
                f"n_point is {self.n_point}; the short cutoff {self.short_cutoff:g} needs two "
                f"points, so {math.ceil(2 * self.side / self.short_cutoff)} or more"
            )
        return self

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Spectrum of the heights, in reduced units."""
        shape = rough_spectrum(self.short_cutoff, self.roll_off, self.hurst)
        return shape.with_elastic_energy(self.elastic_energy)


@dataclass(frozen=True, slots=True)
class Mapping:
    """Heights and works of adhesion on a patch, and measures of the whole tile."""

    position: Array = variable("distance from a corner of the patch", LATERAL, _X)
    heights: Array = variable("height, positive at peaks", VERTICAL, _X, _Y)
    adhesion: Array = variable("local work of adhesion", ADHESION, _X, _Y)
    peak: Integers = variable("indices of the highest point shown", "1", _PLACE)
    valley: Integers = variable("indices of the lowest point shown", "1", _PLACE)
    asked_energy: float = variable("energy of full conformity of the spectrum", ADHESION)
    mode_energy: float = variable("expected energy of the modes of the tile", ADHESION)
    energy_error: float = variable("standard deviation of the energy of a tile", ADHESION)
    energy: float = variable("energy of full conformity of the tile", ADHESION)
    rms: float = variable("rms of the local work of adhesion on the tile", ADHESION)
    mean: float = variable("mean of the local work of adhesion on the tile", ADHESION)
    peak_mean: float = variable("mean work of adhesion at all maxima of the heights", ADHESION)
    valley_mean: float = variable("mean work of adhesion at all minima of the heights", ADHESION)
    band_wavelength: Array = variable("middle of a band of wavelengths", LATERAL, _BAND)
    band_modes: Integers = variable("modes of the band", "1", _BAND)
    band_correlation: Array = variable(
        "correlation of the heights' half-derivative and the work of adhesion in the band",
        "1",
        _BAND,
    )


def mapping(parameters: MappingParameters, progress: Progress) -> Mapping:
    """Synthesise a surface and map it."""
    spectrum, pixel = parameters.spectrum, parameters.side / parameters.n_point
    rng = np.random.default_rng(np.random.SeedSequence(parameters.seed))
    heights = gaussian_field(spectrum, parameters.n_point, parameters.side, rng)
    tile = rough_adhesion(heights, pixel)
    adhesion = tile.work_of_adhesion / WORK_OF_ADHESION
    progress(f"tile of {parameters.n_point} points a side: w_rms = {tile.w_rms:.4f} w_int")
    shown = slice(0, min(round(parameters.patch / pixel) + 1, parameters.n_point))
    patch = heights[shown, shown]
    # From a mean square half-derivative to an energy of full conformity.
    stiffness = spectrum.elastic_energy / spectrum.mean_square(0.5)
    expected, deviation = tile_mean_square(spectrum, parameters.side, 0.5)
    bands = _bands(heights, tile, spectrum)
    return Mapping(
        position=np.asarray(pixel * np.arange(len(patch)), dtype=float),
        heights=patch,
        adhesion=adhesion[shown, shown],
        peak=_highest(patch),
        valley=_highest(-patch),
        asked_energy=parameters.elastic_energy,
        mode_energy=stiffness * expected,
        energy_error=stiffness * deviation,
        energy=tile.e_el,
        rms=tile.w_rms,
        mean=float(adhesion.mean()),
        peak_mean=float(adhesion[_maxima(heights)].mean()),
        valley_mean=float(adhesion[_maxima(-heights)].mean()),
        band_wavelength=np.array([band.wavelength for band in bands]),
        band_modes=np.array([band.modes for band in bands]),
        band_correlation=np.array([band.correlation for band in bands]),
    )


class _Band(NamedTuple):
    """An octave of wavelengths: its middle, its modes, correlation of w_loc with the heights."""

    wavelength: float
    modes: int
    correlation: float


def _bands(heights: Array, tile: AdhesionMap, spectrum: SelfAffineSpectrum) -> list[_Band]:
    """Octaves from the short cutoff on."""
    n_point = len(heights)
    along = 2 * np.pi * fftfreq(n_point, tile.pixel)
    wavevector = np.hypot(along[:, None], along)
    # On one scale the half-derivative is the heights; an octave is not quite one scale.
    heights_modes, adhesion_modes = np.sqrt(wavevector) * fft2(heights), fft2(tile.work_of_adhesion)
    longest = tile.pixel * n_point
    n_band = max(1, math.floor(math.log2(longest / spectrum.short_cutoff)))
    edges = 2 * np.pi / spectrum.short_cutoff * 2.0 ** -np.arange(n_band + 1)
    bands = []
    for high, low in pairwise(edges):
        inside = (wavevector > low) & (wavevector <= high * (1 + 1e-12))
        correlation = _correlation(heights_modes[inside], adhesion_modes[inside])
        middle = 2 * np.pi / math.sqrt(low * high)
        bands.append(_Band(middle, int(np.count_nonzero(inside)), correlation))
    return bands


def _correlation(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> float:
    """Correlation of two fields from their modes."""
    shared = np.sum((first * np.conj(second)).real)
    squares = np.sum(np.abs(first) ** 2) * np.sum(np.abs(second) ** 2)
    return float(shared / squares**0.5)


def _maxima(heights: Array) -> NDArray[np.bool_]:
    """Points of a periodic map that no neighbour exceeds."""
    return np.asarray(heights == maximum_filter(heights, size=3, mode="wrap"))


def _highest(patch: Array) -> Integers:
    """Indices of the highest point away from the rim, where a profile along x has room."""
    margins = len(patch) // 5, len(patch) // 20
    inner = patch[tuple(slice(margin, len(patch) - margin) for margin in margins)]
    return np.array(np.unravel_index(np.argmax(inner), inner.shape)) + margins


def mapping_checks(record: Mapping) -> tuple[Check, ...]:
    """Parseval, the mean, and that peaks raise the work of adhesion."""
    return (*_tile_checks(record), _correlation_check(record), *_peak_checks(record))


def _tile_checks(record: Mapping) -> tuple[Check, ...]:
    """Rms, mean and e_el of the whole tile."""
    return (
        close_to(
            "Parseval: w_rms / sqrt(e_el w_int), both of the tile",
            record.rms / math.sqrt(record.energy),
            2.0,
            _ROUND_OFF,
            remark="SI I C; the main text prints sqrt(2) for it",
        ),
        close_to(
            "mean of w_loc: w_int - e_el of the tile",
            record.mean,
            1 - record.energy,
            _ROUND_OFF,
            units="w_int",
        ),
        close_to(
            "e_el of the tile: as the spectrum has at its modes, within 3 standard deviations",
            record.energy,
            record.mode_energy,
            3 * record.energy_error,
            units="w_int",
            remark=f"the integral over all wavevectors is {record.asked_energy:g}",
        ),
    )


def _correlation_check(record: Mapping) -> Check:
    """Correlation of w_loc with the heights, in the octave where it is furthest from theory."""
    correlations = record.band_correlation[record.band_modes >= _FEWEST_MODES]
    furthest = np.argmax(np.abs(correlations - _ALIGNMENT))
    return close_to(
        "peaks raise w_loc: correlation with the half-derivative of the heights in octaves of "
        "wavelength, the furthest from 2 sqrt(2) / pi",
        float(correlations[furthest]),
        _ALIGNMENT,
        _CORRELATION_TOLERANCE,
        remark="mean of Re sqrt(i q_x + abs(q_y)) / sqrt(q) over the directions of q; "
        f"{correlations.size} octaves of {_FEWEST_MODES} modes or more",
    )


def _peak_checks(record: Mapping) -> tuple[Check, ...]:
    """Works of adhesion at valleys and at peaks."""
    valley, peak = record.adhesion[tuple(record.valley)], record.adhesion[tuple(record.peak)]
    return (
        Check(
            "w_loc at valleys, on average, and at peaks",
            "increasing",
            f"{record.valley_mean:.4f}, {record.mean:.4f}, {record.peak_mean:.4f} w_int",
            record.valley_mean < record.mean < record.peak_mean,
            "means over all minima, all points and all maxima of the heights of the tile",
        ),
        Check(
            "w_loc at the valley and at the peak that are shown",
            "increasing",
            f"{valley:.4f}, {peak:.4f} w_int",
            bool(valley < peak),
        ),
    )


_ADHESION_LABEL = r"$w_\mathrm{loc}/w_\mathrm{int}$"
_PLACES = (("peak", "^", VERMILION), ("valley", "v", BLUE))


def mapping_figure(record: Mapping) -> Drawing:
    """Heights and work of adhesion on a patch, and profiles across a peak and a valley."""
    with house_style():
        figure = blank_figure(PAGE, 0.86 * PAGE)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.3, 1))
        maps = [figure.add_subplot(grid[0, column]) for column in (0, 1)]
        _draw_map(maps[0], record, record.heights, "cividis", HEIGHT_LABEL.format("height $h$"))
        _draw_map(maps[1], record, record.adhesion, "viridis", _ADHESION_LABEL)
        for axes, name in zip(maps, "ab", strict=True):
            label_panel(axes, name)
        for column, (place, _, colour) in enumerate(_PLACES):
            parts = grid[1, column].subgridspec(2, 1, hspace=0.0)
            upper = figure.add_subplot(parts[0])
            lower = figure.add_subplot(parts[1], sharex=upper)
            _draw_profile(upper, lower, record, place, colour)
            label_panel(upper, "cd"[column])
        explain(
            figure,
            "a, b: the front is along $y$, the contact at smaller $x$; c, d: height and work of "
            "adhesion along the white lines; dotted: places of peak and valley; broken: mean of "
            "$w_\\mathrm{loc}$ on the tile",
        )
        return figure


def _draw_map(axes: Axes, record: Mapping, values: Array, colours: str, label: str) -> None:
    """Map with the places of the two profiles."""
    side = float(record.position[-1])
    whole = (0, side, 0, side)
    image = axes.imshow(
        values.T, cmap=colours, interpolation="bilinear", extent=whole, origin="lower"
    )
    reach = _reach(record)
    for place, marker, _ in _PLACES:
        x, y = record.position[getattr(record, place)]
        axes.plot([x - reach, x + reach], [y, y], color="white", linewidth=0.8)
        axes.plot(x, y, marker, color="white", markeredgecolor="black", markersize=5)
        box = {"boxstyle": "round,pad=0.15", "facecolor": "white", "linewidth": 0, "alpha": 0.8}
        write_next_to(axes, place, (x, y), (0, 6), ha="center", color="black", bbox=box)
    axes.figure.colorbar(image, cax=axes.inset_axes((1.03, 0.0, 0.04, 1.0)), label=label)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4))
    axes.set(xlabel=LENGTH_LABEL.format("$x$"), ylabel=LENGTH_LABEL.format("$y$"))


def _draw_profile(upper: Axes, lower: Axes, record: Mapping, place: str, colour: str) -> None:
    """Heights and work of adhesion along x through a peak or a valley."""
    index = getattr(record, place)
    distance = record.position - record.position[index[0]]
    heights, adhesion = record.heights[:, index[1]], record.adhesion[:, index[1]]
    upper.fill_between(distance, heights, heights.min() - 1, color="0.88", linewidth=0)
    upper.plot(distance, heights, color="0.2")
    lower.plot(distance, adhesion, color=colour)
    lower.axhline(record.mean, color="0.2", linewidth=0.6, dashes=(4, 2), zorder=1)
    for axes in (upper, lower):
        axes.axvline(0.0, color=colour, zorder=1, **DOTTED)
    reach = _reach(record)
    upper.set_xlim(-reach, reach)
    for axes, values, room in ((upper, record.heights, 0.1), (lower, record.adhesion, 0.05)):
        low, high = float(values.min()), float(values.max())
        axes.set_ylim(low - room * (high - low), high + room * (high - low))
    mean, end = r"$w_\mathrm{int}-e_\mathrm{el}$", (reach, record.mean)
    write_next_to(lower, mean, end, (3, 0), va="center", annotation_clip=False)
    lower.xaxis.set_major_locator(MaxNLocator(5))
    upper.tick_params(labelbottom=False)
    # As high as the axes.
    upper.set_ylabel(HEIGHT_LABEL.format("$h$").replace(" / ", " /\n"), fontsize=6)
    lower.set_ylabel(_ADHESION_LABEL)
    lower.set_xlabel(LENGTH_LABEL.format(f"distance from the {place} along $x$"))


def _reach(record: Mapping) -> float:
    """Half the length of a profile (Units: reduced lateral length)."""
    return float(record.position[-1]) / 5


FIGURE = Figure(
    title="Main Fig. 4: roughness, and the work of adhesion that it is equivalent to",
    compute=mapping,
    checks=mapping_checks,
    draw=mapping_figure,
)
