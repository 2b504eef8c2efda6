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
from crackfront.data.files import NO_ROOM, UnreadableFileError, integrities
from crackfront.sweep.journal import journal_paths, line_counts, read_journal
from crackfront.sweep.store import SUMS
from crackfront.sweep.table import row_fingerprint

LINES = "lines of journals"
"""What journals are counted as, which have a checksum a line."""


@dataclass(frozen=True, slots=True)
class Verification:
    """What was found in a folder.

    Attributes
    ----------
    counts : dict
        Number of files by the folder that they stand in, and of lines of journals, each by whether
        they are as they were written.
    damaged, missing : tuple of str
        Files that are not as they were written, and files that a list or a journal names and that
        are not there.
    """

    counts: dict[str, Counter[Integrity]]
    damaged: tuple[str, ...]
    missing: tuple[str, ...]


def verification(place: Path) -> Verification:
    """Check all files of a folder, or of an archive of it.

    Raises
    ------
    UnreadableFileError
        If there is no such folder or archive, or the folder is empty.
    """
    counts: dict[str, Counter[Integrity]] = defaultdict(Counter)
    damaged = []
    with _folder(place) as folder:
        for path, state in integrities(folder):
            name = path.relative_to(folder)
            counts[str(name.parent)][state] += 1
            damaged += [str(name)] if state is Integrity.DAMAGED else []
        for path in journal_paths(folder / "journals"):
            n_whole, n_damaged = line_counts(path)
            counts[LINES] += Counter({Integrity.WHOLE: n_whole, Integrity.DAMAGED: n_damaged})
            damaged += [str(path.relative_to(folder))] if n_damaged else []
        listed = dict(_listed(folder))
        missing = [
            name for name in [*_named_curves(folder), *listed] if not (folder / name).is_file()
        ]
        damaged += [
            name
            for name, checksum in listed.items()
            if name not in missing and _checksum(folder / name) != checksum
        ]
        if place.is_file() and not listed:
            damaged.append(place.name)  # the list is the last file of an archive
        elif not counts:
            raise UnreadableFileError(f"{place} holds no file; name a folder of results")
    return Verification(dict(counts), tuple(dict.fromkeys(damaged)), tuple(dict.fromkeys(missing)))


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


def _named_curves(folder: Path) -> Iterator[str]:
    """Files of simulations that journals name."""
    for path in journal_paths(folder / "journals"):
        for _, entry in read_journal(path, row_fingerprint()):
            if entry.row is not None and entry.row.curve:
                yield f"curves/{entry.row.curve}"


def _listed(folder: Path) -> Iterator[tuple[str, str]]:
    """Names and checksums that the list of an archive states."""
    if (folder / SUMS).is_file():
        for line in (folder / SUMS).read_text(encoding="utf-8", errors="replace").splitlines():
            checksum, _, name = line.partition("  ")
            yield name, checksum


def _checksum(path: Path) -> str:
    """SHA-256 of a whole file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
