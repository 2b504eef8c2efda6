"""Parts that the figures of a sweep share: points, lines, labels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crackfront.analysis.estimate import Estimate, with_error
from crackfront.analysis.finding import PAPER_FACTOR, PERTURBATION_FACTOR
from crackfront.analysis.result import SweepFit
from crackfront.analysis.sweep_law import SweepLaw
from crackfront.analysis.table import SweepTable
from crackfront.core.arrays import Array
from crackfront.core.variables import FORCE, LATERAL, VERTICAL
from crackfront.plots.style import BLACK, COLOURS, MARKERS

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.colors import Colormap
    from matplotlib.ticker import Locator

RADIUS_LABEL = f"contact radius / ${LATERAL.tex}$"
PENETRATION_LABEL = f"penetration / ${VERTICAL.tex}$"
FORCE_LABEL = f"normal force / ${FORCE.tex}$"
ADHESION_LABEL = r"work of adhesion / $w_\mathrm{int}$"
LENGTH_LABEL = r"{} / $(3\pi w_\mathrm{{int}}R^2/4E')^{{1/3}}$"
HEIGHT_LABEL = r"{} / $(9\pi^2 w_\mathrm{{int}}^2 R/16E'^2)^{{1/3}}$"

ON_WHITE: dict[str, Any] = {
    "frameon": True,
    "facecolor": "white",
    "framealpha": 1,
    "edgecolor": "none",
}
"""Style of a legend that covers lines."""


def field_colours() -> Colormap:
    """Colours from weak to strong adhesion, light enough for lines on top."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("field", ["white", "0.45"])


def _arrow(style: str, colour: str, width: float, head: float) -> dict[str, Any]:
    """Style of an arrow that is as long as the distance of its ends."""
    look = {"arrowstyle": style, "color": colour, "linewidth": width, "mutation_scale": head}
    return {**look, "shrinkA": 0, "shrinkB": 0}


def draw_arrow(axes: Axes, abscissa: Array, ordinate: Array, colour: str) -> None:
    """Arrow head on a curve, from the first to the last of some of its points."""
    head, tail = (abscissa[-1], ordinate[-1]), (abscissa[0], ordinate[0])
    axes.annotate("", head, tail, arrowprops=_arrow("-|>", colour, 1.0, 8), zorder=4)


@dataclass(frozen=True, slots=True)
class PointStyle:
    """Style of the points of one kind, and their entry in a legend, which may be empty."""

    colour: str
    marker: str
    label: str


def spectrum_styles(table: SweepTable) -> tuple[PointStyle, ...]:
    """Colours and markers of all spectra of a sweep.

    Straight fronts of one spectrum on several springs share a colour and differ by marker.
    """
    families, styles = spectrum_families(table), []
    for index, family in enumerate(families):
        colour = marker = index
        label = spectrum_label(table, index)
        if table.on_springs:
            colour, marker = family, families[:index].count(family)
            label = "" if marker else label
        styles.append(PointStyle(spectrum_colour(colour), spectrum_marker(marker), label))
    return tuple(styles)


def spectrum_families(table: SweepTable) -> list[int]:
    """Number of each entry's spectrum; entries that only differ by their springs share a number."""
    shapes = [
        (table.shape_of(index).identity, table.ensemble(index))
        for index in range(table.spectrum.size)
    ]
    distinct = list(dict.fromkeys(shapes))
    return [distinct.index(shape) for shape in shapes]


def spring_label(fit: SweepFit, index: int) -> str:
    """Length of the springs in correlation lengths, or g if the amplitudes share g."""
    if _share_length(fit):
        length = fit.table.spring[index, 0] / fit.table.correlation_length[index]
        return rf"$L_\kappa={length:.3g}\,\xi$"
    return rf"$g={np.nanmean(fit.cells.size[index]):.2g}$"


def springs_explained(fit: SweepFit) -> str:
    """Explanation of the symbols of :func:`spring_label`."""
    if _share_length(fit):
        return r"$L_\kappa$: length of the springs, $\xi$: correlation length of the field"
    return "$g$: length of the springs over the Larkin length"


def _share_length(fit: SweepFit) -> bool:
    """Whether the springs of each spectrum have the same length at all amplitudes."""
    springs = fit.table.spring
    return bool(np.all(np.ptp(springs, axis=1) < 1e-6 * np.max(springs, axis=1)))


def draw_estimates(
    axes: Axes, style: PointStyle, abscissa: Array, estimate: Estimate, filled: NDArray[np.bool_]
) -> None:
    """Points of one spectrum with their intervals, filled or open."""
    colour = style.colour
    reach = np.nan_to_num(estimate.high - estimate.value)
    for chosen, face, edge, name in (
        (filled, colour, "white", style.label),
        (~filled, "white", colour, ""),
    ):
        if not np.any(chosen):
            continue
        axes.errorbar(
            abscissa[chosen],
            estimate.value[chosen],
            # With None, the legend does not show bars either.
            yerr=reach[chosen] if np.any(reach) else None,
            linestyle="none",
            marker=style.marker,
            color=colour,
            markerfacecolor=face,
            markeredgecolor=edge,
            markeredgewidth=0.4 if face == colour else 0.8,
            markersize=4.2 if face == colour else 3.6,
            elinewidth=0.7,
            capthick=0.7,
            label=name or None,
            zorder=3,
        )


def draw_below(axes: Axes, index: int, colour: str, abscissa: Array) -> None:
    """Draw an arrow at the lower edge for each mean below it, with a shift for each spectrum."""
    for position in abscissa * 1.05 ** (index - 1):
        ends, look = ((position, 0.005), (position, 0.05)), _arrow("->", colour, 0.8, 5)
        axes.annotate("", *ends, xycoords=axes.get_xaxis_transform(), arrowprops=look)


def draw_fit(
    axes: Axes, fit: SweepFit, curve: Callable[[Array, Array], tuple[Array, Array]]
) -> None:
    """Line of the pooled k over the range of the fit, with its interval in the legend.

    `curve` maps e_el and k to points.
    """
    ends = np.array([fit.lowest_elastic_energy, fit.highest_elastic_energy])
    value, reach = float(fit.pooled.factor.value), float(fit.pooled.factor.high)
    text = f"{value:.2f}"
    if np.isfinite(reach):
        text = with_error(value, reach - value).replace("±", r"\pm")
    label = f"pooled $k = {text}$"
    points = curve(ends, np.full(2, value))
    axes.plot(*points, color=BLACK, linewidth=1.2, label=label)


def draw_law(
    axes: Axes, fit: SweepFit, curve: Callable[[Array, Array], tuple[Array, Array]]
) -> None:
    """Curves of k by the law, one for each spectrum; `curve` maps e_el and k to points."""
    law = SweepLaw(fit.table, fit.kind, fit.uncorrelated)
    drawn = False
    for index, style in enumerate(spectrum_styles(fit.table)):
        abscissa, ordinate = curve(*law.curve(index))
        if np.any(np.isfinite(ordinate)):
            drawn = True
            axes.plot(abscissa, ordinate, color=style.colour, linewidth=0.6, zorder=1.5)
    if drawn:
        axes.plot([], [], color="0.5", linewidth=0.6, label="law of $k$ (coloured)")


def draw_theory(axes: Axes, ends: Array, unit: ArrayLike = 1.0) -> None:
    """Lines of k by the paper and by perturbation theory; `unit` is the ordinate of k = 1."""
    look: dict[str, Any] = {"color": "0.35", "linewidth": 0.7, "zorder": 1}
    for factor, dashes, name in (
        (PAPER_FACTOR, (4, 2), "paper"),
        (PERTURBATION_FACTOR, (1, 1.5), "perturbation theory"),
    ):
        ordinate, label = factor * np.broadcast_to(unit, ends.shape), f"$k = {factor:g}$ ({name})"
        axes.plot(ends, ordinate, dashes=dashes, label=label, **look)


def legend_entries(axes: Axes) -> tuple[list[Artist], list[str]]:
    """Handles and labels of a legend, the spectra before the lines."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda entry: isinstance(handles[entry], Line2D))
    return [handles[entry] for entry in order], [labels[entry] for entry in order]


def label_decimals(axis: Axis, locator: Locator | None = None) -> None:
    """Label a logarithmic axis with decimals, by default at 1, 2 and 5 in every decade."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(locator or LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def spectrum_label(table: SweepTable, index: int) -> str:
    """Name of a spectrum in the configuration with its parameters, for a legend."""
    name = str(table.spectrum[index])
    name = name_without_spring(name) if table.on_springs else name
    label = rf"{name}: $\lambda_\mathrm{{s}}={table.short_cutoff[index]:.4g}$"
    is_flat = table.roll_off[index] == table.short_cutoff[index]
    if is_flat or np.isnan(table.hurst[index]) or not table.is_covered(index):
        return label
    roll_off = rf"$\lambda_\mathrm{{r}}={table.roll_off[index]:.4g}$"
    return f"{label}, {roll_off}, $H={table.hurst[index]:g}$"


def name_without_spring(name: str) -> str:
    """Name of a spectrum in the configuration, without the suffix for its springs."""
    return name.rpartition("-L")[0] or name


def spectrum_colour(index: int) -> str:
    """Colour of a spectrum, by its number."""
    return COLOURS[index % len(COLOURS)]


def spectrum_marker(index: int) -> str:
    """Marker of a spectrum, by its number."""
    return MARKERS[index % len(MARKERS)]


def title_letters(*panels: Axes) -> None:
    """Bold letter a, b, ... above the left corner of each panel."""
    for axes, letter in zip(panels, "abcdef", strict=False):
        axes.set_title(letter, loc="left", fontweight="bold")


def label_panel(axes: Axes, name: str, shift: float = 4.0) -> None:
    """Bold letter of a panel above its upper left corner, shifted to the left (Units: point)."""
    look: dict[str, Any] = {"fontsize": 9, "fontweight": "bold", "ha": "right"}
    axes.annotate(name, (0, 1), (-shift, 4), "axes fraction", "offset points", **look)
