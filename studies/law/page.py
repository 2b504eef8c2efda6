"""Numbers of the law of k for the blocks `<!-- law: PART -->` of pages."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np

from crackfront.analysis.finding import (
    PAPER_FACTOR,
    STRONG,
    crossing,
    departure_of_spheres,
    finding,
)
from crackfront.analysis.law import COEFFICIENTS, WEAKEST, Law, pinning_factor, shipped_law
from studies.law.cells import LawCell, measured_cells
from studies.law.spheres import SphereRow, departures, sphere_table
from studies.pages import markdown_table

DISORDERS = (WEAKEST, 0.2, 0.4, STRONG)
"""Disorders s of the table of the infinite contact."""


def law_parts(spheres: Sequence[SphereRow]) -> dict[str, str]:
    """All parts, of the law of the package, what it is fitted to, and spheres."""
    apart = departures(spheres)
    rms = float(np.sqrt(np.mean(np.square(apart))))
    return {
        "coefficients": coefficients_part(shipped_law()),
        "limit": limit_part(),
        "fronts": fronts_part(measured_cells()),
        "spheres": sphere_table(spheres),
        "finding": _wrapped(finding(departure_of_spheres(rms, len(apart), len(spheres)))),
    }


def coefficients_part(law: Law) -> str:
    """Table of the coefficients, and how far the measured k are from the law."""
    errors = np.sqrt(np.diag(law.covariance)).tolist()
    rows = [
        (name, f"{value:.3f}", f"{error:.3f}")
        for name, value, error in zip(COEFFICIENTS, law.coefficients, errors, strict=True)
    ]
    exponent, error = law.exponent
    text = (
        f"Measured are s from {law.disorder[0]:.2g} to {law.disorder[1]:.2g} and g up to "
        f"{law.size[1]:.3g}; the fit begins at g = {law.size[0]:g}. Where g is above 1 the "
        f"measured k depart from the law by {law.rms:.1%} rms, {law.worst:.1%} at worst. What "
        "scatter and numerics do not explain of that is stated as the model's error: "
        f"{law.model_factor:.1%} of k, and {law.model_length:.1%} of g. Left free, the exponent "
        f"1 - zeta is {exponent:.2f} ± {error:.2f} (one standard error)."
    )
    table = markdown_table("coefficient | value | standard error", rows)
    return f"{table}\n\n{_wrapped(text)}"


def limit_part() -> str:
    """Table of k in the infinite contact, and where it is 3."""
    rows = []
    for s in DISORDERS:
        found = pinning_factor(s, math.inf)
        k, name = found.factor, "0, k_0" if s == WEAKEST else f"{s:g}"
        interval = f"{k.value:.2f} ({k.low:.2f} to {k.high:.2f})"
        rows.append((name, interval, f"{found.negative_share:.1%}"))
    s, low, high = crossing()
    header = "s | k, infinite contact (95% interval) | share of negative w_loc"
    return (
        f"{markdown_table(header, rows)}\n\nIn the infinite contact k is {PAPER_FACTOR:g} at s = "
        f"{s:.2f} ({low:.2f} to {high:.2f}) alone."
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
