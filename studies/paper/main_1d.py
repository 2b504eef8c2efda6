"""Main Fig. 1d: a smooth sphere whose work of adhesion is larger in retraction than in approach."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from pydantic import model_validator

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.outcome import Direction
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL, draw_arrow
from crackfront.plots.style import COLUMN, VERMILION, blank_figure, house_style
from crackfront.sweep.section import Section, section_error
from crackfront.validation import Positive
from studies.paper.checks import Check, close_to
from studies.paper.drawing import BRANCHES, DOTTED, draw_jump, write_next_to
from studies.paper.figure import Figure, Integers, values_of
from studies.paper.rings import INNERMOST, circle_steps
from studies.progress import Progress

_STATE = "state"


class SmoothLoopParameters(Section):
    """What Fig. 1d shows."""

    approach: Positive  # works of adhesion of the two branches (w_int)
    retraction: Positive
    max_penetration: Positive  # penetrations to visit (reduced vertical length)
    step: Positive

    @model_validator(mode="after")
    def _ordered(self) -> SmoothLoopParameters:
        if self.approach > self.retraction:
            raise section_error(
                f"works of adhesion are {self.approach:g} in approach and {self.retraction:g} in "
                "retraction; the first must not be above the second"
            )
        return self


@dataclass(frozen=True, slots=True)
class SmoothLoop:
    """States of both branches, as they are stored in the file of the figure."""

    approach: float = variable("work of adhesion in approach", ADHESION)
    retraction: float = variable("work of adhesion in retraction", ADHESION)
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STATE)
    radius: Array = variable("contact radius", LATERAL, _STATE)
    force: Array = variable("normal force", FORCE, _STATE)


def smooth_loop(parameters: SmoothLoopParameters, progress: Progress) -> SmoothLoop:
    """Approach with one work of adhesion and retraction with another."""
    schedule = LoadSchedule(parameters.max_penetration, parameters.step)
    largest = jkr.equilibrium_radius(parameters.max_penetration, parameters.retraction)
    radius, states, places = INNERMOST, [], np.array([INNERMOST, 1.1 * largest])
    branches: tuple[tuple[Direction, float, Iterable[float]], ...] = (
        (1, parameters.approach, schedule.approach()),
        (-1, parameters.retraction, schedule.retraction()),
    )
    for direction, adhesion, penetrations in branches:
        field = polar_field(places, np.full(2, adhesion * WORK_OF_ADHESION))
        coming = (Load(penetration, direction) for penetration in penetrations)
        for step in circle_steps(field, coming, radius):
            radius = float(step.front[0])
            states.append((direction, step.load.value, radius))
        progress(f"work of adhesion {adhesion:g}: contact radius {radius:.4f} at the end")
    directions, visited, radii = (np.array(column) for column in zip(*states, strict=True))
    return SmoothLoop(
        **values_of(parameters, "approach", "retraction"),
        direction=directions,
        penetration=visited,
        radius=radii,
        force=jkr.force(radii, visited),
    )


def smooth_loop_checks(loop: SmoothLoop) -> tuple[Check, ...]:
    """The closed forms of JKR, which both branches must follow."""
    retracting = loop.direction < 0
    works = np.where(retracting, loop.retraction, loop.approach)
    pairs = zip(loop.penetration, works, strict=True)
    smooth = np.array([jkr.equilibrium_radius(b, work) for b, work in pairs])
    smooth[retracting] = np.minimum(smooth[retracting], loop.radius[~retracting].max())
    distance = np.abs(loop.radius - smooth)
    return (
        close_to(
            "radii in approach: the stable JKR radius, largest difference",
            float(np.max(distance[~retracting])),
            0.0,
            1e-9,
        ),
        close_to(
            "radii in retraction: the JKR radius, or that at the turn while the edge is pinned",
            float(np.max(distance[retracting])),
            0.0,
            1e-9,
        ),
        close_to(
            "lowest force: -3/2 w_retr, where the force is controlled",
            loop.force.min(),
            jkr.pull_off_force(loop.retraction),
            2e-3,
            units="pi w_int R",
            remark="lowest of the visited states; the load step leaves the difference",
        ),
        close_to(
            "last penetration: where a smooth contact pulls off, to within a load step",
            loop.penetration[-1],
            jkr.pull_off_penetration(loop.retraction),
            float(np.max(np.abs(np.diff(loop.penetration[retracting])))),
        ),
    )


_LOWEST = -0.1
"""Lower end of the ordinate (Units: reduced lateral length)."""


def smooth_loop_figure(loop: SmoothLoop) -> Drawing:
    """Both branches, with arrows in the direction of motion."""
    with house_style():
        figure = blank_figure(COLUMN, 0.8 * COLUMN)
        axes = figure.add_subplot()
        works = (loop.approach, loop.retraction)
        for (direction, name, short, colour), adhesion in zip(BRANCHES, works, strict=True):
            branch = loop.direction == direction
            radius, force = loop.radius[branch], loop.force[branch]
            label = rf"{name}, $w_\mathrm{{{short}}} = {adhesion:g}\,w_\mathrm{{int}}$"
            axes.plot(force, radius, color=colour, label=label)
            middle = radius.size // 2
            near = slice(middle - 1, middle + 1)
            draw_arrow(axes, force[near], radius[near], colour)
            end = 0 if direction > 0 else -1
            _draw_jump(axes, direction, float(radius[end]), float(force[end]), colour)
        # The lowest of all states is the pull-off force where the force is controlled.
        lowest = int(np.argmin(loop.force))
        axes.plot([loop.force[lowest]] * 2, [_LOWEST, loop.radius[lowest]], color="0.3", **DOTTED)
        axes.plot(loop.force[lowest], loop.radius[lowest], "o", color=VERMILION, ms=3.6, zorder=5)
        label = "pull-off force,\n" r"$-\frac{3}{2}\,\pi w_\mathrm{retr}R$"
        write_next_to(axes, label, (loop.force[lowest], 0.0), (4, 0))
        axes.set(xlim=(1.12 * float(np.min(loop.force)), None), ylim=(_LOWEST, None))
        axes.set(xlabel=FORCE_LABEL, ylabel=RADIUS_LABEL)
        figure.legend(loc="outside upper center")
        return figure


def _draw_jump(axes: Axes, direction: int, radius: float, force: float, colour: str) -> None:
    """Thin dashed arrow between no contact and the first or last state."""
    start, end = ((0.0, 0.0), (force, radius))[::direction]
    draw_jump(axes, start, end, colour, linewidth=0.7, mutation_scale=6, linestyle=(0, (4, 2)))
    write_next_to(
        axes,
        "jump into\ncontact" if direction > 0 else "jump out\nof contact",
        (force / 2, radius / 2),
        (4 * direction, 4 * direction),
        ha="left" if direction > 0 else "right",
        va="bottom" if direction > 0 else "top",
        color=colour,
    )


FIGURE = Figure(
    title="Main Fig. 1d: a smooth sphere with two works of adhesion",
    compute=smooth_loop,
    checks=smooth_loop_checks,
    draw=smooth_loop_figure,
)
