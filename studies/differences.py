"""Numbers of the pages against those of another run, as on another processor.

A number differs if it has moved by more than its own error: half of the interval or the tolerance
that its cell states, or that the claim states which it is compared with. The change of a number
without an error is relative; what is below 1e-12 in both runs is round-off, and equal. Times,
memory and remarks are not compared, nor what stands in one cell with a time: it is of what was
fastest.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from studies.pages import Part, markdown_table

_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_STATED = re.compile(
    rf"(?P<value>{_NUMBER})"
    rf"(?: ± (?P<error>{_NUMBER})| \((?P<low>{_NUMBER}) to (?P<high>{_NUMBER})\))?"
)
_TIME = re.compile(rf"{_NUMBER} s\b")
_LEFT_OUT = re.compile(r"remark|CPU s|.*\b[Mk]B")
"""Headings of columns that are not compared."""

_ROUND_OFF = 1e-12


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a page; without an error of its own it is NaN."""

    place: str
    value: float
    error: float


@dataclass(frozen=True, slots=True)
class Change:
    """A number of two runs."""

    here: Number
    there: Number

    @property
    def is_equal(self) -> bool:
        """Whether every digit is equal."""
        return self.relative == 0

    @property
    def in_errors(self) -> float:
        """Difference over the larger error; NaN where none is stated."""
        error = max(self.here.error, self.there.error)
        if error == 0:
            return 0.0 if self.is_equal else math.inf
        return abs(self.here.value - self.there.value) / error

    @property
    def relative(self) -> float:
        """Difference over the larger number."""
        largest = max(abs(self.here.value), abs(self.there.value))
        return abs(self.here.value - self.there.value) / largest if largest > _ROUND_OFF else 0.0


def numbers(text: str) -> Iterator[Number]:
    """Numbers of a text in Markdown, with the row and the column of each that is in a table."""
    heads: list[str] = []
    for line in text.replace("**", "").splitlines():
        if not line.startswith("|"):
            heads = []
            yield from _stated("", line)
        elif not line.startswith("| ---"):
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            if not heads:
                heads = cells
                continue
            for head, cell in zip(heads, cells, strict=True):
                if not (_LEFT_OUT.fullmatch(head) or _TIME.search(cell)):
                    expected = cells[heads.index("expected")] if head == "found" else ""
                    yield from _stated(f"{cells[0]}, {head}", cell, expected)


def _stated(place: str, text: str, expected: str = "") -> Iterator[Number]:
    """Numbers of a text, with the error of what they are expected to be where they have none."""
    tolerances = [float(one["error"]) for one in _STATED.finditer(expected) if one["error"]]
    for found in _STATED.finditer(_TIME.sub("", text)):
        if found["error"]:
            error = float(found["error"])
        elif found["low"]:
            error = (float(found["high"]) - float(found["low"])) / 2
        else:
            error = tolerances[0] if tolerances else math.nan
        yield Number(place, float(found["value"]), error)


def changes(here: str, there: str) -> list[Change]:
    """Numbers of two texts of one form, in their order; ValueError if the forms differ."""
    pairs = [*numbers(here)], [*numbers(there)]
    if [one.place for one in pairs[0]] != [one.place for one in pairs[1]]:
        raise ValueError("the two texts have not the same rows, columns and numbers")
    return [Change(*pair) for pair in zip(*pairs, strict=True)]


def differences_text(
    here: Mapping[str, Mapping[str, Part]],
    there: Mapping[str, Mapping[str, Part]],
    machine: str | None = None,
) -> str:
    """A row for each part that two runs have, by study and name; a line for each that differs.

    Speeds are left out; parts of other rows or columns have a line alone. `machine` names what
    computed there where the machine is the same; without it, equal parts of one machine and commit
    are those of one run, and are left out.
    """
    rows, beyond = [], []
    for study in sorted({*here} & {*there} - {"speed", "differences"}):
        for name in sorted({*here[study]} & {*there[study]}):
            one, other = here[study][name], there[study][name]
            if machine is None and one == other:
                continue
            try:
                found = changes(one.text, other.text)
            except ValueError as error:
                beyond.append(f"- {name}: {error}")
                continue
            elsewhere = machine if machine and other.machine == one.machine else other.machine
            stated = [change for change in found if not math.isnan(change.in_errors)]
            unstated = [change.relative for change in found if math.isnan(change.in_errors)]
            moved = [change for change in stated if change.in_errors > 1]
            beyond += [
                f"- {name}, {change.here.place}: {change.here.value:g} and {change.there.value:g}, "
                f"{change.in_errors:.1f} times the error"
                for change in moved
            ]
            rows.append(
                [
                    name,
                    f"{one.machine}, {one.commit[:7]}",
                    f"{elsewhere}, {other.commit[:7]}",
                    f"{len(found)}",
                    f"{sum(change.is_equal for change in found)}",
                    f"{max((change.in_errors for change in stated), default=0.0):.2g}",
                    f"{len(moved)}",
                    f"{max(unstated, default=0.0):.2g}",
                ]
            )
    header = (
        "part | here | there | numbers | equal in every digit | largest change over its error | "
        "beyond it | largest relative change without an error"
    )
    return "\n".join([markdown_table(header, rows), *([""] if beyond else []), *beyond])
