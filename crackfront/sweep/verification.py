"""Whether the files of a folder of results, or of its archive, are as they were written."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile, ZipFile

from crackfront.data.digests import read_sums, result_files
from crackfront.data.files import NO_ROOM, UnreadableFileError, damaged_files
from crackfront.sweep.shards import finished_shard
from crackfront.sweep.store import lost_curves


@dataclass(frozen=True, slots=True)
class Verification:
    """What was found in a folder."""

    listed: int
    unlisted: int
    """Numbers of files that the list of checksums names, and of others."""
    arithmetic: frozenset[str]
    """Those of the origins of the rows."""
    damaged: tuple[str, ...]
    missing: tuple[str, ...]
    """Files that are not as they were written, and absent ones that a list or a row names."""


def verification(place: Path) -> Verification:
    """Check all files of a folder, or of an archive of it.

    UnreadableFileError if there is no such folder or archive, or the folder is empty.
    """
    with _folder(place) as folder:
        listed = read_sums(folder)
        names = [str(path.relative_to(folder)) for path in result_files(folder)]
        damaged = [str(path.relative_to(folder)) for path in damaged_files(folder)]
        missing = sorted({*listed} - {*names}) + list(lost_curves(folder))
        shards = map(finished_shard, (folder / "shards").glob("*.nc"))
        arithmetic = frozenset[str]().union(*(one.arithmetic for one in shards if one))
        if place.is_file() and not listed:
            damaged.append(place.name)  # the list is the last file of an archive
        elif not names and not listed:
            raise UnreadableFileError(f"{place} holds no file; name a folder of results")
    unlisted = len({*names} - {*listed})
    return Verification(
        len(listed), unlisted, arithmetic, tuple(damaged), tuple(dict.fromkeys(missing))
    )


@contextlib.contextmanager
def _folder(place: Path) -> Iterator[Path]:
    """A folder, or what can be unpacked of an archive of it."""
    if place.is_dir():
        yield place
        return
    if not place.is_file():
        raise UnreadableFileError(f"{place} does not exist; name a folder of results or an archive")
    with tempfile.TemporaryDirectory() as temporary:
        try:
            with ZipFile(place) as archive:
                archive.extractall(temporary)
        except (BadZipFile, EOFError, ValueError, OSError, NotImplementedError) as error:
            if isinstance(error, OSError) and error.errno in NO_ROOM:
                raise
        inner = list(Path(temporary).iterdir())
        yield inner[0] if len(inner) == 1 else Path(temporary)
