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
from crackfront.plots.style import BLACK, PAGE, blank_figure, explain, house_style
from crackfront.simulate.simulation import simulation_field
from crackfront.validation import Positive
from studies.paper.checks import Check
from studies.paper.drawing import BRANCHES, Animation
from studies.paper.figure import Figure, Integers, Progress
from studies.paper.nanodiamond import NanodiamondCycle
from studies.paper.rough import expected_seconds, recorded

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
        sites = slice(None, None, -(-recorder.front.size // _MOST_SITES))
        fronts.append(recorder.front[sites] * scales.lateral)

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
    reached, lost = 1e3 * float(shown.force.max()), Status.LOST_CONTACT.value
    return (
        Check(
            "the cycle is whole: it reaches the largest force and ends by losing contact",
            f"{1e3 * shown.largest_force:g} mN; {lost}",
            f"{reached:.4g} mN; {shown.status}",
            reached >= 1e3 * shown.largest_force and shown.status == lost,
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

_LAST_FRAMES = 10
"""Frames without contact at the end."""


def video_figure(shown: Video) -> Drawing:
    """The last frame of the approach, with the whole loop up to there."""
    animation = video_animation(shown)
    with house_style():
        animation.show(int(np.argmax(shown.force)))
        return animation.figure


def video_animation(shown: Video) -> Animation:
    """Contact area with the perimeters of its branch, and the loop: one frame a state."""
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        area_axes, loop_axes = figure.subplots(1, 2)
        x, y = (1e6 * shown.front * way(shown.angle) for way in (np.cos, np.sin))
        reach = 1.05 * float(1e6 * shown.front.max())
        area_axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        area_axes.set(xlabel="$x$ (µm)", ylabel="$y$ (µm)", facecolor="0.35")
        contact = Polygon(np.zeros((3, 2)), facecolor="0.85", edgecolor="none")
        area_axes.add_patch(contact)
        perimeters = LineCollection([], linewidths=0.4)
        area_axes.add_collection(perimeters)
        title = area_axes.set_title("0 s")
        force, radius = 1e3 * shown.force, 1e6 * shown.radius
        margins = 0.06 * np.ptp(radius), 0.06 * np.ptp(force)
        loop_axes.set_xlim(force.min() - margins[1], force.max() + margins[1])
        loop_axes.set_ylim(radius.min() - margins[0], radius.max() + margins[0])
        loop_axes.set(xlabel="normal force (mN)", ylabel="mean contact radius (µm)")
        branches = {
            direction: loop_axes.plot([], [], color=colour, label=name)[0]
            for direction, name, _, colour in BRANCHES
        }
        (point,) = loop_axes.plot([], [], "o", color=BLACK, zorder=4, label="frame on the left")
        loop_axes.legend(loc="lower right")
        explain(figure, f"bright: the contact; lines: its perimeters, one in {_EVERY} frames")
    colours = {direction: colour for direction, _, _, colour in BRANCHES}
    last = shown.direction.size

    def show(frame: int) -> None:
        state, touching = min(frame, last - 1), frame < last
        direction = shown.direction[state]
        edge = np.column_stack([x[state], y[state]]) if touching else np.zeros((3, 2))
        contact.set_xy(edge)
        passed = np.flatnonzero(shown.direction[: state + 1] == direction)[::-_EVERY]
        perimeters.set_segments([np.column_stack([x[earlier], y[earlier]]) for earlier in passed])
        perimeters.set_color(colours[direction])
        title.set_text(f"{shown.time[state]:.0f} s{'' if touching else ', contact lost'}")
        for branch, drawn in branches.items():
            seen = np.flatnonzero(shown.direction[: state + 1] == branch)
            drawn.set_data(force[seen], radius[seen])
        now = slice(state, state + 1) if touching else slice(0, 0)
        point.set_data(force[now], radius[now])

    moving = (contact, perimeters, title, *branches.values(), point)
    return Animation(figure, moving, last + _LAST_FRAMES, show)


FIGURE = Figure(
    title="Beyond the paper: animation of area, perimeters and force on nanodiamond, in SI units",
    compute=video,
    checks=video_checks,
    draw=video_figure,
    animate=video_animation,
    seconds=expected_seconds,
)
