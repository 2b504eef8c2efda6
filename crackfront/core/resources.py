"""Memory and time: what this process may have, what it has used, and errors for what needs more."""

from __future__ import annotations

import contextlib
import functools
import os
import resource
import sys
from collections.abc import Iterator
from pathlib import Path

from crackfront.core.words import in_bytes, in_time

MOST_MEMORY = 64e12
"""Memory of the largest machine that a sweep may be planned for here. (Units: bytes)"""

MOST_SECONDS = 1e3 * 365.25 * 86400
"""Processor time of a command: a thousand years."""


class TooLargeError(ValueError):
    """A computation needs more memory or time than there is."""


def check_memory(task: str, needed: float, remedy: str, *, anywhere: bool = False) -> None:
    """Raise TooLargeError if something needs more memory than there is for this process.

    The error states the memory that is needed (Units: bytes), the memory of this process and the
    remedy. With `anywhere` only the largest machine is the limit, as another one will compute it.
    """
    at_hand = memory_at_hand()
    if needed > (max(at_hand, MOST_MEMORY) if anywhere else at_hand):
        raise TooLargeError(
            f"{task} would need {in_bytes(needed)} of memory; here are {in_bytes(at_hand)}: "
            f"{remedy}"
        )


def check_time(task: str, seconds: float, remedy: str) -> None:
    """Raise if something takes more than :data:`MOST_SECONDS` of processor time."""
    if not seconds <= MOST_SECONDS:
        raise TooLargeError(f"{task} would take {in_time(seconds)} of processor time; {remedy}")


def memory_at_hand() -> float:
    """Memory that this process may have, of the machine, its group and its own limit, in bytes."""
    shared = _machine_and_group_limit()
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return shared
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return max(min(shared, float(limit - pages * resource.getpagesize())), 0.0)


# A process may lower its own limit; the limits of its machine and job are set before it starts.
@functools.cache
def _machine_and_group_limit() -> float:
    """Memory of the machine, or of the control groups of this process where that is less."""
    physical = float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    return min([physical, *_group_limits()])


def _group_limits() -> Iterator[float]:
    """Limits of the control groups of this process, as of a container or a job."""
    try:
        groups = Path("/proc/self/cgroup").read_text().splitlines()
    except OSError:
        return
    for line in groups:
        _, controllers, name = line.split(":", 2)
        if controllers not in ("", "memory"):
            continue
        root = Path("/sys/fs/cgroup", controllers)
        file = "memory.limit_in_bytes" if controllers else "memory.max"
        group = root / name.lstrip("/")
        for path in (folder / file for folder in (group, *group.parents)):
            with contextlib.suppress(OSError, ValueError):  # no file, or no number but "max"
                yield float(int(path.read_text()))


def peak_memory() -> float:
    """Largest resident memory of this process, on Linux since it was last reset, in bytes."""
    status = Path("/proc/self/status")
    lines = status.read_text(encoding="utf-8").splitlines() if status.exists() else []
    marks = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
    if marks:
        return 1024.0 * marks[0]
    # This peak cannot be reset, and a process may inherit its parent's peak; macOS: in bytes.
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
