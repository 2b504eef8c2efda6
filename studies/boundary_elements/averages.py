"""Averages of the hysteresis over surfaces, and their limit of no range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import attrgetter
from typing import Any

import numpy as np

from crackfront.analysis.estimate import Estimate, student_estimate
from crackfront.analysis.validity import ValidityRow
from studies.boundary_elements.hysteresis import Hysteresis

Value = Callable[[Hysteresis], float]

ORDER = 3
"""Power of the range with which the hysteresis of boundary elements nears that of no range.

Measured, docs/validation.md: where a range was halved in two steps, the second changed the
hysteresis by a third of the first. The length of the cohesive zone would suggest its square.
"""


@dataclass(frozen=True, slots=True)
class Setting:
    """Surfaces of one spectrum, amplitude, grid and load step."""

    rows: tuple[Hysteresis, ...]
    # Where the rows are extrapolated: a longer range on them and on further surfaces.
    coarse: tuple[Hysteresis, ...] = ()

    @property
    def surfaces(self) -> int:
        """Number of surfaces."""
        return max(len(self.rows), len(self.coarse))

    def mean(self, value: Value) -> Estimate:
        """Mean of a quantity over the surfaces."""
        return self._estimate(lambda mean: mean, value)

    def hysteresis_ratio(self) -> Estimate:
        """Hysteresis of the front over that of the boundary elements, means over the surfaces."""
        models = attrgetter("front_hysteresis"), attrgetter("boundary_hysteresis")
        return self._estimate(lambda front, boundary: front / boundary, *models)

    def _estimate(self, function: Callable[..., float], *values: Value) -> Estimate:
        """Function of means, with the standard error of the jackknife over the surfaces."""
        # Extrapolated: the mean of the longer range over all surfaces, and that of what changes.
        fine, coarse = (
            {row.seed: np.array([value(row) for value in values]) for row in rows}
            for rows in (self.rows, self.coarse)
        )

        def found(left: int | None = None) -> float:
            near = [fine[seed] - coarse.get(seed, 0.0) for seed in fine if seed != left]
            far = [known for seed, known in coarse.items() if seed != left]
            return function(*(np.mean(near, axis=0) + (np.mean(far, axis=0) if far else 0.0)))

        if len(fine) < 2:
            return student_estimate(found(), math.nan, 0)
        count = self.surfaces
        changed = np.array([found(seed) for seed in {**fine, **coarse}])
        error = math.sqrt((count - 1) / count * float(np.sum((changed - np.mean(changed)) ** 2)))
        return student_estimate(found(), error, len(fine) - 1)


def settings(rows: Iterable[Hysteresis]) -> tuple[Setting, ...]:
    """Surfaces that are averaged together, by resolution, spectrum and amplitude."""
    ordered = sorted(rows, key=attrgetter("setting"))
    return tuple(Setting(tuple(alike)) for _, alike in groupby(ordered, attrgetter("setting")))


def limit_settings(rows: Sequence[Hysteresis]) -> tuple[Setting, ...]:
    """The limit of no range at every spectrum and amplitude that has one.

    The longer range that all of its surfaces have, and most others, is averaged with it.
    """
    found = []
    for limit in settings(range_limits(rows)):
        row, seeds = limit.rows[0], {one.seed for one in limit.rows}
        alike = settings(one for one in rows if (one.scene, one.step) == (row.scene, row.step))
        known = [one for one in alike if seeds <= {other.seed for other in one.rows}]
        coarse = max(known, key=lambda one: (len(one.rows), one.rows[0].interaction_range))
        found.append(replace(limit, coarse=coarse.rows))
    return tuple(found)


def range_limits(rows: Iterable[Hysteresis]) -> list[Hysteresis]:
    """Works of adhesion and hysteresis at a vanishing range, from the two shortest of a surface.

    Everything else is that of the shorter range.
    """

    def surface(row: Hysteresis) -> tuple[float, ...]:
        return (*row.scene, row.seed, row.step)

    limits = []
    ordered = sorted(rows, key=lambda row: (surface(row), row.interaction_range, -row.n_point))
    for _, alike in groupby(ordered, surface):
        fine, *others = alike
        longer = [row for row in others if row.interaction_range > fine.interaction_range]
        if longer:
            ratio = (longer[0].interaction_range / fine.interaction_range) ** ORDER
            changes: dict[str, Any] = {"interaction_range": 0.0}
            for name in ("boundary_approach", "boundary_retraction", "boundary_hysteresis"):
                near, far = getattr(fine, name), getattr(longer[0], name)
                changes[name] = near + (near - far) / (ratio - 1)
            limits.append(replace(fine, **changes))
    return limits


def rough_settings(found: Iterable[Setting]) -> list[Setting]:
    """Settings without the smooth spheres."""
    return [one for one in found if one.rows[0].asked_energy > 0]


def validity_row(setting: Setting, short_cutoff: float) -> ValidityRow:
    """How far the front is right at one spectrum and amplitude."""
    ratio, row = setting.hysteresis_ratio(), setting.rows[0]
    return ValidityRow(
        roll_off=row.roll_off / short_cutoff,
        hurst=row.hurst,
        elastic_energy=float(setting.mean(lambda one: one.elastic_energy).value),
        ratio=float(ratio.value),
        error=float(ratio.standard_error),
        surfaces=setting.surfaces,
        fine=len(setting.rows),
        n_point=row.n_point,
        interaction_range=row.interaction_range,
    )
