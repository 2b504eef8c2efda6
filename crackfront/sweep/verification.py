"""Whether the files of a folder of results, or of its archive, are as they were written."""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile, ZipFile

from crackfront.data.digests import Integrity
from crackfront.data.files import NO_ROOM, UnreadableFileError
from crackfront.data.packs import PACK
from crackfront.sweep.shards import finished_shard
from crackfront.sweep.store import SUMS, checked_files, lost_curves

FILES = "packs of curves and rows"
"""Name under which the files in packs are counted, each of which has a checksum."""


@dataclass(frozen=True, slots=True)
class Verification:
    """What was found in a folder."""

    counts: dict[str, Counter[Integrity]]
    """Numbers of whole and damaged files by their folder, and of such files in packs."""
    arithmetic: frozenset[str]
    """Those of the origins of the rows."""
    damaged: tuple[str, ...]
    missing: tuple[str, ...]
    """Files that are not as they were written, and absent ones that a list or a row names."""


def verification(place: Path) -> Verification:
    """Check all files of a folder, or of an archive of it.

    UnreadableFileError if there is no such folder or archive, or the folder is empty.
    """
    counts: dict[str, Counter[Integrity]] = defaultdict(Counter)
    damaged = []
    with _folder(place) as folder:
        for path, states in checked_files(folder):
            name = path.relative_to(folder)
            counts[FILES if path.suffix == PACK else str(name.parent)] += states
            damaged += [str(name)] if states[Integrity.DAMAGED] else []
        listed = _listed(folder)
        missing = [name for name in listed if not (folder / name).is_file()]
        missing += lost_curves(folder)
        shards = map(finished_shard, (folder / "shards").glob("*.nc"))
        arithmetic = frozenset[str]().union(*(one.arithmetic for one in shards if one))
        for file in listed.keys() - set(missing):
            with (folder / file).open("rb") as opened:
                if hashlib.file_digest(opened, "sha256").hexdigest() != listed[file]:
                    damaged.append(file)
        if place.is_file() and not listed:
            damaged.append(place.name)  # the list is the last file of an archive
        elif not counts:
            raise UnreadableFileError(f"{place} holds no file; name a folder of results")
    listed_once = (tuple(dict.fromkeys(names)) for names in (damaged, missing))
    return Verification(dict(counts), arithmetic, *listed_once)


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


def _listed(folder: Path) -> dict[str, str]:
    """Checksums in the list of an archive by the names of the files; empty without a list."""
    if not (folder / SUMS).is_file():
        return {}
    lines = (folder / SUMS).read_text(encoding="utf-8", errors="replace").splitlines()
    return {name: checksum for checksum, _, name in (line.partition("  ") for line in lines)}
