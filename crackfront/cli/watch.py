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


class Progress:
    """What is called at every new state and prints it, with the time that is left.

    Parameters
    ----------
    expected : int
        States that the cycle will have, roughly.
    every_state : bool, optional
        Whether a log gets a line for every state, not one now and then.
    """

    def __init__(self, expected: int, *, every_state: bool = False) -> None:
        self._expected = expected
        self._log_wait = 0.0 if every_state else _SECONDS_IN_LOG
        self._begun: tuple[float, int] | None = None
        self._next = 0.0
        self._last: Recorder | None = None

    def __call__(self, recorder: Recorder) -> None:
        """Print the last state, unless another one was printed just now."""
        now, terminal = time.monotonic(), sys.stderr.isatty()
        wait = _SECONDS if terminal else self._log_wait
        if self._begun is None:
            self._begun = now, len(recorder.states)
            self._next = now if terminal else now + wait
        self._last = recorder
        if now < self._next:
            return
        if terminal:
            self._replace_line(recorder)
        else:
            click.echo(self._line(recorder), err=True)
        self._next = time.monotonic() + wait

    def finish(self) -> None:
        """Leave the last state of all on the terminal."""
        if self._last is not None and sys.stderr.isatty():
            self._replace_line(self._last)
            click.echo(err=True)

    def _replace_line(self, recorder: Recorder) -> None:
        """Print a line over the last one."""
        click.echo(f"\r{self._line(recorder)}\x1b[K", nl=False, err=True)

    def _line(self, recorder: Recorder) -> str:
        """Last state, and the time that the others need at the pace of those before."""
        line, count = state_line(recorder.states), len(recorder.states)
        begun, known = self._begun or (0.0, count)
        left = self._expected - count
        if count == known or left <= 0:
            return line
        seconds = (time.monotonic() - begun) * left / (count - known)
        return f"{line}; about {in_time(seconds)} left"


def state_line(states: Sequence[Any]) -> str:
    """The last state of a cycle in a line."""
    last = states[-1]
    branch = "approach" if last.direction > 0 else "retraction"
    return f"state {len(states)}, {branch}: {last.told}, {last.iterations} sweeps"
