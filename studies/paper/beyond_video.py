"""The contact on nanodiamond as in the videos of the paper: its area, its perimeters, its force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.cycle.record import Recorder
from crackfront.core.outcome import Status
from crackfront.core.variables import variable
from crackfront.plots.style import PAGE, blank_figure, explain, house_style
from crackfront.simulate.simulation import simulation_field
from crackfront.validation import Positive
from studies.paper.checks import Check
from studies.paper.cycle_animation import LAST_FRAMES, GrowingLoop, shown_state
from studies.paper.drawing import BRANCHES, Animation
from studies.paper.figure import Figure, Integers
from studies.paper.nanodiamond import NanodiamondCycle
from studies.paper.rough import expected_seconds, recorded
from studies.progress import Progress
from studies.records import thinned

_STATE, _ANGLE = "state", "angle"

_MOST_SITES = 1500
"""Sites of a front that are kept, more than a frame has pixels around the contact."""


class VideoParameters(NanodiamondCycle):
    """The cycle, and how fast it goes."""

    speed: Positive  # of the sphere (m / s)


@dataclass(frozen=True, slots=True)
class Video:
    """All fronts of a cycle on nanodiamond, in SI units."""

    status: str = variable("what ended the cycle", "1")
    largest_force: float = variable("force at which the approach turns", "N")
    time: Array = variable("time at the speed of the sphere", "s", _STATE)
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    radius: Array = variable("mean contact radius", "m", _STATE)
    force: Array = variable("normal force", "N", _STATE)
    angle: Array = variable("angle of a site", "rad", _ANGLE)
    front: NDArray[np.float32] = variable("front", "m", _STATE, _ANGLE)


def video(parameters: VideoParameters, progress: Progress) -> Video:
    """A full cycle with its fronts."""
    scales, simulation = parameters.scales, parameters.simulation()
    fronts: list[Array] = []

    def observe(recorder: Recorder) -> None:
        front = recorder.front
        fronts.append(front[thinned(front.size, _MOST_SITES)] * scales.lateral)

    recorder = Recorder(observers=[observe])
    loads = parameters.cycle(recorder, progress)
    record = recorded(simulation, simulation_field(simulation), loads, recorder)
    progress(f"{len(fronts)} states: {record.status.value}")
    states = record.states
    travel = np.abs(np.diff(states.penetration, prepend=states.penetration[0])) * scales.vertical
    return Video(
        status=record.status.value,
        largest_force=parameters.largest_force,
        time=np.cumsum(travel) / parameters.speed,
        direction=states.direction,
        radius=states.mean_radius * scales.lateral,
        force=states.force * scales.force,
        angle=2 * np.pi * np.arange(fronts[0].size) / fronts[0].size,
        front=np.array(fronts, dtype=np.float32),
    )


def video_checks(shown: Video) -> tuple[Check, ...]:
    """What must be true of every frame."""
    moved = shown.direction[1:, None] * np.diff(shown.front, axis=0)
    largest, reached = _MILLI * shown.largest_force, _MILLI * float(shown.force.max())
    lost = Status.LOST_CONTACT.value
    return (
        Check(
            "the cycle is whole: it reaches the largest force and ends by losing contact",
            f"{largest:g} mN; {lost}",
            f"{reached:.4g} mN; {shown.status}",
            reached >= largest and shown.status == lost,
        ),
        Check(
            "no site of the front moves back, neither in approach nor in retraction",
            "the least way forward is 0 or more",
            f"{moved.min():.2g} m",
            bool(moved.min() >= 0),
        ),
    )


_EVERY = 3
"""Frames from one perimeter that stays to the next."""

_MICRO = 1e6
"""Micrometres in a metre."""

_MILLI = 1e3
"""Millinewtons in a newton."""

_NO_CONTACT = np.zeros((3, 2))
"""Corners of a triangle without an area."""


def video_figure(shown: Video) -> Drawing:
    """The last frame of the approach, with the whole loop up to there."""
    animation = video_animation(shown)
    with house_style():
        animation.show(int(np.argmax(shown.force)))
        return animation.figure


def video_animation(shown: Video) -> Animation:
    """Contact area with the perimeters of its branch, and the loop: one frame a state."""
    n_state = shown.direction.size
    x, y = (_MICRO * shown.front * component(shown.angle) for component in (np.cos, np.sin))
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        area_axes, loop_axes = figure.subplots(1, 2)
        reach = 1.05 * float(_MICRO * shown.front.max())
        area_axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        area_axes.set(xlabel="$x$ (µm)", ylabel="$y$ (µm)", facecolor="0.35")
        contact = Polygon(_NO_CONTACT, facecolor="0.85", edgecolor="none")
        area_axes.add_patch(contact)
        perimeters = LineCollection([], linewidths=0.4)
        area_axes.add_collection(perimeters)
        title = area_axes.set_title("0 s")
        loop_axes.set(xlabel="normal force (mN)", ylabel="mean contact radius (µm)")
        force, radius = _MILLI * shown.force, _MICRO * shown.radius
        loop = GrowingLoop(loop_axes, shown.direction, force, radius, "frame on the left")
        explain(figure, f"bright: the contact; lines: its perimeters, one in {_EVERY} frames")
    colours = {direction: colour for direction, _, _, colour in BRANCHES}

    def show(frame: int) -> None:
        state, in_contact = shown_state(frame, n_state)
        loop.show(state, in_contact=in_contact)
        direction = shown.direction[state]
        contact.set_xy(np.column_stack([x[state], y[state]]) if in_contact else _NO_CONTACT)
        earlier = np.flatnonzero(shown.direction[: state + 1] == direction)[::-_EVERY]
        perimeters.set_segments([np.column_stack([x[line], y[line]]) for line in earlier])
        perimeters.set_color(colours[direction])
        title.set_text(f"{shown.time[state]:.0f} s{'' if in_contact else ', contact lost'}")

    moving = (contact, perimeters, title, *loop.artists)
    return Animation(figure, moving, n_state + LAST_FRAMES, show)


FIGURE = Figure(
    title="Beyond the paper: animation of area, perimeters and force on nanodiamond, in SI units",
    compute=video,
    checks=video_checks,
    draw=video_figure,
    animate=video_animation,
    seconds=expected_seconds,
)
