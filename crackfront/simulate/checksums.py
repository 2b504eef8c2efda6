"""SHA-256 checksums of results: in a list, in a file next to one, or in the name of one.

`SHA256SUMS` lists a finished folder, as `sha256sum --check` reads it. A derived netCDF file has its
checksum in `<file>.sha256`, in the same format. The names of finished simulations and checkpoints
end with the first digits of their own checksum, because one renaming then replaces both.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Mapping
from pathlib import Path

SUMS = "SHA256SUMS"
"""Name of the list of checksums in a folder."""

DAMAGED_SUFFIX = ".damaged"
"""Ending of the name of a file that was set aside."""

DIGITS_IN_NAME = 16
"""Digits of the checksum of a file that end its name, before its suffix."""

BATCH, MERGED, CHECKPOINT = "batch", "curves", "checkpoint"
"""Beginnings of the names that end with a checksum: finished simulations, many of them in one file,
and simulations that are running."""

_NAMED = re.compile(rf"({BATCH}|{MERGED}|{CHECKPOINT})-.*-([0-9a-f]{{{DIGITS_IN_NAME}}})\.nc")
"""Names that end with a checksum."""

_LINE = re.compile(r"([0-9a-f]{64})  (.+)\n")
"""Line of a list: a checksum, two blanks and a name."""

_EXCLUDED_FOLDERS = {"logs", "benchmarks"}
"""Folders whose files are not results and change while results are made."""

_EXCLUDED_FILES = {SUMS, "report.html"}
"""The list itself, and the report of Snakemake, which is made later."""


def result_files(folder: Path) -> list[str]:
    """Names of the files of a folder of results, relative to it, in their order.

    Links are followed. Hidden files, files that were set aside, checkpoints, the list of checksums,
    a report of Snakemake, and what is not a regular file are left out.
    """
    names = []
    for place, folders, files in os.walk(folder, followlinks=True):
        above = (os.path.realpath(parent) for parent in Path(place).parents)
        if os.path.realpath(place) in above:
            folders.clear()  # a link that leads back
            continue
        folders[:] = [name for name in folders if name not in _EXCLUDED_FOLDERS and name[0] != "."]
        paths = (Path(place, name) for name in files if _is_result(name))
        names += [path.relative_to(folder).as_posix() for path in paths if path.is_file()]
    return sorted(names)


def _is_result(name: str) -> bool:
    """Whether a file of this name is a result."""
    left_out = name in _EXCLUDED_FILES or name[0] == "."
    return not (left_out or name.endswith(DAMAGED_SUFFIX) or name.startswith(f"{CHECKPOINT}-"))


def file_digest(path: Path) -> str:
    """SHA-256 of the content of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def digest_path(path: Path) -> Path:
    """Path of the file that states the checksum of one file, as `sha256sum --check` reads it."""
    return path.with_name(f"{path.name}.sha256")


def stated_digest(path: Path) -> str | None:
    """First digits of the checksum of a file, as its name or the file next to it states them.

    None if nothing states them.
    """
    if match := _NAMED.fullmatch(path.name):
        return match[2]
    file = digest_path(path)
    return file.read_text(encoding="utf-8", errors="replace")[:64] if file.is_file() else None


def is_whole(path: Path) -> bool:
    """Whether a file agrees with the checksum in its name or next to it.

    False if nothing states a checksum: the caller knows which files must have one.
    """
    digest = stated_digest(path)
    # A file next to it that was cut short states too few digits.
    if digest is None or len(digest) < DIGITS_IN_NAME:
        return False
    return file_digest(path).startswith(digest)


def sums_text(digests: Mapping[str, str]) -> str:
    """Content of a list of checksums, by the names of files."""
    return "".join(f"{digest}  {name}\n" for name, digest in digests.items())


def parsed_sums(text: str, place: Path) -> dict[str, str]:
    """Checksums by names, from the content of the list of a folder or an archive.

    ValueError if it is not a whole list of different files.
    """
    lines = [_LINE.fullmatch(line) for line in text.splitlines(keepends=True)]
    digests = {match[2]: match[1] for match in lines if match}
    if not digests or len(digests) < len(lines):
        raise ValueError(
            f"{SUMS} of {place} is empty, cut or damaged; remove it and run make, or crackfront "
            "checksums"
        )
    return digests


def read_sums(folder: Path) -> dict[str, str]:
    """Checksums in the list of a folder by the names of its files; ValueError without a list."""
    path = folder / SUMS
    if not path.is_file():
        raise ValueError(
            f"{folder} lacks {SUMS}, so nothing says which files belong to it; run make, or "
            "crackfront checksums if it is finished"
        )
    return parsed_sums(path.read_text(encoding="utf-8", errors="replace"), folder)


def forget_sums(folder: Path) -> None:
    """Remove the list of a folder before its files change."""
    (folder / SUMS).unlink(missing_ok=True)
