"""Numbers of the law of k in the pages, between marks, so that a new measurement renews them."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Sequence

import numpy as np

from crackfront.analysis.finding import PAPER_FACTOR, STRONG, crossing
from crackfront.analysis.law import COEFFICIENTS, WEAKEST, Law, pinning_factor
from studies.law.fitting import LawCell

DISORDERS = (WEAKEST, 0.2, 0.4, STRONG)
"""Disorders s of the table of the infinite contact."""

_MARK = re.compile(r"(<!-- (\S+) of the law -->\n).*?(<!-- end -->)", re.DOTALL)


def renewed_page(text: str, law: Law, cells: Sequence[LawCell], spheres: str, finding: str) -> str:
    """Page whose marked parts are those of a law.

    Parameters
    ----------
    text : str
        The page.
    law, cells
        The law and what it was fitted to.
    spheres : str
        Table of spheres, in Markdown.
    finding : str
        The sentences that pages open with.

    Raises
    ------
    ValueError
        If a mark names none of the parts that there are.
    """
    parts = {
        "coefficients": coefficients_part(law),
        "limit": limit_part(),
        "fronts": fronts_part(cells),
        "spheres": spheres,
        "finding": _wrapped(finding),
    }

    def part(found: re.Match[str]) -> str:
        if found[2] not in parts:
            raise ValueError(f"no part of the law is {found[2]}; choose one of {', '.join(parts)}")
        return f"{found[1]}\n{parts[found[2]]}\n\n{found[3]}"

    return _MARK.sub(part, text)


def coefficients_part(law: Law) -> str:
    """Table of the coefficients, and how far the measured k are from the law."""
    errors = np.sqrt(np.diag(law.covariance))
    numbers = (law.coefficients, errors)
    rows = [f"| {name} | {value:.3f} | {error:.3f} |" for name, value, error in _named(*numbers)]
    exponent, error = law.exponent
    text = (
        f"Measured are s from {law.disorder[0]:.2g} to {law.disorder[1]:.2g} and g up to "
        f"{law.size[1]:.3g}; the fit begins at g = {law.size[0]:g}. Where g is above 1 the "
        f"measured k depart from the law by {law.rms:.1%} rms, {law.worst:.1%} at worst. What "
        "scatter and numerics do not explain of that is stated as the model's error: "
        f"{law.model_factor:.1%} of k, and {law.model_length:.1%} of g. Left free, the exponent "
        f"1 - zeta is {exponent:.2f} ± {error:.2f} (one standard error)."
    )
    return "\n".join(
        [
            "| coefficient | value | standard error |",
            "| --- | --- | --- |",
            *rows,
            "",
            _wrapped(text),
        ]
    )


def _named(values: Sequence[float], errors: Sequence[float]) -> list[tuple[str, float, float]]:
    """Coefficients with their names and errors."""
    return list(zip(COEFFICIENTS, values, errors, strict=True))


def limit_part() -> str:
    """Table of k in the infinite contact, and where it is 3."""
    rows = []
    for s in DISORDERS:
        found = pinning_factor(s, math.inf)
        k, name = found.factor, "0, k_0" if s == WEAKEST else f"{s:g}"
        rows.append(
            f"| {name} | {k.value:.2f} ({k.low:.2f} to {k.high:.2f}) | {found.negative_share:.1%} |"
        )
    s, low, high = crossing()
    text = (
        f"In the infinite contact k is {PAPER_FACTOR:g} at s = {s:.2f} ({low:.2f} to {high:.2f}) "
        "alone."
    )
    return "\n".join(
        [
            "| s | k, infinite contact (95% interval) | share of negative w_loc |",
            "| --- | --- | --- |",
            *rows,
            "",
            text,
        ]
    )


def fronts_part(cells: Sequence[LawCell]) -> str:
    """How far fronts reach: their rms, a power law of g by least squares for g above 1."""
    large = [cell for cell in cells if cell.size > 1 and cell.front_rms > 0]
    size, rms = (np.log([getattr(cell, name) for cell in large]) for name in ("size", "front_rms"))
    exponent, start = np.polyfit(size, rms, 1)
    scatter = float(np.std(rms - np.polyval((exponent, start), size)))
    return _wrapped(
        f"Observed over {len(large)} spectra, amplitudes and springs with g above 1: "
        f"u_rms = {math.exp(start):.2f} xi_u g^{exponent:.2f}, within {scatter:.0%} rms."
    )


def _wrapped(text: str) -> str:
    """Lines of a paragraph."""
    return textwrap.fill(text, 108)
