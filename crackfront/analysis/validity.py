"""Up to which roughness the hysteresis of a crack front is that of boundary elements.

`python -m studies boundary-elements validate` computes both on the same surfaces and writes
`validity.csv`, which is kept here.
"""

from __future__ import annotations

import csv
import functools
import io
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from importlib.resources import files
from typing import get_type_hints

TOLERANCES = (0.10, 0.25)
"""Relative differences of the hysteresis whose ranges a sentence gives."""

_ALIKE = 0.9
"""Energies measured on tiles differ by some percent from the requested one."""


@dataclass(frozen=True, slots=True)
class ValidityRow:
    """Both models at one spectrum and amplitude."""

    roll_off: float
    """Roll-off wavelength over the shortest; 1 for a flat spectrum."""
    hurst: float
    """Hurst exponent."""
    elastic_energy: float
    """Energy of full conformity. (Units: w_int)"""
    ratio: float
    error: float
    """Hysteresis of the front over that of boundary elements, and its standard error; NaN for one
    surface."""
    surfaces: int
    fine: int
    """Surfaces that are averaged, and those of them on the finest grids."""
    n_point: int
    """Points along a side of the boundary elements' grid."""
    interaction_range: float
    """Gap at which their attraction ends. (Units: reduced vertical length)"""


@functools.cache
def shipped_validity() -> tuple[ValidityRow, ...]:
    """Rows of the file that the package ships."""
    return validity_of(files(__package__).joinpath("validity.csv").read_text(encoding="utf-8"))


def validity_of(text: str) -> tuple[ValidityRow, ...]:
    """Rows of a table as of :func:`validity_text`."""
    kinds = get_type_hints(ValidityRow)
    rows = csv.DictReader(io.StringIO(text))
    return tuple(ValidityRow(**{name: kinds[name](row[name]) for name in kinds}) for row in rows)


def validity_text(rows: Sequence[ValidityRow]) -> str:
    """Table of comma-separated values."""
    lines = [",".join(item.name for item in fields(ValidityRow))]
    lines += [",".join(f"{value:.5g}" for value in asdict(row).values()) for row in rows]
    return "\n".join(lines) + "\n"


def largest_energy(rows: Sequence[ValidityRow], tolerance: float) -> float:
    """Largest e_el up to which every row's hysteresis is right to a tolerance (Units: w_int).

    Right within its standard error. That of a row, not between two; 0 where the smoothest surface
    is outside already.

    Examples
    --------
    >>> ratios = {0.03: 1.05, 0.06: 1.2, 0.1: 1.5}
    >>> rows = [ValidityRow(1, 1, e, r, 0.01, 4, 4, 512, 0.2) for e, r in ratios.items()]
    >>> [largest_energy(rows, tolerance) for tolerance in (0.01, 0.1, 0.25)]
    [0.0, 0.03, 0.06]
    """
    outside = [row.elastic_energy for row in rows if not _departure(row) <= tolerance]
    least = _ALIKE * min(outside, default=math.inf)
    return max((row.elastic_energy for row in rows if row.elastic_energy < least), default=0.0)


def _departure(row: ValidityRow) -> float:
    """How far the ratio is from one, beyond its standard error if it has one."""
    return abs(row.ratio - 1) - (row.error if math.isfinite(row.error) else 0.0)


def validity_sentence(rows: Sequence[ValidityRow] | None = None) -> str:
    """What the hysteresis of a front is worth by amplitude, by the shipped table or another."""
    rows = shipped_validity() if rows is None else rows
    energies = [row.elastic_energy for row in rows]
    ranges: dict[float, str] = {}
    for tolerance in TOLERANCES:
        energy = largest_energy(rows, tolerance)
        if energy:
            strongest = ", the strongest that was compared" if energy == max(energies) else ""
            words = f"to {tolerance:.0%} up to e_el/w_int = {energy:.2g}{strongest}"
        else:
            words = f"to {tolerance:.0%} nowhere from e_el/w_int = {min(energies):.2g} on"
        ranges.setdefault(energy, words)
    worst = max(rows, key=_departure)
    error = f" ± {worst.error:.1f}" if math.isfinite(worst.error) else ""
    return (
        f"Against boundary elements on the same surfaces the front's hysteresis is right, within "
        f"the error of the comparison, {', and '.join(ranges.values())}; at worst it is "
        f"{worst.ratio:.1f}{error} times theirs, at e_el/w_int = {worst.elastic_energy:.2g}."
    )
