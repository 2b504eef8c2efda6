"""Spectral densities: of any surface, and of the nanodiamond film (main Fig. 5a, SI Fig. S-6)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import ArrayLike, NDArray

from crackfront.plots.parts import LATERAL_UNIT
from crackfront.plots.style import BLACK, BLUE, COLUMN, VERMILION, blank_figure, house_style
from crackfront.studies.paper.film_scales import FilmScales
from crackfront.studies.paper.synthetic_film import SyntheticFilm

Array = NDArray[np.float64]

WAVEVECTOR_LABEL = r"wavevector $q$ (m$^{-1}$)"
PROFILE_LABEL = r"$C^\mathrm{1D}$ (m$^3$)"
ISOTROPIC_LABEL = r"$C^\mathrm{iso}$ (m$^4$)"
_CONVERTED = r"$q\,C^\mathrm{iso}/\pi$ (paper's conversion)"


def draw_spectrum(
    axes: Axes,
    wavevector: Array,
    density: Array,
    rms: Array,
    shortest: Array,
    longest: Array,
    ideal: Array | None = None,
) -> None:
    """Isotropic density of a surface, with bars of the scales that dominate its rms measures.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    wavevector : (n_wave,) array
        Magnitudes q. (Units: 1 / reduced lateral length)
    density : (n_wave,) array
        C(q). (Units: (3 pi w_int R / 4E')^2)
    rms : (3,) array
        Rms height, half-derivative and slope. (Units: reduced)
    shortest, longest : (3,) array
        Wavelengths between which 80% of their squares lie. (Units: reduced lateral length)
    ideal : (n_wave,) array, optional
        Density of the spectrum that the surface was made from, zero where it has none.
    """
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.plot(wavevector, density, color=BLUE, label="surface")
    names = [
        rf"$h_\mathrm{{rms}}^{{({order})}} = {value:.3g}$"
        for order, value in zip(("0", "1/2", "1"), rms, strict=True)
    ]
    axes.set_xlim(0.7 * wavevector[0], 1.4 * wavevector[-1])
    _add_bars(axes, names, 2 * np.pi / longest, 2 * np.pi / shortest)
    if ideal is not None:
        kept = ideal > 0
        axes.plot(
            wavevector[kept], ideal[kept], color=BLACK, dashes=(4, 2), label="spectrum", zorder=3
        )
    axes.set_ylim(bottom=0.1 * float(density.min()))
    axes.set_xlabel(rf"wavevector $q$ $\times$ {LATERAL_UNIT}")
    axes.set_ylabel(r"$C^\mathrm{iso}$ / $(3\pi w_\mathrm{int}R/4E')^2$")
    axes.legend(loc="lower left")


def film_scales_figure(record: FilmScales) -> Figure:
    """Isotropic density with the dominating scales, and density of profiles below.

    Parameters
    ----------
    record : FilmScales
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(COLUMN, 1.35 * COLUMN)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.25, 1))
        for axes in (upper, lower):
            set_density_scales(axes, record.wavevector)
        upper.plot(record.wavevector, record.isotropic, color=BLACK)
        draw_dominant_scales(
            upper,
            record.mean_square,
            record.shortest,
            record.longest,
        )
        _draw_roll_off(upper, record)
        lower.plot(record.wavevector, record.profile, color=BLACK, label="exact projection")
        lower.plot(record.wavevector, record.converted, color=BLUE, dashes=(4, 2), label=_CONVERTED)
        if record.measured_wavevector.size:
            q, density = record.measured_wavevector, record.measured_profile
            upper.plot(q, np.pi / q * density, ".", color=VERMILION, markersize=2)
            lower.plot(q, density, ".", color=VERMILION, markersize=2, label="measured")
        lower.axvline(2 * np.pi / record.roll_off, color="0.6", linewidth=0.6, zorder=1)
        lower.legend(loc="lower left")
        upper.set_ylabel(ISOTROPIC_LABEL)
        lower.set_ylabel(PROFILE_LABEL)
        add_wavelengths(upper)
        lower.set_xlabel(WAVEVECTOR_LABEL)
        return figure


def synthetic_film_figure(record: SyntheticFilm) -> Figure:
    """Profile densities of the film and of the synthetic surfaces, with the included scales.

    Parameters
    ----------
    record : SyntheticFilm
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(COLUMN, 0.9 * COLUMN)
        axes = figure.add_subplot()
        set_density_scales(axes, record.wavevector)
        axes.plot(
            record.wavevector, record.profile, color=VERMILION, label="nanodiamond, ideal spectrum"
        )
        axes.plot(record.wavevector, record.converted, color="0.5", dashes=(4, 2), label=_CONVERTED)
        if record.measured_wavevector.size:
            q, density = record.measured_wavevector, record.measured_profile
            axes.plot(q, density, ".", color=BLACK, markersize=2, label="nanodiamond, measured")
        label = f"synthetic surfaces, mean of {record.realisations}"
        axes.plot(record.mode, record.synthetic, color=BLUE, linewidth=0.8, label=label)
        _draw_end(axes, f"tile {1e6 * record.side:.3g} µm", record.side, "left")
        _draw_end(axes, f"cutoff {1e6 * record.shortest:.3g} µm", record.shortest, "right")
        axes.set_ylabel(PROFILE_LABEL)
        axes.set_xlabel(WAVEVECTOR_LABEL)
        axes.set_ylim(top=20 * float(record.profile.max()))
        add_wavelengths(axes)
        axes.legend(
            loc="lower left", frameon=True, facecolor="white", framealpha=1, edgecolor="none"
        )
        return figure


def _draw_end(axes: Axes, name: str, length: float, alignment: Literal["left", "right"]) -> None:
    """Line at an end of the included scales, with a text inside them."""
    axes.axvline(2 * np.pi / length, color=BLUE, linewidth=0.6, dashes=(1.5, 1.5))
    axes.annotate(
        name,
        (2 * np.pi / length, 0.97),
        xycoords=axes.get_xaxis_transform(),
        xytext=(3 if alignment == "left" else -3, 0),
        textcoords="offset points",
        ha=alignment,
        va="top",
        color=BLUE,
    )


def draw_dominant_scales(axes: Axes, mean_square: Array, shortest: Array, longest: Array) -> None:
    """Bars of the scales that carry 80% of the mean squares, above what is drawn.

    Parameters
    ----------
    axes : Axes
        Axes of an isotropic density, in SI units, whose wavevectors have their limits.
    mean_square, shortest, longest : (3,) array
        Mean squares of heights, half-derivatives and slopes, and the ends of their scales.
        (Units: m^(2 - 2 order), m)
    """
    names = (
        rf"$h_\mathrm{{rms}}^{{(0)}} = {1e9 * mean_square[0] ** 0.5:.0f}$ nm",
        rf"$h_\mathrm{{rms}}^{{(1/2)}} = {1e4 * mean_square[1] ** 0.5:.1f}"
        r"\times10^{-4}$ m$^{1/2}$",
        rf"$h_\mathrm{{rms}}^{{(1)}} = {mean_square[2] ** 0.5:.2f}$",
    )
    _add_bars(axes, names, 2 * np.pi / longest, 2 * np.pi / shortest)


def _add_bars(axes: Axes, names: Sequence[str], lowest: Array, highest: Array) -> None:
    """Bars between wavevectors with their names, above what is drawn."""
    (left, right), top = (
        axes.get_xlim(),
        max(float(np.max(line.get_ydata())) for line in axes.get_lines()),
    )
    for level, (name, *ends) in enumerate(zip(names, lowest, highest, strict=True)):
        height = top * 10.0 ** (5.4 - 1.9 * level)
        axes.plot(ends, [height, height], color=BLACK, linewidth=2.5, solid_capstyle="butt")
        on_right = bool(ends[1] ** 2 < left * right)
        axes.annotate(
            name,
            (ends[on_right], height),
            xytext=(4 if on_right else -4, 0),
            textcoords="offset points",
            ha="left" if on_right else "right",
            va="center",
            bbox={"facecolor": "white", "linewidth": 0, "pad": 1},
        )
    axes.set_ylim(top=top * 10.0**6.6)


def _draw_roll_off(axes: Axes, record: FilmScales) -> None:
    """Line at the roll-off with its wavelength."""
    place = 2 * np.pi / record.roll_off
    axes.axvline(place, color="0.6", linewidth=0.6, zorder=1)
    axes.annotate(
        f"roll-off {1e6 * record.roll_off:.3g} µm",
        (place, 0.03),
        xycoords=axes.get_xaxis_transform(),
        xytext=(-3, 0),
        textcoords="offset points",
        ha="right",
        color="0.35",
    )


def set_density_scales(axes: Axes, wavevector: Array) -> None:
    """Logarithmic axes, over these wavevectors."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(wavevector[0], wavevector[-1])


def add_wavelengths(axes: Axes) -> None:
    """Wavelengths on the upper edge."""
    axes.tick_params(which="both", top=False)
    above = axes.secondary_xaxis("top", functions=(_micrometres, _micrometres))
    above.xaxis.set_major_locator(LogLocator())
    above.xaxis.set_minor_formatter(NullFormatter())
    above.set_xlabel(r"wavelength $2\pi/q$ (µm)")


def _micrometres(wavevector: ArrayLike) -> Array:
    """Wavelength in micrometres of a wavevector in 1/m, and back."""
    return np.asarray(2e6 * np.pi / np.maximum(wavevector, 1e-100))
