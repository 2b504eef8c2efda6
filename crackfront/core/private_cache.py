"""Folders in which this user alone keeps compiled kernels and fingerprints."""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from pathlib import Path


def private_folder(name: str) -> Path | None:
    """A folder of this name in a cache to which nobody but this user can write, if there is one.

    The cache of the user comes first, then the folder for temporary files.
    """
    caches = [Path(tempfile.gettempdir(), f"crackfront-{os.geteuid()}")]
    # A container that runs as a number has neither HOME nor a name.
    with contextlib.suppress(RuntimeError):
        cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        caches.insert(0, Path(cache, "crackfront"))
    folders = (parent / name for parent in caches if _is_private(parent))
    return next((folder for folder in folders if _is_private(folder)), None)


def _is_private(folder: Path) -> bool:
    """Whether nobody but this user can write to a folder, which is made if it is missing."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = folder.lstat()
    except OSError:
        return False
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid()
    shared = found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return own and not shared and os.access(folder, os.W_OK)
