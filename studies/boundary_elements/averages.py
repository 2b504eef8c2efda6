"""Averages over the surfaces of a validation by amplitude, and their limit of no range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from crackfront.analysis.estimate import Estimate, student_estimate
from crackfront.analysis.validity import ValidityRow
from studies.boundary_elements.amplitudes import SurfaceComparison

Value = Callable[[SurfaceComparison], float]
Model = Literal["boundary", "front"]

_ORDER = 3
"""Order of the differences in the range, where surfaces are rough."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Surfaces of one spectrum, amplitude, grid and load step.

    Attributes
    ----------
    rows : tuple of SurfaceComparison
        The surfaces.
    coarse : tuple of SurfaceComparison
        Where the rows are extrapolated: a longer range on them and on further surfaces.
    """

    rows: tuple[SurfaceComparison, ...]
    coarse: tuple[SurfaceComparison, ...] = ()

    @property
    def surfaces(self) -> int:
        """Number of surfaces."""
        return max(len(self.rows), len(self.coarse))

    def mean(self, value: Value) -> Estimate:
        """Mean of a quantity over the surfaces."""
        return self._estimate(lambda mean: mean, value)

    def hysteresis(self, model: Model) -> Estimate:
        """Mean hysteresis of a model over the surfaces (Units: w_int)."""
        return self.mean(lambda row: float(getattr(row, f"{model}_hysteresis")))

    def hysteresis_ratio(self) -> Estimate:
        """Hysteresis of the front over that of the boundary elements, means over the surfaces."""
        return self._estimate(
            lambda front, boundary: front / boundary,
            lambda row: row.front_hysteresis,
            lambda row: row.boundary_hysteresis,
        )

    def _estimate(self, function: Callable[..., float], *values: Value) -> Estimate:
        """Function of means, with the standard error of the jackknife over the surfaces.

        A mean over extrapolated rows is that of the longer range over all surfaces, and that of
        what the extrapolation changes on its own.
        """
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


def settings(rows: Iterable[SurfaceComparison]) -> tuple[Setting, ...]:
    """Surfaces that are averaged together, by resolution, spectrum and amplitude."""
    alike: dict[tuple[float, ...], list[SurfaceComparison]] = {}
    for row in rows:
        alike.setdefault(row.setting, []).append(row)
    return tuple(Setting(tuple(alike[key])) for key in sorted(alike))


def limit_settings(rows: Sequence[SurfaceComparison]) -> tuple[Setting, ...]:
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


def range_limits(rows: Sequence[SurfaceComparison]) -> list[SurfaceComparison]:
    """The two shortest ranges of every surface, extrapolated to a vanishing one.

    Works of adhesion and hysteresis by the cube of the range: where it was halved in two steps,
    the second changed them by a third of the first. Everything else is that of the shorter range.
    """
    alike: dict[tuple[float, ...], list[SurfaceComparison]] = {}
    for row in rows:
        alike.setdefault((*row.scene, row.seed, row.step), []).append(row)
    limits = []
    for found in alike.values():
        found.sort(key=lambda row: (row.interaction_range, -row.n_point))
        fine = found[0]
        longer = [row for row in found if row.interaction_range > fine.interaction_range]
        if not longer:
            continue
        coarse = longer[0]
        share = 1 / ((coarse.interaction_range / fine.interaction_range) ** _ORDER - 1)
        names = (f"boundary_{name}" for name in ("approach", "retraction", "hysteresis"))
        limits.append(
            replace(
                fine,
                interaction_range=0.0,
                **{
                    name: (1 + share) * getattr(fine, name) - share * getattr(coarse, name)
                    for name in names
                },
                zone_approach=fine.front_approach,
                zone_retraction=fine.front_retraction,
                zone_hysteresis=fine.front_hysteresis,
                zone_dissipated=fine.front_dissipated,
            )
        )
    return limits


def validity_row(setting: Setting, short_cutoff: float) -> ValidityRow:
    """What is told of the front at one spectrum and amplitude."""
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
