"""Text files of any encoding, decoded."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

_MARKS = (
    (b"\xff\xfe\0\0", "utf-32"),
    (b"\0\0\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
    (b"\xef\xbb\xbf", "utf-8-sig"),
)
"""Byte order marks, the longer ones first."""

_COMPRESSED = (
    (b"\x1f\x8b", "gzip", "gunzip"),
    (b"BZh", "bzip2", "bunzip2"),
    (b"\xfd7zXZ\0", "xz", "unxz"),
    (b"\x28\xb5\x2f\xfd", "zstd", "unzstd"),
)
"""Signatures of compressed files, with the names of the format and of the command that unpacks."""

_BINARY = bytes({*range(32)} - {*b"\t\n\v\f\r\x1a"})
"""Bytes that do not occur in a text; 0x1a ends one in DOS."""

_MICROS = (("Âµ", "µ"), ("Î¼", "µ"), ("æm", "µm"))
"""A micro sign that another program has decoded wrongly, or wrote in the encoding of DOS."""


def decoded(path: Path) -> str | None:
    r"""Content of a text file with \n between its lines.

    UTF-8, UTF-16 and UTF-32, with or without a byte order mark, else Windows-1252 or Latin-1.

    Parameters
    ----------
    path : Path
        Any file.

    Returns
    -------
    str or None
        None if the file is not a text.

    Raises
    ------
    ValueError
        If the file contradicts its own byte order mark, or is compressed.
    OSError
        If it cannot be opened.
    """
    with path.open("rb") as file:
        start = file.read(4096)
        for signature, name, command in _COMPRESSED:
            if start.startswith(signature):
                raise ValueError(
                    f"{path} is compressed with {name}; unpack it, as with {command}, and name the "
                    "file that comes out"
                )
        marked = next((name for mark, name in _MARKS if start.startswith(mark)), None)
        wide = None if marked else _encoding_of_nulls(start)
        if b"\0" in start and not (marked or wide):
            return None
        content = start + file.read()
    if not (marked or wide) and len(content.translate(None, _BINARY)) < len(content):
        return None
    text, encoding = None, marked or wide
    for name in (encoding,) if encoding else ("utf-8", "cp1252", "latin-1"):
        with suppress(UnicodeDecodeError):
            text = content.decode(name)
            break
    if text is None and marked:
        raise ValueError(
            f"{path} begins as a text in {marked} and does not go on as one; export it from the "
            "instrument again"
        )
    if text is None or "\0" in text:
        return None
    for wrong, right in _MICROS:
        text = text.replace(wrong, right)
    return text.rstrip("\x1a").replace("\r\n", "\n").replace("\r", "\n")


def _encoding_of_nulls(start: bytes) -> str | None:
    """UTF-16 without a mark, by zeros in every second byte and nowhere else."""
    even, odd = start[::2], start[1::2]
    for zeros, letters, name in ((odd, even, "utf-16-le"), (even, odd, "utf-16-be")):
        if len(start) > 3 and not letters.count(0) and zeros.count(0) > 0.9 * len(zeros):
            return name
    return None
