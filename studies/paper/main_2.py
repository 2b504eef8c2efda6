"""Main Fig. 2: a sphere whose work of adhesion varies in concentric rings, a scalar problem."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots import parts, style
from crackfront.sweep.section import Section, section_error
from crackfront.validation import Count, Positive
from studies.paper.checks import Check, close_to
from studies.paper.drawing import BRANCHES, write_next_to
from studies.paper.figure import Figure, Integers, values_of
from studies.paper.rings import INNERMOST, Rings, first_stops, folds, steady_stiffness
from studies.progress import Progress

_STATE, _LOOP, _CASE = "state", "loop", "case"

Amplitude = Annotated[float, Field(gt=0, lt=1)]


class RingsParameters(Section):
    """What Fig. 2 shows, on rings of w_loc(a) = 1 + delta sin(2 pi a / d) in units of w_int."""

    amplitude: Amplitude  # delta
    wavelengths: tuple[Positive, Positive]  # the long and the short d (reduced lateral length)
    max_penetration: Positive  # penetrations to visit (reduced vertical length)
    step: Positive
    samples: Count  # of the field a wavelength
    case_amplitude: Amplitude  # of the cases that are compared with numbers known beforehand
    case_wavelengths: tuple[Positive, ...]
    case_window: tuple[Positive, Positive]  # penetrations between which hysteresis is averaged
    case_step: Positive  # distance of these penetrations

    @model_validator(mode="after")
    def _usable(self) -> RingsParameters:
        (long, short), (low, high) = self.wavelengths, self.case_window
        if not short < long:
            raise section_error(f"wavelengths are {[long, short]}; they must decrease")
        if not low < high:
            raise section_error(f"case_window are {[low, high]}; they must increase")
        if self.samples < 16:
            raise section_error(f"samples is {self.samples}; a ring needs at least 16 of them")
        if self.case_step > high - low:
            raise section_error(
                f"case_step {self.case_step:g} is longer than case_window; lower it"
            )
        return self


@dataclass(frozen=True, slots=True)
class RingLoops:
    """States of the loops, and the mean hysteresis of the cases."""

    amplitude: float = variable("amplitude of the work of adhesion", ADHESION)
    wavelength: Array = variable("wavelength of the rings", LATERAL, _LOOP)
    loop: Integers = variable("index of the loop", "1", _STATE)
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STATE)
    radius: Array = variable("contact radius", LATERAL, _STATE)
    force: Array = variable("normal force", FORCE, _STATE)
    adhesion: Array = variable("energy release rate of the front", ADHESION, _STATE)
    jump: Integers = variable("1 where an instability led to the state", "1", _STATE)
    case_amplitude: float = variable("amplitude of the cases", ADHESION)
    case_lowest: float = variable("lowest penetration of the averages", VERTICAL)
    case_highest: float = variable("highest penetration of the averages", VERTICAL)
    case_wavelength: Array = variable("wavelength of a case", LATERAL, _CASE)
    case_approach: Array = variable("mean work of adhesion in approach", ADHESION, _CASE)
    case_retraction: Array = variable("mean work of adhesion in retraction", ADHESION, _CASE)

    def rings(self, loop: int) -> Rings:
        """Rings of a loop."""
        return Rings(self.amplitude, float(self.wavelength[loop]))

    def branch(self, loop: int, direction: int) -> NDArray[np.bool_]:
        """States of one branch of a loop."""
        return (self.loop == loop) & (self.direction == direction)

    def radius_at_zero(self, loop: int, direction: int) -> float:
        """Radius of a branch at b = 0: state A in approach, B in retraction."""
        return float(self.radius[self.branch(loop, direction) & (self.penetration == 0)][0])


def ring_loops(parameters: RingsParameters, progress: Progress) -> RingLoops:
    """Approach and retraction on rings of both wavelengths, and the cases."""
    schedule, loops = LoadSchedule(parameters.max_penetration, parameters.step), []
    for index, wavelength in enumerate(parameters.wavelengths):
        states = Rings(parameters.amplitude, wavelength).loop(schedule, parameters.samples)
        loops.append(np.column_stack([np.full(len(states), index), states]))
        progress(f"rings of {wavelength:g}: {len(states)} states, {states[:, 3].sum():g} jumps")
    loop, direction, penetration, radius, jump = np.concatenate(loops).T
    low, high = parameters.case_window
    count = round((high - low) / parameters.case_step)
    cases_of_rings = [
        Rings(parameters.case_amplitude, wavelength) for wavelength in parameters.case_wavelengths
    ]
    cases = [rings.mean_adhesion(low, high, count, parameters.samples) for rings in cases_of_rings]
    progress(f"{len(cases)} cases with an amplitude of {parameters.case_amplitude:g}")
    case_approach, case_retraction = np.transpose(cases)
    return RingLoops(
        **values_of(parameters, "amplitude", "case_amplitude"),
        wavelength=np.array(parameters.wavelengths),
        loop=loop.astype(np.int64),
        direction=direction.astype(np.int64),
        penetration=penetration,
        radius=radius,
        force=jkr.force(radius, penetration),
        adhesion=jkr.apparent_work_of_adhesion(radius, penetration),
        jump=jump.astype(np.int64),
        case_lowest=low,
        case_highest=high,
        case_wavelength=np.array(parameters.case_wavelengths),
        case_approach=case_approach,
        case_retraction=case_retraction,
    )


_EXPECTED_HYSTERESIS = {(0.2, 0.3, 0.7, 0.005): (0.3886, 2e-4), (0.2, 0.3, 0.7, 0.1): (0.238, 1e-3)}
"""Hysteresis with its tolerance, by amplitude, window and wavelength, from a separate program."""

_ROUND_OFF = 1e-9


def rings_checks(loops: RingLoops) -> tuple[Check, ...]:
    """First stopping points, the limit of short wavelengths, the states A and B."""
    return (*_loop_checks(loops), *_limit_checks(loops), *_case_checks(loops))


def _loop_checks(loops: RingLoops) -> Iterator[Check]:
    """Radii, pull-off, and the states A and B of every loop."""
    for index, wavelength in enumerate(loops.wavelength):
        rings, start = loops.rings(index), INNERMOST
        for direction, name, *_ in BRANCHES:
            branch = loops.branch(index, direction)
            radius, penetration = loops.radius[branch], loops.penetration[branch]
            stops = first_stops(rings, penetration, direction, start)
            start = radius[-1]
            yield close_to(
                f"rings of {wavelength:g}, {name}: radii, first points where b_eq(a) reaches b, "
                "largest difference",
                float(np.max(np.abs(radius - stops))),
                0.0,
                _ROUND_OFF,
                remark="folds and roots of the closed form of b_eq, without the solver",
            )
        yield close_to(
            f"rings of {wavelength:g}: last penetration, the lowest b_eq, within a load step",
            penetration[-1],
            float(rings.penetration(folds(rings, INNERMOST, start)).min()),
            float(np.max(np.abs(np.diff(penetration)))) * (1 + 1e-9),
        )
        inner, outer = (loops.radius_at_zero(index, direction) for direction in (1, -1))
        yield Check(
            f"rings of {wavelength:g}: a(A) < a(B) at b = 0",
            "a(A) < a(B)",
            f"{inner:.6f}, {outer:.6f}",
            inner < outer,
        )


def _limit_checks(loops: RingLoops) -> Iterator[Check]:
    """The short rings of the figure against JKR with the extremes of their work of adhesion."""
    index = int(np.argmin(loops.wavelength))
    wavelength = loops.wavelength[index]
    for direction, name, *_ in BRANCHES:
        # The steady part: between the first and the last instability, whole rings.
        states = np.flatnonzero(loops.branch(index, direction))
        jumps = states[loops.jump[states] > 0]
        steady = slice(jumps[1], jumps[-1]) if direction > 0 else slice(jumps[0], jumps[-1])
        # In a ring the front goes on from the landing of its jump, S d away, to the extreme.
        extreme = 1 - direction * loops.amplitude
        half = float(np.mean(steady_stiffness(loops.radius[steady], extreme))) * wavelength / 2
        yield close_to(
            f"rings of {wavelength:g}, {name}: mean work of adhesion, the extreme of the field "
            "and half of the fall S d in a jump",
            float(np.mean(loops.adhesion[steady])),
            extreme + direction * half,
            half * math.sqrt(half / loops.amplitude),
            units="w_int",
            remark="the tolerance is of the next order, because extremes are rounded",
        )
    states = loops.loop == index
    lowest = float(loops.force[states].min())
    limit = jkr.pull_off_force(1 + loops.amplitude)
    sharpest = float(steady_stiffness(loops.radius[states].max(), 1 + loops.amplitude))
    reach = jkr.pull_off_force(sharpest * wavelength)
    yield close_to(
        f"rings of {wavelength:g}: pull-off force, -3/2 w_retr or less by the fall S d in a jump",
        lowest,
        limit - reach / 2,
        abs(reach) / 2,
        units="pi w_int R",
    )


def _case_checks(loops: RingLoops) -> Iterator[Check]:
    """Mean hysteresis of the cases, known beforehand or in a limit."""
    delta, low, high = loops.case_amplitude, loops.case_lowest, loops.case_highest
    radii = np.array([jkr.equilibrium_radius(b) for b in np.linspace(low, high, 21)])
    stiffness, softest = (float(part(steady_stiffness(radii))) for part in (np.mean, np.min))
    near, critical = partial(close_to, units="w_int"), 2 * math.pi * delta / softest
    hysteresis = loops.case_retraction - loops.case_approach
    for wavelength, mean_hysteresis in zip(loops.case_wavelength, hysteresis, strict=True):
        name = f"amplitude {delta:g}, rings of {wavelength:g}: mean hysteresis"
        if reference := _EXPECTED_HYSTERESIS.get((delta, low, high, float(wavelength))):
            remark = f"mean over b from {low:g} to {high:g}; from an independent program"
            yield near(name, mean_hysteresis, *reference, remark=remark)
        fall = stiffness * wavelength
        if wavelength == loops.case_wavelength.min():
            yield near(
                f"{name}, peak to peak less the fall in the jumps, 2 delta - S d",
                mean_hysteresis,
                2 * delta - fall,
                fall * math.sqrt(fall / (2 * delta)),
                remark=f"the limit d -> 0 is 2 delta = {2 * delta:g}; the tolerance is of the next "
                "order, S d sqrt(S d / 2 delta), because extremes are rounded",
            )
        if wavelength > critical:
            remark = f"no instability beyond 2 pi delta / S = {critical:.3f}"
            yield near(name, mean_hysteresis, 0.0, _ROUND_OFF, remark=remark)


_COLOURS = ({1: style.BLUE, -1: style.VERMILION}, {1: style.SKY, -1: style.ORANGE})
"""Colours of both branches, dark for the long and light for the short rings."""

_REACH = 2.2
"""Half width of the cross-section (Units: reduced lateral length)."""


def rings_figure(loops: RingLoops) -> Drawing:
    """Contact and rings, sampled works of adhesion for both wavelengths, force against radius."""
    with style.house_style():
        figure = style.blank_figure(style.PAGE, 0.8 * style.PAGE)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.15, 1))
        cell = grid[0, 0].subgridspec(2, 1, height_ratios=(1, 1.25), hspace=0.02)
        profile = figure.add_subplot(cell[0])
        top = figure.add_subplot(cell[1], sharex=profile)
        _draw_contact(profile, loops)
        _draw_rings(top, loops)
        long, short, force = (figure.add_subplot(grid[place]) for place in ((0, 1), (1, 0), (1, 1)))
        _draw_release(long, loops, 0, (0.4, 2.15))
        _draw_release(short, loops, 1, (1.1, 1.8))
        _draw_forces(force, loops)
        for name, axes in zip("abcd", (profile, long, short, force), strict=True):
            parts.label_panel(axes, name)
        style.explain(
            figure,
            "thick: the edge is pinned; thin: it jumps (b, d with arrows); grey: $w_\\mathrm{loc}$ "
            "of the rings; A, B: contact at $b=0$ in approach and retraction; broken lines: the "
            "extremes of the rings",
        )
        return figure


def _draw_contact(axes: Axes, loops: RingLoops) -> None:
    """Cross-section at b = 0: state A on the left, state B on the right."""
    distance = np.linspace(0, _REACH, 600)
    for side in (-1, 1):
        axes.plot(side * distance, distance**2 / 2, color="0.35")
    axes.annotate("sphere", (0.0, 1.0), ha="center", color="0.35")
    for direction, side in ((1, -1), (-1, 1)):
        contact = loops.radius_at_zero(0, direction)
        height = -jkr.surface_displacement(distance, contact, 0.0)
        axes.fill_between(side * distance, height, -1, color="0.88", linewidth=0)
        axes.plot(side * distance, height, color=_COLOURS[0][direction])
        _draw_state(axes, direction, (side * contact, contact**2 / 2), (-7 * side, 3))
    axes.annotate("elastic body", (0.0, -0.4), ha="center")
    axes.set_ylim(-0.6, 1.7)
    axes.set_box_aspect(0.4)
    # As high as the axes.
    axes.set_ylabel(parts.HEIGHT_LABEL.format("height").replace(" / ", " /\n"), fontsize=6)
    axes.tick_params(labelbottom=False)


def _draw_rings(axes: Axes, loops: RingLoops) -> None:
    """Work of adhesion from above, half of it, with the contact edges of A and B."""
    loops.rings(0).draw(axes, _REACH)
    angle = np.linspace(-np.pi, 0, 361)
    for direction, colour in _COLOURS[0].items():
        contact = loops.radius_at_zero(0, direction)
        axes.plot(contact * np.cos(angle), contact * np.sin(angle), color=colour)
    axes.set_xlabel(parts.LENGTH_LABEL.format("$x$"))
    axes.set_ylabel(parts.LENGTH_LABEL.format("$y$").replace(" / ", " /\n"), fontsize=6)


def _draw_release(axes: Axes, loops: RingLoops, index: int, limits: tuple[float, float]) -> None:
    """Work of adhesion of the rings, G at b = 0, and what both branches sample of it."""
    radius = np.linspace(*limits, 3000)
    adhesion, label = loops.rings(index).adhesion(radius), r"$w_\mathrm{loc}(a)$"
    label = f"{label}, $d={loops.wavelength[index]:g}$"
    axes.plot(radius, adhesion, color="0.85", linewidth=0.8, label=label)
    release = jkr.apparent_work_of_adhesion(radius, 0.0)
    axes.plot(radius, release, color=style.BLACK, linewidth=0.8, label=r"$G_\mathrm{JKR}(b=0,a)$")
    for direction, name, short, _ in BRANCHES:
        _draw_branch(axes, loops, index, direction, _radius_and_release, name)
        level = 1 - direction * loops.amplitude
        axes.axhline(level, color="0.3", linewidth=0.6, dashes=(4, 2), zorder=1)
        label, below = rf"$w_\mathrm{{{short}}}$", "top" if direction > 0 else "bottom"
        write_next_to(axes, label, (limits[1], level), (-3, -3 * direction), ha="right", va=below)
        if index == 0:
            contact = loops.radius_at_zero(0, direction)
            place = contact, float(jkr.apparent_work_of_adhesion(contact, 0.0))
            _draw_state(axes, direction, place, (8, -3) if direction > 0 else (-6, 4))
    axes.set(xlim=limits, ylim=(0.35, 2.05), xlabel=parts.RADIUS_LABEL)
    axes.set_ylabel(r"energy release rate / $w_\mathrm{int}$")
    axes.legend(loc="upper left")


def _draw_forces(axes: Axes, loops: RingLoops) -> None:
    """Radius against force of both loops between the JKR curves of the extremes."""
    radius = np.linspace(0.0, _REACH, 400)
    for index in (1, 0):
        for direction, name, *_ in BRANCHES:
            label = rf"{name}, $d={loops.wavelength[index]:g}$"
            _draw_branch(axes, loops, index, direction, _force_and_radius, label)
            if index == 0:
                contact = loops.radius_at_zero(0, direction)
                place = float(jkr.force(contact, 0.0)), contact
                _draw_state(axes, direction, place, (-8, -5) if direction > 0 else (-7, 4))
    for direction, _, short, _ in BRANCHES:
        adhesion = 1 - direction * loops.amplitude
        axes.plot(
            jkr.equilibrium_force(radius, adhesion),
            radius,
            color="0.3",
            linewidth=0.8,
            dashes=(4, 2) if direction > 0 else (1.5, 1.5),
            label=rf"JKR, $w_\mathrm{{{short}}}={adhesion:g}\,w_\mathrm{{int}}$",
            zorder=1,
        )
    axes.plot(
        jkr.force(radius, 0.0), radius, color=style.BLACK, linewidth=0.8, label="$b=0$", zorder=1
    )
    axes.set(
        xlim=(-2.7, 2.7), ylim=(0, _REACH), xlabel=parts.FORCE_LABEL, ylabel=parts.RADIUS_LABEL
    )
    axes.legend(loc="lower right", fontsize=6)


def _radius_and_release(radius: ArrayLike, penetration: ArrayLike) -> tuple[Array, Array]:
    """Point of the energy release rate against the radius."""
    return np.asarray(radius), np.asarray(jkr.apparent_work_of_adhesion(radius, penetration))


def _force_and_radius(radius: ArrayLike, penetration: ArrayLike) -> tuple[Array, Array]:
    """Point of the radius against the force."""
    return np.asarray(jkr.force(radius, penetration)), np.asarray(radius)


def _draw_state(
    axes: Axes, direction: int, place: tuple[float, float], aside: tuple[float, float]
) -> None:
    """State at b = 0 of the long rings, with its letter."""
    colour = _COLOURS[0][direction]
    axes.plot(*place, "o", color=colour, markersize=3, zorder=5)
    letter, middle = "A" if direction > 0 else "B", {"ha": "center", "va": "center"}
    write_next_to(axes, letter, place, aside, color=colour, fontweight="bold", **middle)


def _draw_branch(
    axes: Axes,
    loops: RingLoops,
    index: int,
    direction: int,
    curve: Callable[[ArrayLike, ArrayLike], tuple[Array, Array]],
    label: str,
) -> None:
    """Curve of the contact on a branch: heavy where it is pinned, arrows where it jumps.

    `curve` maps radii and penetrations to points.
    """
    branch, colour = loops.branch(index, direction), _COLOURS[index][direction]
    radius, penetration = loops.radius[branch], loops.penetration[branch]
    starts = np.flatnonzero(loops.jump[branch])
    pieces = zip(np.split(radius, starts), np.split(penetration, starts), strict=True)
    for number, (pinned, load) in enumerate(piece for piece in pieces if piece[0].size):
        name = label if number == 0 else None
        axes.plot(*curve(pinned, load), color=colour, linewidth=1.4, label=name)
    jumps = list(zip(np.r_[0.0, radius][starts], radius[starts], penetration[starts], strict=True))
    if direction < 0:
        jumps.append((radius[-1], 0.0, penetration[-1]))
    for before, after, load in jumps:
        # The energy release rate is not defined at radius zero.
        path = np.linspace(max(before, 1e-6), max(after, 1e-6), 40)
        abscissa, ordinate = curve(path, load)
        axes.plot(abscissa, ordinate, color=colour, linewidth=0.7)
        if index == 0:
            middle = slice(path.size // 2, path.size // 2 + 2)
            parts.draw_arrow(axes, abscissa[middle], ordinate[middle], colour)


FIGURE = Figure(
    title="Main Fig. 2: rings of high and low work of adhesion",
    compute=ring_loops,
    checks=rings_checks,
    draw=rings_figure,
)
