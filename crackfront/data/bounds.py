"""Bounds of what comes from outside: sizes of numbers, the memory and time they imply, files."""

from __future__ import annotations

import contextlib
import functools
import math
import os
import resource
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple


class Range(NamedTuple):
    """Smallest and largest value that a quantity may have."""

    least: float
    most: float


NUMBER = Range(1e-15, 1e15)
"""Any positive number: powers of it, as formulas have them, are still numbers."""

COUNT = Range(1, 10**15)
"""Any count."""

PLATEAU = Range(1e-60, 1e15)
"""Densities of heights at long waves, in m^4 or reduced: 1e-27 m^4 is that of a polished film."""

LENGTH = Range(1e-9, 1e9)
"""Lengths in reduced units: from far below an atom on the smallest spheres to far above them."""

PENETRATION = Range(0.0, 1e6)
"""Largest penetrations in reduced units; the contact is then a thousand units wide."""

ADHESION = Range(-1e4, 1e4)
"""Local works of adhesion, in units of w_int, and heights in reduced units."""

DENSITY = Range(1e-3, 1e3)
"""Sites, samples or points per length of a surface."""

PIXELS = Range(2, 1e3)
"""Points of a tile per shortest wavelength; fewer do not hold it."""

SITES = Range(4, 10**15)
"""Sites of a front; fewer resolve no distortion."""

SEED = Range(0, 2**63 - 1)
"""Seeds: what a netCDF file can hold as an attribute."""

SI = {
    "m": Range(1e-12, 1e7),
    "Pa": Range(1e-6, 1e14),
    "J/m^2": Range(1e-9, 1e6),
    "N": Range(1e-18, 1e9),
    "N/m": Range(1e-9, 1e12),
}
"""Lengths from below an atom to planets, moduli beyond those of foams and diamond, and so on."""

MOST_MEMORY = 64e12
"""Memory of the largest machine that a sweep may be planned for here. (Units: bytes)"""

MOST_SECONDS = 1e3 * 365.25 * 86400
"""Processor time of a command: a thousand years."""

TOLERANCE = Range(1e-16, 1.0)
"""Force that may be left, relative to w_int per front length."""

_KINDS = {"d": "a folder", "p": "a pipe", "s": "a socket", "c": "a device", "b": "a device"}
"""What a path names that is no file, by the first letter of its mode."""


class TooLargeError(ValueError):
    """A computation needs more memory or time than there is."""


def refuse_outside(what: str, value: float, bounds: Range, unit: str = "") -> None:
    """Raise a ValueError that names a number if it is not within its bounds.

    Examples
    --------
    >>> refuse_outside("spring", 1e300, LENGTH)
    Traceback (most recent call last):
    ValueError: spring is 1e+300; it must lie between 1e-09 and 1e+09
    """
    if not bounds.least <= value <= bounds.most:
        unit = f" {unit}" if unit else ""
        raise ValueError(
            f"{what} is {value:g}{unit}; it must lie between {bounds.least:g} and "
            f"{bounds.most:g}{unit}"
        )


def refuse_beyond_memory(what: str, needed: float, remedy: str, *, anywhere: bool = False) -> None:
    """Raise TooLargeError if something needs more memory than there is for this process.

    The error states the memory that is needed (Units: bytes), the memory of this process and the
    remedy. With `anywhere` only the largest machine is the limit, as another one will compute it.
    """
    at_hand = memory_at_hand()
    if needed > (max(at_hand, MOST_MEMORY) if anywhere else at_hand):
        raise TooLargeError(
            f"{what} would need {in_bytes(needed)} of memory; here are {in_bytes(at_hand)}: "
            f"{remedy}"
        )


def refuse_beyond_time(what: str, seconds: float, remedy: str) -> None:
    """Raise if something takes more than :data:`MOST_SECONDS` of processor time."""
    if not seconds <= MOST_SECONDS:
        raise TooLargeError(f"{what} would take {in_time(seconds)} of processor time; {remedy}")


def memory_at_hand() -> float:
    """Memory that this process may have, of the machine, its group and its own limit, in bytes."""
    shared = _machine_and_group_limit()
    own, _ = resource.getrlimit(resource.RLIMIT_AS)
    if own == resource.RLIM_INFINITY:
        return shared
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return max(min(shared, float(own - pages * resource.getpagesize())), 0.0)


# A process may lower its own limit, but those of its machine and job are set before it starts.
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
        here = root / name.lstrip("/")
        for path in (folder / file for folder in (here, *here.parents)):
            with contextlib.suppress(OSError, ValueError):  # no file, or no number but "max"
                yield float(int(path.read_text()))


def counted(number: int, thing: str) -> str:
    """A number of things, whose plural takes an s.

    Examples
    --------
    >>> counted(1, "scan"), counted(3, "scan")
    ('1 scan', '3 scans')
    """
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def in_bytes(number: float) -> str:
    """Bytes in words.

    Examples
    --------
    >>> in_bytes(3e11), in_bytes(2.4e7)
    ('300 GB', '24 MB')
    """
    for power, name in ((18, "EB"), (15, "PB"), (12, "TB"), (9, "GB")):
        if number >= 10.0**power:
            return f"{number / 10.0**power:.3g} {name}"
    return f"{number / 1e6:.3g} MB"


def in_time(seconds: float) -> str:
    """Time in words.

    Examples
    --------
    >>> in_time(0.452), in_time(110.0), in_time(9000.0), in_time(1e12)
    ('0.45 s', '110 s', '2.5 hours', '3.17e+04 years')
    """
    if not math.isfinite(seconds):
        return "for ever"
    for unit, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "hours"), (60.0, "min")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.2g} s"


def regular_file(path: Path, most_bytes: float = math.inf) -> Path:
    """A path that names a file with an end, and not more than so many bytes.

    ValueError if it names a folder, a pipe or a device, or a file that is larger; OSError if there
    is nothing of that name.
    """
    about = path.stat()
    if not stat.S_ISREG(about.st_mode):
        kind = _KINDS.get(stat.filemode(about.st_mode)[0], "something else")
        raise ValueError(f"{path} is {kind}, no file; name a file")
    if about.st_size > most_bytes:
        raise ValueError(
            f"{path} has {in_bytes(about.st_size)}; more than {in_bytes(most_bytes)} are not read"
        )
    return path
