"""Numbers and tables of the law of k for the pages."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.finding import (
    PAPER_FACTOR,
    STRONG,
    crossing,
    least_size,
    stated_breadths,
)
from crackfront.analysis.law import (
    COEFFICIENTS,
    WEAKEST,
    Departure,
    Law,
    PinningFactor,
    pinning_factor,
    shipped_law,
)
from studies.law.cells import HELD_OUT, LawCell, measured_cells
from studies.law.spheres import SphereRow, departures, is_within, sphere_table
from studies.numbers import Number
from studies.tables import Table, interval_cells, interval_header, make_table

DISORDERS = (WEAKEST, 0.2, 0.4, STRONG)
"""Disorders s of the table of the infinite contact."""


def law_parts(spheres: Sequence[SphereRow]) -> dict[str, Table]:
    """All parts, of the law of the package, what it is fitted to, and spheres."""
    return {
        "coefficients": coefficients_part(shipped_law()),
        "limit": limit_part(),
        "departures": departures_part(shipped_law()),
        "shapes": shapes_part(measured_cells()),
        "fronts": fronts_part(measured_cells()),
        "spheres": sphere_table(spheres),
    }


def law_numbers(spheres: Sequence[SphereRow]) -> dict[str, Number]:
    """Numbers that README and the paper quote; errors are half of the 95% intervals."""
    differences = departures(spheres)
    s, low, high = crossing()
    strong = {
        f"k at s = {STRONG:g}, {name}": _half(pinning_factor(STRONG, math.inf, breadth=breadth))
        for name, breadth in stated_breadths().items()
    }
    return {
        "k at vanishing disorder": _half(pinning_factor(WEAKEST, math.inf)),
        **strong,
        f"g of k = {PAPER_FACTOR:g} at vanishing disorder": Number(least_size()),
        f"s of k = {PAPER_FACTOR:g} in the infinite contact": Number(s, (high - low) / 2),
        "spheres": Number(len(spheres)),
        "spheres with g above 1": Number(len(differences)),
        "rms difference of spheres": Number(float(np.sqrt(np.mean(np.square(differences))))),
    }


def _half(pinning: PinningFactor) -> Number:
    """Factor k with half of its interval."""
    return Number(pinning.factor.value, (pinning.factor.high - pinning.factor.low) / 2)


def coefficients_part(law: Law) -> Table:
    """Table of the coefficients, and how far the measured k are from the law."""
    errors = np.sqrt(np.diag(law.covariance)).tolist()
    rows = [
        (name, f"{value:.3f}", f"{error:.3f}")
        for name, value, error in zip(COEFFICIENTS, law.coefficients, errors[:-1], strict=True)
    ]
    exponent, error = law.exponent
    text = (
        f"The measurements have s from {law.disorder[0]:.2g} to {law.disorder[1]:.2g} and g up to "
        f"{law.size[1]:.3g}; the fit begins at g = {law.size[0]:g}. Where g is above 1, the "
        f"measured k differ from the law by {law.rms:.1%} rms and by {law.worst:.1%} at most. The "
        "part of this that scatter and numerics do not explain is the error of the model: "
        f"{law.model_factor:.1%} of k, and {law.model_length:.1%} of g. If the exponent 1 - zeta "
        f"is fitted too, it is {exponent:.2f} ± {error:.2f} (one standard error)."
    )
    return make_table("coefficient | value | standard error", rows, text)


def departures_part(law: Law) -> Table:
    """Table of how far measured k lie above the law, by breadth and size."""
    rows = [
        (
            f"{departure.narrowest:.3g}",
            f"{departure.broadest:.3g}",
            f"{departure.least_size:.3g}",
            f"{departure.largest_size:.3g}",
            str(departure.fronts),
            f"{100 * departure.mean:+.1f}",
            f"{100 * departure.rms:.1f}",
        )
        for departure in map(Departure._make, law.departures)
    ]
    return make_table(
        "breadth from | breadth to | g from | g to | fronts | mean % | rms %",
        rows,
        "Measured k above the law.",
    )


def limit_part() -> Table:
    """Table of k in the infinite contact by spectrum, and where it is 3."""
    rows, breadths = [], stated_breadths()
    for s in DISORDERS:
        factors = [pinning_factor(s, math.inf, breadth=breadth) for breadth in breadths.values()]
        name = "0" if s == WEAKEST else f"{s:g}"
        cells = (cell for factor in factors for cell in interval_cells(factor.factor))
        rows.append((name, *cells, f"{100 * factors[0].negative_share:.1f}"))
    s, low, high = crossing()
    names = (f"k, {name} (beta {breadth:.2f})" for name, breadth in breadths.items())
    header = " | ".join(map(interval_header, names))
    return make_table(
        f"s | {header} | share of negative w_loc %",
        rows,
        "k of the infinite contact, with 95% intervals. For a typical spectrum it is "
        f"{PAPER_FACTOR:g} only at s = {s:.2f} ({low:.2f} to {high:.2f}).",
    )


def shapes_part(cells: Sequence[LawCell]) -> Table:
    """Table of how far the measured k of each spectrum are from the law, for g above 1."""
    rows = []
    for name in dict.fromkeys(cell.spectrum for cell in cells):
        large = [cell for cell in cells if cell.spectrum == name and cell.size > 1]
        laws = [_law_of(cell) for cell in large]
        differences = np.array(
            [law.value / cell.both - 1 for law, cell in zip(laws, large, strict=True)]
        )
        inside = sum(
            is_within(cell.both, np.nan_to_num(cell.error), law)
            for law, cell in zip(laws, large, strict=True)
        )
        rows.append(
            (
                name,
                "no" if name in HELD_OUT else "yes",
                f"{large[0].breadth:.2f}",
                f"{min(cell.disorder for cell in large):.2g}",
                f"{max(cell.disorder for cell in large):.2g}",
                f"{max(cell.size for cell in large):.3g}",
                f"{100 * np.sqrt(np.mean(differences**2)):.1f}",
                f"{100 * differences[np.argmax(np.abs(differences))]:+.1f}",
                f"{inside}",
                f"{len(large)}",
            )
        )
    return make_table(
        "spectrum | in the fit | beta | s from | s to | largest g | rms % | worst % "
        "| in the 95% interval | rows",
        rows,
        "The law over measured k of straight fronts, for g above 1.",
    )


def _law_of(cell: LawCell) -> Estimate[float]:
    """Factor k of the law at the place of a cell."""
    return pinning_factor(max(cell.disorder, WEAKEST), cell.size, breadth=cell.breadth).factor


def fronts_part(cells: Sequence[LawCell]) -> Table:
    """How far fronts reach: their rms, a power law of g by least squares for g above 1."""
    large = [cell for cell in cells if cell.size > 1 and cell.front_rms > 0]
    size, rms = (np.log([getattr(cell, name) for cell in large]) for name in ("size", "front_rms"))
    exponent, start = np.polyfit(size, rms, 1)
    scatter = float(np.std(rms - np.polyval((exponent, start), size)))
    return make_table(
        "rows | factor | exponent | scatter %",
        [(f"{len(large)}", f"{math.exp(start):.2f}", f"{exponent:.2f}", f"{100 * scatter:.0f}")],
        "Rms of fronts over spectra, amplitudes and springs with g above 1: "
        "u_rms = factor xi_u g^exponent.",
    )
