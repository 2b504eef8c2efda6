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
from crackfront.plots.parts import PointStyle, draw_arrow, name_without_spring, title_letters
from crackfront.plots.style import BLUE, COLUMN, PAGE, VERMILION, blank_figure, house_style
from crackfront.simulate.line.line_loads import LineSchedule

if TYPE_CHECKING:
    from crackfront.simulate.run_simulation import SimulationResult
    from crackfront.simulate.simulation import Simulation

FEWEST_FOR_ARROW = 5
"""Smallest number of states of a branch with an arrow for its direction."""

MOST_MARKERS = 60
"""Approximate largest number of markers on a branch; further states have no marker."""

_CURVE_POINTS = 300
"""Points of a JKR curve."""

_LEAST_SPAN = 0.1
"""Least range of forces or radii that an axis shows. (Units: reduced)"""

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
    schedule = result.simulation.schedule
    if isinstance(schedule, LineSchedule):
        return _line_figure(result, schedule)
    return _sphere_figure(result)


def _title(name: str, simulation: Simulation) -> str:
    """Title of a simulation, with a name of its spectrum."""
    return (
        rf"{name}, $e_\mathrm{{el}} = {simulation.elastic_energy:.3g}\,w_\mathrm{{int}}$, "
        f"realisation {simulation.realisation}"
    )


def _line_figure(result: SimulationResult, schedule: LineSchedule) -> Figure:
    """Pinning force of a straight front."""
    simulation = result.simulation
    name = name_without_spring(simulation.spectrum_name)
    spring = schedule.spring / simulation.correlation_length
    title = _title(rf"{name}, $L_\kappa = {spring:.3g}\,\xi$", simulation)
    with house_style():
        figure = blank_figure(COLUMN, 0.72 * COLUMN)
        axes = figure.add_subplot(title=title)
        draw_pinning(
            axes,
            result.record.states,
            schedule.n_period,
            elastic_energy=result.measures.e_el,
        )
        return figure


def _sphere_figure(result: SimulationResult) -> Figure:
    """Loop of a sphere: the one that was simulated, or of the works of its steady parts."""
    simulation, states = result.simulation, result.record.states
    energy, kind = result.measures.e_el, simulation.kind
    title = _title(simulation.spectrum_name, simulation)
    steady = steady_adhesion(result.record, simulation.correlation_length)
    works = steady.w_appr, steady.w_retr
    window = steady.lowest_radius, steady.highest_radius
    # Steady parts are not a closed loop; draw the loop that follows from their works of adhesion.
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
        _draw_jkr_loop(left_axes, states, works, window)
        look: dict[str, Any] = {"elastic_energy": elastic_energy, "kind": kind, "arrows": False}
        draw_loop(right_axes, states, works, window, **look)
        handles, labels = right_axes.get_legend_handles_labels()
        left_handles, left_labels = left_axes.get_legend_handles_labels()
        right_axes.get_legend().remove()
        handles, labels = handles + left_handles, labels + left_labels
        figure.legend(handles, labels, loc="outside upper center", ncols=3, title=title)
        title_letters(left_axes, right_axes)
        left_axes.set_title("loop of its works of adhesion", fontsize=7)
        right_axes.set_title("steady parts, which were simulated", fontsize=7)
        return figure


def _draw_jkr_loop(
    axes: Axes, states: LoopStates, works: tuple[float, float], window: tuple[float, float]
) -> None:
    """Loop of a smooth sphere with each branch's work of adhesion, and the states."""
    w_appr, w_retr = works
    largest = float(np.max(states.mean_radius))
    _draw_jkr_branch(axes, states, 1, w_appr, jkr.equilibrium_radius(0.0, w_appr))
    _draw_jkr_branch(axes, states, -1, w_retr, jkr.pull_off_radius(w_retr))
    turn = jkr.equilibrium_force(largest, np.array(works))
    axes.plot(
        turn,
        [largest, largest],
        label="edge pinned at the turn",
        color="0.35",
        linewidth=0.7,
        dashes=(1, 1.5),
        zorder=1,
    )
    axes.axhspan(*window, color="0.93", linewidth=0, zorder=0)
    axes.annotate(
        "dashed: jumps into\nand out of contact",
        (0.03, 0.04),
        xycoords="axes fraction",
        color="0.35",
        va="bottom",
    )
    low, high = jkr.pull_off_force(w_retr), float(max(turn[0], np.max(states.force)))
    axes.set_xlim(low - 0.08 * (high - low), max(high, 0.0) + 0.1 * (high - low))
    axes.set_ylim(0.0, 1.06 * largest)
    _name_axes(axes)


def _draw_jkr_branch(
    axes: Axes, states: LoopStates, direction: int, adhesion: float, first_radius: float
) -> None:
    """A branch of a smooth sphere from its first or last contact, with the states and an arrow."""
    colour = _BRANCHES[direction].colour
    radius = np.linspace(first_radius, float(np.max(states.mean_radius)), _CURVE_POINTS)
    force = jkr.equilibrium_force(radius, adhesion)
    axes.plot(force, radius, linewidth=1.0, color=colour, zorder=2)
    axes.plot(
        [0.0, force[0]],
        [0.0, first_radius],
        linewidth=0.7,
        dashes=(4, 2),
        color=colour,
        zorder=2,
    )
    _mark_states(axes, states, direction, markersize=2, markeredgewidth=0.5)
    middle = _CURVE_POINTS // 2
    arrow = [middle, middle + 1] if direction > 0 else [middle + 1, middle]
    draw_arrow(axes, force[arrow], radius[arrow], colour)


def draw_loop(
    axes: Axes,
    states: LoopStates,
    works: tuple[float, float],
    window: tuple[float, float],
    *,
    elastic_energy: float = math.nan,
    kind: FieldKind = "roughness",
    units: AxisUnits = REDUCED,
    arrows: bool = True,
) -> None:
    """Draw two branches, their JKR curves and the window of the averages.

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
    units : AxisUnits, optional
        Units of the axes.
    arrows : bool, optional
        Whether arrows show the direction of each branch.
    """
    end = 1.2 * float(np.max(states.mean_radius))
    for (direction, style), adhesion in zip(_BRANCHES.items(), works, strict=True):
        every = max(1, np.count_nonzero(states.direction == direction) // MOST_MARKERS)
        _mark_states(
            axes,
            states,
            direction,
            units,
            label=style.label,
            markersize=2.8,
            markeredgewidth=0.6,
            markevery=every,
        )
        if np.isfinite(adhesion):
            branch = style.label[:4]  # appr or retr
            label = rf"JKR, $w_\mathrm{{{branch}}} = {units.adhesion_text(adhesion)}$"
            _draw_jkr_curve(
                axes, adhesion, end, units, label=label, color=style.colour, linewidth=1.0, zorder=2
            )
    if np.isfinite(elastic_energy):
        _draw_paper_curves(axes, mean_adhesion(kind, elastic_energy), elastic_energy, end, units)
    if np.isfinite(window[0]):
        low, high = units.scale(LATERAL) * window[0], units.scale(LATERAL) * window[1]
        label = "window of the averages"
        axes.axhspan(low, high, color="0.93", linewidth=0, zorder=0, label=label)
    _set_limits(axes, states, units)
    _name_axes(axes, units)
    axes.legend(loc="lower right")
    if arrows:
        for direction, style in _BRANCHES.items():
            _draw_direction(axes, *_points(states, direction, units), style.colour)


def _draw_jkr_curve(axes: Axes, adhesion: float, end: float, units: AxisUnits, **look: Any) -> None:
    """Draw the JKR curve of a work of adhesion (Units: w_int) up to a radius (Units: reduced)."""
    radius = np.linspace(0.0, end, _CURVE_POINTS)
    force = units.scale(FORCE) * jkr.equilibrium_force(radius, adhesion)
    axes.plot(force, units.scale(LATERAL) * radius, **look)


def _draw_paper_curves(
    axes: Axes, mean: float, elastic_energy: float, end: float, units: AxisUnits
) -> None:
    """Draw the JKR curves of both branches by the paper; the mean of w_loc is in w_int."""
    look: dict[str, Any] = {"color": "0.35", "linewidth": 0.6, "dashes": (4, 2), "zorder": 1}
    half_width = PAPER_FACTOR * elastic_energy
    label = f"JKR, $k = {PAPER_FACTOR:g}$ (paper)"
    _draw_jkr_curve(axes, max(mean - half_width, 0.0), end, units, label=label, **look)
    _draw_jkr_curve(axes, max(mean + half_width, 0.0), end, units, **look)


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
    axes.set_xlim(_limits(states.force, units.scale(FORCE), 0.15, 0.2))
    axes.set_ylim(_limits(states.mean_radius, units.scale(LATERAL), 0.12, 0.08))


def _limits(values: Array, unit: float, below: float, above: float) -> tuple[float, float]:
    """Ends of an axis around values, with margins relative to their range."""
    low, high = float(np.min(values)), float(np.max(values))
    span = max(high - low, _LEAST_SPAN)
    return unit * (low - below * span), unit * (high + above * span)


def _draw_direction(axes: Axes, force: Array, radius: Array, colour: str) -> None:
    """Draw an arrow next to a branch in its direction, as far from all curves as possible."""
    if radius.size < FEWEST_FOR_ARROW:
        return
    to_axes = axes.transData + axes.transAxes.inverted()
    curves = np.concatenate([to_axes.transform(line.get_xydata()) for line in axes.get_lines()])

    def clearance(arrow: Array) -> float:
        return float(np.hypot(*(arrow[:, None] - curves).T).min())

    arrows = _possible_arrows(to_axes.transform(np.stack([force, radius], axis=1)))
    if not arrows:
        return
    tail, _, head = max(arrows, key=clearance)
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.0, "mutation_scale": 8}
    axes.annotate("", head, tail, "axes fraction", arrowprops=look, zorder=4)


def _possible_arrows(branch: Array) -> list[Array]:
    """Arrows parallel to a branch, (n_state, 2), that are inside the axes.

    Each has a tail, a middle and a head, (3, 2). (Units: axes)
    """
    span = max(1, len(branch) // 5)
    chords = branch[span:] - branch[:-span]
    along = chords / np.hypot(*chords.T)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    centres = (branch[:-span] + branch[span:]) / 2
    arrows = []
    for offset in _ARROW_OFFSETS:
        for middle, direction in zip(centres + offset * across, along, strict=True):
            arrow = middle + _HALF_ARROW * np.outer([-1, 0, 1], direction)
            if _fits_axes(arrow):
                arrows.append(arrow)
    return arrows


def _fits_axes(arrow: Array) -> bool:
    """Whether the points of an arrow, (3, 2), are inside the axes and outside the legend."""
    on_legend = (arrow[:, 0] > 1 - _LEGEND) & (arrow[:, 1] < _LEGEND)
    inside = (arrow > _MARGIN) & (arrow < 1 - _MARGIN)
    return bool(np.all(inside) and not np.any(on_legend))
