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
from studies.tables import Table, make_table

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
    usual, number = _ends(measurements, None)
    seeds = [_ends(measurements, seed)[0] for seed in range(SEEDS)]
    rounded = [
        replace(measurement, heights=_rounded(measurement.heights)) for measurement in measurements
    ]
    digits = [_ends(rounded, None)[0]]
    size = [_ends(measurements, SEEDS, [MORE * number // BATCH])[0]]
    width = usual[2] - usual[0]
    low, value, high = np.exp(usual).tolist()
    by_seeds, by_digits, by_size = (
        np.max(np.abs(np.array(ends) - usual), axis=0) / width for ends in (seeds, digits, size)
    )
    return Movement(Estimate(value, math.nan, low, high), by_seeds, by_digits, by_size, number)


def _rounded(heights: Array) -> Array:
    """Heights with steps of `DIGITS` of their standard deviation."""
    step = DIGITS * heights.std()
    return step * np.round(heights / step)


def _ends(
    measurements: Sequence[Measurement], seed: int | None, numbers: Sequence[int] | None = None
) -> tuple[Array, int]:
    """Logarithms of the ends and the median of the interval, and the number of draws."""
    draws = joint_spectrum(
        [analysed_scan(measurement) for measurement in measurements], seed, numbers
    ).draws
    energy = draws.mean_square(0.5)
    return np.log([energy.low, energy.value, energy.high]), draws.weight.size


def movement_table(movements: Sequence[tuple[str, Movement]]) -> Table:
    """Movements, a surface a row, per cent of the width."""
    columns = [
        f"{cause} {end} %"
        for cause in ("seeds", "digits", "more draws")
        for end in ("low", "median", "high")
    ]
    return make_table(
        f"scans | factor of the interval | draws | {' | '.join(columns)}",
        list(_rows(movements)),
        "Movements of the low end, the median and the high end of the interval, in per cent of its "
        "width.",
    )


def _rows(movements: Sequence[tuple[str, Movement]]) -> Iterator[tuple[str, ...]]:
    """Rows of the table."""
    for name, moved_ends in movements:
        factor = (moved_ends.energy.high / moved_ends.energy.low) ** 0.5
        moved = (
            f"{100 * end:.1f}"
            for ends in (moved_ends.seeds, moved_ends.digits, moved_ends.size)
            for end in ends
        )
        yield (name, f"{factor:.2f}", str(moved_ends.draws), *moved)
