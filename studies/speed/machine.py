"""The memory of a process, and processes of their own for what is measured."""

from __future__ import annotations

import multiprocessing
import resource
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

Result = TypeVar("Result")


def in_fresh_process(function: Callable[..., Result], *arguments: Any) -> Result:
    """What a function returns in a process of its own, whose memory is that of the call."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as fresh:
        return fresh.submit(function, *arguments).result()


def restart_peak() -> float:
    """Reset the peak of this process's memory, where the system can; return its memory in MB."""
    forget = Path("/proc/self/clear_refs")
    if forget.exists():
        forget.write_text("5", encoding="utf-8")
    return peak_memory()


def peak_memory() -> float:
    """Largest resident memory of this process since the last reset, in MB."""
    status = Path("/proc/self/status")
    lines = status.read_text(encoding="utf-8").splitlines() if status.exists() else []
    marks = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
    if marks:
        return marks[0] * 1024 / 1e6
    # This peak cannot be reset, and a process may inherit that of its parent; macOS: in bytes.
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
