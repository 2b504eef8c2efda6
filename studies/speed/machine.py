"""What the tables say about the machine and the code, and the memory of a process."""

from __future__ import annotations

import os
import platform
import resource
from pathlib import Path

from crackfront.data.provenance import provenance


def described_machine() -> str:
    """One sentence: processor, cores, Python, version and commit."""
    origin = provenance()
    return (
        f"Machine: {_processor()}, {os.cpu_count()} cores, Python {platform.python_version()}; "
        f"crackfront {origin.crackfront_version}, commit {origin.git_commit}."
    )


def restart_peak() -> float:
    """Forget what this process held before, where the system can; return what it holds, in MB."""
    forget = Path("/proc/self/clear_refs")
    if forget.exists():
        forget.write_text("5", encoding="utf-8")
    return peak_memory()


def peak_memory() -> float:
    """Largest resident memory of this process since then, in MB."""
    status = Path("/proc/self/status")
    lines = status.read_text(encoding="utf-8").splitlines() if status.exists() else []
    marks = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
    if marks:
        return marks[0] * 1024 / 1e6
    # This mark cannot be restarted, and a process may inherit that of its parent; macOS: in bytes.
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def _processor() -> str:
    """Name of the processor."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
