"""Figures of a surface and its predicted adhesion, in SI units."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.scan.reading import Measurement
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.plots.axis_units import scaled_unit
from crackfront.plots.density_axes import (
    ISOTROPIC_LABEL,
    PROFILE_LABEL,
    WAVEVECTOR_LABEL,
    add_wavelengths,
    draw_dominant_scales,
    set_density_scales,
)
from crackfront.plots.force_axes import draw_forces
from crackfront.plots.parts import ON_WHITE, label_panel, spectrum_colour, spectrum_marker
from crackfront.plots.style import BLACK, BLUE, PAGE, SMALLEST_FONT, blank_figure, house_style

_MOST_MAPS = 4
"""Largest number of scans that are drawn as maps."""

_FEWEST_MAPS = 2
"""Smallest number of panels for maps, so that a single map is not too large."""

_MOST_PIXELS = 512
"""Largest number of points along a side of a drawn map; the rest is skipped."""

_COLOUR_RANGE = (0.002, 0.998)
"""Quantiles of the heights at both ends of the colours."""

_LATE_LIMIT = 0.4
"""Wavevector over the end of the axis above which the name of a limit is to its left."""

_LETTER_SHIFT = 12.0
"""Shift of the letter of a panel, away from the ticks of an upper axis. (Units: point)"""

_SPECTRUM = "spectrum, with its 95% interval"
_PROJECTION = "projection of the model"
_CURVES = (_SPECTRUM, _PROJECTION)
"""Names of the curves of densities."""

_SYMBOL_WIDTH = 6
"""Width of a symbol in a legend, with the gap to the next. (Units: characters)"""

_GAP = 7
"""Gap between the titles of maps. (Units: characters)"""

_LINE_HEIGHT = 8.0
"""Distance of lines of text. (Units: point)"""

_LONGEST_SHOWN = 3.0
"""Longest wavelength of the axes over the longest trusted wavelength."""


def prediction_figure(surface: Surface, prediction: Prediction, panel: str | None = None) -> Figure:
    """Densities with the spectrum, forces of both branches and scans; or one panel, by letter.

    A surface without scans only has the panels a and c; ValueError for others.
    """
    with house_style():
        if isinstance(surface, StatedSurface):
            return _stated_figure(surface, prediction, panel)
        if panel == "d":
            figure = blank_figure(0.5 * PAGE * min(len(surface.scans), _MOST_MAPS), 0.4 * PAGE)
            _draw_scans(figure, surface)
            return figure
        if panel is not None:
            figure = blank_figure(0.6 * PAGE, 0.45 * PAGE)
            axes = figure.subplots()
            _DRAWINGS[panel](axes, surface, prediction)
            if panel != "c":
                _name_scans(figure, (axes,))
            return figure
        figure = blank_figure(PAGE, 0.97 * PAGE)
        above, below = figure.subfigures(2, 1, height_ratios=(0.64, 0.33), squeeze=False)[:, 0]
        panels = above.subplot_mosaic([["a", "c"], ["b", "c"]], height_ratios=(1.35, 1))
        panels["a"].sharex(panels["b"])
        for name, draw in _DRAWINGS.items():
            draw(panels[name], surface, prediction)
            label_panel(panels[name], name, _LETTER_SHIFT)
        _name_scans(above, (panels["a"], panels["b"]))
        panels["a"].tick_params(labelbottom=False)
        panels["a"].set_xlabel("")
        _draw_scans(below, surface, _FEWEST_MAPS)
        below.text(0.005, 0.97, "d", fontsize=9, fontweight="bold", va="top")
        return figure


def _name_scans(figure: Figure | SubFigure, panels: Sequence[Axes]) -> None:
    """Explain the symbols of scans above all panels, where they cover no data."""
    entries: dict[str, Artist] = {}
    for axes in panels:
        handles, names = axes.get_legend_handles_labels()
        entries |= dict(zip(names, handles, strict=True))
    for name in _CURVES:
        entries.pop(name, None)
    widest = max(map(len, entries)) + _SYMBOL_WIDTH
    columns = max(1, int(_characters(figure) / widest))
    figure.legend(list(entries.values()), list(entries), loc="outside upper center", ncols=columns)


def _name_curve(axes: Axes) -> None:
    """Explain the curve of a density below it."""
    handles, names = axes.get_legend_handles_labels()
    curves = [place for place, name in enumerate(names) if name in _CURVES]
    axes.legend(
        [handles[place] for place in curves],
        [names[place] for place in curves],
        loc="lower left",
        **ON_WHITE,
    )


def _characters(figure: Figure | SubFigure) -> float:
    """Width of a figure in characters of the smallest font."""
    return float(figure.bbox.width / figure.dpi * 72 / (0.6 * SMALLEST_FONT))


def _stated_figure(surface: StatedSurface, prediction: Prediction, panel: str | None) -> Figure:
    """The spectrum and the forces of both branches, or one of them."""
    names = ["a", "c"] if panel is None else [panel]
    if not set(names) <= {"a", "c"}:
        raise ValueError(f"panel is {panel}, which shows scans; without scans choose a or c")
    figure = blank_figure(PAGE if panel is None else 0.6 * PAGE, 0.45 * PAGE)
    for name, axes in zip(names, figure.subplots(1, len(names), squeeze=False)[0], strict=True):
        if name == "a":
            _draw_stated(axes, surface)
        else:
            _draw_forces(axes, surface, prediction)
        if panel is None:
            label_panel(axes, name, _LETTER_SHIFT)
    return figure


def _draw_stated(axes: Axes, surface: StatedSurface) -> None:
    """The spectrum of a surface without scans, and its dominant scales."""
    spectrum = surface.spectrum
    wavevector = _set_wavevectors(axes, surface)
    shown = wavevector[wavevector <= 2 * np.pi / spectrum.short_cutoff]
    axes.plot(shown, spectrum.density(shown), color=BLACK, label="spectrum", zorder=4)
    points = 2 * np.pi / np.array(spectrum.wavelengths), np.array(spectrum.densities)
    _draw_points(axes, *points, BLUE, "o", "as given")
    axes.set_ylim(bottom=0.02 * min(spectrum.densities))
    _add_scales(axes, surface)
    axes.legend(loc="lower left")


def _draw_points(
    axes: Axes, wavevector: Array, density: Array, colour: str, marker: str, label: str
) -> None:
    """Draw values of a density as open markers, with an entry in the legend if it has a label."""
    axes.plot(
        wavevector,
        density,
        linestyle="none",
        marker=marker,
        markersize=2.8,
        markerfacecolor="none",
        markeredgewidth=0.6,
        color=colour,
        label=label or None,
        zorder=3,
    )


def _add_scales(axes: Axes, surface: Surface) -> None:
    """Add dominant scales to an isotropic density, and name its axes."""
    scales = [(item.rms.value**2, item.shortest, item.longest) for item in surface.measures]
    draw_dominant_scales(axes, *np.transpose(scales))
    axes.set_ylabel(ISOTROPIC_LABEL)
    add_wavelengths(axes)


def _draw_scans(figure: Figure | SubFigure, surface: MeasuredSurface, fewest: int = 1) -> None:
    """The scans as used, in a row of panels."""
    shown = surface.scans[:_MOST_MAPS]
    maps = figure.subplots(1, max(len(shown), fewest), squeeze=False)[0]
    width = _characters(figure) / maps.size - _GAP
    for axes, scan in zip(maps, shown, strict=False):
        draw_scan(axes, scan.measurement, scan.band.stripes, int(width))
    for axes in maps[len(shown) :]:
        axes.set_axis_off()


def _set_wavevectors(axes: Axes, surface: Surface) -> Array:
    """Prepare axes for the spectrum, and return its wavevectors (Units: 1 / m)."""
    ends = surface.longest * _LONGEST_SHOWN, surface.spectrum.short_cutoff / 1.5
    wavevector = np.geomspace(2 * np.pi / ends[0], 2 * np.pi / ends[1], 400)
    set_density_scales(axes, wavevector)
    axes.set_xlabel(WAVEVECTOR_LABEL)
    return wavevector


def _draw_isotropic(axes: Axes, surface: MeasuredSurface, _: Prediction) -> None:
    """Densities of maps at all wavelengths, the spectrum and its dominant scales."""
    spectrum = surface.joint.spectrum
    wavevector = _set_wavevectors(axes, surface)
    shown = wavevector[wavevector <= 2 * np.pi / spectrum.short_cutoff]
    for index, scan in enumerate(surface.scans):
        if not scan.measurement.is_line:
            _draw_density(axes, index, scan.trusted, scan.measurement.path.name)
            whole = scan.density.within(2 * np.pi / wavevector[-1], 2 * np.pi / wavevector[0])
            colour = spectrum_colour(index)
            axes.plot(
                whole.wavevector, whole.value, color=colour, linewidth=0.5, alpha=0.6, zorder=2
            )
    draws = surface.joint.draws
    inside = (draws.wavevector >= shown[0]) & (draws.wavevector <= shown[-1] * (1 + 1e-9))
    low, high = draws.low[inside], draws.high[inside]
    axes.fill_between(draws.wavevector[inside], low, high, color="0.8", linewidth=0, zorder=1)
    axes.plot(shown, spectrum.density(shown), color=BLACK, label=_SPECTRUM, zorder=4)
    axes.set_ylim(0.02 * np.min(low), 5 * np.max(high))
    _add_scales(axes, surface)
    _draw_limits(axes, surface, with_causes=False)
    _name_curve(axes)


def _draw_limits(axes: Axes, surface: MeasuredSurface, *, with_causes: bool) -> None:
    """Ends of the trusted bands, and their causes if `with_causes`."""
    for index, scan in enumerate(surface.scans):
        colour = spectrum_colour(index)
        for limit in scan.band.ends:
            wavevector = 2 * np.pi / limit.wavelength
            axes.axvline(wavevector, color=colour, linewidth=0.5, dashes=(2, 2), zorder=1)
            if not with_causes:
                continue
            alignment, shift = "left", 1.5
            if wavevector > _LATE_LIMIT * axes.get_xlim()[1]:
                alignment, shift = "right", -1.5
            axes.annotate(
                limit.cause,
                (wavevector, 1.0),
                xytext=(shift, -2 - _LINE_HEIGHT * index),
                xycoords=("data", "axes fraction"),
                textcoords="offset points",
                ha=alignment,
                va="top",
                color=colour,
            )


def _draw_profiles(axes: Axes, surface: MeasuredSurface, _: Prediction) -> None:
    """Densities of profiles and the projection of the model that continues the spectrum."""
    wavevector = _set_wavevectors(axes, surface)
    for index, scan in enumerate(surface.scans):
        name = scan.measurement.path.name if scan.measurement.is_line else ""
        _draw_density(axes, index, scan.profile, name)
    projection = surface.joint.fit.projected_density(wavevector)
    axes.plot(wavevector, projection, color=BLACK, label=_PROJECTION, zorder=4)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** (0.15 * len(surface.scans)))
    _draw_limits(axes, surface, with_causes=True)
    axes.set_ylabel(PROFILE_LABEL)
    _name_curve(axes)


def _draw_density(axes: Axes, index: int, density: Density, name: str) -> None:
    """Density of one measurement as open markers."""
    colour, marker = spectrum_colour(index), spectrum_marker(index)
    _draw_points(axes, density.wavevector, density.value, colour, marker, name)


def _draw_forces(axes: Axes, _: Surface, prediction: Prediction) -> None:
    """Contact radius against force of both branches with intervals, and of a smooth sphere."""
    draw_forces(axes, prediction.scales, prediction.w_appr, prediction.w_retr)


_DRAWINGS = {"a": _draw_isotropic, "b": _draw_profiles, "c": _draw_forces}
"""Functions that draw the panels, by their letters."""


def draw_scan(
    axes: Axes, measurement: Measurement, stripes: Sequence[int], title_width: int
) -> None:
    """A map in colours, or heights along a line; its density leaves out waves along `stripes`.

    Lines of the title are at most `title_width` characters long.
    """
    low, high = (float(end) for end in np.quantile(measurement.heights, _COLOUR_RANGE))
    unit, scale = scaled_unit("m", max(abs(low), abs(high)))
    lateral, side = scaled_unit("m", max(measurement.size))
    channel = f", channel {measurement.channel}" if measurement.channel else ""
    levelling = f"without {measurement.levelling}" if measurement.levelling else "as it is"
    left_out = " and ".join("xy"[axis] for axis in stripes)
    waves = f"\n(a) without waves along {left_out} alone" if stripes else ""
    lines = f"{measurement.path.name}{channel}\n{levelling}{waves}".split("\n")
    title = "\n".join(textwrap.fill(line, title_width) for line in lines)
    axes.set_title(title, fontsize=SMALLEST_FONT, loc="left")
    axes.set_xlabel(f"x ({lateral})")
    label = f"height ({unit})"
    if measurement.is_line:
        places = np.arange(measurement.heights.size) * measurement.pixels[0] / side
        axes.plot(places, measurement.heights / scale, color=BLUE, linewidth=0.5)
        axes.set_xlim(0, measurement.size[0] / side)
        # On the right, where maps have the bar of their heights.
        axes.yaxis.set_label_position("right")
        axes.tick_params(labelleft=False, labelright=True)
        axes.set_ylabel(label)
        return
    heights, (width, height) = measurement.heights, measurement.size
    steps = (slice(None, None, math.ceil(count / _MOST_PIXELS)) for count in heights.shape)
    image = axes.imshow(
        heights[tuple(steps)].T / scale,
        origin="lower",
        extent=(0.0, width / side, 0.0, height / side),
        cmap="viridis",
        vmin=low / scale,
        vmax=high / scale,
    )
    axes.set_ylabel(f"y ({lateral})")
    bar = axes.inset_axes((1.05, 0.0, 0.06, 1.0))
    axes.figure.colorbar(image, cax=bar, extend="both", label=label)
