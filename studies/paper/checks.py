"""Checks of figures: what the paper states, and what this project expects, against the data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from crackfront.analysis.estimate import with_error
from studies.tables import Table, make_table

Result = Literal[
    "agrees", "differs as the law of k says", "cannot be decided", "is not met", "FAIL"
]
"""How a check ends."""


@dataclass(frozen=True, slots=True)
class Check:
    """One claim and whether the data agree with it."""

    claim: str  # what the paper states, what must be true, or what this project expects
    expected: str  # its number, with the tolerance
    computed: str  # what the data of the figure say
    passed: bool
    remark: str = ""  # where the difference comes from, or what the number rests on
    law: str = ""  # number of the law of k, if the computed one agrees with it
    undecided: str = ""  # why data of this size can neither confirm nor contradict the claim
    # Source of an expectation that the paper does not state, and why data may differ.
    expectation: str = ""

    @property
    def result(self) -> Result:
        """How the check ends.

        A difference fails unless the law of k predicts it, the data cannot decide, or the claim is
        an expectation of this project.
        """
        if self.undecided:
            return "cannot be decided"
        if self.passed:
            return "agrees"
        if self.law:
            return "differs as the law of k says"
        return "is not met" if self.expectation else "FAIL"


def close_to(
    claim: str,
    measured: float,
    expected: float,
    tolerance: float,
    *,
    units: str = "",
    remark: str = "",
    law: tuple[float, float] | None = None,
) -> Check:
    """Check that a number lies within an absolute tolerance of another.

    `law` is the number that the law of k gives, and the half of its interval.
    """
    after = f" {units}" if units else ""
    law_text = ""
    if law is not None and abs(measured - law[0]) <= law[1]:
        law_text = f"{with_error(*law)}{after}"
    return Check(
        claim,
        f"{with_error(expected, tolerance)}{after}",
        f"{measured:.6g}{after}",
        abs(measured - expected) <= tolerance,
        remark,
        law_text,
    )


STATEMENT = "statement"
"""Kind of a check of the paper's statement, or of an exact result."""

EXPECTATION = "expectation"
"""Kind of a check of what this project expects."""


def checks_table(checks: Iterable[Check]) -> Table:
    """Table of checks: a reason for a difference, and the source of an expectation."""
    rows = (
        (
            EXPECTATION if check.expectation else STATEMENT,
            check.claim,
            check.expected,
            check.computed,
            check.result,
            _reason(check),
            check.remark,
            check.expectation,
        )
        for check in checks
    )
    return make_table("kind | claim | expected | found | result | reason | remark | source", rows)


def _reason(check: Check) -> str:
    """Number of the law that explains a difference, or why the data cannot decide."""
    if check.result == "differs as the law of k says":
        return check.law
    return check.undecided


def counted(tables: Iterable[Table]) -> tuple[str, ...]:
    """Sentences that count the results of both kinds in some tables of checks.

    Examples
    --------
    >>> [sentence] = counted([checks_table([Check("k is 3", "3", "3", passed=True)])])
    >>> sentence.partition(",")[0]
    'Statements of the paper and exact results: 1 of 1 agree'
    """
    rows = [row for table in tables for row in table.records()]
    statements = Counter(row["result"] for row in rows if row["kind"] == STATEMENT)
    expectations = Counter(row["result"] for row in rows if row["kind"] == EXPECTATION)
    sentences = [
        f"Statements of the paper and exact results: {statements['agrees']} of "
        f"{statements.total()} agree, "
        f"{statements['differs as the law of k says']} differ as the law of k says, "
        f"{statements['cannot be decided']} cannot be decided at their scale, "
        f"{statements['FAIL']} fail."
    ]
    if expectations:
        sentences.append(
            f"Expectations of this project: {expectations['agrees']} of "
            f"{expectations.total()} met, {expectations['is not met']} not met, "
            f"{expectations['cannot be decided']} cannot be decided at their scale."
        )
    return tuple(sentences)
