"""Figure of one cycle: force against mean radius between two JKR curves, or of a straight front."""

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
from crackfront.core.adhesion import FieldKind
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
"""States that a branch must have for a part of it to have a direction."""

MOST_MARKERS = 60
"""Markers on a branch, roughly; of more states only every second, third ... is marked."""

_HALF_ARROW, _MARGIN, _LEGEND = 0.07, 0.02, 0.55
"""Half of the length of an arrow, least distance from the edges, and what a legend takes at the
upper left. (Units: axes)"""

_ASIDE = (-0.09, -0.07, -0.05, 0.05, 0.07, 0.09)
"""Distances from its branch at which an arrow may stand. (Units: axes)"""


class LoopStates(Protocol):
    """What is drawn of the states of a cycle."""

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
"""How the branch of each direction is drawn."""


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
    # Steady parts have no loop to draw but the one that they stand for.
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
    """The loop that steady parts of two branches stand for, beside these parts.

    Parameters are those of :func:`draw_loop`; both works of adhesion have values. The figure is a
    page wide.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.44 * PAGE)
        left, right = figure.subplots(1, 2)
        _draw_whole(left, states, works, window)
        draw_loop(
            right, states, works, window, elastic_energy=elastic_energy, kind=kind, arrows=False
        )
        legends = (axes.get_legend_handles_labels() for axes in (right, left))
        handles, labels = (one + other for one, other in zip(*legends, strict=True))
        right.get_legend().remove()
        figure.legend(handles, labels, loc="outside upper center", ncols=4, title=title)
        for axes, letter in ((left, "a"), (right, "b")):
            axes.set_title(letter, loc="left", fontweight="bold")
        left.set_title("loop of its works of adhesion", fontsize=7)
        right.set_title("steady parts, which were simulated", fontsize=7)
        return figure


def _draw_whole(
    axes: Axes, states: LoopStates, works: tuple[float, float], window: tuple[float, float]
) -> None:
    """Loop of a smooth sphere with the work of adhesion of either branch, and the states on it."""
    turn = float(np.max(states.mean_radius))
    starts = jkr.equilibrium_radius(0.0, works[0]), jkr.pull_off_radius(works[1])
    for direction, adhesion, start in zip(_BRANCHES, works, starts, strict=True):
        colour = _BRANCHES[direction].colour
        look: dict[str, Any] = {"color": colour, "zorder": 2}
        radius = np.linspace(start, turn, 300)
        force = jkr.equilibrium_force(radius, adhesion)
        axes.plot(radius, force, linewidth=1.0, **look)
        axes.plot([0.0, start], [0.0, force[0]], linewidth=0.7, dashes=(4, 2), **look)
        _mark_states(axes, states, direction, markersize=2, markeredgewidth=0.5)
        middle = np.array([150, 151])[::direction]
        draw_arrow(axes, radius[middle], force[middle], colour)
    ends = jkr.equilibrium_force(turn, np.array(works))
    look = {"color": "0.35", "linewidth": 0.7, "dashes": (1, 1.5), "zorder": 1}
    axes.plot([turn, turn], ends, label="edge pinned at the turn", **look)
    axes.axvspan(*window, color="0.93", linewidth=0, zorder=0)
    axes.annotate(
        "jumps into and out of contact",
        (starts[0] / 2, float(jkr.equilibrium_force(starts[0], works[0])) / 2),
        xytext=(-8, 8),
        textcoords="offset points",
        color="0.35",
    )
    low, high = jkr.pull_off_force(works[1]), float(max(ends[0], np.max(states.force)))
    axes.set_xlim(0.0, 1.06 * turn)
    axes.set_ylim(low - 0.08 * (high - low), max(high, 0.0) + 0.1 * (high - low))
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

    No curves are drawn where w_appr and w_retr are NaN (units: w_int). They are averages over a
    window of mean radii (units: reduced lateral length). The measured e_el (units: w_int) and the
    kind of field are those of the curves that the paper predicts, none with NaN. Arrows beside the
    branches have their directions.

    Raises
    ------
    ValueError
        If the record holds no state.
    """
    if states.mean_radius.size == 0:
        raise ValueError("the record holds no state; there is no loop to draw")
    radius = np.linspace(0.0, 1.2 * np.max(states.mean_radius), 300)

    def draw_curve(adhesion: float, label: str | None, **look: Any) -> None:
        force = units.scale(FORCE) * jkr.equilibrium_force(radius, adhesion)
        axes.plot(units.scale(LATERAL) * radius, force, label=label, **look)

    for (direction, look), adhesion in zip(_BRANCHES.items(), works, strict=True):
        every = max(1, np.count_nonzero(states.direction == direction) // MOST_MARKERS)
        sizes = {"markersize": 2.8, "markeredgewidth": 0.6, "markevery": every}
        _mark_states(axes, states, direction, units, label=look.label, **sizes)
        if np.isfinite(adhesion):
            label = rf"JKR, $w_\mathrm{{{look.label[:4]}}} = {units.adhesion_text(adhesion)}$"
            draw_curve(adhesion, label, color=look.colour, linewidth=1.0, zorder=2)
    if np.isfinite(elastic_energy):
        centre = 1 - elastic_energy if kind == "roughness" else 1.0
        text = f"JKR, $k = {PAPER_FACTOR:g}$ (paper)"
        for sign, name in ((-1, text), (1, None)):
            adhesion = max(centre + sign * PAPER_FACTOR * elastic_energy, 0.0)
            draw_curve(adhesion, name, color="0.35", linewidth=0.6, dashes=(4, 2), zorder=1)
    if np.isfinite(window[0]):
        ends = (units.scale(LATERAL) * end for end in window)
        axes.axvspan(*ends, color="0.93", linewidth=0, zorder=0, label="window of the averages")
    _set_limits(axes, states, units)
    for direction in _BRANCHES if arrows else ():
        _draw_motion(axes, *_places(states, direction, units), _BRANCHES[direction].colour)
    _name_axes(axes, units)
    axes.legend(loc="upper left")


def _places(states: LoopStates, direction: int, units: AxisUnits) -> tuple[Array, Array]:
    """Mean radii and forces of a branch in the units of the axes."""
    branch = states.direction == direction
    return units.scale(LATERAL) * states.mean_radius[branch], units.scale(FORCE) * states.force[
        branch
    ]


def _mark_states(
    axes: Axes, states: LoopStates, direction: int, units: AxisUnits = REDUCED, **look: Any
) -> None:
    """Draw an open marker for each state of a branch."""
    look |= {"color": _BRANCHES[direction].colour, "marker": _BRANCHES[direction].marker}
    places = _places(states, direction, units)
    axes.plot(*places, linestyle="none", markerfacecolor="none", zorder=3, **look)


def _name_axes(axes: Axes, units: AxisUnits = REDUCED) -> None:
    """Names of the axes of a loop."""
    units.name(axes.xaxis, "mean contact radius", LATERAL)
    units.name(axes.yaxis, "normal force", FORCE)


def draw_pinning(
    axes: Axes,
    states: LineState[Array],
    n_period: int | None = None,
    *,
    elastic_energy: float | None = None,
) -> None:
    """Draw both branches, and their means over the last period of the tile if it is given.

    The last `n_period` states of each branch are a period. Its mean is k times the measured e_el
    (units: w_int).

    Raises
    ------
    ValueError
        If there is no state, or a branch has fewer of them than a period.
    """
    if states.spring_position.size == 0:
        raise ValueError("the record holds no state; there is no loop to draw")
    for direction, colour in ((1, BLUE), (-1, VERMILION)):
        name = states.branch_names[direction]
        branch = states.direction == direction
        load, pinning = states.spring_position[branch], states.pinning_force[branch]
        axes.plot(load, pinning, color=colour, linewidth=0.8, label=name, zorder=3)
        if n_period is None or elastic_energy is None:
            continue
        if load.size < n_period:
            raise ValueError(
                f"the branch {name} has {load.size} states, fewer than the {n_period} of a period; "
                "the front was left before it had passed the tile"
            )
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
    """Limits around the states, with room for the legend at the upper left."""
    for values, setter, unit, below, above in (
        (states.mean_radius, axes.set_xlim, units.scale(LATERAL), 0.12, 0.08),
        (states.force, axes.set_ylim, units.scale(FORCE), 0.15, 0.2),
    ):
        low, high = float(np.min(values)), float(np.max(values))
        span = max(high - low, 0.1)
        setter(unit * (low - below * span), unit * (high + above * span))


def _draw_motion(axes: Axes, radius: Array, force: Array, colour: str) -> None:
    """Arrow beside a branch, in the direction of motion, where it is furthest from all curves."""
    if radius.size < FEWEST_FOR_ARROW:
        return
    to_axes = axes.transData + axes.transAxes.inverted()
    drawn = np.concatenate([to_axes.transform(line.get_xydata()) for line in axes.get_lines()])
    places = to_axes.transform(np.stack([radius, force], axis=1))
    span = max(1, radius.size // 5)
    tails, heads = places[:-span], places[span:]
    along = (heads - tails) / np.hypot(*(heads - tails).T)[:, None]
    centres = (tails + heads) / 2
    found = []
    for aside in _ASIDE:
        middle = centres + aside * np.stack([-along[:, 1], along[:, 0]], axis=1)
        ends = np.stack([middle + part * _HALF_ARROW * along for part in (-1, 0, 1)])
        apart = np.hypot(*(ends[:, :, None] - drawn).transpose(3, 0, 1, 2)).min(axis=(0, 2))
        inside = np.all((ends > _MARGIN) & (ends < 1 - _MARGIN), axis=(0, 2))
        free = inside & ~np.any((ends < _LEGEND)[..., 0] & (ends > 1 - _LEGEND)[..., 1], axis=0)
        found += [(apart[k], *ends[::2, k]) for k in np.flatnonzero(free)]
    if not found:
        return
    _, tail, head = max(found, key=lambda one: float(one[0]))
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.0, "mutation_scale": 8}
    axes.annotate("", head, tail, "axes fraction", arrowprops=look, zorder=4)
