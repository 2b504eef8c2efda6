"""Whether the files of a folder of results, or of its archive, are as they were written."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile, ZipFile

from crackfront.data.digests import SUMS, read_sums, result_files
from crackfront.data.files import (
    NO_ROOM,
    UnreadableFileError,
    damaged_files,
    read_attributes,
)
from crackfront.data.packs import members
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.fit_files import fit_range
from crackfront.sweep.result_packs import pack_paths
from crackfront.sweep.shards import curve_names, finished_shard
from crackfront.sweep.store import Store, lost_curves
from crackfront.sweep.table import SWEEP_FINGERPRINT

_RESULTS = (".nc", ".tar", ".json")
"""Suffixes of files, one of which every folder of results has."""


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
    mixture: tuple[str, ...] = ()
    """Sentences that say which files are of different sweeps."""


def verification(place: Path) -> Verification:
    """Check all files of a folder, or of an archive of it.

    UnreadableFileError if there is no such folder or archive, or the folder is empty.
    """
    with _folder(place) as folder:
        listed = read_sums(folder)
        names = [str(path.relative_to(folder)) for path in result_files(folder)]
        damaged = [str(path.relative_to(folder)) for path in damaged_files(folder)]
        missing = sorted({*listed} - {*names, ""})
        if "" in listed:  # of a line that is none of a list of checksums
            damaged.append(SUMS)
        # An archive may have been packed without curves.
        if place.is_dir() or (folder / "curves").is_dir():
            missing += lost_curves(folder)
        shards = map(finished_shard, (folder / "shards").glob("*.nc"))
        arithmetic = frozenset[str]().union(*(one.arithmetic for one in shards if one))
        mixture = tuple(
            sentence.replace(f"{folder}/", "") for sentence in mixture_sentences(Store(folder))
        )
        if place.is_file() and not listed:
            damaged.append(place.name)  # the list is the last file of an archive
        elif not listed and not any(name.endswith(_RESULTS) for name in names):
            raise UnreadableFileError(f"{place} holds no results; name a folder of results")
    unlisted = len({*names} - {*listed})
    absent = tuple(dict.fromkeys(missing))
    return Verification(len(listed), unlisted, arithmetic, tuple(damaged), absent, mixture)


def mixture_sentences(store: Store) -> Iterator[str]:
    """Sentences that say which files of a folder are of different sweeps."""
    if not store.hysteresis.is_file():
        return
    shards = sorted((store.folder / "shards").glob("*.nc"))
    try:
        about, listed = read_attributes(store.hysteresis), set(curve_names(store.hysteresis))
        rows = {name for path in shards for name in curve_names(path)}
    except (UnreadableFileError, KeyError):
        return  # what is damaged is said elsewhere
    path = store.configuration
    if path.is_file() and path.read_bytes() != about.get("configuration", "").encode():
        # Another text may mean the same. What it reads may be on another machine.
        with contextlib.suppress(ValueError, OSError):
            if load_configuration(path).table_fingerprint != about.get(SWEEP_FINGERPRINT):
                yield f"{store.hysteresis} is the table of another sweep than {path}"
    if others := listed - rows:
        cause = "of another sweep" if shards and not listed & rows else "to be simulated again"
        yield (
            f"{len(others)} of {len(listed)} rows of {store.hysteresis} are in no file of "
            f"{store.folder / 'shards'}, which are {cause}"
        )
    yield from _fit_sentences(store, about.get(SWEEP_FINGERPRINT, ""))
    known = {one.name for pack in pack_paths(store.curves) for one in members(pack)[0]}
    if known and listed and not listed & known:
        yield f"{store.curves} holds no curve of {store.hysteresis}, but those of another sweep"


def _fit_sentences(store: Store, table: str) -> Iterator[str]:
    """Sentences where the fit of a folder is not that of its table and its configuration."""
    path = store.folder / "fit.nc"
    with contextlib.suppress(ValueError, OSError):
        if not path.is_file():
            return
        found, fitted = fit_range(path)
        if fitted and fitted != table:
            yield f"{path} is the fit of another table than {store.hysteresis}"
        if store.configuration.is_file():
            wanted = load_configuration(store.configuration).fit
            if found != wanted:
                yield f"{path} is the fit of another range than that of {store.configuration}"


@contextlib.contextmanager
def _folder(place: Path) -> Iterator[Path]:
    """A folder, or what can be unpacked of an archive of it."""
    if place.is_dir():
        yield place
        return
    if not place.is_file():
        raise UnreadableFileError(f"{place} does not exist; name a folder of results or an archive")
    with place.open("rb") as file:
        if place.suffix.lower() != ".zip" and file.read(2) != b"PK":
            raise UnreadableFileError(
                f"{place} is neither a folder of results nor an archive (ZIP) of one"
            )
    with tempfile.TemporaryDirectory() as temporary:
        _unpack(place, Path(temporary))
        inner = list(Path(temporary).iterdir())
        yield inner[0] if len(inner) == 1 else Path(temporary)


_ENCRYPTED = 1
"""Bit of an entry in a ZIP file whose content is encrypted."""


def _unpack(place: Path, folder: Path) -> None:
    """Unpack what can be unpacked of an archive; the rest lacks or is cut, and is found as that."""
    try:
        archive = ZipFile(place)
    except (BadZipFile, EOFError, ValueError, NotImplementedError):
        return
    with archive:
        entries = archive.infolist()
        if entries and all(entry.flag_bits & _ENCRYPTED for entry in entries):
            raise UnreadableFileError(
                f"{place} is encrypted; unpack it with its password, and verify the folder"
            )
        for entry in entries:
            try:
                archive.extract(entry, folder)
            except MemoryError:
                raise
            except Exception as error:  # a damaged entry may be wrong in any way
                if isinstance(error, OSError) and error.errno in NO_ROOM:
                    raise
