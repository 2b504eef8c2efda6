"""Compilation of the kernels: one decorator, and functions that the type of an argument chooses."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import event
from numba.extending import overload

from crackfront.core.kernel_cache import KernelCache


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
    if cache and not numba.config.DISABLE_JIT:
        compiled._cache = KernelCache(function)
    return compiled


kernel = functools.partial(jit, _nrt=False)
"""As :func:`jit` without reference counts, for inner functions that use only arrays passed to them.

Reference counts of the arrays of a field would take three quarters of the time of inner loops.
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
