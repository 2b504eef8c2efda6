"""The folder of compiled kernels: one for each state of the sources, safe from other users.

numba checks only the file of a kernel, not the files of the kernels that it calls. The name of the
folder therefore changes with every source in `core`.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import os
import stat
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numba

_logger = logging.getLogger(__name__)


@functools.cache
def kernel_folder() -> Path | None:
    """Folder of the kernels of these sources; None if no folder is safe, which is said once."""
    name = f"kernels-{_sources_digest(Path(__file__).parent)}"
    for parent in _cache_folders():
        folder = _safe_folder(parent / name)
        if folder is not None:
            return folder
    _logger.warning(
        "compiled kernels are not kept: other users could change them in every folder for caches; "
        "set XDG_CACHE_HOME to a folder that only you can write to, with all folders above it"
    )
    return None


def _cache_folders() -> Iterator[Path]:
    """Folders for caches: the one given to numba, the user's, the one for temporary files."""
    if numba.config.CACHE_DIR:
        yield Path(numba.config.CACHE_DIR)
    # A container that runs as a number has neither HOME nor a name.
    with contextlib.suppress(RuntimeError):
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "crackfront")
    yield Path(tempfile.gettempdir(), f"crackfront-{os.geteuid()}")


def _safe_folder(path: Path) -> Path | None:
    """The folder without links, made if it is missing; None if another user can change its files.

    Whoever can rename a folder above could exchange the kernels, which are executed. So all belong
    to root or the user, and only those where everybody may rename just their own, like `/tmp`, are
    writable for others.
    """
    try:
        folder = path.resolve()
        for parent in reversed(folder.parents):
            # From the top, so that nothing is made in a folder of others.
            parent.mkdir(mode=0o700, exist_ok=True)
            mode = _mode_if_ours(parent)
            if mode is None or (mode & 0o022 and not mode & stat.S_ISVTX):
                return None
        folder.mkdir(mode=0o700, exist_ok=True)
        mode = _mode_if_ours(folder)
    except (OSError, RuntimeError):  # a loop of links is a RuntimeError
        return None
    # numba makes folders within, to which a group can write if the user's mask says so.
    if mode is None or mode & 0o077 or not os.access(folder, os.W_OK):
        return None
    return folder


def _mode_if_ours(folder: Path) -> int | None:
    """Permissions of a folder that belongs to root or the user; None for another's."""
    status = folder.lstat()
    is_ours = status.st_uid in (0, os.geteuid())
    return status.st_mode if is_ours and stat.S_ISDIR(status.st_mode) else None


def _sources_digest(folder: Path) -> str:
    """Twelve hexadecimal digits of the sources in a folder and of what compiles them."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(f"{path.relative_to(folder)}\n".encode() + path.read_bytes())
    # numba notices its own version, the processor and Python 3.x; the rest is up to us.
    versions = sys.version, *map(version, ("numba", "llvmlite", "rocket-fft"))
    digest.update(repr(versions).encode())
    return digest.hexdigest()[:12]
