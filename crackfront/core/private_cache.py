"""Folders in which this user alone keeps what is made once: compiled kernels, fingerprints."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path


def caches() -> Iterator[Path]:
    """Folders that may be the cache of this user, the best first."""
    # A container that runs as a number has neither HOME nor a name.
    with contextlib.suppress(RuntimeError):
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "crackfront")
    yield Path(tempfile.gettempdir(), f"crackfront-{os.geteuid()}")


def is_private(folder: Path) -> bool:
    """Whether nobody but this user writes in a folder; made, or made anew, where that helps."""
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
            return False
        if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            shutil.rmtree(folder)
            folder.mkdir(mode=0o700)
        return os.access(folder, os.W_OK)
    return False
