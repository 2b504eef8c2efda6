"""A whole cycle as it is seen: every front over the field, and the loop that it draws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.variables import ADHESION, ENERGY, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.fronts import closed_front, draw_field
from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, explain, house_style
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.simulation import simulation_adhesion, simulation_field
from crackfront.simulate.sphere.full_cycle import FullCycle
from studies.paper.checks import Check, close_to
from studies.paper.cycle_animation import LAST_FRAMES, GrowingLoop, shown_state
from studies.paper.drawing import Animation
from studies.paper.figure import Figure, Integers, values_of
from studies.paper.rough import RoughCycleParameters, patch_of, whole_cycle
from studies.progress import Progress

_STATE, _ANGLE, _X, _Y = "state", "angle", "x", "y"

_PATCH_POINTS = 400
"""Points along a side of the field that is shown."""


@dataclass(frozen=True, slots=True)
class AnimatedCycle:
    """All states of a cycle with their fronts, and the field."""

    status: str = variable("what ended the cycle", "1")
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    end_penetration: float = variable("penetration at which contact was lost", VERTICAL)
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STATE)
    mean_radius: Array = variable("mean contact radius", LATERAL, _STATE)
    force: Array = variable("normal force", FORCE, _STATE)
    dissipated_energy: Array = variable("energy lost in a load step", ENERGY, _STATE)
    pull_off_energy: float = variable("energy lost when the contact vanishes", ENERGY)
    angle: Array = variable("angle of a site", "rad", _ANGLE)
    front: Array = variable("front", LATERAL, _STATE, _ANGLE)
    x: Array = variable("abscissa of the field", LATERAL, _X)
    y: Array = variable("ordinate of the field", LATERAL, _Y)
    patch: NDArray[np.float32] = variable("local work of adhesion", ADHESION, _X, _Y)


def motion(parameters: RoughCycleParameters, progress: Progress) -> AnimatedCycle:
    """A full cycle with all its fronts."""
    simulation = parameters.simulation()
    adhesion = simulation_adhesion(simulation)
    field = simulation_field(simulation, adhesion)
    compile_solver(simulation.solver.name, FullCycle)
    recorder = Recorder(fronts=True, energy=True)
    record = run_cycle(field, parameters.schedule, simulation.solver, recorder)
    progress(f"{record.states.penetration.size} states: {record.status.value}")
    if record.fronts is None or record.dissipated_energy is None or record.pull_off_energy is None:
        raise ValueError(f"the cycle ended early: {record.status.value}")
    reach = 1.08 * record.states.max_radius.max()
    axis = np.linspace(-reach, reach, _PATCH_POINTS)
    return AnimatedCycle(
        status=record.status.value,
        elastic_energy=adhesion.e_el,
        end_penetration=record.end_load,
        **values_of(record.states, "direction", "penetration", "mean_radius", "force"),
        **values_of(record, "dissipated_energy", "pull_off_energy"),
        angle=2 * np.pi * np.arange(record.fronts.shape[1]) / record.fronts.shape[1],
        front=record.fronts,
        x=axis,
        y=axis,
        patch=patch_of(field, axis, axis),
    )


def motion_checks(shown: AnimatedCycle) -> tuple[Check, ...]:
    """What must be true of every frame."""
    approach = shown.direction > 0
    moved = shown.direction[1:, None] * np.diff(shown.front, axis=0)
    smallest = float(shown.dissipated_energy.min())
    # Loop integral of F db, in which each front is held while the penetration changes.
    ends = np.append(shown.penetration[1:], shown.end_penetration)
    held = np.mean(jkr.force(shown.front, ends[:, None]), axis=1)
    work = float(np.sum((shown.force + held) / 2 * (ends - shown.penetration)))
    dissipated = float(shown.dissipated_energy.sum()) + shown.pull_off_energy
    mean = np.mean(jkr.force(shown.front, shown.penetration[:, None]), axis=1)
    return (
        whole_cycle(shown.status),
        Check(
            "no site of the front moves back, neither in approach nor in retraction",
            "the least way forward is 0 or more",
            f"{moved.min():.2g}",
            bool(moved.min() >= 0),
        ),
        close_to(
            "the fronts that are shown have the forces that are shown, largest difference",
            float(np.max(np.abs(mean - shown.force))),
            0.0,
            1e-9,
            units=FORCE,
        ),
        Check(
            "every load step dissipates",
            "the least energy is 0 or more",
            f"{smallest:.2g}",
            smallest >= 0,
        ),
        close_to(
            "the dissipated energies sum up to the work of the loop",
            dissipated,
            work,
            1e-9,
            remark=f"in {FORCE} times a reduced vertical length; {np.count_nonzero(approach)} "
            f"states in approach, {np.count_nonzero(~approach)} in retraction",
        ),
    )


def motion_figure(shown: AnimatedCycle) -> Drawing:
    """The last frame with contact, and the whole loop."""
    animation = motion_animation(shown)
    with house_style():
        animation.show(shown.direction.size - 1)
        return animation.figure


def motion_animation(shown: AnimatedCycle) -> Animation:
    """The front over the field, and the loop: one frame a state, and some without contact."""
    n_state = shown.direction.size
    with house_style():
        figure = blank_figure(PAGE, 0.53 * PAGE)
        map_axes, loop_axes = figure.subplots(1, 2)
        mean, reach = 1 - shown.elastic_energy, 4 * np.sqrt(shown.elastic_energy)
        draw_field(map_axes, shown.x, shown.y, shown.patch, mean, reach)
        (front,) = map_axes.plot([], [], linewidth=1.2)
        title = map_axes.set_title("penetration $+0.00$")
        loop_axes.set(xlabel=FORCE_LABEL, ylabel=f"mean {RADIUS_LABEL}")
        name = "front on the left"
        loop = GrowingLoop(loop_axes, shown.direction, shown.force, shown.mean_radius, name)
        explain(figure, f"unit of the penetration: ${VERTICAL.tex}$")

    def show(frame: int) -> None:
        state, in_contact = shown_state(frame, n_state)
        loop.show(state, in_contact=in_contact)
        front.set_color(BLUE if shown.direction[state] > 0 else VERMILION)
        if in_contact:
            front.set_data(*closed_front(shown.angle, shown.front[state]))
            title.set_text(f"penetration ${shown.penetration[state]:+.2f}$")
        else:
            front.set_data([], [])
            title.set_text(f"penetration ${shown.end_penetration:+.2f}$, contact lost")

    return Animation(figure, (front, title, *loop.artists), n_state + LAST_FRAMES, show)


FIGURE = Figure(
    title="Beyond the paper: animation of the fronts of a cycle over the field, with its loop",
    compute=motion,
    checks=motion_checks,
    draw=motion_figure,
    animate=motion_animation,
)
