"""Packs: tar archives to which one process appends, read past any damage.

The header of a file holds the SHA-256 of its content, in the field for the target of a link, which
programs that unpack ignore for files.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tarfile import BLOCKSIZE, USTAR_FORMAT, HeaderError, TarInfo

PACK = ".tar"
"""Ending of the names of packs."""

SECONDS_TO_DISK = 0.5
"""What a machine that crashes may lose of a pack; a process that is killed loses nothing."""

_SECONDS_IN_USE = 60.0
"""Time after a change during which a pack counts as in use where there are no locks."""

LONGEST_NAME = 100
"""Letters that the name of a file in a pack may have."""


@dataclass(frozen=True, slots=True)
class Member:
    """A file in a pack: where its content begins, its number of bytes, and their checksum."""

    path: Path
    name: str
    place: int
    size: int
    digest: str
    """SHA-256 of its content, in hexadecimal digits."""

    def content(self) -> bytes | None:
        """Its bytes, None where they are not those that were written."""
        with contextlib.suppress(FileNotFoundError), self.path.open("rb", buffering=0) as file:
            content = os.pread(file.fileno(), self.size, self.place)
            return content if hashlib.sha256(content).hexdigest() == self.digest else None
        return None

    def __str__(self) -> str:
        return f"{self.path}: {self.name}"


File = Path | Member
"""A file, or one in a pack."""


def members(path: Path) -> tuple[list[Member], int]:
    """Files in a pack in their order, and the number of damaged places between them.

    A pack is created with its first file: an empty one is damaged.
    """
    found: list[Member] = []
    end = path.stat().st_size
    with path.open("rb", buffering=0) as file:
        place, n_damaged, known = 0, int(not end), True
        while place < end:
            with contextlib.suppress(HeaderError):
                block = os.pread(file.fileno(), BLOCKSIZE, place)
                # Another program may have written it, with any bytes in a name.
                head = TarInfo.frombuf(block, "utf-8", "surrogateescape")
                start = place + BLOCKSIZE
                if head.size >= 0 and start + head.size <= end:
                    found.append(Member(path, head.name, start, head.size, head.linkname))
                    place, known = start + _padded(head.size), True
                    continue
            # Headers begin at multiples of a block: the next one ends what is damaged.
            n_damaged += known
            known = False
            place += BLOCKSIZE
    return found, n_damaged


def _padded(size: int) -> int:
    """Bytes of whole blocks for so many bytes."""
    return -(-size // BLOCKSIZE) * BLOCKSIZE


def checked(path: Path) -> tuple[list[Member], int]:
    """Whole files in a pack, and the number of its damaged files and places."""
    found, n_damaged = members(path)
    whole = [one for one in found if one.content() is not None]
    return whole, n_damaged + len(found) - len(whole)


def record(name: str, content: bytes) -> bytes:
    """A file as it stands in a pack."""
    head = TarInfo(name)
    head.size = len(content)
    head.linkname = hashlib.sha256(content).hexdigest()
    return head.tobuf(USTAR_FORMAT, "ascii", "strict") + content.ljust(_padded(len(content)), b"\0")


class Pack:
    """A new pack to which this process appends; it is locked until it is closed or the end."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._number: int | None = None
        self._on_disk = -SECONDS_TO_DISK

    def append(self, files: Mapping[str, bytes]) -> None:
        """Append files; the pack is created with the first ones, and on disk from time to time.

        It is created anew where it was renamed or removed. OSError if that is impossible; what was
        there before stays.
        """
        if self._number is not None and not self._is_in_place(self._number):
            self.close()
        if self._number is None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._number = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o666)
            _lock(self._number)
        rest = memoryview(b"".join(record(*item) for item in files.items()))
        length = os.lseek(self._number, 0, os.SEEK_END)
        try:
            while rest:
                rest = rest[os.write(self._number, rest) :]
            if time.monotonic() - self._on_disk >= SECONDS_TO_DISK:
                os.fsync(self._number)
                self._on_disk = time.monotonic()
        except OSError:
            os.ftruncate(self._number, length)
            if not length:
                self._path.unlink()
                os.close(self._number)
                self._number = None
            raise

    def _is_in_place(self, number: int) -> bool:
        """Whether an open file still is that of the path."""
        try:
            return os.path.samestat(os.fstat(number), self._path.stat())
        except FileNotFoundError:
            return False

    def close(self) -> None:
        """Have all of it on disk, and unlock it; an OSError where that is impossible."""
        if self._number is not None:
            number, self._number = self._number, None
            try:
                os.fsync(number)
            except OSError as error:
                raise OSError(error.errno, error.strerror, str(self._path)) from error
            finally:
                os.close(number)


def _lock(number: int) -> None:
    """Lock an open file, where the file system has locks and no other process has this one."""
    with contextlib.suppress(OSError):
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_locked(path: Path) -> bool:
    """Whether a process holds the lock on a pack, as far as the file system says so.

    Where it has no locks, whether the pack has changed within the last minute.
    """
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            return _now(path.parent) - os.fstat(file.fileno()).st_mtime < _SECONDS_IN_USE
    return False


def _now(folder: Path) -> float:
    """Time by the clock of the file system of a folder, or of this machine where it is read-only.

    (Units: s)
    """
    with contextlib.suppress(OSError), tempfile.NamedTemporaryFile(prefix=".", dir=folder) as new:
        return Path(new.name).stat().st_mtime
    return time.time()
