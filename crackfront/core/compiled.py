"""Compilation of the kernels: one decorator, and a cache that a change of the sources empties.

numba looks for changes only in the file that holds a kernel, not in the kernels that it calls
from other files. The cache therefore lies in a folder named after the sources of all kernels.
"""

from __future__ import annotations

import functools
import os
import tempfile
from pathlib import Path

import numba

from crackfront.core.fingerprint import solver_fingerprint


@functools.cache
def cache_folder() -> Path:
    """Folder of the compiled kernels of these sources, created on first use."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
    for parent in (home, Path(tempfile.gettempdir())):
        folder = parent / "crackfront" / solver_fingerprint()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    raise OSError(
        f"neither {home} nor {tempfile.gettempdir()} is writable; set XDG_CACHE_HOME to a folder "
        "for compiled code"
    )


def kernels_are_cached() -> bool:
    """Whether an earlier run has left compiled kernels of these sources."""
    return any(cache_folder().rglob("*.nbi"))


if not os.environ.get("NUMBA_CACHE_DIR"):
    numba.config.CACHE_DIR = str(cache_folder())

jit = functools.partial(numba.njit, cache=True, error_model="numpy")
"""Compile to machine code, keep it on disk; division by zero follows IEEE rules."""

kernel = functools.partial(jit, _nrt=False)
"""The same without reference counts, for inner functions that only use arrays they are given.

Counting references to the arrays of a field took three quarters of the time of the inner loops.
"""
