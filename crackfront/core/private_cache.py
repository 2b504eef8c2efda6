"""The user's cache: folders that only this user can write to, and files with checksums.

Files may be lost or damaged at any time. Each begins with the digest of its content, by which a
truncated or changed file is recognised.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import tempfile
from pathlib import Path


class DamagedFileError(ValueError):
    """A file of the cache is not what was written."""


def private_folder(name: str, cache: str = "") -> Path | None:
    """A folder of this name in a cache to which nobody but this user can write, if there is one.

    The given cache comes first, then that of the user, then the folder for temporary files.
    """
    caches = [Path(tempfile.gettempdir(), f"crackfront-{os.geteuid()}")]
    # A container that runs as a number has neither HOME nor a name.
    with contextlib.suppress(RuntimeError):
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        caches.insert(0, Path(home, "crackfront"))
    if cache:
        caches.insert(0, Path(cache))
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


def read_checked(path: Path) -> bytes:
    """What :func:`write_checked` wrote into a file.

    DamagedFileError if the file holds anything else, OSError if it cannot be read.
    """
    stored = path.read_bytes()
    digest, content = stored[:_DIGEST_SIZE], stored[_DIGEST_SIZE:]
    if digest != hashlib.sha256(content).digest():
        raise DamagedFileError(f"{path} is damaged; remove it")
    return content


def write_checked(path: Path, content: bytes) -> None:
    """Write a file with its digest, whole or not at all; OSError if it cannot be written."""
    part = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        part.write_bytes(hashlib.sha256(content).digest() + content)
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise


_DIGEST_SIZE = hashlib.sha256().digest_size
