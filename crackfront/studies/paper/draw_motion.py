"""Animation of a cycle: the front over the field, beside the loop that it draws."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.plots.animation import Animation
from crackfront.plots.fronts import closed_front, draw_field
from crackfront.plots.parts import FORCE_LABEL, PENETRATION_LABEL, RADIUS_LABEL
from crackfront.plots.style import BLACK, BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.motion import Motion

_LAST_FRAMES = 10
"""Frames without contact at the end."""


class _Scene:
    """The figure of one animation and its parts that move."""

    def __init__(self, shown: Motion) -> None:
        self._shown = shown
        self.figure = blank_figure(PAGE, 0.47 * PAGE)
        left, right = self.figure.subplots(1, 2)
        mean, reach = 1 - shown.elastic_energy, 4 * np.sqrt(shown.elastic_energy)
        draw_field(left, shown.x, shown.y, shown.patch, mean, reach)
        _draw_axes(right, shown)
        (self._front,) = left.plot([], [], linewidth=1.2)
        self._title = left.set_title(f"{PENETRATION_LABEL} = $+0.00$")
        self._branches = {
            direction: right.plot([], [], color=colour, label=label)[0]
            for direction, colour, label in ((1, BLUE, "approach"), (-1, VERMILION, "retraction"))
        }
        (self._point,) = right.plot([], [], "o", color=BLACK, zorder=4)
        right.legend(loc="upper left")

    @property
    def moving(self) -> tuple[Artist, ...]:
        """Parts that differ from frame to frame."""
        return (self._front, self._title, *self._branches.values(), self._point)

    def show(self, frame: int) -> None:
        """Put all parts where they are in a frame; after the last state there is no contact."""
        shown, last = self._shown, self._shown.direction.size
        state = min(frame, last - 1)
        self._front.set_color(BLUE if shown.direction[state] > 0 else VERMILION)
        front = closed_front(shown.angle, shown.front[state])
        self._front.set_data(*front if frame < last else ([], []))
        b = shown.penetration[state] if frame < last else shown.end_penetration
        lost = "" if frame < last else ": contact lost"
        self._title.set_text(f"{PENETRATION_LABEL} = ${b:+.2f}${lost}")
        for direction, line in self._branches.items():
            branch = np.flatnonzero(shown.direction[: state + 1] == direction)
            line.set_data(shown.mean_radius[branch], shown.force[branch])
        seen = slice(state, state + 1) if frame < last else slice(0, 0)
        self._point.set_data(shown.mean_radius[seen], shown.force[seen])


def motion_figure(shown: Motion) -> Figure:
    """The last frame with contact, and the whole loop.

    Parameters
    ----------
    shown : Motion
        Data of the animation.
    """
    with house_style():
        scene = _Scene(shown)
        scene.show(shown.direction.size - 1)
        return scene.figure


def motion_animation(shown: Motion) -> Animation:
    """One frame a state, and some without contact at the end.

    Parameters
    ----------
    shown : Motion
        Data of the animation.
    """
    with house_style():
        scene = _Scene(shown)
        return Animation(
            scene.figure, scene.moving, shown.direction.size + _LAST_FRAMES, scene.show
        )


def _draw_axes(axes: Axes, shown: Motion) -> None:
    """Axes that hold the whole loop."""
    axes.axhline(0.0, color="0.6", linewidth=0.4, zorder=1)
    for values, setter, above in (
        (shown.mean_radius, axes.set_xlim, 0.06),
        (shown.force, axes.set_ylim, 0.2),
    ):
        low, high = values.min(), values.max()
        setter(low - 0.06 * (high - low), high + above * (high - low))
    axes.set_xlabel(f"mean {RADIUS_LABEL}")
    axes.set_ylabel(FORCE_LABEL)
