"""Remarks on a surface and its prediction: what each concerns, how severe it is, what would help.

Conditions of the theory, reservations and notes are all remarks. Every output shows them by
:func:`remark_text` and :func:`remark_lines`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from crackfront.core.words import counted

Severity = Literal["fails", "undecided", "reservation", "note", "holds"]
"""Whether the theory ends, may end or is in doubt there; a note on the input; or all is well."""

Outcome = Literal["applies", "applies with reservations", "cannot be decided", "does not apply"]

_HEADINGS: dict[Severity, str] = {
    "fails": "Fails",
    "undecided": "Cannot be decided",
    "reservation": "Reservations",
    "note": "Notes",
    "holds": "Holds",
}
"""Headings of the groups of remarks, the most severe first."""

_BORDER = 1.1
"""Factor to which a limit is known: a value that is beyond it by less is undecided."""


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """A number and the limits that a condition of the theory sets to it, in SI units."""

    value: float
    doubtful: float
    limit: float
    """The condition holds up to the one value and is in doubt up to the other; if `rising`, it
    holds down to the one and is in doubt down to the other."""
    units: str
    rising: bool = False
    """Whether the condition needs values above the limit, not below."""
    best_case: float = 1.0
    """Value over the end of its interval that meets the condition best."""

    @property
    def severity(self) -> Severity:
        """Whether the condition holds.

        Undecided where the value is beyond the limit, but its interval holds values that are not,
        or the limit is too near to tell.
        """
        margin = self._margin(self.limit)
        if margin <= 1:
            return "fails" if margin * max(self.best_case, _BORDER) <= 1 else "undecided"
        return "holds" if self.margin > 1 else "reservation"

    @property
    def margin(self) -> float:
        """Factor from the value to where the condition is in doubt; above 1 where it holds."""
        return self._margin(self.doubtful)

    def _margin(self, end: float) -> float:
        """Factor from the value to an end of what is allowed."""
        if self.rising:
            return self.value / end
        return end / self.value if self.value > 0 else math.inf


@dataclass(frozen=True, slots=True)
class Remark:
    """One thing that a reader must know of a surface or a prediction."""

    concerns: str
    """What it is about: a condition as 'small slopes', the file of a scan, or a quantity."""
    severity: Severity
    sentence: str
    """What was found, complete in itself."""
    remedies: tuple[str, ...] = ()
    """Changes each of which alone would do."""
    comparison: LimitCheck | None = None
    """The numbers behind a condition."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether the theory applies to a sphere on a surface, and all remarks on both."""

    remarks: tuple[Remark, ...]

    def of(self, *severities: Severity) -> tuple[Remark, ...]:
        """Remarks of some severities, the most severe first."""
        return tuple(by_severity(one for one in self.remarks if one.severity in severities))

    @property
    def outcome(self) -> Outcome:
        """What follows from all remarks."""
        severities = {one.severity for one in self.remarks}
        if "fails" in severities:
            return "does not apply"
        if "undecided" in severities:
            return "cannot be decided"
        return "applies with reservations" if "reservation" in severities else "applies"

    @property
    def heading(self) -> str:
        """The outcome as the head of a text."""
        count = len(self.of("reservation"))
        headings: dict[Outcome, str] = {
            "applies": "The theory applies",
            "applies with reservations": f"The theory applies with {counted(count, 'reservation')}",
            "cannot be decided": (
                "WHETHER THE THEORY APPLIES CANNOT BE DECIDED; the numbers hold if it does"
            ),
            "does not apply": "THE THEORY DOES NOT APPLY",
        }
        return headings[self.outcome]


def by_severity(remarks: Iterable[Remark]) -> list[Remark]:
    """Remarks with the most severe first, otherwise in their order."""
    return sorted(remarks, key=lambda one: list(_HEADINGS).index(one.severity))


def remark_text(remark: Remark) -> str:
    """What a remark says, with its remedies."""
    if not remark.remedies:
        return remark.sentence
    return f"{remark.sentence} It would hold with {', or '.join(remark.remedies)}."


def remark_lines(remarks: Iterable[Remark]) -> Iterator[str]:
    """Lines of remarks, under a heading for each severity."""
    ordered = by_severity(remarks)
    for severity, heading in _HEADINGS.items():
        group = [one for one in ordered if one.severity == severity]
        if group:
            yield heading
            yield from (f"  {remark_text(one)}" for one in group)
