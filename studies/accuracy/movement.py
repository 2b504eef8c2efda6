"""How far intervals of e_el move with seeds, with the digits of heights, and with more draws."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crackfront.analysis.estimate import Estimate
from crackfront.core.arrays import Array
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.scan.reading import Measurement
from crackfront.measured.spectrum.draws import BATCH
from crackfront.measured.spectrum.joining import joint_spectrum
from studies.pages import markdown_table

SEEDS = 5
DIGITS = 1e-4
"""Rounding of heights, in their standard deviation."""
MORE = 4
"""Times as many draws as are used."""


@dataclass(frozen=True, slots=True)
class Movement:
    """Largest movements of the low end, the median and the high end, over the width."""

    energy: Estimate[float]
    """Mean square half-derivative. (Units: m)"""
    seeds: Array
    digits: Array
    size: Array
    """With other seeds, with rounded heights, and with more draws. Shapes (3,)."""
    draws: int
    """Number of draws that are used."""


def movement(measurements: Sequence[Measurement]) -> Movement:
    """Movements of the interval of one surface."""
    known, number = _ends(measurements, None)
    seeds = [_ends(measurements, seed)[0] for seed in range(SEEDS)]
    rounded = [
        replace(one, heights=step * np.round(one.heights / step))
        for one, step in ((one, DIGITS * one.heights.std()) for one in measurements)
    ]
    digits = [_ends(rounded, None)[0]]
    size = [_ends(measurements, SEEDS, [MORE * number // BATCH])[0]]
    width = known[2] - known[0]
    low, value, high = np.exp(known).tolist()
    by_seeds, by_digits, by_size = (
        np.max(np.abs(np.array(ends) - known), axis=0) / width for ends in (seeds, digits, size)
    )
    return Movement(Estimate(value, math.nan, low, high), by_seeds, by_digits, by_size, number)


def _ends(
    measurements: Sequence[Measurement], seed: int | None, numbers: Sequence[int] | None = None
) -> tuple[Array, int]:
    """Logarithms of the ends and the median of the interval, and the number of draws."""
    found = joint_spectrum([analysed_scan(one) for one in measurements], seed, numbers).draws
    energy = found.mean_square(0.5)
    return np.log([energy.low, energy.value, energy.high]), found.weight.size


def movement_table(found: Sequence[tuple[str, Movement]]) -> str:
    """Movements in Markdown, a surface a row, per cent of the width."""
    return markdown_table(
        "scans | factor of the interval | draws | seeds: low, median, high | digits | more draws",
        list(_rows(found)),
    )


def _rows(found: Sequence[tuple[str, Movement]]) -> Iterator[tuple[str, ...]]:
    """Rows of the table."""
    for name, one in found:
        factor = (one.energy.high / one.energy.low) ** 0.5
        moved = (
            ", ".join(f"{100 * end:.1f}" for end in ends)
            for ends in (one.seeds, one.digits, one.size)
        )
        yield (name, f"{factor:.2f}", str(one.draws), *moved)
