"""Records of dataclasses as comma-separated values."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import astuple, fields
from typing import Any, TypeVar

Row = TypeVar("Row")

_NUMBERS = {"int": int, "float": float}
"""Functions that read a number from its text, by the type of its field; other fields are texts."""


def csv_rows(text: str, kind: type[Row]) -> tuple[Row, ...]:
    """Records of texts, whole numbers and numbers from comma-separated values.

    ValueError if all rows or a column are missing.
    """
    record: Any = kind
    readers = {item.name: _NUMBERS.get(str(item.type), str) for item in fields(record)}
    rows = list(csv.DictReader(text.splitlines()))
    if not rows:
        raise ValueError("the table lacks rows; name one that csv_text has written")
    if missing := readers.keys() - rows[0].keys():
        raise ValueError(
            f"the table lacks the column {min(missing)}; name one of {record.__name__}"
        )
    return tuple(kind(**{name: read(row[name]) for name, read in readers.items()}) for row in rows)


def csv_text(rows: Sequence[Any]) -> str:
    """Comma-separated values of records of one kind, numbers to five digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([item.name for item in fields(rows[0])])
    for row in rows:
        writer.writerow([f"{x:.5g}" if isinstance(x, float) else x for x in astuple(row)])
    return text.getvalue()
