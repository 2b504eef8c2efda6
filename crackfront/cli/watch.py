"""A running cycle on a terminal: the front from above, beside the loop as it grows."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from crackfront.core.cycle.record import Recorder
    from crackfront.core.geometry.sphere import ContactState

    Array = NDArray[np.float64]

_ROWS = 18
"""Height of the two panels, in lines."""

_NARROWEST = 60
"""Columns below which the panels are not drawn."""

_SECONDS = 0.1
"""Time between two frames, so that drawing costs next to nothing."""

_SECONDS_BETWEEN_LINES = 10.0
"""Time between two lines where there is no terminal."""

_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bits of the dots of a Braille character, two to the right and four down."""

_COLOURS = {1: "blue", -1: "red"}
"""Colours of approach and retraction."""


class Canvas:
    """Dots in Braille characters, two by four to each; a character has the colour of its last dot.

    Parameters
    ----------
    columns, rows : int
        Size in characters.
    left, right, bottom, top : float
        Coordinates of the edges.
    """

    def __init__(
        self, columns: int, rows: int, left: float, right: float, bottom: float, top: float
    ) -> None:
        self._bits = [[0] * columns for _ in range(rows)]
        self._colours: list[list[str | None]] = [[None] * columns for _ in range(rows)]
        self._left, self._top = left, top
        self._scale = (2 * columns - 1) / (right - left), (4 * rows - 1) / (top - bottom)

    def add(self, x: Array, y: Array, colour: str) -> None:
        """Put dots at points; those outside are left out."""
        for abscissa, ordinate in zip(x.tolist(), y.tolist(), strict=True):
            column = round((abscissa - self._left) * self._scale[0])
            row = round((self._top - ordinate) * self._scale[1])
            if 0 <= column < 2 * len(self._bits[0]) and 0 <= row < 4 * len(self._bits):
                self._bits[row // 4][column // 2] |= _DOTS[row % 4][column % 2]
                self._colours[row // 4][column // 2] = colour

    def lines(self) -> list[str]:
        """Lines of characters, coloured."""
        return [
            "".join(
                click.style(chr(0x2800 + bits), fg=colour) if bits else " "
                for bits, colour in zip(row, colours, strict=True)
            )
            for row, colours in zip(self._bits, self._colours, strict=True)
        ]


class Progress:
    """What is called at every new state: its line and the time that is left.

    On a terminal the line replaces the last one, elsewhere there is one now and then.

    Parameters
    ----------
    expected : int
        States that the cycle will have, roughly.
    """

    _seconds_between_lines = _SECONDS_BETWEEN_LINES

    def __init__(self, expected: int) -> None:
        self._expected = expected
        self._begun: tuple[float, int] | None = None
        self._next = 0.0
        self._last: Recorder | None = None

    def __call__(self, recorder: Recorder) -> None:
        """Show the last state, if there was nothing shown just now."""
        now, terminal = time.monotonic(), sys.stderr.isatty()
        wait = _SECONDS if terminal else self._seconds_between_lines
        if self._begun is None:
            self._begun = now, len(recorder.states)
            self._next = now if terminal else now + wait
        self._last = recorder
        if now < self._next:
            return
        if terminal:
            self._show(recorder)
        else:
            click.echo(self._line(recorder), err=True)
        self._next = time.monotonic() + wait

    def finish(self) -> None:
        """Show the last state of all, which may have come just after another one."""
        if self._last is not None and sys.stderr.isatty():
            self._show(self._last)
            self._end()

    def _line(self, recorder: Recorder) -> str:
        """Last state, and how long the others will take if they take as long as those before."""
        line, count = state_line(recorder.states), len(recorder.states)
        begun, known = self._begun or (0.0, count)
        left = self._expected - count
        if count == known or left <= 0:
            return line
        seconds = (time.monotonic() - begun) * left / (count - known)
        return f"{line}; about {duration(seconds)} left"

    def _show(self, recorder: Recorder) -> None:
        """Replace the last line."""
        click.echo(f"\r{self._line(recorder)}\x1b[K", nl=False, err=True)

    def _end(self) -> None:
        """Leave the line."""
        click.echo(err=True)


class Watch(Progress):
    """The same with the front and the loop as they grow; a line a state without a terminal.

    Parameters
    ----------
    expected : int
        As of :class:`Progress`.
    max_penetration : float or None
        Largest penetration of the cycle, which decides how much the panels show; without one, as
        where no sphere is pressed, there are lines alone.
    """

    _seconds_between_lines = 0.0

    def __init__(self, expected: int, max_penetration: float | None) -> None:
        from crackfront.core import jkr

        super().__init__(expected)
        self._panels: tuple[float, tuple[float, float]] | None = None
        if max_penetration is not None:
            # Room for a contact that sticks more than a smooth one, or less.
            smooth = jkr.equilibrium_radius(max_penetration)
            highest = float(jkr.equilibrium_force(smooth)) + 0.7
            self._panels = 1.15 * smooth, (1.5 * jkr.pull_off_force(), highest)
        self._drawn = 0

    def _show(self, recorder: Recorder) -> None:
        """Replace the last frame."""
        columns, rows = os.get_terminal_size(sys.stderr.fileno())
        lines = [self._line(recorder)]
        # A frame that does not fit cannot be replaced.
        if self._panels and columns >= _NARROWEST and rows > _ROWS + 2:
            lines += frame(recorder.states, recorder.front, columns - 1, *self._panels)
        back = f"\x1b[{self._drawn}A\x1b[J" if self._drawn else ""
        click.echo(back + "\n".join(lines), err=True)
        self._drawn = len(lines)

    def _end(self) -> None:
        """A frame ends with a line of its own."""


def duration(seconds: float) -> str:
    """A time in the unit that a person would take."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s" if seconds >= 1 else "1 s"


def state_line(states: Sequence[Any]) -> str:
    """What is told of the last state of a cycle."""
    branch = "approach" if states[-1].direction > 0 else "retraction"
    return f"state {len(states)}, {branch}: {states[-1].told}"


def frame(
    states: Sequence[ContactState[float]],
    front: Array,
    columns: int,
    largest: float,
    forces: tuple[float, float],
) -> list[str]:
    """Front and loop side by side, with their scales below.

    Parameters
    ----------
    states : sequence of ContactState
        The states so far.
    front : (n_angle,) array
        Front of the last. (Units: reduced lateral length)
    columns : int
        Width in characters.
    largest : float
        Largest radius that is shown. (Units: reduced lateral length)
    forces : tuple of float
        Lowest and highest force that are shown. (Units: pi w_int R)

    Returns
    -------
    list of str
        Lines; a character is about twice as high as wide, so that the front looks round.
    """
    import numpy as np

    left = 2 * _ROWS
    plane = Canvas(left, _ROWS, -largest, largest, -largest, largest)
    # Several dots a site, so that the curve is closed on the canvas.
    site = np.linspace(0, front.size, max(front.size, 600))
    radius = np.interp(site, np.arange(front.size + 1), np.append(front, front[0]))
    angle = 2 * np.pi * site / front.size
    colour = _COLOURS[int(states[-1].direction)]
    plane.add(radius * np.cos(angle), radius * np.sin(angle), colour)
    loop = Canvas(columns - left - 3, _ROWS, 0.0, largest, *forces)
    ground = np.linspace(0.0, largest, 400)
    loop.add(ground, np.zeros_like(ground), "bright_black")
    for direction, name in _COLOURS.items():
        branch = [one for one in states if one.direction == direction]
        radii, pulls = (
            np.array([getattr(one, key) for one in branch]) for key in ("mean_radius", "force")
        )
        loop.add(radii, pulls, name)
    rows = [f"{one} │ {other}" for one, other in zip(plane.lines(), loop.lines(), strict=True)]
    below = f"front, |x|, |y| < {largest:.3g}"
    told = f"force {forces[0]:.3g} to {forces[1]:.3g} over radius 0 to {largest:.3g}"
    return [*rows, f"{below:{left}} │ {told}"[:columns]]
