"""Whether results are as they were written: verification, lists of checksums and archives.

Nothing here opens a netCDF file: HDF5 may loop for ever on damaged metadata.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from crackfront.data.bounds import counted, in_bytes
from crackfront.data.digests import (
    DIGEST_SUFFIX,
    SUMS,
    FolderContent,
    digest_of_line,
    file_digest,
    folder_content,
    is_plain_name,
    is_result_name,
    named_digest,
    parsed_sums,
    read_sums,
    shown,
    stated_digest,
    sums_text,
)
from crackfront.data.files import replace_atomically, write_text

_CURVES, _SHARDS = "curves", "shards"
"""Folders of the finished simulations of a sweep, and of the rows that are derived from them."""

_OF_SWEEPS = {_CURVES, _SHARDS, "requests", "configuration.yaml"}
"""Files and folders, at least one of which every folder of a sweep contains."""

_DERIVED = {"hysteresis.nc", "fit.nc"}
"""Files of a sweep that must have a checksum next to them, as those in its shards."""

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Suffixes of files that a ZIP file stores as they are, because they would not become smaller."""

_CHUNK = 2**20
"""Bytes that are read at a time: memory does not depend on the size of a file."""

_MOST_MEMBERS = 10**6
"""Files that an archive may contain; a sweep has some hundreds."""

_MOST_EXPANSION = 1000
"""How many times larger than its packed content a file may be; texts stay below a hundred."""

_LONGEST_LIST = 10**8
"""Size of a list of checksums in an archive that is read: that of a million files. (Units: bytes)
"""

_ENCRYPTED = 1
"""Flag of a file in an archive whose content is encrypted."""


@dataclass(frozen=True, slots=True)
class Verification:
    """What a verification found; names are relative to the folder of results."""

    listed: int
    """Number of files that the list of checksums names."""
    verified: int
    """Number of files that agree with a checksum."""
    damaged: tuple[str, ...] = ()
    """Files that do not agree with a checksum."""
    missing: tuple[str, ...] = ()
    """Absent files that the list names, or whose checksum is there, or that a link leads to."""
    unlisted: tuple[str, ...] = ()
    """Results that the list does not name."""
    irregular: tuple[str, ...] = ()
    """Pipes, sockets, devices and loops of links; none was opened."""
    fault: str = ""
    """Sentence on the list, or on the archive, if it cannot be used."""

    @property
    def is_whole(self) -> bool:
        """Whether a list names all results, and all are there and as they were written."""
        wrong = self.damaged or self.missing or self.unlisted or self.fault
        return self.verified > 0 and not wrong


@dataclass(slots=True)
class _Content:
    """What was read of a folder or an archive, by names relative to the folder of results."""

    digests: dict[str, str] = field(default_factory=dict)
    """Checksums of the files as they are; empty for a file that cannot be read."""
    stated: dict[str, str] = field(default_factory=dict)
    """Checksums that files next to others state of these."""
    sums: dict[str, str] = field(default_factory=dict)
    """The list."""
    dangling: list[str] = field(default_factory=list)
    irregular: list[str] = field(default_factory=list)
    fault: str = ""


def verification(place: Path) -> Verification:
    """Compare all files of a folder of results, or of its archive, with their checksums.

    ValueError if the place is neither, or if it is an archive that is not safe to unpack.
    """
    if place.is_dir():
        return _compared(_folder_digests(place, folder_content(place)))
    if not place.exists():
        raise ValueError(f"{place} does not exist; name a folder of results or its archive (ZIP)")
    if not place.is_file() or not _claims_to_be_zip(place):
        raise ValueError(f"{place} is neither a folder of results nor its archive (ZIP)")
    try:
        archive = ZipFile(place)
    except (MemoryError, PermissionError):
        raise
    except Exception:  # a damaged archive may be wrong in any way
        fault = f"{place} is not a whole ZIP file; pack or copy it again"
        return Verification(0, 0, damaged=(place.name,), fault=fault)
    with archive:
        return _compared(_archive_digests(place, archive))


def _claims_to_be_zip(place: Path) -> bool:
    """Whether a file has the suffix or the first letters of a ZIP file."""
    with place.open("rb") as file:
        return place.suffix.lower() == ".zip" or file.read(2) == b"PK"


def _compared(content: _Content) -> Verification:
    """Compare the checksums of files with those of the list, of their names and next to them."""
    digests, sums = content.digests, content.sums
    damaged = {
        name for name, digest in digests.items() if not digest or sums.get(name, digest) != digest
    }
    # A damaged file with a checksum says nothing on the file next to it.
    stated = {
        name: digest
        for name, digest in content.stated.items()
        if f"{name}{DIGEST_SUFFIX}" not in damaged
    }
    damaged |= {name for name in digests if not _agrees_with_own(name, digests[name], stated)}
    missing = {*sums, *stated, *content.dangling, *_lacking_digests(digests)} - {*digests}
    checked = {name for name in digests if _is_checked(name, stated, sums)}
    return Verification(
        listed=len(sums),
        verified=len(checked - damaged),
        damaged=tuple(sorted(damaged)),
        missing=tuple(sorted(missing)),
        unlisted=tuple(sorted({*filter(is_result_name, digests)} - {*sums})) if sums else (),
        irregular=tuple(content.irregular),
        fault=content.fault,
    )


def _is_checked(name: str, stated: Mapping[str, str], sums: Mapping[str, str]) -> bool:
    """Whether there is a checksum to compare a file with."""
    return name in sums or name in stated or named_digest(PurePosixPath(name)) is not None


def _agrees_with_own(name: str, digest: str, stated: Mapping[str, str]) -> bool:
    """Whether a file has the checksum that its name states, or a file next to it."""
    named = named_digest(PurePosixPath(name))
    if named is not None:
        return digest.startswith(named)
    return stated.get(name, digest) == digest


def _lacking_digests(names: Iterable[str]) -> Iterator[str]:
    """Names of the files with checksums that derived files of a sweep must have."""
    paths = [PurePosixPath(name) for name in names]
    # A validation has a table of the same name, which nothing is derived from.
    is_sweep = any(path.parts[0] in _OF_SWEEPS for path in paths)
    for path in paths:
        in_shards = path.parent == PurePosixPath(_SHARDS) and path.suffix == ".nc"
        if in_shards or (is_sweep and str(path) in _DERIVED):
            yield f"{path}{DIGEST_SUFFIX}"


def _folder_digests(folder: Path, found: FolderContent) -> _Content:
    """Read the files that were found in a folder."""
    content = _Content()
    content.dangling = _names(folder, found.dangling)
    content.irregular = _names(folder, found.irregular)
    try:
        content.sums = read_sums(folder)
        if not content.sums:
            content.fault = (
                f"{folder} has no {SUMS}, so nothing says which files belong to it; run make, or "
                f"crackfront checksums {folder} if it is finished"
            )
    except ValueError as error:
        content.fault = str(error)
    # A list may also name files that are otherwise left out, such as logs.
    listed = (folder / name for name in content.sums if not is_result_name(name))
    for path in (*found.files, *filter(Path.is_file, listed)):
        name = _name(folder, path)
        try:
            content.digests[name] = file_digest(path)
        except FileNotFoundError:
            continue  # a running command has removed it in the meantime
        if path.suffix == DIGEST_SUFFIX:
            described = path.with_suffix("")
            content.stated[_name(folder, described)] = stated_digest(described) or ""
    return content


def _name(folder: Path, path: Path) -> str:
    """Name of a file relative to its folder, with slashes."""
    return path.relative_to(folder).as_posix()


def _names(folder: Path, paths: Iterable[Path]) -> list[str]:
    """Names of files relative to their folder, with slashes."""
    return [_name(folder, path) for path in paths]


def _archive_digests(place: Path, archive: ZipFile) -> _Content:
    """Read the files of an archive in pieces, without unpacking it."""
    _refuse_unsafe(place, archive.infolist())
    files = [member for member in archive.infolist() if not member.is_dir()]
    root = _root(member.filename for member in files)
    members = {member.filename.removeprefix(root): member for member in files}
    content = _Content()
    _read_list(place, content, archive, members.pop(SUMS, None))
    for name, member in members.items():
        if is_result_name(name) or name in content.sums:
            digest, first = _stream_digest(archive, member)
            content.digests[name] = digest
            if PurePosixPath(name).suffix == DIGEST_SUFFIX:
                content.stated[name.removesuffix(DIGEST_SUFFIX)] = digest_of_line(first)
    return content


def _read_list(place: Path, content: _Content, archive: ZipFile, member: ZipInfo | None) -> None:
    """Read the list of an archive, or say what is wrong with it."""
    if member is None:
        content.fault = (
            f"{place} has no {SUMS}, so nothing says which files belong to it; pack it again with "
            "crackfront archive"
        )
        return
    if member.file_size > _LONGEST_LIST:
        raise ValueError(f"{place}: {SUMS} has more than {in_bytes(_LONGEST_LIST)}; pack it again")
    try:
        content.sums = parsed_sums(archive.read(member))
    except MemoryError:
        raise
    except Exception as error:  # a damaged member may be wrong in any way
        reason = error if type(error) is ValueError else "is damaged"
        content.fault = f"{place}: {SUMS} {reason}; pack it again with crackfront archive"


def _stream_digest(archive: ZipFile, member: ZipInfo) -> tuple[str, bytes]:
    """Checksum of a file of an archive, empty if it cannot be read, and its first piece."""
    digest, first = hashlib.sha256(), b""
    try:
        with archive.open(member) as file:
            while piece := file.read(_CHUNK):
                first = first or piece
                digest.update(piece)
    except MemoryError:
        raise
    except Exception:  # a damaged member may be wrong in any way
        return "", b""
    return digest.hexdigest(), first


def _root(names: Iterable[str]) -> str:
    """Folder that all files of an archive are in, with its slash; empty if they are in several."""
    folders = {name.partition("/")[0] if "/" in name else "" for name in names}
    folder = folders.pop() if len(folders) == 1 else ""
    return f"{folder}/" if folder else ""


def _refuse_unsafe(place: Path, members: list[ZipInfo]) -> None:
    """Raise a ValueError if an archive should be neither read nor unpacked."""
    if len(members) > _MOST_MEMBERS:
        raise ValueError(
            f"{place} contains {len(members)} files, more than {_MOST_MEMBERS}; results have "
            "fewer, so it is not read"
        )
    packed = place.stat().st_size
    names: set[str] = set()
    for member in members:
        name = member.filename.removesuffix("/")
        if not is_plain_name(name):
            raise ValueError(
                f"{place} contains {shown(name)}, which would be unpacked outside of its folder or "
                "under another name; do not unpack it"
            )
        if name in names:
            raise ValueError(f"{place} contains {shown(name)} twice; pack it again")
        names.add(name)
        if member.flag_bits & _ENCRYPTED:
            raise ValueError(
                f"{place} is encrypted; unpack it with its password, and verify the folder"
            )
        # Other methods may turn a piece of any size into memory without a bound.
        if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
            raise ValueError(
                f"{place}: {shown(name)} is compressed by another method than deflate; pack it "
                "again with crackfront archive"
            )
        _refuse_expansion(f"{place}: {shown(name)}", member.file_size, member.compress_size)
    _refuse_expansion(f"{place}", sum(member.file_size for member in members), packed)


def _refuse_expansion(what: str, size: int, packed: int) -> None:
    """Raise a ValueError if a small file would become a very large one."""
    if size > _MOST_EXPANSION * packed:
        raise ValueError(
            f"{what} would grow from {in_bytes(packed)} to {in_bytes(size)}, more than "
            f"{_MOST_EXPANSION} times; results do not, so do not unpack it"
        )


def write_sums(folder: Path) -> Path:
    """Write the list of the checksums of a finished folder of results, and return its path.

    ValueError, and the list stays as it was, if the folder has no results, a file disagrees with
    its checksum or with the list that is there, or the list could not name a file.
    """
    found = folder_content(folder)
    _refuse_unusual(folder, found)
    content = _folder_digests(folder, found)
    if (folder / SUMS).is_file() and content.fault:
        raise ValueError(content.fault)
    for name in _compared(content).damaged:
        if content.sums.get(name) not in (None, content.digests[name]):
            raise ValueError(
                f"{folder / name} does not agree with {SUMS}; remove it and run make, which makes "
                f"it again, or remove {SUMS} if the file was changed on purpose"
            )
        raise ValueError(
            f"{folder / name} is damaged: it does not agree with its checksum; remove it and run "
            "make, which makes it again"
        )
    if lacking := sorted({*_lacking_digests(content.digests)} - {*content.digests}):
        described = lacking[0].removesuffix(DIGEST_SUFFIX)
        raise ValueError(
            f"{folder / described} has no checksum, {PurePosixPath(lacking[0]).name}; remove the "
            "file and run make, which writes both"
        )
    if absent := sorted({*content.stated} - {*content.digests}):
        raise ValueError(
            f"{folder / absent[0]} is missing, although its checksum is there; run make, which "
            "makes it again"
        )
    digests = {name: content.digests[name] for name in _names(folder, found.files)}
    if not digests:
        raise ValueError(f"{folder} has no files; name a folder of results")
    write_text(folder / SUMS, sums_text(digests))
    return folder / SUMS


def _refuse_unusual(folder: Path, found: FolderContent) -> None:
    """Raise a ValueError if a link leads to nothing, or a list or an archive cannot have a name."""
    for path in found.dangling:
        raise ValueError(
            f"{_shown_path(path)} is a link to nothing; restore its target, or remove it"
        )
    for path in found.files:
        _refuse_name(path, _name(folder, path))


def _refuse_name(path: Path, name: str) -> None:
    """Raise a ValueError if a name cannot stand in a line of UTF-8 text."""
    try:
        name.encode("utf-8")
    except UnicodeEncodeError as error:
        raise ValueError(f"{_shown_path(path)} has a name that is not UTF-8; rename it") from error
    if "\n" in name:
        raise ValueError(f"{_shown_path(path)} has a line break in its name; rename it")


def _shown_path(path: Path) -> str:
    """A path as a terminal can show it in one line."""
    return shown(os.fspath(path))


def archive_results(folder: Path, path: Path, *, curves: bool) -> int:
    """Pack the listed files of a folder into a ZIP file, with their list; return their number.

    Every file is compared with the list while it is packed. Names begin with the name of the
    folder, as given: unpack, go there, `sha256sum --check SHA256SUMS`. `curves` includes the files
    of finished simulations. ValueError, and no archive, if there is no list, the folder has other
    results than those of the list, or a file is missing or damaged.
    """
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a folder; name a folder of results")
    sums = read_sums(folder)
    if not sums:
        raise ValueError(
            f"{folder} has no {SUMS}; run make, or crackfront checksums {folder} if it is "
            "finished, before it is archived"
        )
    found = folder_content(folder)
    _refuse_unusual(folder, found)
    root = PurePosixPath(folder.name)
    _refuse_name(folder, folder.name)
    if unlisted := sorted({*_packed(_names(folder, found.files), curves)} - {*sums}):
        raise ValueError(
            f"{SUMS} of {folder} does not list {counted(len(unlisted), 'file')}, the first is "
            f"{unlisted[0]}; run crackfront checksums {folder}, or remove what does not belong to "
            "the results"
        )
    packed = {name: sums[name] for name in _packed(sums, curves)}
    if not packed:
        raise ValueError(f"{SUMS} of {folder} lists only curves; archive it with them")

    def write(part: Path) -> None:
        with ZipFile(part, "w") as archive:
            for name, digest in packed.items():
                _pack(archive, folder / name, str(root / name), digest)
            archive.writestr(str(root / SUMS), sums_text(packed), ZIP_DEFLATED)

    replace_atomically(path, write)
    return len(packed)


def _packed(names: Iterable[str], curves: bool) -> Iterator[str]:
    """Names of the files that belong to an archive with or without curves."""
    return (name for name in names if curves or PurePosixPath(name).parts[0] != _CURVES)


def _pack(archive: ZipFile, path: Path, name: str, digest: str) -> None:
    """Pack a file into an archive; ValueError if it does not have the given checksum."""
    if not path.is_file():
        raise ValueError(
            f"{path} is missing, although {SUMS} lists it; run make, which makes it again, before "
            "the folder is archived"
        )
    # ZIP has no dates before 1980, which a wrong clock may have given.
    member = ZipInfo.from_file(path, name, strict_timestamps=False)
    member.compress_type = ZIP_STORED if path.suffix in _COMPRESSED else ZIP_DEFLATED
    actual = hashlib.sha256()
    with path.open("rb") as source, archive.open(member, "w") as target:
        while piece := source.read(_CHUNK):
            actual.update(piece)
            target.write(piece)
    if actual.hexdigest() != digest:
        raise ValueError(
            f"{path} is damaged: it does not agree with {SUMS}; remove it and run make, which "
            "makes it again, before the folder is archived"
        )
