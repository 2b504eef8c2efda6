"""Whether results are as they were written: verification, lists of checksums and archives.

Nothing here opens a netCDF file: HDF5 may loop for ever on damaged metadata.
"""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile, ZipInfo

from crackfront.core.words import in_bytes
from crackfront.simulate.checksums import (
    SUMS,
    file_digest,
    is_whole,
    parsed_sums,
    read_sums,
    result_files,
    stated_digest,
    sums_text,
)
from crackfront.simulate.storage import replace_atomically, write_text

_DERIVED = "hysteresis.nc", "fit.nc"
"""Files of a sweep that must have a checksum next to them, as those in its shards."""

_MOST_EXPANSION = 1000
"""Largest ratio of the size of unpacked files to their archive; sweeps have about 2."""

_PART_BYTES = 2**20
"""Part of a file in an archive that is in memory at a time. (Units: byte)"""

_UNREADABLE = BadZipFile, EOFError, NotImplementedError, RuntimeError, zlib.error
"""What a damaged, encrypted or unusual archive raises."""


@dataclass(frozen=True, slots=True)
class Verification:
    """What a verification found; names are relative to the folder of results."""

    verified: int
    """Number of files that agree with the list."""
    damaged: tuple[str, ...]
    """Files of the list that do not agree with it."""
    missing: tuple[str, ...]
    """Files of the list that are not there."""
    unlisted: tuple[str, ...]
    """Results that the list does not name."""

    @property
    def is_whole(self) -> bool:
        """Whether all results are in the list, there, and as they were written."""
        return self.verified > 0 and not (self.damaged or self.missing or self.unlisted)


def verification(place: Path) -> Verification:
    """Compare the files of a folder of results, or of its archive, with their list.

    An archive is read, not unpacked. ValueError if the list is missing or incomplete, or if the
    place is neither a folder nor an archive.
    """
    if place.is_dir():
        sums = read_sums(place)
        return _compared(sums, {name: file_digest(place / name) for name in result_files(place)})
    if not place.is_file():
        raise ValueError(f"{place} is neither a folder of results nor its archive (ZIP)")
    try:
        with ZipFile(place) as archive:
            _check_unpacked_size(place, archive)
            digests = _archive_digests(archive)
            members = {_name(member): member for member in archive.infolist()}
            if SUMS not in members:
                raise ValueError(f"{place} lacks {SUMS}; pack it with crackfront archive")
            text = archive.read(members[SUMS]).decode("utf-8", "replace")
    except _UNREADABLE as error:
        raise ValueError(f"{place} cannot be read as an archive (ZIP): {error}") from error
    return _compared(parsed_sums(text, place), digests)


def _compared(sums: Mapping[str, str], digests: Mapping[str, str]) -> Verification:
    """Compare the checksums of files with the list."""
    damaged = [name for name in sums if name in digests and digests[name] != sums[name]]
    missing = [name for name in sums if name not in digests]
    return Verification(
        verified=len(sums) - len(damaged) - len(missing),
        damaged=tuple(damaged),
        missing=tuple(missing),
        unlisted=tuple(name for name in digests if name not in sums),
    )


def _check_unpacked_size(place: Path, archive: ZipFile) -> None:
    """Raise ValueError if an archive is small and its files are not."""
    packed, size = place.stat().st_size, sum(member.file_size for member in archive.infolist())
    if size > _MOST_EXPANSION * packed:
        raise ValueError(
            f"{place} would grow from {in_bytes(packed)} to {in_bytes(size)}, which results do "
            "not; do not unpack it"
        )


def _archive_digests(archive: ZipFile) -> dict[str, str]:
    """Checksums of the files in an archive but its list; empty where one cannot be read."""
    members = [member for member in archive.infolist() if not member.is_dir()]
    digests = {}
    for member in members:
        try:
            digests[_name(member)] = _member_digest(archive, member)
        except _UNREADABLE:
            digests[_name(member)] = ""
    digests.pop(SUMS, None)
    return digests


def _member_digest(archive: ZipFile, member: ZipInfo) -> str:
    """SHA-256 of a file in an archive, which is read in parts, in hexadecimal digits."""
    digest = hashlib.sha256()
    with archive.open(member) as file:
        while part := file.read(_PART_BYTES):
            digest.update(part)
    return digest.hexdigest()


def _name(member: ZipInfo) -> str:
    """Name of a file in an archive relative to the folder that was packed."""
    return member.filename.partition("/")[2]


def write_sums(folder: Path) -> Path:
    """Write the list of the checksums of a finished folder of results, and return its path.

    ValueError if the folder lacks results, or a file does not agree with the checksum in its name
    or next to it, or lacks a checksum that it must have.
    """
    names = result_files(folder)
    if not names:
        raise ValueError(f"{folder} is empty; name a folder of results")
    is_sweep = (folder / "shards").is_dir()
    digests = {}
    for name in names:
        path = folder / name
        if not name.isprintable():
            raise ValueError(
                f"{folder} has a file {name!r}, whose name no list can state; rename it"
            )
        is_derived = is_sweep and (name in _DERIVED or path.parent == folder / "shards")
        must_state_digest = is_derived and path.suffix == ".nc"
        states_digest = stated_digest(path) is not None
        if (must_state_digest or states_digest) and not is_whole(path):
            raise ValueError(
                f"{path} does not agree with its checksum; remove it, of curves also their file in "
                "shards, and run make, which makes it again"
            )
        digests[name] = file_digest(path)
    write_text(folder / SUMS, sums_text(digests))
    return folder / SUMS


def archive_results(folder: Path, path: Path, *, curves: bool) -> int:
    """Pack the files of a folder into a ZIP file, with their list; return their number.

    Names begin with the name of the folder: unpack, go there, `sha256sum --check SHA256SUMS`.
    `curves` includes the files of finished simulations. ValueError, and no archive, if the folder
    is not whole.
    """
    result = verification(folder)
    if not result.is_whole:
        raise ValueError(
            f"{folder} has {len(result.damaged)} damaged, {len(result.missing)} missing and "
            f"{len(result.unlisted)} unlisted files; crackfront verify names them"
        )
    listed = read_sums(folder).items()
    packed = {name: digest for name, digest in listed if curves or not name.startswith("curves/")}

    def write(part: Path) -> None:
        with ZipFile(part, "w", ZIP_DEFLATED, compresslevel=1, strict_timestamps=False) as archive:
            for name in packed:
                archive.write(folder / name, f"{folder.name}/{name}")
            archive.writestr(f"{folder.name}/{SUMS}", sums_text(packed))

    replace_atomically(path, write)
    return len(packed)
