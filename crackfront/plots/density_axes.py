"""Spectral densities of surfaces, with the scales that dominate their rms measures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from crackfront.core.arrays import Array
from crackfront.core.variables import LATERAL, VERTICAL
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.style import BLACK, BLUE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WAVEVECTOR_LABEL = r"wavevector $q$ (m$^{-1}$)"
PROFILE_LABEL = r"$C^\mathrm{1D}$ (m$^3$)"
ISOTROPIC_LABEL = r"$C^\mathrm{iso}$ (m$^4$)"
_REDUCED_LABEL = r"$C^\mathrm{iso}$ / $(3\pi w_\mathrm{int}R/4E')^2$"

_NAME_WIDTH = 0.4
"""Width of the name of a bar. (Units: width of the axes)"""

_BARS_NEXT_TO_NAMES = 0.92, 0.11
"""Height of the highest bar and distance of the bars. (Units: height of the axes)"""

_BARS_BELOW_NAMES = 0.85, 0.15
"""The same for bars with their names above them. (Units: height of the axes)"""


def draw_spectrum(
    axes: Axes,
    wavevector: Array,
    density: Array,
    rms: Array,
    shortest: Array,
    longest: Array,
    ideal: Array | None = None,
    units: AxisUnits = REDUCED,
) -> None:
    """Isotropic density of a surface, with bars of the scales that dominate its rms measures.

    Arrays are in reduced units: n_wave wavevectors and densities, three rms measures (height,
    half-derivative, slope), and the wavelengths between which 80% of their squares lie. `ideal` is
    the density of the spectrum from which the surface was made, zero outside its range.
    """
    axes.set(xscale="log", yscale="log")
    lateral, vertical = units.scale(LATERAL), units.scale(VERTICAL)
    wave, power = wavevector / lateral, (vertical * lateral) ** 2
    axes.plot(wave, power * density, color=BLUE, label="surface")
    axes.set_xlim(0.7 * wave[0], 1.4 * wave[-1])
    if units.is_si:
        measured = vertical * rms / lateral ** np.array([0.0, 0.5, 1.0])
        names = _measured_names(measured**2)
        axes.set(xlabel=WAVEVECTOR_LABEL, ylabel=ISOTROPIC_LABEL)
    else:
        names = _reduced_names(rms)
        axes.set(xlabel=rf"wavevector $q$ $\times$ ${LATERAL.tex}$", ylabel=_REDUCED_LABEL)
    if ideal is not None:
        curve = wave[ideal > 0], power * ideal[ideal > 0]
        axes.plot(*curve, color=BLACK, dashes=(4, 2), label="spectrum", zorder=3)
    axes.set_ylim(bottom=0.1 * power * float(density.min()))
    _add_bars(axes, names, 2 * np.pi / (lateral * longest), 2 * np.pi / (lateral * shortest))
    axes.legend(loc="lower left")


def draw_dominant_scales(axes: Axes, mean_square: Array, shortest: Array, longest: Array) -> None:
    """Bars of the scales that carry 80% of the mean squares, above the curves.

    Call this after the limits of the wavevectors are set. The mean squares are of heights,
    half-derivatives and slopes (Units: m^(2 - 2 order)), the ends of the scales in m.
    """
    _add_bars(axes, _measured_names(mean_square), 2 * np.pi / longest, 2 * np.pi / shortest)


def _reduced_names(rms: Array) -> list[str]:
    """Names of the bars in reduced units, from rms height, half-derivative and slope."""
    return [
        rf"$h_\mathrm{{rms}}^{{({order})}} = {value:.3g}$"
        for order, value in zip(("0", "1/2", "1"), rms, strict=True)
    ]


def _measured_names(mean_square: Array) -> list[str]:
    """Names of the bars in SI, from the mean squares of :func:`draw_dominant_scales`."""
    height, half, slope = mean_square**0.5
    power = math.floor(math.log10(half))
    return [
        rf"$h_\mathrm{{rms}}^{{(0)}} = {_two_digits(1e9 * height)}$ nm",
        rf"$h_\mathrm{{rms}}^{{(1/2)}} = {half / 10.0**power:.1f}"
        rf"\times10^{{{power}}}$ m$^{{1/2}}$",
        rf"$h_\mathrm{{rms}}^{{(1)}} = {_two_digits(slope)}$",
    ]


def _two_digits(value: float) -> str:
    """A number with two digits, or all digits before the decimal point."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _add_bars(axes: Axes, names: Sequence[str], lowest: Array, highest: Array) -> None:
    """Bars between wavevectors in a strip above the curves, with their names next to or above them.

    Call this after the lower limit of the densities is set.
    """
    limits = np.log(axes.get_xlim())
    name_width = _NAME_WIDTH * (limits[1] - limits[0])
    bars = np.clip(np.log([lowest, highest]), *limits).T
    room = np.max([bars[:, 0] - limits[0], limits[1] - bars[:, 1]], axis=0)
    names_next_to_bars = bool(np.all(room > name_width))
    first, spacing = _BARS_NEXT_TO_NAMES if names_next_to_bars else _BARS_BELOW_NAMES
    strip = axes.get_xaxis_transform()
    for level, (name, bar) in enumerate(zip(names, bars, strict=True)):
        height = first - spacing * level
        ends = lowest[level], highest[level]
        axes.plot(
            ends,
            [height, height],
            color=BLACK,
            linewidth=2.5,
            solid_capstyle="butt",
            transform=strip,
        )
        if names_next_to_bars:
            place, shift, look = _name_next_to_bar(ends, bar, limits)
        else:
            place, shift, look = _name_above_bar(bar, limits, name_width / 2)
        look["bbox"] = {"facecolor": "white", "linewidth": 0, "pad": 0.5}
        axes.annotate(
            name, (place, height), xytext=shift, xycoords=strip, textcoords="offset points", **look
        )
    _raise_upper_limit(axes, first - spacing * len(names))


_NamePlace = tuple[float, tuple[int, int], dict[str, Any]]
"""Wavevector of a name, its shift (Units: points), and its alignment."""


def _name_next_to_bar(ends: tuple[float, float], bar: Array, limits: Array) -> _NamePlace:
    """Place of a name on the side of a bar with more room; bar and limits are logarithms."""
    if limits[1] - bar[1] > bar[0] - limits[0]:
        return ends[1], (4, 0), {"ha": "left", "va": "center"}
    return ends[0], (-4, 0), {"ha": "right", "va": "center"}


def _name_above_bar(bar: Array, limits: Array, half_width: float) -> _NamePlace:
    """Place of a name above the middle of a bar, within the axes; all are logarithms."""
    middle = np.clip(np.sum(bar) / 2, limits[0] + half_width, limits[1] - half_width)
    return math.exp(middle), (0, 2), {"ha": "center", "va": "bottom"}


def _raise_upper_limit(axes: Axes, share: float) -> None:
    """Raise the upper limit so that all curves are in the lower share of the axes."""
    bottom = axes.get_ylim()[0]
    curves = [line for line in axes.get_lines() if line.get_transform() == axes.transData]
    top = max(float(np.max(line.get_ydata())) for line in curves)
    axes.set_ylim(top=bottom * (top / bottom) ** (1 / share))


def set_density_scales(axes: Axes, wavevector: Array) -> None:
    """Make both axes logarithmic, with the range of some wavevectors."""
    from matplotlib.ticker import NullFormatter

    axes.set(xscale="log", yscale="log", xlim=(wavevector[0], wavevector[-1]))
    axes.xaxis.set_minor_formatter(NullFormatter())


def add_wavelengths(axes: Axes) -> None:
    """Add an axis of wavelengths at the upper edge."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.tick_params(which="both", top=False)
    above = axes.secondary_xaxis("top", functions=(_micrometres, _micrometres))
    above.xaxis.set_major_locator(LogLocator())
    above.xaxis.set_minor_formatter(NullFormatter())
    above.set_xlabel(r"wavelength $2\pi/q$ (µm)")


def _micrometres(wavevector: ArrayLike) -> Array:
    """Wavelength in micrometres of a wavevector in 1/m, and back."""
    return np.asarray(2e6 * np.pi / np.maximum(wavevector, 1e-100))
