"""What a file must be before a library reads it: regular, of bearable size, its rows complete."""

from __future__ import annotations

import collections
import hashlib
import math
import re
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from crackfront.data.bounds import memory_at_hand, refuse_beyond_memory, regular_file

_BYTES_PER_POINT = 100
"""Memory that the analysis of a map takes for a point: heights, transforms, wavevectors."""

_LARGEST_FILE = 0.125
"""Largest file in parts of the memory: its points need several times what they take there."""

_SEPARATORS = re.compile(r"[\s,;]+")

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?")
_BETWEEN_DIGITS = re.compile(r"(?<=\d),(?=\d)")
_NO_VALUE = re.compile(r"\b(bad|infinite)\b", re.IGNORECASE)
"""Words for a point without a value that one reader knows and another takes for text."""

_MARKS = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig"))
_ADVICE = "export the scan again, or write nan where there is no value"


def refuse_unreadable(path: Path) -> None:
    """Raise where a path is no regular file, or one that is empty or larger than the memory."""
    if not regular_file(path, _LARGEST_FILE * memory_at_hand()).stat().st_size:
        raise ValueError(f"{path} is empty; export it from the instrument again")


def refuse_too_many_points(path: Path, counts: Sequence[int]) -> None:
    """Raise where a map has more points than the memory holds, before any of them is read."""
    refuse_beyond_memory(
        f"{path}, which claims {' x '.join(map(str, counts))} points,",
        _BYTES_PER_POINT * math.prod(map(float, counts)),
        "export a part of the map, or with fewer points",
    )


def checksum(path: Path) -> str:
    """Eight hexadecimal digits of the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:8]


def readable(path: Path) -> Path | BytesIO:
    """What a library shall read: the file, or its text with numbers as every reader knows them.

    A text with a row that a reader would leave out is refused.
    """
    text = _text(path)
    if text is None:
        return path
    lines = text.splitlines()
    known = [_NO_VALUE.sub("nan", line) if _row(line) is None else line for line in lines]
    if _has_decimal_commas(known):
        known = [_BETWEEN_DIGITS.sub(".", line) for line in known]
    _refuse_damaged_rows(path, known)
    return path if known == lines else BytesIO("\n".join([*known, ""]).encode())


def _text(path: Path) -> str | None:
    """Content of a text file; None of any other."""
    with path.open("rb") as file:
        start = file.read(4096)
        encoding = next((name for mark, name in _MARKS if start.startswith(mark)), None)
        if encoding is None and b"\0" in start:
            return None
        content = start + file.read()
    if encoding is None and b"\0" in content:
        return None
    try:
        return content.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _has_decimal_commas(lines: Sequence[str]) -> bool:
    """Whether numbers are written as 1,5 throughout: no number of any row has a point."""
    found = False
    for line in lines:
        cells = line.replace(";", " ").split()
        numbers = [_DECIMAL_COMMA.fullmatch(cell) is not None for cell in cells]
        if len(cells) < 2 or not (any(numbers) or all(map(_is_number, cells))):
            continue
        if any("." in cell for cell in cells):
            return False
        found = found or any(numbers)
    return found


def _refuse_damaged_rows(path: Path, lines: Sequence[str]) -> None:
    """Raise at the first line that is meant as a row of numbers and is none."""
    rows = [_row(line) for line in lines]
    counts = collections.Counter(count for count in rows if count)
    if not counts:
        return
    [(width, _)] = counts.most_common(1)
    first = next(number for number, count in enumerate(rows) if count)
    before = 0
    for number, (line, count) in enumerate(zip(lines, rows, strict=True)):
        where = f"{path}, line {number + 1}:"
        if count:
            if before > 1 and count != before:
                words = [cell.strip(",") for cell in line.replace(";", " ").split()]
                odd = next((cell for cell in words if not _is_number(cell)), None)
                text = f"{odd!r} is no number" if odd else f"the row has {count} numbers"
                raise ValueError(f"{where} {text} and the row above has {before}; {_ADVICE}")
            before = count
        elif cells := _cells(line):
            before = 0
            wrong = _wrong_cell(cells, width if number < first else None)
            if wrong is not None:
                raise ValueError(
                    f"{where} number {wrong + 1} of the row is {cells[wrong]!r}, which is no "
                    f"number; {_ADVICE}"
                )


def _wrong_cell(cells: Sequence[str], width: int | None) -> int | None:
    """Place of what is no number in a row; None where the line is a text, a comment or a head."""
    wrong = [place for place, cell in enumerate(cells) if not _is_number(cell)]
    if cells[0].startswith("#") or 2 * len(wrong) > len(cells):
        return None
    if width is not None:
        has_words = any(any(map(str.isalpha, cells[place])) for place in wrong)
        if len(cells) != width or (has_words and 4 * len(wrong) > len(cells)):
            return None
    return wrong[0]


def _row(line: str) -> int | None:
    """Numbers in a line of nothing else; 0 in an empty one, None in any other."""
    try:
        return len(list(map(float, line.split())))
    except ValueError:
        cells = _cells(line)
        return len(cells) if all(map(_is_number, cells)) else None


def _cells(line: str) -> list[str]:
    """What stands between separators."""
    return [cell for cell in _SEPARATORS.split(line) if cell]


def _is_number(cell: str) -> bool:
    """Whether readers take a text for a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
