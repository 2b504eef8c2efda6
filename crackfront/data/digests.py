"""Digests: a file states at its end what its content hashes to, which is checked on reading.

The statement is a line of its own, or what the format has for a remark: netCDF, PNG, PDF and GIF
end where they say themselves, Markdown, YAML and HTML have comments, and JSON gets a last key. The
SHA-256 is that of all bytes of the file but its own 64 digits.
"""

from __future__ import annotations

import enum
import hashlib
import io
import os
from pathlib import Path
from typing import BinaryIO

_MARK = b"crackfront digest sha256 "
"""What stands before the digits."""

_DIGITS = 64

_TAIL = 160
"""Bytes at the end of a file among which its digest stands."""

_COMMENT = {
    ".json": (b',\n "digest": "', b'"\n}\n'),
    ".md": (b"<!-- ", b" -->\n"),
    ".html": (b"<!-- ", b" -->\n"),
    ".svg": (b"<!-- ", b" -->\n"),
    ".yaml": (b"# ", b"\n"),
    ".pdf": (b"% ", b"\n"),
}
"""What stands around a digest in a file of a format; elsewhere it is a line."""

_ALWAYS_SEALED = (
    *("configuration.yaml", "hysteresis.nc", "fit.nc", "fit.json", "fit.md", "summary.html"),
    *("curves/*-r[0-9]*.nc", "checkpoints/*-r[0-9]*.nc", "shards/*.nc"),
    *("figures/*.pdf", "figures/*.png"),
    *("figures/*/*.nc", "figures/*/*.pdf", "figures/*/*.png", "figures/*/*.gif"),
    *("checks.md", "accuracy/*.nc", "accuracy/*.pdf", "accuracy/*.png", "accuracy.md"),
    *("validation*/*.nc", "validation.pdf", "validation.png", "validation.md"),
)
"""Files in folders of results that are never written without a digest."""


class Integrity(enum.Enum):
    """Whether the content of a file is that which was written."""

    WHOLE = "whole"
    DAMAGED = "damaged"
    UNKNOWN = "without a digest"


def seal(path: Path, suffix: str) -> str:
    """Add the digest to a file that is finished otherwise, and return it.

    The suffix is the ending of the name that it will have, from which its format follows. JSON must
    be a mapping that ends in a brace and a new line.
    """
    before, after = _COMMENT.get(suffix, (b"\n", b"\n"))
    with path.open("rb+") as file:
        if suffix == ".json":
            file.truncate(file.seek(-len(b"\n}\n"), os.SEEK_END))
        file.seek(0, os.SEEK_END)
        file.write(before + _MARK)
        file.seek(0)
        content = hashlib.file_digest(file, "sha256")
        content.update(after)
        file.write(content.hexdigest().encode() + after)
    return content.hexdigest()


def integrity(path: Path) -> tuple[Integrity, str]:
    """Whether a file is as it was written, and the digest that it states; empty where none is.

    Without a digest, a file that is always written with one is damaged.
    """
    with path.open("rb") as file:
        found, digest = _integrity(file)
    if found is Integrity.UNKNOWN and any(path.match(pattern) for pattern in _ALWAYS_SEALED):
        return Integrity.DAMAGED, ""
    return found, digest


def sealed(content: bytes, suffix: str) -> tuple[bytes, str]:
    """Content of a file with its digest, as :func:`seal` adds it, and the digest."""
    before, after = _COMMENT.get(suffix, (b"\n", b"\n"))
    start = content.removesuffix(b"\n}\n" if suffix == ".json" else b"") + before + _MARK
    digest = hashlib.sha256(start + after).hexdigest()
    return start + digest.encode() + after, digest


def content_digest(content: bytes) -> str:
    """The digest that the content of a file states; empty where it is wrong or none."""
    return _integrity(io.BytesIO(content))[1]


def _integrity(file: BinaryIO) -> tuple[Integrity, str]:
    """The same of an open file, of any name."""
    start = max(0, file.seek(0, os.SEEK_END) - _TAIL)
    file.seek(start)
    tail = file.read()
    place = tail.rfind(_MARK)
    if place < 0:
        return Integrity.UNKNOWN, ""
    digits = place + len(_MARK)
    stated, left = tail[digits : digits + _DIGITS], start + digits
    content = hashlib.sha256()
    file.seek(0)
    while left and (block := file.read(min(left, 2**20))):
        content.update(block)
        left -= len(block)
    content.update(tail[digits + _DIGITS :])
    if content.hexdigest().encode() != stated:
        return Integrity.DAMAGED, ""
    return Integrity.WHOLE, content.hexdigest()
