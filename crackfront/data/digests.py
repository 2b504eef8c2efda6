"""SHA-256 checksums of results: in a list, in a file next to one, or in the name of one.

`SHA256SUMS` lists a finished folder, as `sha256sum --check` reads it. A derived netCDF file has its
checksum in `<file>.sha256`, in the same format. The names of finished simulations and checkpoints
end with the first digits of their own checksum, because one renaming then replaces both.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath, PurePosixPath

SUMS = "SHA256SUMS"
"""Name of the list of checksums in a folder."""

DIGEST_SUFFIX = ".sha256"
"""Ending of the name of the file that states the checksum of one other file."""

DAMAGED_SUFFIX = ".damaged"
"""Ending of the name of a file that was set aside."""

DIGITS_IN_NAME = 16
"""Digits of the checksum of a file that end its name, before its suffix."""

_NAMED = re.compile(
    rf"(?:batch|curves|checkpoint)-(?:.*-)?([0-9a-f]{{{DIGITS_IN_NAME}}})\.nc", re.DOTALL
)
"""Names that end with a checksum."""

_LINE = re.compile(r"([0-9a-f]{64})  (.+)", re.DOTALL)
"""Line of a list: a checksum, two blanks and a name."""

_NO_RESULTS = {"logs", "benchmarks"}
"""Folders whose files are not results and change while results are made."""

_CHECKPOINT = re.compile(r"checkpoint-.*\.nc", re.DOTALL)
"""Names of checkpoints, which are not results: a run removes them when it ends."""

_CHECKSUM_BYTES = 4096
"""Bytes that are read of a file with one checksum: a longer name than this cannot exist."""


@dataclass(frozen=True, slots=True)
class FolderContent:
    """What a folder of results contains, by paths that begin with the folder."""

    files: tuple[Path, ...]
    """Regular files, also those that links lead to."""
    dangling: tuple[Path, ...]
    """Links that lead to nothing."""
    irregular: tuple[Path, ...]
    """Pipes, sockets, devices, and links to a folder that contains them; none was opened."""


def folder_content(folder: Path) -> FolderContent:
    """Files of a folder of results, in the order of their names; links are followed.

    Hidden files, files that were set aside, checkpoints, lists of checksums and the folders `logs`
    and `benchmarks` are left out.
    """
    files, dangling, irregular = [], [], []
    for path, mode in _entries(folder, frozenset()):
        if mode is None:
            dangling.append(path)
        elif stat.S_ISREG(mode):
            files.append(path)
        else:
            irregular.append(path)
    return FolderContent(tuple(files), tuple(dangling), tuple(irregular))


def _entries(folder: Path, above: frozenset[str]) -> Iterator[tuple[Path, int | None]]:
    """Paths below a folder with their file modes, None for links to nothing.

    `above` has the real paths of the folders that lead to this one, so that a loop of links ends.
    """
    here = above | {os.path.realpath(folder)}
    for path in sorted(folder.iterdir()):
        if not _is_result(path.name):
            continue
        try:
            mode = path.stat().st_mode
        except OSError:
            # A file that a running command has removed in the meantime is not a result.
            if path.is_symlink():
                yield path, None
            continue
        if stat.S_ISDIR(mode) and os.path.realpath(path) not in here:
            with contextlib.suppress(FileNotFoundError):  # removed in the meantime
                yield from _entries(path, here)
        else:
            yield path, mode


def _is_result(name: str) -> bool:
    """Whether a file of this name, or a folder of it, belongs to results."""
    left_out = name.startswith(".") or name.endswith(DAMAGED_SUFFIX) or name == SUMS
    return not (left_out or name in _NO_RESULTS or _CHECKPOINT.fullmatch(name))


def is_result_name(name: str) -> bool:
    """Whether a file belongs to results, by its name relative to their folder.

    Examples
    --------
    >>> is_result_name("shards/flat.nc"), is_result_name("logs/fit.log")
    (True, False)
    """
    return all(map(_is_result, PurePosixPath(name).parts))


def result_files(folder: Path) -> Iterator[Path]:
    """Regular files of a folder of results, as :func:`folder_content` finds them."""
    yield from folder_content(folder).files


def file_digest(path: Path) -> str:
    """SHA-256 of the content of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def digest_path(path: Path) -> Path:
    """Path of the file that states the checksum of one file, as `sha256sum --check` reads it."""
    return path.with_name(path.name + DIGEST_SUFFIX)


def stated_digest(path: Path) -> str | None:
    """Checksum of a file that the file at its :func:`digest_path` states.

    None without such a file; empty if that file does not state a checksum.
    """
    try:
        if not stat.S_ISREG(digest_path(path).stat().st_mode):  # opening a pipe would wait
            return ""
        with digest_path(path).open("rb") as file:
            return digest_of_line(file.read(_CHECKSUM_BYTES))
    except FileNotFoundError:
        return None


def digest_of_line(content: bytes) -> str:
    """Checksum that the content of a file with one checksum states; empty if it states none."""
    match = _LINE.fullmatch(content.decode("utf-8", "surrogateescape"))
    return match[1] if match and match[2].endswith("\n") else ""


def named_digest(path: PurePath) -> str | None:
    """First digits of the checksum of a file that its name states; None for other names.

    Examples
    --------
    >>> from pathlib import Path
    >>> named_digest(Path("curves/flat/batch-0-3-0123456789abcdef.nc"))
    '0123456789abcdef'
    """
    match = _NAMED.fullmatch(path.name)
    return match[1] if match else None


def is_whole(path: Path) -> bool:
    """Whether the checksum of a file is stated in its name, or next to it, and the file agrees.

    False if nothing states a checksum: the caller knows which files must have one.
    """
    named, stated = named_digest(path), stated_digest(path)
    if not path.is_file() or (named is None and stated is None):
        return False
    digest = file_digest(path)
    return digest == stated if named is None else digest.startswith(named)


def sums_text(digests: Mapping[str, str]) -> str:
    """Content of a list of checksums, by the names of files."""
    return "".join(f"{digest}  {name}\n" for name, digest in digests.items())


def parsed_sums(content: bytes) -> dict[str, str]:
    """Checksums by names, from the content of a list.

    ValueError if it is not a whole list; the message says what is wrong and begins with a verb.
    """
    if not content:
        raise ValueError("is empty")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError("is not UTF-8 text") from error
    if not text.endswith("\n"):
        raise ValueError("is truncated: its last line does not end")
    digests: dict[str, str] = {}
    # Not by splitlines(): a name may contain what that takes for the end of a line.
    for number, line in enumerate(text[:-1].split("\n"), start=1):
        match = _LINE.fullmatch(line)
        if match is None:
            raise ValueError(f"is damaged: line {number} is not a checksum, two blanks and a name")
        digest, name = match.groups()
        if not is_plain_name(name):
            raise ValueError(
                f"names {shown(name)} in line {number}, which is not a path within the folder"
            )
        if name in digests:
            raise ValueError(f"names {shown(name)} twice")
        digests[name] = digest
    return digests


def is_plain_name(name: str) -> bool:
    """Whether a name leads to a place within its folder, and is written in the shortest way.

    Examples
    --------
    >>> is_plain_name("shards/flat.nc"), is_plain_name("../flat.nc"), is_plain_name("/flat.nc")
    (True, False, False)
    """
    path = PurePosixPath(name)
    leads_out = path.is_absolute() or ".." in path.parts
    return bool(path.parts) and str(path) == name and not leads_out and "\0" not in name


def shown(name: str) -> str:
    r"""A name as a terminal can show it in one line: letters that it cannot show are escaped.

    Examples
    --------
    >>> print(shown("two\nlines"))
    two\nlines
    """
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in name)


def read_sums(folder: Path) -> dict[str, str]:
    """Checksums in the list of a folder by the names of its files; empty without a list.

    ValueError if the list is empty, truncated, doubled or damaged.
    """
    path = folder / SUMS
    if not path.is_file():
        return {}
    try:
        return parsed_sums(path.read_bytes())
    except ValueError as error:
        raise ValueError(
            f"{path} {error}; remove it, and run crackfront checksums {folder}"
        ) from error


def forget_sums(folder: Path) -> None:
    """Remove the list of a folder before its files change."""
    (folder / SUMS).unlink(missing_ok=True)
