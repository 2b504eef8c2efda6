"""Compilation of the kernels: one decorator, and a cache that a change of the sources renews.

numba looks for changes only in the file that holds a kernel, not in the kernels that it calls
from other files. The cache therefore lies in a folder named after the sources of all kernels. What
lies there is executed, so nobody but this user may write to it.
"""

from __future__ import annotations

import functools
import hashlib
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import event
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    _CacheLocator,
    _SourceFileBackedLocatorMixin,
)
from numba.extending import overload

from crackfront.core.private_cache import private_folder


@functools.cache
def cache_folder() -> Path | None:
    """Folder of the compiled kernels of these sources, in NUMBA_CACHE_DIR where that is set.

    None where this user has no private folder: every process then compiles its own kernels.
    """
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR, f"crackfront-{_digest_of_kernels()}")
    return private_folder(_digest_of_kernels())


def _digest_of_kernels() -> str:
    """Twelve hexadecimal digits of the sources that hold kernels and their constants."""
    core, digest = Path(__file__).parent, hashlib.sha256()
    parts = (path for name in ("field", "geometry", "solver") for path in core.glob(f"{name}/*.py"))
    for path in (core / "compiled.py", core / "units.py", *sorted(parts)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


class _Locator(_SourceFileBackedLocatorMixin, _CacheLocator):  # type: ignore[misc]
    """Place of one kernel in the folder of the compiled kernels."""

    def __init__(self, function: Callable[..., Any], source: str) -> None:
        self._py_file, self._lineno = source, function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """Folder of the kernels of one folder of sources."""
        return str(Path(cache_folder() or "", self.get_suitable_cache_subpath(self._py_file)))


class _Implementation(CompileResultCacheImpl):  # type: ignore[misc]
    """How numba stores a kernel, with the place above."""

    _locator_classes = (_Locator,)


class _Cache(FunctionCache):  # type: ignore[misc]
    """Compiled versions of one kernel on disk."""

    _impl_class = _Implementation


class _FirstCompilation(event.Listener):  # type: ignore[misc]
    """Calls a function when the first kernel begins to be compiled, then never again."""

    def __init__(self, announce: Callable[[], None]) -> None:
        self._announce: Callable[[], None] | None = announce

    def on_start(self, _: event.Event) -> None:
        """A kernel is not in the cache."""
        # It stays registered: numba would skip the next listener if this one left here.
        announce, self._announce = self._announce, None
        if announce is not None:
            announce()

    def on_end(self, _: event.Event) -> None:
        """The kernel is compiled."""


def when_compiling(announce: Callable[[], None]) -> None:
    """Call a function once, before the first kernel is compiled that the cache does not hold."""
    event.register("numba:compile", _FirstCompilation(announce))


def jit(function: Callable[..., Any] | None = None, *, cache: bool = True, **options: Any) -> Any:
    """Compile to machine code, keep it on disk; division by zero follows IEEE rules."""
    if function is None:
        return functools.partial(jit, cache=cache, **options)
    compiled = numba.njit(function, error_model="numpy", **options)
    if cache and not numba.config.DISABLE_JIT and cache_folder() is not None:
        compiled._cache = _Cache(function)
    return compiled


kernel = functools.partial(jit, _nrt=False)
"""The same without reference counts, for inner functions that only use arrays they are given.

Counting references to the arrays of a field took three quarters of the time of the inner loops.
"""

Function = TypeVar("Function", bound=Callable[..., Any])

_IMPLEMENTATIONS: dict[Any, dict[type, Any]] = {}
"""Implementations of every dispatched function, by the type of its first argument."""


def dispatched(function: Function) -> Function:
    """Let the type of the first argument, a NamedTuple, choose the implementation of a function.

    numba chooses when it compiles, so one source of a kernel serves all types.
    """
    known: dict[type, Any] = {}

    @functools.wraps(function)
    def chosen(first: Any, *others: Any) -> Any:
        return known[type(first)](first, *others)

    def choose(first: Any, *others: Any) -> Any:
        return known.get(first.instance_class) if isinstance(first, types.BaseNamedTuple) else None

    # numba compares the names of arguments, and annotations as well.
    names = inspect.signature(function).parameters.values()
    plain = [name.replace(annotation=name.empty) for name in names]
    choose.__signature__ = inspect.Signature(plain)  # type: ignore[attr-defined]
    overload(chosen)(choose)
    _IMPLEMENTATIONS[chosen] = known
    return chosen  # type: ignore[return-value]


def implements(function: Callable[..., Any], kind: type) -> Callable[[Function], Function]:
    """Register the decorated function as the implementation of a dispatched one for a type."""

    def register(implementation: Function) -> Function:
        implementation.__annotations__ = {}
        _IMPLEMENTATIONS[function][kind] = implementation
        return implementation

    return register
