"""Checks of figures: what the paper states, and what this project expects, against the data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from crackfront.analysis.estimate import with_error
from studies.pages import markdown_table

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


def checks_tables(checks: Sequence[Check], scale: str) -> Iterator[str]:
    """Parts in Markdown: statements of the paper and exact results, then expectations.

    A row is a check; the reason of each expectation stands below their table.
    """
    statements, expectations = _groups(checks)
    yield _table(statements, scale)
    if expectations:
        yield ""
        yield f"{EXPECTATIONS}, which the paper does not state:"
        yield ""
        yield _table(expectations, scale)
        for reason in dict.fromkeys(check.expectation for check in expectations):
            yield ""
            yield reason


STATEMENTS = "Statements of the paper and exact results"
EXPECTATIONS = "Expectations of this project"


def _groups(checks: Sequence[Check]) -> tuple[list[Check], list[Check]]:
    """Statements of the paper with exact results, and expectations."""
    statements = [check for check in checks if not check.expectation]
    expectations = [check for check in checks if check.expectation]
    return statements, expectations


def _table(checks: Iterable[Check], scale: str) -> str:
    """Table in Markdown, one row a check."""
    rows = (
        (check.claim, check.expected, check.computed, _result_text(check, scale), check.remark)
        for check in checks
    )
    return markdown_table("claim | expected | found | result | remark", rows)


def _result_text(check: Check, scale: str) -> str:
    """Result of a check in its row, with the number of the law or the reason."""
    if check.result == "FAIL":
        return "**FAIL**"
    if check.result == "differs as the law of k says":
        return f"{check.result}: {check.law}"
    if check.result == "cannot be decided":
        return f"cannot be decided at {scale} scale: {check.undecided}"
    return check.result


def counted(checks: Sequence[Check]) -> tuple[str, ...]:
    """Sentences that count the results of both groups.

    Examples
    --------
    >>> [sentence] = counted([Check("k is 3", "3", "3", passed=True)])
    >>> sentence.partition(",")[0]
    'Statements of the paper and exact results: 1 of 1 agree'
    """
    statements, expectations = _groups(checks)
    results = Counter(check.result for check in statements)
    sentences = [
        f"{STATEMENTS}: {results['agrees']} of {len(statements)} agree, "
        f"{results['differs as the law of k says']} differ as the law of k says, "
        f"{results['cannot be decided']} cannot be decided at their scale, "
        f"{results['FAIL']} fail."
    ]
    if expectations:
        results = Counter(check.result for check in expectations)
        sentences.append(
            f"{EXPECTATIONS}: {results['agrees']} of {len(expectations)} met, "
            f"{results['is not met']} not met, "
            f"{results['cannot be decided']} cannot be decided at their scale."
        )
    return tuple(sentences)
