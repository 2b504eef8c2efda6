"""SI Fig. S-6: profile densities of nanodiamond and of the surfaces of a simulation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from pydantic import Field, model_validator
from scipy.signal import periodogram

from crackfront.core.adhesion import half_derivative_mean_square
from crackfront.core.arrays import Array
from crackfront.core.synthesis import gaussian_field
from crackfront.core.variables import variable
from crackfront.plots import density_axes
from crackfront.plots.style import (
    BLACK,
    BLUE,
    COLUMN,
    VERMILION,
    blank_figure,
    explain,
    house_style,
)
from crackfront.sweep.section import section_error
from crackfront.validation import Count, Positive, Seed
from studies.paper.checks import Check, close_to
from studies.paper.drawing import DOTTED, write_next_to
from studies.paper.figure import Figure, values_of
from studies.paper.film import CONVERTED_LABEL, POINTS_PER_DECADE, FilmDensities, FilmParameters
from studies.paper.tile_sizes import tile_mean_square
from studies.progress import Progress

_MODE = "mode"

_PIXELS = 4
"""Points of a tile in its shortest wavelength."""

_MILLI = 1e3
"""Millijoules in a joule."""

_ROOM = 20
"""How far below the shortest wavelength of the surfaces the film is shown."""


class SyntheticFilmParameters(FilmParameters):
    """What Fig. S-6 shows."""

    shortest: Positive  # wavelength of the synthetic surfaces (m)
    tile_roll_offs: Annotated[float, Field(ge=2, allow_inf_nan=False)]  # side of their tile
    realisations: Count  # surfaces that are averaged
    seed: Seed  # of all of them

    @model_validator(mode="after")
    def _inside(self) -> SyntheticFilmParameters:
        if not self.short_cutoff <= self.shortest <= self.roll_off:
            raise section_error(
                f"shortest is {self.shortest:g}; it must lie between short_cutoff "
                f"({self.short_cutoff:g}) and roll_off ({self.roll_off:g})"
            )
        if self.longest < self.side:
            raise section_error(
                f"longest is {self.longest:g}; it must not be below the side of the tile "
                f"({self.side:g})"
            )
        return self

    @property
    def side(self) -> float:
        """Side of a tile (Units: m)."""
        return self.tile_roll_offs * self.roll_off


@dataclass(frozen=True, slots=True)
class SyntheticFilm(FilmDensities):
    """Profile densities of the film's spectrum and of synthetic surfaces."""

    shortest: float = variable("shortest wavelength of the surfaces", "m")
    side: float = variable("side of the tiles, their longest wavelength", "m")
    realisations: int = variable("number of surfaces", "1")
    mode: Array = variable("wavevector of a mode of the tiles", "m-1", _MODE)
    synthetic: Array = variable("profile density of the surfaces, mean over all lines", "m3", _MODE)
    included: Array = variable("profile density of the included scales", "m3", _MODE)
    film_energy: float = variable("energy of full conformity of the film", "J m-2")
    tile_energy: float = variable("e_el of the surfaces, measured from their maps", "J m-2")
    mode_energy: float = variable("expected energy of the modes of a tile", "J m-2")
    energy_error: float = variable("standard error of the mean of all surfaces", "J m-2")
    height_square: float = variable("mean square height of the lines about their means", "m2")
    dominant_shortest: float = variable("wavelength below which a tenth of e_el lies", "m")
    dominant_longest: float = variable("wavelength above which a tenth of e_el lies", "m")


def synthetic_film(parameters: SyntheticFilmParameters, progress: Progress) -> SyntheticFilm:
    """Synthesise surfaces of the film's spectrum and average the periodograms of their lines."""
    film, side = parameters.spectrum, parameters.side
    included, stiffness = film.longer_than(parameters.shortest), parameters.contact_modulus / 4
    n_point = 2 * math.ceil(_PIXELS * side / parameters.shortest / 2)
    profiles, halves, squares = [], [], []
    seeds = np.random.SeedSequence(parameters.seed).spawn(parameters.realisations)
    for surface, seed in enumerate(seeds, start=1):
        heights = gaussian_field(included, n_point, side, np.random.default_rng(seed))
        profiles.append(profile_periodogram(heights, side / n_point))
        halves.append(half_derivative_mean_square(heights, side / n_point))
        squares.append(float(np.mean(np.var(heights, axis=0))))
        progress(f"surface {surface} of {parameters.realisations}: {n_point} points a side")
    mode = np.asarray(2 * np.pi / side * np.arange(1, n_point // 2), dtype=float)
    # A mode on the cutoff itself belongs to the surfaces, as in the spectrum.
    is_resolved = mode <= 2 * np.pi / parameters.shortest * (1 + 1e-12)
    finest = max(parameters.short_cutoff, parameters.shortest / _ROOM)
    expected, deviation = tile_mean_square(included, side, 0.5)
    dominant = film.dominant_wavelengths(0.5)
    return SyntheticFilm(
        **values_of(parameters.densities(finest)),
        **values_of(parameters, "shortest", "side", "realisations"),
        mode=mode[is_resolved],
        synthetic=np.mean(profiles, axis=0)[is_resolved],
        included=included.profile_density(mode[is_resolved]),
        film_energy=stiffness * film.mean_square(0.5),
        tile_energy=stiffness * float(np.mean(halves)),
        mode_energy=stiffness * expected,
        energy_error=stiffness * deviation / math.sqrt(parameters.realisations),
        height_square=float(np.mean(squares)),
        dominant_shortest=dominant[0],
        dominant_longest=dominant[1],
    )


def profile_periodogram(heights: Array, pixel: float) -> Array:
    """Density of the lines along x of a periodic map, averaged over all of them.

    The map is (n_x, n_y) with even n_x. C_1D stands at the wavevectors 2 pi m / (n_x pixel) below
    the Nyquist one, from m = 1; its sum times the spacing over pi is the mean square height.
    """
    _, density = periodogram(heights, fs=1 / pixel, axis=0, detrend=False)
    # One-sided in the frequency q / 2 pi; C_1D is one half of it.
    return np.asarray(density.mean(axis=1)[1 : len(heights) // 2] / 2)


def synthetic_film_checks(record: SyntheticFilm) -> tuple[Check, ...]:
    """Whether the surfaces have the densities of their spectrum, and enough of its scales."""
    return (*_surface_checks(record), *_density_checks(record), _scales_check(record))


def _surface_checks(record: SyntheticFilm) -> tuple[Check, ...]:
    """Mean square height and e_el of the surfaces, by their maps and by their lines."""
    spacing = 2 * math.pi / record.side
    weighted = float(np.sum(record.mode * record.synthetic))
    converted = record.contact_modulus / 8 * spacing * weighted
    return (
        close_to(
            "Parseval: sum of the density of the lines, over their mean square height",
            spacing / math.pi * float(np.sum(record.synthetic)) / record.height_square,
            1.0,
            1e-9,
        ),
        close_to(
            "e_el of the surfaces: as the spectrum has at their modes, within 3 standard errors",
            _MILLI * record.tile_energy,
            _MILLI * record.mode_energy,
            3 * _MILLI * record.energy_error,
            units="mJ/m2",
            remark=f"{record.realisations} surfaces",
        ),
        close_to(
            "e_el from the density of the lines by the paper's conversion, over e_el of the maps",
            converted / record.tile_energy,
            1.0,
            _scatter(record),
            remark="exact on average; tolerance of 3 standard errors of e_el",
        ),
    )


def _density_checks(record: SyntheticFilm) -> tuple[Check, ...]:
    """Density of the lines in the range that carries most of e_el, weighted as e_el weights it."""
    longest, shortest = record.dominant_longest, record.dominant_shortest
    wavelength = 2 * np.pi / record.mode
    dominant = (wavelength > shortest) & (wavelength < longest)
    measured = float(np.sum((record.mode * record.synthetic)[dominant]))
    projected = float(np.sum((record.mode * record.included)[dominant]))
    q = np.geomspace(2 * np.pi / longest, 2 * np.pi / shortest, POINTS_PER_DECADE)
    film = np.exp(np.interp(np.log(q), np.log(record.wavevector), np.log(record.profile)))
    film_integral = float(np.trapezoid(q**2 * film, np.log(q)))
    return (
        close_to(
            "density of the lines over the projection of the included scales, in the range that "
            "carries 80% of e_el",
            measured / projected,
            1.0,
            _scatter(record),
            remark="weighted by q, as e_el is; tolerance of 3 standard errors of e_el",
        ),
        close_to(
            "density of the lines over the density of the film's spectrum, in the same range",
            measured * (2 * math.pi / record.side) / film_integral,
            1.0,
            0.1,
            remark="waves shorter than the cutoff are missing in long profiles too; the measured "
            "density of the film is not part of this repository",
        ),
    )


def _scales_check(record: SyntheticFilm) -> Check:
    """Whether the surfaces have all waves that carry most of e_el."""
    share = record.mode_energy / record.film_energy
    return Check(
        "the included scales contain those that carry 80% of e_el",
        _micrometres(record.dominant_shortest, record.dominant_longest),
        f"within {_micrometres(record.shortest, record.side)}",
        record.shortest < record.dominant_shortest and record.dominant_longest < record.side,
        f"they carry {share:.3f} of e_el; the paper does not print its cutoff",
    )


def _scatter(record: SyntheticFilm) -> float:
    """Three standard errors of e_el of the surfaces, relative to it."""
    return 3 * record.energy_error / record.mode_energy


def _micrometres(low: float, high: float) -> str:
    """A range of wavelengths."""
    return f"{1e6 * low:.3g} to {1e6 * high:.3g} um"


def synthetic_film_figure(record: SyntheticFilm) -> Drawing:
    """Profile densities of the film and of the synthetic surfaces, with the included scales."""
    with house_style():
        figure, q = blank_figure(COLUMN, COLUMN), record.wavevector
        axes = figure.add_subplot()
        density_axes.set_density_scales(axes, q)
        # Wider and paler than what lies on it.
        wide: dict[str, Any] = {"color": VERMILION, "linewidth": 2.4, "alpha": 0.5, "zorder": 1.5}
        axes.plot(q, record.profile, label="nanodiamond, ideal spectrum", **wide)
        axes.plot(q, record.converted, color="0.3", dashes=(4, 2), label=CONVERTED_LABEL)
        if record.measured_wavevector.size:
            points, label = record.measured_wavevector, "nanodiamond, measured"
            axes.plot(points, record.measured_profile, ".", color=BLACK, markersize=2, label=label)
        label = f"synthetic surfaces, mean of {record.realisations}"
        axes.plot(record.mode, record.synthetic, color=BLUE, linewidth=0.8, label=label)
        _draw_end(axes, f"tile {1e6 * record.side:.0f} µm", record.side, "left")
        _draw_end(axes, f"cutoff {1e9 * record.shortest:.0f} nm", record.shortest, "right")
        axes.set(ylabel=density_axes.PROFILE_LABEL, xlabel=density_axes.WAVEVECTOR_LABEL)
        axes.set_ylim(top=20 * float(record.profile.max()))
        density_axes.add_wavelengths(axes)
        axes.legend(loc="lower left", bbox_to_anchor=(0.07, 0.0))
        explain(
            figure,
            "density of heights along a line; dotted: side of the tile and shortest wavelength of "
            "the synthetic surfaces",
        )
        return figure


def _draw_end(axes: Axes, name: str, length: float, alignment: Literal["left", "right"]) -> None:
    """Line at an end of the included scales, with a text inside them."""
    place, inside = 2 * np.pi / length, 3 if alignment == "left" else -3
    axes.axvline(place, color=BLUE, **DOTTED)
    style = {"xycoords": axes.get_xaxis_transform(), "ha": alignment, "va": "top", "color": BLUE}
    write_next_to(axes, name, (place, 0.97), (inside, 0), **style)


FIGURE = Figure(
    title="SI Fig. S-6: profile densities of nanodiamond and of synthetic surfaces",
    compute=synthetic_film,
    checks=synthetic_film_checks,
    draw=synthetic_film_figure,
)
