"""Remarks on a surface and its prediction: subject, severity, sentence and remedies.

Conditions of the theory, reservations and notes are all remarks. Outputs print them with
:func:`remark_text` and :func:`remark_lines`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from crackfront.core.words import counted
from crackfront.simulate.jsonable import to_jsonable

Severity = Literal["fails", "undecided", "reservation", "note", "holds"]
"""Severity: the theory ends, may end or is in doubt; a note on the input; or a condition met."""

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
"""Uncertainty of a limit as a factor; values beyond the limit by less are undecided."""


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """A number and its limits by a condition of the theory, in SI units."""

    value: float
    doubtful: float
    limit: float
    """The condition is met up to `doubtful` and in doubt up to `limit`; if `rising`, it is met down
    to `doubtful` and in doubt down to `limit`."""
    units: str
    rising: bool = False
    """Whether values must be above the limit, not below."""
    best_case: float = 1.0
    """Ratio of the value to the end of its interval that is closer to meeting the condition."""

    @property
    def severity(self) -> Severity:
        """Whether the condition is met.

        It is undecided if the value is beyond the limit, but its interval is not, or the value is
        very close to the limit.
        """
        margin = self._margin(self.limit)
        if margin <= 1:
            return "fails" if margin * max(self.best_case, _BORDER) <= 1 else "undecided"
        return "holds" if self.margin > 1 else "reservation"

    @property
    def margin(self) -> float:
        """Factor from the value to `doubtful`; above 1 if the condition is met."""
        return self._margin(self.doubtful)

    def _margin(self, end: float) -> float:
        """Factor from the value to a limit; above 1 on the allowed side."""
        if self.rising:
            return self.value / end
        return end / self.value if self.value > 0 else math.inf


@dataclass(frozen=True, slots=True)
class Remark:
    """A statement on a surface or a prediction for the reader."""

    concerns: str
    """Subject: a condition such as 'small slopes', the file of a scan, or a quantity."""
    severity: Severity
    sentence: str
    """The finding, as a complete sentence."""
    remedies: tuple[str, ...] = ()
    """Changes, each of which alone would meet the condition."""
    comparison: LimitCheck | None = None
    """The numbers behind a condition."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether the theory applies to a sphere on a surface, with all remarks."""

    remarks: tuple[Remark, ...]

    def with_severity(self, *severities: Severity) -> tuple[Remark, ...]:
        """Remarks with some severities, the most severe first."""
        remarks = [remark for remark in self.remarks if remark.severity in severities]
        return tuple(by_severity(remarks))

    @property
    def outcome(self) -> Outcome:
        """Whether the theory applies, by the most severe remark."""
        severities = {remark.severity for remark in self.remarks}
        if "fails" in severities:
            return "does not apply"
        if "undecided" in severities:
            return "cannot be decided"
        return "applies with reservations" if "reservation" in severities else "applies"

    @property
    def heading(self) -> str:
        """The outcome as the heading of a text."""
        count = len(self.with_severity("reservation"))
        headings: dict[Outcome, str] = {
            "applies": "The theory applies",
            "applies with reservations": f"The theory applies with {counted(count, 'reservation')}",
            "cannot be decided": (
                "WHETHER THE THEORY APPLIES CANNOT BE DECIDED; the numbers are valid if it does"
            ),
            "does not apply": "THE THEORY DOES NOT APPLY",
        }
        return headings[self.outcome]


def by_severity(remarks: Iterable[Remark]) -> list[Remark]:
    """Remarks sorted by severity, the most severe first."""
    return sorted(remarks, key=lambda remark: list(_HEADINGS).index(remark.severity))


def remark_text(remark: Remark) -> str:
    """Sentence of a remark, with its remedies."""
    if not remark.remedies:
        return remark.sentence
    return f"{remark.sentence} It would be met with {', or '.join(remark.remedies)}."


def remark_lines(remarks: Iterable[Remark]) -> Iterator[str]:
    """Lines of remarks, under a heading for each severity."""
    ordered = by_severity(remarks)
    for severity, heading in _HEADINGS.items():
        group = [remark for remark in ordered if remark.severity == severity]
        if group:
            yield heading
            yield from (f"  {remark_text(remark)}" for remark in group)


def remark_entries(remarks: Iterable[Remark]) -> list[dict[str, Any]]:
    """Remarks for JSON, with the margins of conditions."""
    entries = []
    for remark in remarks:
        entry = to_jsonable(remark)
        if remark.comparison is not None:
            entry["comparison"]["margin"] = to_jsonable(remark.comparison.margin)
        entries.append(entry)
    return entries
