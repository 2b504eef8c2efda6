"""Compilation of the kernels: one decorator, and functions that the type of an argument chooses."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import inspect
import logging
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import event
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.extending import overload

from crackfront.core.cache_folder import kernel_folder

_logger = logging.getLogger(__name__)


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
    """Call a function once, before the first kernel is compiled that is not in the cache."""
    event.register("numba:compile", _FirstCompilation(announce))


class _CheckedContent(CompileResultCacheImpl):  # type: ignore[misc]
    """Gives compiled versions a checksum: a flipped bit in machine code can go unnoticed."""

    def reduce(self, compiled: CompileResult) -> tuple[Any, str, bytes]:
        """Processor, checksum and content of a file."""
        content = dumps(super().reduce(compiled))
        return compiled.codegen.magic_tuple(), hashlib.sha256(content).hexdigest(), content

    def rebuild(self, target_context: Any, stored: tuple[Any, str, bytes]) -> CompileResult:
        """The compiled version; ValueError if the file is damaged or for another processor."""
        processor, checksum, content = stored
        if processor != target_context.codegen().magic_tuple():
            raise ValueError("compiled for another processor")
        if checksum != hashlib.sha256(content).hexdigest():
            raise ValueError("the checksum differs")
        return super().rebuild(target_context, pickle.loads(content))


class _KernelCache(FunctionCache):  # type: ignore[misc]
    """numba's cache, but damaged files are compiled again and a full disk raises no error."""

    _impl_class = _CheckedContent

    def load_overload(self, signature: Any, target_context: Any) -> CompileResult | None:
        """The version for a signature; None if it is missing or damaged."""
        try:
            compiled = super().load_overload(signature, target_context)
            # Two processes that add different signatures at once can exchange their files.
            if compiled is not None and tuple(compiled.signature.args) != tuple(signature):
                raise ValueError("compiled for another signature")
        except OSError:
            return None
        except Exception:  # pickle raises many kinds
            _say_damaged(kernel_folder())
            self._forget()
            return None
        return compiled

    def save_overload(self, signature: Any, compiled: CompileResult) -> None:
        """Keep the version for a signature, if the disk has room for it.

        Versions for a geometry outside of `core` are not kept: the folder is not named after its
        source, and another process may be unable to import it.
        """
        if all(map(_is_of_core, compiled.signature.args)):
            with contextlib.suppress(OSError):
                super().save_overload(signature, compiled)

    def _forget(self) -> None:
        """Empty the index of the function, or else do without the cache."""
        try:
            self.flush()
        except OSError:
            self.disable()


def _is_of_core(kind: types.Type) -> bool:
    """Whether the named tuples in the type of an argument are all from `core`."""
    if not isinstance(kind, types.BaseNamedTuple):
        return True
    return kind.instance_class.__module__.startswith("crackfront.core.") and all(
        map(_is_of_core, kind.types)
    )


@functools.cache
def _say_damaged(folder: Path) -> None:
    """Say once that compiled kernels are damaged."""
    _logger.warning("compiled kernels in %s are damaged; they are compiled again", folder)


def _function_cache(function: Callable[..., Any]) -> _KernelCache | None:
    """Cache of a function; None without a safe folder, or if the function is not in a file."""
    folder = kernel_folder()
    if folder is None:
        return None
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        cache = _KernelCache(function)
    except RuntimeError:
        return None
    finally:
        numba.config.CACHE_DIR = before
    # If numba cannot write there, it turns to `__pycache__`, where changed callees run stale.
    return cache if folder in Path(cache.cache_path).parents else None


def jit(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """Compile to machine code, keep it on disk; division by zero follows IEEE rules."""
    if function is None:
        return functools.partial(jit, **options)
    compiled = numba.njit(function, error_model="numpy", **options)
    if not numba.config.DISABLE_JIT and (cache := _function_cache(function)) is not None:
        compiled._cache = cache
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
    implementations: dict[type, Any] = {}

    @functools.wraps(function)
    def chosen(first: Any, *arguments: Any) -> Any:
        return implementations[type(first)](first, *arguments)

    def choose(first: Any, *arguments: Any) -> Any:
        if not isinstance(first, types.BaseNamedTuple):
            return None
        return implementations.get(first.instance_class)

    # numba compares the names of arguments, and annotations as well.
    names = inspect.signature(function).parameters.values()
    plain = [name.replace(annotation=name.empty) for name in names]
    choose.__signature__ = inspect.Signature(plain)  # type: ignore[attr-defined]
    overload(chosen)(choose)
    _IMPLEMENTATIONS[chosen] = implementations
    return chosen  # type: ignore[return-value]


def implements(function: Callable[..., Any], kind: type) -> Callable[[Function], Function]:
    """Register the decorated function as the implementation of a dispatched one for a type."""

    def register(implementation: Function) -> Function:
        implementation.__annotations__ = {}
        _IMPLEMENTATIONS[function][kind] = implementation
        return implementation

    return register
