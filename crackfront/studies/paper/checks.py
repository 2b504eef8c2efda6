"""Claims about a figure, each compared with what was found."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Check:
    """One claim and whether it holds.

    Attributes
    ----------
    claim : str
        What the paper states, or what must be true.
    expected : str
        Its number, with the tolerance.
    found : str
        What the figure's data say.
    passed : bool
        Whether they agree.
    remark : str
        Where the difference comes from, or what the number rests on.
    """

    claim: str
    expected: str
    found: str
    passed: bool
    remark: str = ""


def close_to(
    claim: str,
    found: float,
    expected: float,
    tolerance: float,
    *,
    units: str = "",
    remark: str = "",
) -> Check:
    """Check that a number lies within an absolute tolerance of another.

    Parameters
    ----------
    claim : str
        What is compared.
    found, expected : float
        The numbers.
    tolerance : float
        Largest difference, in the same units.
    units : str, optional
        Their units.
    remark : str, optional
        What the number rests on.

    Examples
    --------
    >>> close_to("pull-off", -1.5001, -1.5, 1e-3).passed
    True
    """
    after = f" {units}" if units else ""
    return Check(
        claim,
        f"{expected:.6g} ± {tolerance:.2g}{after}",
        f"{found:.6g}{after}",
        abs(found - expected) <= tolerance,
        remark,
    )


def checks_table(checks: Iterable[Check]) -> Iterator[str]:
    """Lines of a Markdown table.

    Parameters
    ----------
    checks : iterable of Check
        Its rows.
    """
    yield "| claim | expected | found | | remark |"
    yield "| --- | --- | --- | --- | --- |"
    for check in checks:
        verdict = "pass" if check.passed else "**FAIL**"
        yield (f"| {check.claim} | {check.expected} | {check.found} | {verdict} | {check.remark} |")
