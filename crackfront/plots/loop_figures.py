"""Figures of one cycle: mean radius against force with JKR curves, or of a straight front."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, mean_adhesion
from crackfront.core.arrays import Array
from crackfront.core.geometry.line import LineState
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.variables import FORCE, LATERAL
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.parts import PointStyle, draw_arrow, name_without_spring
from crackfront.plots.style import BLUE, COLUMN, PAGE, VERMILION, blank_figure, house_style
from crackfront.simulate.line.line_loads import LineSchedule

if TYPE_CHECKING:
    from crackfront.simulate.run_simulation import SimulationResult

FEWEST_FOR_ARROW = 5
"""Smallest number of states of a branch with an arrow for its direction."""

MOST_MARKERS = 60
"""Approximate largest number of markers on a branch; further states have no marker."""

_HALF_ARROW = 0.07
"""Half of the length of an arrow. (Units: axes)"""

_MARGIN = 0.02
"""Least distance of an arrow from the edges. (Units: axes)"""

_LEGEND = 0.55
"""Width and height of the space for a legend at the lower right. (Units: axes)"""

_ARROW_OFFSETS = (-0.09, -0.07, -0.05, 0.05, 0.07, 0.09)
"""Distances between a branch and its arrow that are tried. (Units: axes)"""


class LoopStates(Protocol):
    """Columns of the states of a cycle that are drawn."""

    @property
    def direction(self) -> NDArray[np.int64]:
        """+1 in approach, -1 in retraction."""

    @property
    def mean_radius(self) -> Array:
        """Mean radii of the fronts."""

    @property
    def force(self) -> Array:
        """Normal forces."""


_BRANCHES = {
    direction: PointStyle(colour, marker, ContactState.branch_names[direction])
    for direction, colour, marker in ((1, BLUE, "o"), (-1, VERMILION, "s"))
}
"""Style of the branch of each direction."""


def simulation_figure(result: SimulationResult) -> Figure:
    """Loop of one simulation: force of a sphere, pinning force of a straight front."""
    simulation, states = result.simulation, result.record.states
    energy, kind = result.measures.e_el, simulation.kind
    name = simulation.spectrum_name
    schedule = simulation.schedule
    if isinstance(schedule, LineSchedule):
        spring = schedule.spring / simulation.correlation_length
        name = rf"{name_without_spring(name)}, $L_\kappa = {spring:.3g}\,\xi$"
    title = (
        rf"{name}, $e_\mathrm{{el}} = {simulation.elastic_energy:.3g}\,w_\mathrm{{int}}$, "
        f"realisation {simulation.realisation}"
    )
    if isinstance(schedule, LineSchedule):
        with house_style():
            figure = blank_figure(COLUMN, 0.72 * COLUMN)
            axes = figure.add_subplot(title=title)
            draw_pinning(axes, states, schedule.n_period, elastic_energy=energy)
            return figure
    steady = steady_adhesion(result.record, simulation.correlation_length)
    works, window = (steady.w_appr, steady.w_retr), (steady.lowest_radius, steady.highest_radius)
    # Steady parts are no closed loop; draw the loop that follows from their works of adhesion.
    if result.record.status is Status.STEADY and np.all(np.isfinite(works)):
        return steady_loop_figure(
            states, works, window, elastic_energy=energy, kind=kind, title=title
        )
    with house_style():
        figure = blank_figure(COLUMN, 0.82 * COLUMN)
        axes = figure.add_subplot(title=title)
        draw_loop(axes, states, works, window, elastic_energy=energy, kind=kind)
        return figure


def steady_loop_figure(
    states: LoopStates,
    works: tuple[float, float],
    window: tuple[float, float],
    *,
    elastic_energy: float,
    kind: FieldKind = "roughness",
    title: str = "",
) -> Figure:
    """The steady parts of two branches, and the loop that follows from their works of adhesion.

    Parameters are as for :func:`draw_loop`, with finite works of adhesion. The figure is a page
    wide.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.44 * PAGE)
        left_axes, right_axes = figure.subplots(1, 2)
        _draw_whole(left_axes, states, works, window)
        draw_loop(
            right_axes,
            states,
            works,
            window,
            elastic_energy=elastic_energy,
            kind=kind,
            arrows=False,
        )
        handles, labels = right_axes.get_legend_handles_labels()
        left_handles, left_labels = left_axes.get_legend_handles_labels()
        right_axes.get_legend().remove()
        handles, labels = handles + left_handles, labels + left_labels
        figure.legend(handles, labels, loc="outside upper center", ncols=3, title=title)
        for axes, letter in ((left_axes, "a"), (right_axes, "b")):
            axes.set_title(letter, loc="left", fontweight="bold")
        left_axes.set_title("loop of its works of adhesion", fontsize=7)
        right_axes.set_title("steady parts, which were simulated", fontsize=7)
        return figure


def _draw_whole(
    axes: Axes, states: LoopStates, works: tuple[float, float], window: tuple[float, float]
) -> None:
    """Loop of a smooth sphere with each branch's work of adhesion, and the states."""
    largest = float(np.max(states.mean_radius))
    starts = jkr.equilibrium_radius(0.0, works[0]), jkr.pull_off_radius(works[1])
    for direction, adhesion, start in zip(_BRANCHES, works, starts, strict=True):
        colour = _BRANCHES[direction].colour
        look: dict[str, Any] = {"color": colour, "zorder": 2}
        radius = np.linspace(start, largest, 300)
        force = jkr.equilibrium_force(radius, adhesion)
        axes.plot(force, radius, linewidth=1.0, **look)
        axes.plot([0.0, force[0]], [0.0, start], linewidth=0.7, dashes=(4, 2), **look)
        _mark_states(axes, states, direction, markersize=2, markeredgewidth=0.5)
        middle = np.array([150, 151])[::direction]
        draw_arrow(axes, force[middle], radius[middle], colour)
    ends = jkr.equilibrium_force(largest, np.array(works))
    look = {"color": "0.35", "linewidth": 0.7, "dashes": (1, 1.5), "zorder": 1}
    axes.plot(ends, [largest, largest], label="edge pinned at the turn", **look)
    axes.axhspan(*window, color="0.93", linewidth=0, zorder=0)
    look = {"xycoords": "axes fraction", "color": "0.35", "va": "bottom"}
    axes.annotate("dashed: jumps into\nand out of contact", (0.03, 0.04), **look)
    low, high = jkr.pull_off_force(works[1]), float(max(ends[0], np.max(states.force)))
    axes.set_xlim(low - 0.08 * (high - low), max(high, 0.0) + 0.1 * (high - low))
    axes.set_ylim(0.0, 1.06 * largest)
    _name_axes(axes)


def draw_loop(
    axes: Axes,
    states: LoopStates,
    works: tuple[float, float],
    window: tuple[float, float],
    *,
    elastic_energy: float = math.nan,
    kind: FieldKind = "roughness",
    arrows: bool = True,
    units: AxisUnits = REDUCED,
) -> None:
    """Draw the two branches, their JKR curves and the window of the averages.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Axes to draw on.
    states : LoopStates
        States of the cycle, at least one.
    works : tuple of float
        w_appr and w_retr for the JKR curves; NaN for no curve. (Units: w_int)
    window : tuple of float
        Range of mean radii over which they are averaged. (Units: reduced lateral length)
    elastic_energy, kind : optional
        Measured e_el (Units: w_int) and kind of field, for the curves of the paper; NaN for none.
    arrows : bool, optional
        Whether arrows show the directions of the branches.
    units : AxisUnits, optional
        Units of the axes.
    """
    radius = np.linspace(0.0, 1.2 * np.max(states.mean_radius), 300)

    def draw_curve(adhesion: float, label: str | None, **look: Any) -> None:
        force = units.scale(FORCE) * jkr.equilibrium_force(radius, adhesion)
        axes.plot(force, units.scale(LATERAL) * radius, label=label, **look)

    for (direction, style), adhesion in zip(_BRANCHES.items(), works, strict=True):
        every = max(1, np.count_nonzero(states.direction == direction) // MOST_MARKERS)
        sizes = {"markersize": 2.8, "markeredgewidth": 0.6, "markevery": every}
        _mark_states(axes, states, direction, units, label=style.label, **sizes)
        if np.isfinite(adhesion):
            branch = style.label[:4]  # appr or retr
            label = rf"JKR, $w_\mathrm{{{branch}}} = {units.adhesion_text(adhesion)}$"
            draw_curve(adhesion, label, color=style.colour, linewidth=1.0, zorder=2)
    if np.isfinite(elastic_energy):
        centre = mean_adhesion(kind, elastic_energy)
        text = f"JKR, $k = {PAPER_FACTOR:g}$ (paper)"
        for sign, name in ((-1, text), (1, None)):
            adhesion = max(centre + sign * PAPER_FACTOR * elastic_energy, 0.0)
            draw_curve(adhesion, name, color="0.35", linewidth=0.6, dashes=(4, 2), zorder=1)
    if np.isfinite(window[0]):
        ends = (units.scale(LATERAL) * end for end in window)
        axes.axhspan(*ends, color="0.93", linewidth=0, zorder=0, label="window of the averages")
    _set_limits(axes, states, units)
    if arrows:
        for direction, style in _BRANCHES.items():
            _draw_direction(axes, *_points(states, direction, units), style.colour)
    _name_axes(axes, units)
    axes.legend(loc="lower right")


def _points(states: LoopStates, direction: int, units: AxisUnits) -> tuple[Array, Array]:
    """Forces and mean radii of a branch in the units of the axes."""
    branch = states.direction == direction
    radius, force = states.mean_radius[branch], states.force[branch]
    return units.scale(FORCE) * force, units.scale(LATERAL) * radius


def _mark_states(
    axes: Axes, states: LoopStates, direction: int, units: AxisUnits = REDUCED, **look: Any
) -> None:
    """Draw an open marker for each state of a branch."""
    look |= {"color": _BRANCHES[direction].colour, "marker": _BRANCHES[direction].marker}
    points = _points(states, direction, units)
    axes.plot(*points, linestyle="none", markerfacecolor="none", zorder=3, **look)


def _name_axes(axes: Axes, units: AxisUnits = REDUCED) -> None:
    """Name the axes of a loop."""
    units.name(axes.xaxis, "normal force", FORCE)
    units.name(axes.yaxis, "mean contact radius", LATERAL)


def draw_pinning(
    axes: Axes,
    states: LineState[Array],
    n_period: int | None = None,
    *,
    elastic_energy: float | None = None,
) -> None:
    """Draw both branches of a straight front, and their means over the last period of the tile.

    The last `n_period` states of each branch are a period; their mean is k times the measured e_el
    (Units: w_int). Without these two arguments, no means are drawn.
    """
    for direction, colour in ((1, BLUE), (-1, VERMILION)):
        name = states.branch_names[direction]
        branch = states.direction == direction
        load, pinning = states.spring_position[branch], states.pinning_force[branch]
        axes.plot(load, pinning, color=colour, linewidth=0.8, label=name, zorder=3)
        if n_period is None or elastic_energy is None:
            continue
        mean = float(np.mean(pinning[-n_period:]))
        label = rf"mean of a period, $k={direction * mean / elastic_energy:.2f}$"
        look: dict[str, Any] = {"linewidth": 1.0, "dashes": (4, 2), "zorder": 4}
        axes.plot(load[[-n_period, -1]], [mean, mean], color=colour, label=label, **look)
    axes.axhline(0.0, color="0.6", linewidth=0.4, zorder=1)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.45 * (high - low))
    unit = "unit of the tile" if n_period is None else "reduced length"
    axes.set_xlabel(f"load $X$, place of the springs ({unit})")
    axes.set_ylabel(r"pinning force / $w_\mathrm{int}$")
    axes.legend(loc="upper left")


def _set_limits(axes: Axes, states: LoopStates, units: AxisUnits) -> None:
    """Limits around the states, with room for the legend at the lower right."""
    for values, setter, unit, below, above in (
        (states.force, axes.set_xlim, units.scale(FORCE), 0.15, 0.2),
        (states.mean_radius, axes.set_ylim, units.scale(LATERAL), 0.12, 0.08),
    ):
        low, high = float(np.min(values)), float(np.max(values))
        span = max(high - low, 0.1)
        setter(unit * (low - below * span), unit * (high + above * span))


def _draw_direction(axes: Axes, force: Array, radius: Array, colour: str) -> None:
    """Draw an arrow next to a branch in its direction, as far from all curves as possible."""
    if radius.size < FEWEST_FOR_ARROW:
        return
    to_axes = axes.transData + axes.transAxes.inverted()
    curves = np.concatenate([to_axes.transform(line.get_xydata()) for line in axes.get_lines()])
    points = to_axes.transform(np.stack([force, radius], axis=1))
    span = max(1, radius.size // 5)
    chords = points[span:] - points[:-span]
    along = chords / np.hypot(*chords.T)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    centres = (points[:-span] + points[span:]) / 2
    arrows = [
        middle + _HALF_ARROW * np.outer([-1, 0, 1], direction)
        for offset in _ARROW_OFFSETS
        for middle, direction in zip(centres + offset * across, along, strict=True)
    ]
    arrows = [arrow for arrow in arrows if _fits_axes(arrow)]
    if not arrows:
        return
    best = max(arrows, key=lambda arrow: float(np.hypot(*(arrow[:, None] - curves).T).min()))
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.0, "mutation_scale": 8}
    axes.annotate("", best[-1], best[0], "axes fraction", arrowprops=look, zorder=4)


def _fits_axes(arrow: Array) -> bool:
    """Whether the points of an arrow, (3, 2), are inside the axes and outside the legend."""
    on_legend = (arrow[:, 0] > 1 - _LEGEND) & (arrow[:, 1] < _LEGEND)
    inside = (arrow > _MARGIN) & (arrow < 1 - _MARGIN)
    return bool(np.all(inside) and not np.any(on_legend))
