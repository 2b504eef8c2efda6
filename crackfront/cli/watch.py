"""Progress of a running cycle: a line that replaces itself on a terminal, lines in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from crackfront.data.bounds import in_time

if TYPE_CHECKING:
    from crackfront.core.cycle.record import Recorder

_SECONDS = 0.1
"""Time between two lines on a terminal, so that they cost next to nothing."""

_SECONDS_IN_LOG = 10.0
"""Time between two lines of a log."""

_LINE_START, _LINE_END = "\r", "\x1b[K"
"""Codes of a terminal by which a line replaces the last one."""


class Progress:
    """What is called at every new state and prints it, with the time that is left.

    A cycle is expected to have so many states. A log gets a line now and then, or for every state.
    """

    def __init__(self, expected: int, *, every_state: bool = False) -> None:
        self._expected = expected
        self._log_wait = 0.0 if every_state else _SECONDS_IN_LOG
        self._begun: tuple[float, int] | None = None
        self._next = 0.0
        self._line = ""

    def __call__(self, recorder: Recorder) -> None:
        """Print the last state, unless another one was printed just now."""
        now, count, terminal = time.monotonic(), len(recorder.states), sys.stderr.isatty()
        wait = _SECONDS if terminal else self._log_wait
        if self._begun is None:
            self._begun, self._next = (now, count), now if terminal else now + wait
        self._line = state_line(recorder.states)
        # At the pace of the states since the first one, which may be that of a checkpoint.
        begun, known = self._begun
        if known < count < self._expected:
            seconds = (now - begun) * (self._expected - count) / (count - known)
            self._line += f"; about {in_time(seconds)} left"
        if now >= self._next:
            shown = f"{_LINE_START}{self._line}{_LINE_END}" if terminal else self._line
            click.echo(shown, nl=not terminal, err=True)
            self._next = time.monotonic() + wait

    def finish(self) -> None:
        """Leave the last state of all on the terminal."""
        if self._line and sys.stderr.isatty():
            click.echo(f"{_LINE_START}{self._line}{_LINE_END}", err=True)


def state_line(states: Sequence[Any]) -> str:
    """The last state of a cycle in a line."""
    last = states[-1]
    branch = "approach" if last.direction > 0 else "retraction"
    return f"state {len(states)}, {branch}: {last.told}, {last.iterations} sweeps"
