"""A measured surface and the adhesion that is predicted for it, in SI units."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.plots.densities import (
    ISOTROPIC_LABEL,
    PROFILE_LABEL,
    WAVEVECTOR_LABEL,
    add_wavelengths,
    draw_dominant_scales,
    set_density_scales,
)
from crackfront.plots.parts import label_panel
from crackfront.plots.style import (
    BLACK,
    BLUE,
    COLOURS,
    MARKERS,
    PAGE,
    VERMILION,
    blank_figure,
    house_style,
)
from crackfront.topography.densities import Density
from crackfront.topography.maps import draw_scan
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.prediction import Prediction

Array = NDArray[np.float64]

_MOST_MAPS, _FEWEST_PLACES = 4, 2
"""Scans that are shown as maps, and places for them."""

_LAST = 0.4
"""Part of the last wavevector from which on a limit is named on its left."""

_BESIDE_TICKS = 12.0
"""Points to the left of a panel where its letter is beside the ticks of an upper axis."""

_ENTRY = 0.1
"""Part of the height of a panel that an entry of a legend takes."""

_ROOM = 3.0
"""How far beyond the longest trusted wavelength the spectrum is shown."""


def prediction_figure(surface: MeasuredSurface, prediction: Prediction) -> Figure:
    """Densities with the spectrum, predicted forces of both branches, and the scans as used."""
    with house_style():
        figure = blank_figure(PAGE, 0.86 * PAGE)
        above, below = figure.subfigures(2, 1, height_ratios=(0.56, 0.3), squeeze=False)[:, 0]
        panels = above.subplot_mosaic([["a", "c"], ["b", "c"]], height_ratios=(1.35, 1))
        upper, lower, forces = panels["a"], panels["b"], panels["c"]
        upper.sharex(lower)
        upper.tick_params(labelbottom=False)
        _draw_isotropic(upper, surface)
        _draw_profiles(lower, surface)
        add_wavelengths(upper)
        lower.set_xlabel(WAVEVECTOR_LABEL)
        _draw_forces(forces, prediction)
        for name, axes in panels.items():
            label_panel(axes, name, _BESIDE_TICKS)
        shown = surface.scans[:_MOST_MAPS]
        maps = below.subplots(1, max(len(shown), _FEWEST_PLACES), squeeze=False)[0]
        for axes, one in zip(maps, shown, strict=False):
            draw_scan(axes, one.measurement, one.band.stripes)
        for axes in maps[len(shown) :]:
            axes.set_axis_off()
        below.text(0.005, 0.97, "d", fontsize=9, fontweight="bold", va="top")
        return figure


def _draw_isotropic(axes: Axes, surface: MeasuredSurface) -> None:
    """Densities of maps, trusted and not, the spectrum and the scales that dominate."""
    joint, wavevector = surface.joint, _wavevectors(surface)
    set_density_scales(axes, wavevector)
    shown = wavevector <= 2 * np.pi / joint.spectrum.short_cutoff
    for index, one in enumerate(surface.scans):
        if not one.measurement.is_line:
            _draw_density(axes, index, one.trusted, one.measurement.path.name)
            _draw_untrusted(axes, index, one.density.within(*_ends(wavevector)))
    logarithms = np.log([item.density(wavevector[shown]) for item in _reaching(surface)])
    low, high = np.exp(np.quantile(logarithms, (0.025, 0.975), axis=0))
    axes.fill_between(wavevector[shown], low, high, color="0.8", linewidth=0, zorder=1)
    axes.plot(
        wavevector[shown],
        joint.spectrum.density(wavevector[shown]),
        color=BLACK,
        label="spectrum, with its 95% interval",
        zorder=4,
    )
    axes.set_ylim(0.2 * np.min(low), 5 * np.max(high))
    measures = surface.measures
    draw_dominant_scales(
        axes,
        np.array([item.rms.value**2 for item in measures]),
        np.array([item.shortest for item in measures]),
        np.array([item.longest for item in measures]),
    )
    _draw_limits(axes, surface, named=False)
    axes.set_ylabel(ISOTROPIC_LABEL)
    _add_legend(axes)


def _add_legend(axes: Axes) -> None:
    """Legend at the lower left, below all that is drawn there."""
    middle = math.sqrt(math.prod(axes.get_xlim()))
    bottom, top = axes.get_ylim()
    curves = (line for line in axes.get_lines() if line.get_transform() == axes.transData)
    points = [np.asarray(line.get_xydata(), dtype=float) for line in curves]
    here = [each[each[:, 0] <= middle, 1] for each in points]
    least = min((float(np.min(values)) for values in here if values.size), default=top)
    entries = len(axes.get_legend_handles_labels()[0])
    room = _ENTRY * (entries + 1)
    # The legend takes a part of the axis, below the least value on the left.
    axes.set_ylim(bottom=min(bottom, (least / top**room) ** (1 / (1 - room))))
    axes.legend(loc="lower left")


def _reaching(surface: MeasuredSurface) -> list[TabulatedSpectrum]:
    """Draws of the spectrum, continued to the end of what is shown of it."""
    end = surface.joint.spectrum.short_cutoff
    return [item for item in surface.joint.draws if item.short_cutoff <= end]


def _ends(wavevector: Array) -> tuple[float, float]:
    """Shortest and longest wavelength of an axis."""
    return float(2 * np.pi / wavevector[-1]), float(2 * np.pi / wavevector[0])


def _draw_limits(axes: Axes, surface: MeasuredSurface, *, named: bool) -> None:
    """Ends of the trusted bands, with what ends them above the data."""
    for index, one in enumerate(surface.scans):
        colour = COLOURS[index % len(COLOURS)]
        for limit in one.band.ends:
            place = 2 * np.pi / limit.wavelength
            axes.axvline(place, color=colour, linewidth=0.5, dashes=(2, 2), zorder=1)
            is_last = place > _LAST * axes.get_xlim()[1]
            if named:
                axes.annotate(
                    limit.cause,
                    (place, 1.0),
                    xycoords=("data", "axes fraction"),
                    xytext=(-1.5 if is_last else 1.5, -2 - 6 * index),
                    textcoords="offset points",
                    ha="right" if is_last else "left",
                    va="top",
                    fontsize=5,
                    color=colour,
                )


def _draw_profiles(axes: Axes, surface: MeasuredSurface) -> None:
    """Densities of profiles and the projection of the model that continues the spectrum."""
    wavevector = _wavevectors(surface)
    for index, (one, density) in enumerate(zip(surface.scans, surface.profiles, strict=True)):
        name = one.measurement.path.name if one.measurement.is_line else ""
        _draw_density(axes, index, density, name)
    axes.plot(
        wavevector,
        surface.joint.fit.projected_density(wavevector),
        color=BLACK,
        label="projection of the model",
        zorder=4,
    )
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** (0.12 * len(surface.scans)))
    _draw_limits(axes, surface, named=True)
    axes.set_ylabel(PROFILE_LABEL)
    _add_legend(axes)


def _draw_untrusted(axes: Axes, index: int, density: Density) -> None:
    """The whole density of a measurement as a thin line."""
    colour = COLOURS[index % len(COLOURS)]
    axes.plot(density.wavevector, density.value, color=colour, linewidth=0.5, alpha=0.6, zorder=2)


def _draw_density(axes: Axes, index: int, density: Density, name: str) -> None:
    """Points of one measurement."""
    axes.plot(
        density.wavevector,
        density.value,
        linestyle="none",
        marker=MARKERS[index % len(MARKERS)],
        markersize=2.8,
        markerfacecolor="none",
        markeredgewidth=0.6,
        color=COLOURS[index % len(COLOURS)],
        label=name or None,
        zorder=3,
    )


def _draw_forces(axes: Axes, prediction: Prediction) -> None:
    """Force against contact radius of both branches with their intervals, and of a smooth one."""
    scales = Scales(prediction.radius, prediction.work_of_adhesion, prediction.contact_modulus)
    branches = (
        ("approach", BLUE, prediction.w_appr),
        ("retraction", VERMILION, prediction.w_retr),
    )
    strongest = max(prediction.w_retr.high, prediction.work_of_adhesion)
    largest = 1.15 * jkr.radius_at_force(0.0, strongest / prediction.work_of_adhesion)
    radius = np.linspace(1e-3, largest, 400)
    unit, power = _force_unit(scales.force)

    def force(adhesion: float) -> Array:
        relative = max(adhesion, 0.0) / prediction.work_of_adhesion
        return jkr.equilibrium_force(radius, relative) * scales.force / power

    place = 1e6 * radius * scales.lateral
    for name, colour, found in branches:
        label = rf"{name}, $w = {1e3 * found.value:.3g}$ mJ m$^{{-2}}$"
        axes.plot(place, force(found.value), color=colour, label=label, zorder=3)
        ends = force(found.low), force(found.high)
        axes.fill_between(place, *ends, color=colour, alpha=0.2, linewidth=0)
    smooth = rf"smooth, $w_\mathrm{{int}} = {1e3 * prediction.work_of_adhesion:.3g}$ mJ m$^{{-2}}$"
    axes.plot(place, force(prediction.work_of_adhesion), color="0.35", dashes=(4, 2), label=smooth)
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=1)
    axes.set_xlim(0, place[-1])
    axes.set_xlabel("contact radius (µm)")
    axes.set_ylabel(f"normal force ({unit})")
    axes.legend(loc="upper left", title="95% intervals shaded", title_fontsize=6)


def _force_unit(force: float) -> tuple[Literal["mN", "µN", "nN"], float]:
    """Unit in which a force is drawn, and its value in newtons."""
    if force > 1e-5:
        return "mN", 1e-3
    return ("µN", 1e-6) if force > 1e-8 else ("nN", 1e-9)


def _wavevectors(surface: MeasuredSurface) -> Array:
    """Wavevectors that are shown."""
    ends = surface.joint.longest * _ROOM, surface.joint.spectrum.short_cutoff / 1.5
    return np.geomspace(2 * np.pi / ends[0], 2 * np.pi / ends[1], 400)
