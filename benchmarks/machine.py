"""What the tables say about the machine and the code."""

from __future__ import annotations

import os
import platform
from pathlib import Path

from crackfront.provenance import provenance


def described_machine() -> str:
    """One sentence: processor, cores, Python, version and commit."""
    origin = provenance()
    return (
        f"Machine: {_processor()}, {os.cpu_count()} cores, Python {platform.python_version()}; "
        f"crackfront {origin.crackfront_version}, commit {origin.git_commit}."
    )


def _processor() -> str:
    """Name of the processor."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
