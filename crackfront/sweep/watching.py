"""How far a computation is: bars on a terminal, lines in a log."""

from __future__ import annotations

import re
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from crackfront.core.cycle.record import Observer, Recorder

Item = TypeVar("Item")

_PATIENCE = 5.0
"""Time after which a command shows how far it is. (Units: s)"""

_SECONDS_IN_LOG = 10.0
"""Time between two lines of a log on the states of a cycle. (Units: s)"""

_SECONDS_BETWEEN_LOOKS = 1.0
"""Time between two looks at the logs of jobs. (Units: s)"""

_FINISHED = re.compile(rb"^\[\d+/\d+\] ", re.MULTILINE)
_STORED = re.compile(rb": (\d+) of \d+ simulations are stored$", re.MULTILINE)
"""Lines of the log of a job: for each finished simulation, and for those that it finds stored."""


def with_progress(items: Iterable[Item], total: int, unit: str) -> Iterator[Item]:
    """Yield items, with a bar on a terminal once they take more than a few seconds.

    Elsewhere lines on standard error count them, each after twice the time of the line before. The
    unit is the plural of an item.
    """
    from tqdm import tqdm

    began, due, terminal = time.monotonic(), _PATIENCE, sys.stderr.isatty()
    with tqdm(
        total=total, unit=unit, delay=_PATIENCE, disable=not terminal, file=sys.stderr
    ) as bar:
        for number, item in enumerate(items, start=1):
            yield item
            bar.update()
            passed = time.monotonic() - began
            if not terminal and passed > due and number < total:
                bar.write(f"{number} of {total} {unit}", file=sys.stderr)
                due = 2 * passed


@contextmanager
def cycle_progress(expected: int, *, every_state: bool) -> Iterator[Observer]:
    """Observer of a cycle that is expected to have some number of states.

    It draws a bar on a terminal, and elsewhere prints a line from time to time, or one for each
    state.
    """
    from tqdm import tqdm

    with tqdm(total=expected, unit="state", disable=not sys.stderr.isatty()) as bar:
        due = time.monotonic() + _SECONDS_IN_LOG

        def show(recorder: Recorder) -> None:
            nonlocal due
            count, last = len(recorder.states), recorder.states[-1]
            bar.set_postfix_str(last.summary, refresh=False)
            bar.update(count - bar.n)
            if every_state or (bar.disable and time.monotonic() >= due):
                due = time.monotonic() + _SECONDS_IN_LOG
                branch = last.branch_names[last.direction]
                bar.write(f"state {count}, {branch}: {last.summary}", file=sys.stderr)

        yield show


class SweepBar:
    """Progress of the simulations of a sweep, by a thread of the process that runs the workflow.

    A terminal has a bar; elsewhere lines count the simulations, each after twice the time of the
    line before. The thread counts lines in the logs of the jobs; `sizes` are the numbers of
    simulations of the shards by their names.
    """

    def __init__(self, sizes: Mapping[str, int], results: Path) -> None:
        self._sizes, self._results = sizes, results
        self._began = time.time()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._draw, daemon=True)

    def begin(self) -> None:
        """Draw from now on."""
        self._thread.start()

    def end(self) -> None:
        """Draw what is finished by now, and no more."""
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join()

    def _finished(self, shard: str) -> int:
        """How many simulations of a shard have finished: all if its file is there, and no job."""
        log = self._results / "logs" / f"simulate-{shard}.log"
        if log.exists() and log.stat().st_mtime >= self._began:
            text = log.read_bytes()
            return sum(map(int, _STORED.findall(text))) + len(_FINISHED.findall(text))
        return self._sizes[shard] if (self._results / "shards" / f"{shard}.nc").exists() else 0

    def _draw(self) -> None:
        """Read the logs repeatedly, and update the bar."""
        from tqdm import tqdm

        total, terminal = sum(self._sizes.values()), sys.stderr.isatty()
        finished, due = 0, _PATIENCE
        with tqdm(
            total=total, unit="simulation", smoothing=0, disable=not terminal, file=sys.stderr
        ) as bar:
            while True:
                ended = self._ended.wait(_SECONDS_BETWEEN_LOOKS)
                before, finished = finished, sum(map(self._finished, self._sizes))
                bar.update(finished - before)
                passed = time.time() - self._began
                if not terminal and finished > before and (passed > due or finished == total):
                    bar.write(f"{finished} of {total} simulations", file=sys.stderr)
                    due = 2 * passed
                if ended:
                    return
