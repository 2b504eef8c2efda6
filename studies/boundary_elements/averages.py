"""Averages of the hysteresis over surfaces, and their limit of no range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from crackfront.analysis.estimate import REACH, Estimate, student_estimate
from crackfront.analysis.validity import ValidityRow
from crackfront.core import jkr
from crackfront.core.adhesion import adhesion_rms, larkin_length
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from studies.boundary_elements.hysteresis import Hysteresis

Value = Callable[[Hysteresis], float]

_DIFFERENCE = attrgetter("boundary_difference")

ORDER = 3
"""Power of the range by which the hysteresis of boundary elements is extrapolated to no range.

Measured, docs/experiments/boundary-elements.md: where a range was halved twice, the second halving
changed the hysteresis by a third of the first. The length of the cohesive zone would suggest 2.
"""

ORDERS = (2, ORDER, 4)
"""Powers that are compared; results of the outer two differ by the error of the extrapolation."""

ZONE = 0.26
"""Length of the cohesive zone over the square of the range."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Surfaces of one spectrum, amplitude, grid and load step."""

    rows: tuple[Hysteresis, ...]
    # For an extrapolation: a longer range on the same and on further surfaces.
    coarse: tuple[Hysteresis, ...] = ()

    @property
    def surfaces(self) -> int:
        """Number of surfaces."""
        return max(len(self.rows), len(self.coarse))

    def mean(self, value: Value) -> Estimate:
        """Mean of a quantity over the surfaces."""
        return self._estimate(lambda mean: mean, value)

    def excess(self, smooth: float) -> Estimate:
        """Logarithm of the ratio of hystereses, front over boundary elements.

        `smooth` is what boundary elements lose on the smooth sphere; it is subtracted from theirs.
        (Units: w_int)
        """
        models = attrgetter("front_difference"), attrgetter("boundary_difference")

        def logarithm(front: float, boundary: float) -> float:
            both_lose = front > 0 and boundary > smooth
            return math.log(front / (boundary - smooth)) if both_lose else math.nan

        return self._estimate(logarithm, *models)

    def _estimate(self, function: Callable[..., float], *values: Value) -> Estimate:
        """Function of means, with the standard error of the jackknife over the surfaces."""
        # Extrapolated: mean of the longer range over all surfaces, plus the mean of the change.
        fine, coarse = (
            {row.seed: np.array([value(row) for value in values]) for row in rows}
            for rows in (self.rows, self.coarse)
        )

        def estimate_without(omitted: int | None = None) -> float:
            near = [fine[seed] - coarse.get(seed, 0.0) for seed in fine if seed != omitted]
            far = [values for seed, values in coarse.items() if seed != omitted]
            return function(*(np.mean(near, axis=0) + (np.mean(far, axis=0) if far else 0.0)))

        if len(fine) < 2:
            return student_estimate(estimate_without(), math.nan, 0)
        changed = np.array([estimate_without(seed) for seed in {**fine, **coarse}])
        squares = (changed - np.mean(changed)) ** 2
        error = math.sqrt((self.surfaces - 1) / self.surfaces * float(np.sum(squares)))
        freedom = _degrees_of_freedom(squares[: len(fine)], squares[len(fine) :])
        return student_estimate(estimate_without(), error, freedom)


def _degrees_of_freedom(fine: Array, coarse: Array) -> float:
    """Welch's and Satterthwaite's degrees of freedom of a jackknife over two kinds of surfaces.

    The arrays are squares of its changes, by surfaces with and without a shorter range.
    """
    squares = float(np.sum(fine)), float(np.sum(coarse))
    weighted = squares[0] ** 2 / (fine.size - 1) + squares[1] ** 2 / max(1, coarse.size)
    return sum(squares) ** 2 / weighted if weighted else fine.size - 1


def settings(rows: Iterable[Hysteresis]) -> tuple[Setting, ...]:
    """Surfaces that are averaged together, by resolution, spectrum and amplitude."""
    ordered = sorted(rows, key=attrgetter("setting"))
    return tuple(Setting(tuple(alike)) for _, alike in groupby(ordered, attrgetter("setting")))


def limit_settings(rows: Sequence[Hysteresis], order: float = ORDER) -> tuple[Setting, ...]:
    """The limit of no range at every spectrum and amplitude that has one, by a power of the range.

    The longer range that all of its surfaces have, and most others, is averaged with it.
    """
    extended = []
    for limit in settings(range_limits(rows, order)):
        first, seeds = limit.rows[0], {row.seed for row in limit.rows}
        alike = (row for row in rows if (row.scene, row.step) == (first.scene, first.step))
        complete = (
            setting for setting in settings(alike) if seeds <= {row.seed for row in setting.rows}
        )
        coarse = max(
            complete, key=lambda setting: (len(setting.rows), setting.rows[0].interaction_range)
        )
        extended.append(replace(limit, coarse=coarse.rows))
    return tuple(extended)


def range_limits(rows: Iterable[Hysteresis], order: float = ORDER) -> list[Hysteresis]:
    """Works of adhesion and hysteresis at a vanishing range, from the two shortest of a surface.

    They approach it with a power of the range. Everything else is copied from the shorter range.
    """

    def surface(row: Hysteresis) -> tuple[float, ...]:
        return (*row.scene, row.seed, row.step)

    limits = []
    ordered = sorted(rows, key=lambda row: (surface(row), row.interaction_range, -row.n_point))
    for _, alike in groupby(ordered, surface):
        fine, *longer_ranges = alike
        longer = [row for row in longer_ranges if row.interaction_range > fine.interaction_range]
        if longer:
            ratio = (longer[0].interaction_range / fine.interaction_range) ** order
            changes: dict[str, Any] = {"interaction_range": 0.0}
            for name in ("boundary_approach", "boundary_retraction"):
                near, far = getattr(fine, name), getattr(longer[0], name)
                changes[name] = near + (near - far) / (ratio - 1)
            limits.append(replace(fine, **changes))
    return limits


def rough_settings(candidates: Iterable[Setting]) -> list[Setting]:
    """Settings without the smooth spheres."""
    return [setting for setting in candidates if setting.rows[0].asked_energy > 0]


class ZoneKey(NamedTuple):
    """Spectrum and amplitude of a setting, and the length of its cohesive zone."""

    roll_off: float
    """Over the short cutoff."""
    hurst: float
    elastic_energy: float
    """Requested. (Units: w_int)"""
    zone: float
    """Length of the cohesive zone over the short cutoff; 0 without a range."""


def rows_by_zone(rows: Sequence[Hysteresis], short_cutoff: float) -> dict[ZoneKey, ValidityRow]:
    """How far the front is right, at every spectrum, amplitude, and range, and at none."""
    by_zone, smooth = {}, _smooth_loss(rows)
    for setting in sorted(rough_settings(settings(rows)), key=attrgetter("surfaces")):
        row = _validity_row(setting, setting.excess(smooth), 0.0, short_cutoff)
        by_zone[_zone_key(setting, short_cutoff)] = row
    for setting, (near, excess, far) in excess_by_order(rows):
        half_difference = abs(float(far.value - near.value)) / 2
        by_zone[_zone_key(setting, short_cutoff)] = _validity_row(
            setting, excess, half_difference, short_cutoff
        )
    return by_zone


def excess_by_order(rows: Sequence[Hysteresis]) -> list[tuple[Setting, tuple[Estimate, ...]]]:
    """Settings with a limit of no range, and the logarithms of their ratios by all powers."""
    smooth = _smooth_loss(rows)
    by_order = [rough_settings(limit_settings(rows, order)) for order in ORDERS]
    return [
        (alike[ORDERS.index(ORDER)], tuple(setting.excess(smooth) for setting in alike))
        for alike in zip(*by_order, strict=True)
    ]


def _zone_key(setting: Setting, short_cutoff: float) -> ZoneKey:
    """Key of a setting in the table by zone."""
    row = setting.rows[0]
    zone = ZONE * row.interaction_range**2 / short_cutoff
    roll_off = round(row.roll_off / short_cutoff, 2)
    return ZoneKey(roll_off, row.hurst, row.asked_energy, round(zone, 2))


def brought_to_no_range(
    rows: Mapping[ZoneKey, ValidityRow], counterparts: Mapping[ZoneKey, ValidityRow]
) -> Iterator[ValidityRow]:
    """Rows of one range in the limit of none, by what the range changes on others of equal keys.

    The errors of all three are taken as independent.
    """
    for key, row in rows.items():
        same, limit = counterparts.get(key), counterparts.get(key._replace(zone=0.0))
        if key.zone and same and limit and math.isfinite(row.error):
            error = math.hypot(row.error, same.error, limit.error)
            yield replace(row, ratio=row.ratio * limit.ratio / same.ratio, error=error)


def _smooth_loss(rows: Iterable[Hysteresis]) -> float:
    """Hysteresis of boundary elements on the smooth sphere (Units: w_int)."""
    return max((_DIFFERENCE(row) for row in rows if not row.asked_energy), default=0.0)


def _validity_row(
    setting: Setting, logarithm: Estimate, order_error: float, short_cutoff: float
) -> ValidityRow:
    """Both models of a setting; the error is half of Student's interval, as of a normal number."""
    row, energy = setting.rows[0], float(setting.mean(attrgetter("elastic_energy")).value)
    reach = float(logarithm.high - logarithm.value)
    spectrum = SelfAffineSpectrum(short_cutoff, row.roll_off, row.hurst)
    larkin = larkin_length("roughness", spectrum, adhesion_rms(energy))
    return ValidityRow(
        roll_off=row.roll_off / short_cutoff,
        hurst=row.hurst,
        elastic_energy=energy,
        size=jkr.spring(jkr.radius_at_force(0.0), 1 - energy) / larkin,
        ratio=math.exp(float(logarithm.value)),
        error=math.hypot(reach / REACH, order_error),
        surfaces=setting.surfaces,
        fine=len(setting.rows),
        n_point=row.n_point,
    )
