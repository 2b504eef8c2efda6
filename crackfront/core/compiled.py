"""Compilation of the kernels: one decorator, and a cache that a change of the sources empties.

numba looks for changes only in the file that holds a kernel, not in the kernels that it calls
from other files. The cache therefore lies in a folder named after the sources of all kernels. What
lies there is run: the folder is of this user alone, and its files are compiled anew where they are
damaged.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import hashlib
import inspect
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.core import event
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.extending import overload

from crackfront.core.fingerprint import solver_fingerprint
from crackfront.core.private_cache import caches, is_private


@functools.cache
def cache_folder() -> Path:
    """Folder of the compiled kernels of these sources, created on first use.

    It stands in the cache of this user or, where that cannot be, in the folder for temporary
    files. Where no place is this user's alone, it lives as long as the process.

    Raises
    ------
    OSError
        If there is no place for a folder.
    """
    for parent in caches():
        if is_private(parent) and is_private(parent / solver_fingerprint()):
            return parent / solver_fingerprint()
    try:
        folder = tempfile.mkdtemp(prefix="crackfront-")
    except OSError as error:
        places = " or ".join(map(str, caches()))
        raise OSError(
            f"compiled code can be kept neither in {places}; set XDG_CACHE_HOME to a folder that "
            "is writable"
        ) from error
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


class _CheckedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """Files of one compiled kernel that end with the digest of what stands before it."""

    def _load_index(self) -> Any:
        """Names of the data files, none where the index is damaged."""
        return super()._load_index() if _is_whole(self._index_path) else {}

    def _load_data(self, name: str) -> Any:
        """What a data file holds; an OSError tells numba that it is to compile anew."""
        if not _is_whole(self._data_path(name)):
            raise OSError(f"{name} is damaged")
        return super()._load_data(name)

    @contextlib.contextmanager
    def _open_for_write(self, path: str) -> Iterator[Any]:
        """A file that gets its digest and then its name."""
        with super()._open_for_write(path) as file:
            yield file
            file.flush()
            file.write(hashlib.sha256(Path(file.name).read_bytes()).digest())


class _CheckedCache(FunctionCache):  # type: ignore[misc]
    """Cache of one compiled kernel whose files are checked."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _CheckedFiles(
            self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp()
        )


def _is_whole(path: str) -> bool:
    """Whether a file of the cache ends with its digest."""
    try:
        content = Path(path).read_bytes()
    except FileNotFoundError:
        return False
    length = hashlib.sha256().digest_size
    return hashlib.sha256(content[:-length]).digest() == content[-length:]


class _First(event.Listener):  # type: ignore[misc]
    """Calls a function when a kernel begins to be compiled, then never again."""

    def __init__(self, told: Callable[[], None]) -> None:
        self.told: Callable[[], None] | None = told

    def on_start(self, _: event.Event) -> None:
        """A kernel is not in the cache."""
        # To be unregistered here would hide the event from the listener behind this one.
        told, self.told = self.told, None
        if told is not None:
            told()

    def on_end(self, _: event.Event) -> None:
        """It is compiled."""


def when_compiling(told: Callable[[], None]) -> None:
    """Have a function called once, before the first kernel that no cache holds is compiled."""
    event.register("numba:compile", _First(told))


if not os.environ.get("NUMBA_CACHE_DIR"):
    numba.config.CACHE_DIR = str(cache_folder())


def jit(function: Callable[..., Any] | None = None, *, cache: bool = True, **options: Any) -> Any:
    """Compile to machine code, keep it on disk; division by zero follows IEEE rules."""
    if function is None:
        return functools.partial(jit, cache=cache, **options)
    compiled = numba.njit(function, error_model="numpy", **options)
    if cache and not numba.config.DISABLE_JIT:
        compiled._cache = _CheckedCache(function)
    return compiled


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
