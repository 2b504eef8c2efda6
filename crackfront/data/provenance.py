"""Where a result comes from: version, sources, command and moment."""

from __future__ import annotations

import functools
import platform
import shlex
import subprocess
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from crackfront.data.fingerprint import solver_fingerprint

PACKAGE = Path(__file__).parents[1]


try:
    __version__ = version("crackfront")
except PackageNotFoundError:
    __version__ = "0+unknown"
"""Version of the package, which setuptools-scm took from git."""


@dataclass(frozen=True, slots=True)
class Provenance:
    """What every result file says about its origin."""

    crackfront_version: str
    git_commit: str
    """As :func:`git_commit`."""
    solver_fingerprint: str
    """Changes with every source that determines a result."""
    command: str
    """Command line of the process, the program without its folder."""
    platform: str
    """Operating system, machine and Python."""
    configuration: str
    """Text of the configuration file, empty where there was none."""


def provenance(configuration: str = "") -> Provenance:
    """Origin of what this process computes for a configuration of this text."""
    program = Path(sys.argv[0])
    # Without its folder, which is that of one machine.
    name = program.parent.name if program.name == "__main__.py" else program.name
    return Provenance(
        crackfront_version=__version__,
        git_commit=git_commit(),
        solver_fingerprint=solver_fingerprint(),
        command=shlex.join([name, *sys.argv[1:]]),
        platform=f"{platform.platform()}, Python {platform.python_version()}",
        configuration=configuration,
    )


def utc_now() -> str:
    """Date and time of now, UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@functools.cache
def git_commit() -> str:
    """Commit of the sources, with "-dirty" where they were changed since; or "unknown"."""
    # Without the tags, whose names would stand for the commit.
    options = "--always", "--dirty", "--abbrev=40", "--exclude=*"
    command = "git", "-C", str(PACKAGE), "describe", *options
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return result.stdout.strip() if result.returncode == 0 else "unknown"
