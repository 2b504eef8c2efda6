"""Compilation of the kernels: one decorator, and a cache that a change of the sources empties.

numba looks for changes only in the file that holds a kernel, not in the kernels that it calls
from other files. The cache therefore lies in a folder named after the sources of all kernels.
"""

from __future__ import annotations

import functools
import inspect
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.extending import overload

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

Function = TypeVar("Function", bound=Callable[..., Any])

_IMPLEMENTATIONS: dict[Any, dict[type, Any]] = {}
"""Of every dispatched function what implements it, by the type of its first argument."""


def dispatched(function: Function) -> Function:
    """A function whose implementation is picked by the type of its first argument, a NamedTuple.

    In compiled code numba picks it while it compiles; one kernel serves all types.
    """
    known: dict[type, Any] = {}

    @functools.wraps(function)
    def picked(first: Any, *others: Any) -> Any:
        return known[type(first)](first, *others)

    def choose(first: Any, *others: Any) -> Any:
        return known.get(first.instance_class) if isinstance(first, types.BaseNamedTuple) else None

    # numba compares the names of arguments, and annotations as well.
    names = inspect.signature(function).parameters.values()
    plain = [name.replace(annotation=name.empty) for name in names]
    choose.__signature__ = inspect.Signature(plain)  # type: ignore[attr-defined]
    overload(picked)(choose)
    _IMPLEMENTATIONS[picked] = known
    return picked  # type: ignore[return-value]


def implements(function: Callable[..., Any], kind: type) -> Callable[[Function], Function]:
    """Make what follows the implementation of a dispatched function for a type."""

    def register(implementation: Function) -> Function:
        implementation.__annotations__ = {}
        _IMPLEMENTATIONS[function][kind] = implementation
        return implementation

    return register
