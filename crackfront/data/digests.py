"""SHA256SUMS: the checksums of a folder of results, as `sha256sum --check SHA256SUMS` reads them.

A command that finishes a folder writes the list, and one that changes the folder removes it first.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

SUMS = "SHA256SUMS"
"""Name of the list of checksums in a folder."""

_DIGEST_SUFFIX = ".sha256"
"""Ending of the name of the file that states the checksum of one other file."""

DAMAGED_SUFFIX = ".damaged"
"""Ending of the name of a file that was set aside."""

_NO_RESULTS = {"logs", "benchmarks", "checkpoints"}
"""Folders whose files are not results and change while results are made."""


def result_files(folder: Path) -> Iterator[Path]:
    """Files of a folder of results, in the order of their names.

    Hidden ones, links, files that were set aside, logs, times and checkpoints are left out.
    """
    for path in sorted(folder.rglob("[!.]*")):
        parts = path.relative_to(folder).parts
        left_out = path.is_symlink() or path.suffix == DAMAGED_SUFFIX or path.name == SUMS
        if path.is_file() and not left_out and _NO_RESULTS.isdisjoint(parts):
            yield path


def file_digest(path: Path) -> str:
    """SHA-256 of the content of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def digest_path(path: Path) -> Path:
    """Path of the file that states the checksum of one file, as `sha256sum --check` reads it."""
    return path.with_name(path.name + _DIGEST_SUFFIX)


def stated_digest(path: Path) -> str | None:
    """Checksum of a file as the one at its :func:`digest_path` states it; None without one."""
    try:
        return digest_path(path).read_text(encoding="utf-8", errors="replace").partition(" ")[0]
    except FileNotFoundError:
        return None


def sums_text(digests: Mapping[str, str]) -> str:
    """Content of a list of checksums, by the names of files."""
    return "".join(f"{digest}  {name}\n" for name, digest in digests.items())


def read_sums(folder: Path) -> dict[str, str]:
    """Checksums in the list of a folder by the names of its files; empty without a list."""
    path = folder / SUMS
    if not path.is_file():
        return {}
    lines = path.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    return {name: digest for digest, _, name in (line.partition("  ") for line in lines)}


def forget_sums(folder: Path) -> None:
    """Remove the list of a folder before its files change."""
    (folder / SUMS).unlink(missing_ok=True)


DIGITS_IN_NAME = 16
"""Digits of the checksum of a file that end its name, before its suffix."""

_NAMED = re.compile(r"(batch|curves|checkpoint)-.+-([0-9a-f]{16})\.nc")


def named_digest(path: Path) -> str | None:
    """First digits of the checksum of a file as its own name states them; None without any."""
    match = _NAMED.fullmatch(path.name)
    return match[2] if match else None


def is_whole(path: Path) -> bool:
    """Whether a file agrees with the checksum that its name or the file beside it states."""
    known = named_digest(path)
    if known is not None:
        return file_digest(path).startswith(known)
    return stated_digest(path) == file_digest(path)
