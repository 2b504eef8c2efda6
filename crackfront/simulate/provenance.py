"""Origin of a result: version, sources, command, machine and moment."""

from __future__ import annotations

import functools
import hashlib
import platform
import shlex
import subprocess
import sys
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, distributions, version
from pathlib import Path

from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION

PACKAGE = Path(__file__).parents[1]

_ARITHMETIC_PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "rocket-fft")
"""Packages whose versions may decide the last bits of a result."""

try:
    __version__ = version("crackfront")
except PackageNotFoundError:
    __version__ = "0+unknown"
"""Version of the package, which setuptools-scm took from git."""


@functools.cache
def _processor() -> str:
    """Model of the processor, or its kind where the system does not say."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


@functools.cache
def _arithmetic() -> str:
    """What numba compiles for, what numpy finds beyond what it needs, and versions."""
    import numpy as np
    from llvmlite.binding import get_host_cpu_name
    from numba import config

    compiled = config.CPU_NAME or get_host_cpu_name(), config.CPU_FEATURES or ""
    extensions = np.show_config(mode="dicts")["SIMD Extensions"].get("found", ())
    versions = (f"{name} {version(name)}" for name in _ARITHMETIC_PACKAGES)
    return ", ".join([" ".join(filter(None, (*compiled, *extensions))), *versions])


@functools.cache
def _packages() -> str:
    """Twelve hexadecimal digits of the lock of a clone, or of what is installed."""
    lock = PACKAGE.with_name("requirements.lock")
    if lock.exists():
        return hashlib.sha256(lock.read_bytes()).hexdigest()[:12]
    installed = sorted({(package.name, package.version) for package in distributions()})
    return hashlib.sha256(repr(installed).encode()).hexdigest()[:12]


@dataclass(frozen=True, slots=True)
class Provenance:
    """What every result file says about its origin."""

    crackfront_version: str
    """Version of the package."""
    git_commit: str
    """As :func:`git_commit`."""
    command: str
    """Command line of the process, the program without its folder."""
    configuration: str
    """Text of the configuration file, empty where there was none."""
    physics_version: int = PHYSICS_VERSION
    """Version of the states, of :mod:`crackfront.core.versions`."""
    rows_version: int = ROWS_VERSION
    """Version of what is derived from the states, of the same module."""
    platform: str = f"{platform.platform()}, Python {platform.python_version()}"
    """Operating system, machine and Python."""
    processor: str = field(default_factory=_processor)
    """Model of the processor that computed the result."""
    arithmetic: str = field(default_factory=_arithmetic)
    """Processor that numba compiles for, instruction sets of numpy, and versions of libraries.

    They decide the last bits of results."""
    packages: str = field(default_factory=_packages)
    """Digits of requirements.lock, or without that file of the versions of all packages."""

    def here(self) -> Provenance:
        """Copy that states the machine of this process, which may be a rank on another one."""
        return Provenance(
            self.crackfront_version, self.git_commit, self.command, self.configuration
        )


def provenance(configuration: str = "") -> Provenance:
    """Origin of what this process computes for a configuration of this text."""
    program = Path(sys.argv[0])
    # Without its folder, which differs between machines.
    name = program.parent.name if program.name == "__main__.py" else program.name
    return Provenance(
        crackfront_version=__version__,
        git_commit=git_commit(),
        command=shlex.join([name, *sys.argv[1:]]),
        configuration=configuration,
    )


def utc_now() -> str:
    """Date and time of now, UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@functools.cache
def git_commit() -> str:
    """Commit of the sources, "-dirty" where files outside docs were changed; or "unknown"."""
    git = "git", "-C", str(PACKAGE)
    change = "diff", "--quiet", "HEAD", "--", ":/", ":(top,exclude)docs"
    try:
        head, changed = (
            subprocess.run([*git, *words], capture_output=True, text=True, timeout=10, check=False)
            for words in (("rev-parse", "HEAD"), change)
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    if head.returncode:
        return "unknown"
    return head.stdout.strip() + ("-dirty" if changed.returncode else "")
