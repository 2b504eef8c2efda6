"""Processes of their own for what is measured, and the peak of the memory of one."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

from crackfront.core.resources import peak_memory

Result = TypeVar("Result")


def in_fresh_process(function: Callable[..., Result], *arguments: Any) -> Result:
    """What a function returns in a fresh process, whose memory is due to the call alone."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as fresh:
        return fresh.submit(function, *arguments).result()


def restart_peak() -> float:
    """Reset the peak of this process's memory, where the system can; return its memory in bytes."""
    forget = Path("/proc/self/clear_refs")
    if forget.exists():
        forget.write_text("5", encoding="utf-8")
    return peak_memory()
