"""Texts of numbers: decoded once, and written with the separators and decimals of every reader."""

from __future__ import annotations

import collections
import csv
import itertools
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_MARKS = (
    (b"\xff\xfe\0\0", "utf-32"),
    (b"\0\0\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
    (b"\xef\xbb\xbf", "utf-8-sig"),
)
"""Marks of byte order, the longer ones first."""

_BINARY = bytes({*range(32)} - {*b"\t\n\v\f\r\x1a"})
"""Bytes that no text has, but for the mark of its end in DOS."""

_MICROS = (("Âµ", "µ"), ("Î¼", "µ"), ("æm", "µm"))
"""A micro sign that another program has decoded wrongly, or wrote in the encoding of DOS."""

_NO_VALUE = re.compile(r"\b(bad|infinite)\b", re.IGNORECASE)
"""Words for a point without a value that one reader knows and another takes for text."""

_ROW = re.compile(r'[\s\d.,;+\-eE"]*\d[\s\d.,;+\-eE"]*')
"""A line that holds nothing but numbers and separators."""

_SEPARATORS = re.compile(r"[\s,;]+")
_COMMA_NUMBER = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?|[-+]?\d+,")
_LISTED = re.compile(r",(?=\s|$)")
_QUOTED = re.compile(r'"([^"]*)"')

_HEAD_NUMBER = re.compile(
    r"(?:^|[^\d\s])\s*[:=：]\s*([-+]?\d+(?:[.,]\d+)+(?:[eE][-+]?\d+)?)(?![.,:/\-]?\d)"
)
"""A number with a decimal sign that a head gives to a name."""

_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[.,]\d{3})+")
"""A number whose decimal sign may as well separate thousands."""

_FEWEST_COLUMNS, _FEWEST_ROWS = 5, 8
"""Sides of a matrix whose first column or row, of consecutive numbers, counts the others."""

_ADVICE = "export the scan again, or write nan where there is no value"


@dataclass(frozen=True, slots=True)
class NumberText:
    """A text with rows of numbers."""

    lines: tuple[str, ...]
    """Its lines: rows have spaces between cells, points as decimals and nan for no value."""
    rows: tuple[int, ...]
    """Places of the rows among the lines."""
    n_column: int
    """Numbers in most of the rows."""

    @property
    def head(self) -> tuple[str, ...]:
        """Lines before the first row that has all columns."""
        first = next(row for row in self.rows if len(self.lines[row].split()) == self.n_column)
        return self.lines[:first]

    def with_columns(self, places: Sequence[int]) -> NumberText:
        """The text with some of the columns of its rows, in another order."""
        lines = list(self.lines)
        rows = [row for row in self.rows if len(lines[row].split()) == self.n_column]
        for row in rows:
            cells = lines[row].split()
            lines[row] = " ".join(cells[place] for place in places)
        return NumberText(tuple(lines), tuple(rows), len(places))


def decoded(path: Path) -> str | None:
    """Content of a text file; None of any other. ValueError if it contradicts its own encoding."""
    with path.open("rb") as file:
        start = file.read(4096)
        marked = next((name for mark, name in _MARKS if start.startswith(mark)), None)
        wide = None if marked else _encoding_of_nulls(start)
        if b"\0" in start and not (marked or wide):
            return None
        content = start + file.read()
    if not (marked or wide) and len(content.translate(None, _BINARY)) < len(content):
        return None
    text, known = None, marked or wide
    for name in (known,) if known else ("utf-8", "cp1252", "latin-1"):
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
    for zeros, others, name in ((odd, even, "utf-16-le"), (even, odd, "utf-16-be")):
        if len(start) > 3 and not others.count(0) and zeros.count(0) > 0.9 * len(zeros):
            return name
    return None


def number_text(path: Path) -> NumberText | None:
    """The text of a file with rows of numbers; None of any other file.

    A row that a reader would leave out, and decimals that have two readings, are refused with their
    line.
    """
    text = decoded(path)
    if text is None:
        return None
    given = text.split("\n")
    split = _splitter([line for line in given if _ROW.fullmatch(line)])
    known = [_NO_VALUE.sub("nan", line) if _ROW.fullmatch(line) is None else line for line in given]
    table = [split(line) for line in known]
    counts = [_count(cells) for cells in table]
    if not any(counts):
        return None
    sign = _decimal_sign(path, table, counts)
    _refuse_damaged_rows(path, known, table, counts)
    lines = [
        _row(cells) if count else _head_line(path, number, line, sign)
        for number, (line, cells, count) in enumerate(zip(known, table, counts, strict=True))
    ]
    [(n_column, _)] = collections.Counter(filter(None, counts)).most_common(1)
    rows = tuple(number for number, count in enumerate(counts) if count)
    return _without_counts(NumberText(tuple(lines), rows, n_column))


def _row(cells: Sequence[str]) -> str:
    """A row with spaces between its cells, points as decimals and nan in empty cells."""
    filled = cells if all(cells) else [cell or "nan" for cell in cells]
    return " ".join(filled).replace(",", ".")


def _splitter(rows: Sequence[str]) -> Callable[[str], list[str]]:
    """What splits lines into cells, chosen by the separators of most rows."""
    sample = rows[:1000]

    def most(has: Callable[[str], object]) -> bool:
        return 2 * sum(map(bool, map(has, sample))) > len(sample)

    if most(lambda row: '"' in row):
        between = "".join(_QUOTED.sub("", row) for row in sample).strip()
        separator = between[0] if between else " "
        return lambda line: [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    if most(lambda row: ";" in row):
        return _by(";", sample)
    if not most(lambda row: "," in row):
        return str.split
    if not most(lambda row: len(row.split()) > 1):
        # One comma a line and no points: two columns of whole numbers, or decimals of one column.
        is_one_column = most(lambda row: row.count(",") == 1 and "." not in row)
        if is_one_column and not _ascend([row.partition(",")[0] for row in sample]):
            return str.split
        return _by(",", sample)
    if most(_LISTED.search):
        if any("," in _LISTED.sub(" ", row) for row in sample):
            return lambda line: _LISTED.sub(" ", line).split()
        return _by(",", sample)
    if most(lambda row: any(map(_COMMA_NUMBER.fullmatch, row.split()))):
        return str.split
    return lambda line: [cell for cell in _SEPARATORS.split(line) if cell]


def _by(separator: str, rows: Sequence[str]) -> Callable[[str], list[str]]:
    """What splits lines at a separator, without the columns that are empty in all of the rows."""
    split = [[cell.strip() for cell in row.split(separator)] for row in rows]
    if any(len(cell.split()) > 1 for cells in split for cell in cells):
        return lambda line: [cell for cell in _SEPARATORS.split(line) if cell]
    width = max(map(len, split))
    n_empty = 0
    while n_empty < width and not any("".join(row[width - n_empty - 1 :]) for row in split):
        n_empty += 1

    def cells(line: str) -> list[str]:
        found = [cell.strip() for cell in line.split(separator)]
        while found and not found[-1] and len(found) > width - n_empty:
            found.pop()
        return found if any(found) else []

    return cells


def _ascend(cells: Sequence[str]) -> bool:
    """Whether whole numbers ascend or descend all along."""
    try:
        steps = [int(b) - int(a) for a, b in itertools.pairwise(cells)]
    except ValueError:
        return True
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)


def _count(cells: Sequence[str]) -> int:
    """Numbers in a row, with cells that are empty; 0 of any other line."""
    try:
        list(map(float, cells))
    except ValueError:
        if not (all(not cell or _is_number(cell) for cell in cells) and any(cells)):
            return 0
    return len(cells)


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, with a point or a comma."""
    try:
        float(cell)
    except ValueError:
        return _COMMA_NUMBER.fullmatch(cell) is not None
    return True


def _decimal_sign(path: Path, table: Sequence[Sequence[str]], counts: Sequence[int]) -> str | None:
    """Decimal sign of the rows, None if all numbers are whole; refused where there are two."""
    seen: dict[str, tuple[int, str]] = {}
    tally = collections.Counter[str]()
    for number, (cells, count) in enumerate(zip(table, counts, strict=True)):
        if count:
            joined = " ".join(cells)
            for sign in ",.":
                if sign in joined:
                    tally[sign] += 1
                    if sign not in seen:
                        seen[sign] = number, next(cell for cell in cells if sign in cell)
    if len(seen) < 2:
        return next(iter(seen), None)
    (usual, _), (rare, _) = tally.most_common()
    number, cell = seen[rare]
    raise ValueError(
        f"{path}, line {number + 1}: {cell!r} is no number with {usual!r} for decimals, as line "
        f"{seen[usual][0] + 1} has it; write all numbers alike"
    )


def _head_line(path: Path, number: int, line: str, sign: str | None) -> str:
    """A line of the head with points as decimals, refused where its numbers have two readings."""
    found = _HEAD_NUMBER.search(line)
    if found is None:
        return line
    text = found[1]
    n_comma, n_point = text.count(","), text.count(".")
    may_be_thousands = _THOUSANDS.fullmatch(text) is not None
    if not n_comma and (n_point > 1 or sign != "," or not may_be_thousands):
        return line  # A number as every reader knows it, a date or a version.
    if n_comma == 1 and not n_point and (sign == "," or (sign is None and not may_be_thousands)):
        start, end = found.span(1)
        return line[:start] + text.replace(",", ".") + line[end:]
    wrong = "the rows have points" if sign == "." else "it has two readings"
    raise ValueError(
        f"{path}, line {number + 1}: the number is {text!r}, and {wrong}; write the head and the "
        "rows with points, as in 20.9"
    )


def _refuse_damaged_rows(
    path: Path, lines: Sequence[str], table: Sequence[Sequence[str]], counts: Sequence[int]
) -> None:
    """Raise at the first line that is meant as a row of numbers and is none."""
    [(width, _)] = collections.Counter(filter(None, counts)).most_common(1)
    first = next(number for number, count in enumerate(counts) if count)
    before = 0
    for number, (line, cells, count) in enumerate(zip(lines, table, counts, strict=True)):
        where = f"{path}, line {number + 1}:"
        if count:
            if before > 1 and count != before:
                raise ValueError(
                    f"{where} the row has {count} numbers and the row above has {before}; {_ADVICE}"
                )
            before = count
        elif line.strip():
            before = 0
            wrong = _wrong_cell(cells, width if number < first else None)
            if wrong is not None:
                raise ValueError(
                    f"{where} number {wrong + 1} of the row is {cells[wrong]!r}, which is no "
                    f"number; {_ADVICE}"
                )


def _wrong_cell(cells: Sequence[str], width: int | None) -> int | None:
    """Place of what is no number in a row; None where the line is a text, a comment or a head."""
    wrong = [place for place, cell in enumerate(cells) if cell and not _is_number(cell)]
    if not wrong or cells[0].startswith("#") or 2 * len(wrong) > len(cells):
        return None
    if width is not None:
        has_words = any(any(map(str.isalpha, cells[place])) for place in wrong)
        if len(cells) != width or (has_words and 4 * len(wrong) > len(cells)):
            return None
    return wrong[0]


def _without_counts(text: NumberText) -> NumberText:
    """A matrix without a column, and a row, that count its rows and columns."""
    rows = [row for row in text.rows if len(text.lines[row].split()) == text.n_column]
    if text.n_column < _FEWEST_COLUMNS or len(rows) < _FEWEST_ROWS:
        return text
    lines, top = list(text.lines), text.lines[rows[0]].split()
    firsts = [text.lines[row].split(maxsplit=1)[0] for row in rows]
    if _counts(top) or (_counts(top[1:]) and _counts(firsts[1:])):
        lines[rows.pop(0)] = ""
        firsts = firsts[1:]
    has_column = _counts(firsts)
    for row in rows if has_column else ():
        lines[row] = lines[row].split(maxsplit=1)[1]
    return NumberText(tuple(lines), tuple(rows), text.n_column - has_column)


def _counts(cells: Sequence[str]) -> bool:
    """Whether cells are consecutive whole numbers from 0 or 1."""
    return list(cells) in ([*map(str, range(start, start + len(cells)))] for start in (0, 1))
