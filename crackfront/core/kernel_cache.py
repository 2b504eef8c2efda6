"""The cache of compiled kernels: a file for every kernel and every type of its arguments.

The name of its folder ends with the fingerprint of the solver, which covers the sources of all
kernels; numba's own cache checks only the file of a kernel, not the files of the kernels that it
calls. Cached files are executed, so the folder is writable for this user alone. Kernels whose
files are missing or damaged are compiled anew.

This module uses private functions of numba; `pyproject.toml` bounds its version.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import pickle
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from crackfront.core.private_cache import (
    DamagedFileError,
    private_folder,
    read_checked,
    write_checked,
)

_logger = logging.getLogger(__name__)


@functools.cache
def solver_fingerprint() -> str:
    """Digest of the sources of the core."""
    sources = sorted(Path(__file__).parent.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:12]


@functools.cache
def kernel_folder() -> Path | None:
    """Folder of the compiled kernels of these sources, in NUMBA_CACHE_DIR where that is private.

    None where this user has no private folder: every process then compiles its own kernels.
    """
    return private_folder(f"kernels-{solver_fingerprint()}", numba.config.CACHE_DIR)


class KernelCache(NullCache):  # type: ignore[misc]
    """Compiled versions of one kernel on disk, as numba's dispatcher asks for them."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._code = function.__code__.co_code
        name = f"{function.__module__}.{function.__qualname__}"
        self._name = name.replace("<", "").replace(">", "")

    @property
    def cache_path(self) -> str | None:
        """Folder of the compiled kernels."""
        folder = kernel_folder()
        return None if folder is None else str(folder)

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """The version for a signature; None where the cache does not hold it whole."""
        target_context.refresh()
        key = self._key(sig, target_context.codegen())
        path = self._path(key)
        if path is None:
            return None
        try:
            stored_key, compiled = pickle.loads(read_checked(path))
        except DamagedFileError:
            _say_damaged(path.parent)
            return None
        except OSError:
            return None
        if stored_key != key:
            return None
        return CompileResult._rebuild(target_context, *compiled)

    def save_overload(self, sig: Any, cres: CompileResult) -> None:
        """Keep the version for a signature, where the disk has room for it."""
        key = self._key(sig, cres.codegen)
        path = self._path(key)
        # Addresses of this process are of no use to another one.
        if path is None or cres.library.has_dynamic_globals:
            return
        content = dumps((key, cres._reduce()))
        with contextlib.suppress(OSError):
            write_checked(path, content)

    def _key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        """What a compiled version depends on beside the sources of the kernels."""
        return sig, codegen.magic_tuple(), self._code, _versions()

    def _path(self, key: tuple[Any, ...]) -> Path | None:
        """File of a compiled version; None without a private folder."""
        folder = kernel_folder()
        if folder is None:
            return None
        digest = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        return folder / f"{self._name}-{digest}"


@functools.cache
def _versions() -> tuple[str, ...]:
    """Versions of Python and of the libraries that compile, or are called by what is compiled."""
    return sys.version, *map(version, ("numba", "llvmlite", "rocket-fft"))


@functools.cache
def _say_damaged(folder: Path) -> None:
    """Say once that compiled kernels are damaged."""
    _logger.warning("compiled kernels in %s are damaged; they are compiled anew", folder)
