"""Averages over the surfaces of a validation by amplitude, and their limit of no range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from crackfront.analysis.estimate import Estimate, mean_estimate, student_estimate
from crackfront.analysis.validity import ValidityRow
from crackfront.studies.boundary_elements.amplitudes import SurfaceComparison

Model = Literal["boundary", "front"]

_ORDER = 3
"""Order of the differences in the range, where surfaces are rough."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Surfaces of one spectrum, amplitude, grid and load step."""

    rows: tuple[SurfaceComparison, ...]

    def mean(self, value: Callable[[SurfaceComparison], float]) -> Estimate:
        """Mean of a quantity over the surfaces."""
        return mean_estimate(np.array([value(row) for row in self.rows]))[0]

    def hysteresis(self, model: Model) -> Estimate:
        """Mean hysteresis of a model over the surfaces (Units: w_int)."""
        return self.mean(lambda row: float(getattr(row, f"{model}_hysteresis")))

    def hysteresis_ratio(self) -> Estimate:
        """Hysteresis of the front over that of the boundary elements, means over the surfaces.

        The standard error is that of the jackknife.
        """
        front, boundary = (
            np.array([getattr(row, f"{model}_hysteresis") for row in self.rows])
            for model in ("front", "boundary")
        )
        count = len(self.rows)
        value = np.sum(front) / np.sum(boundary)
        if count < 2:
            return student_estimate(value, math.nan, 0)
        left = (np.sum(front) - front) / (np.sum(boundary) - boundary)
        error = math.sqrt((count - 1) / count * float(np.sum((left - np.mean(left)) ** 2)))
        return student_estimate(value, error, count - 1)


def settings(rows: Iterable[SurfaceComparison]) -> tuple[Setting, ...]:
    """Surfaces that are averaged together, by resolution, spectrum and amplitude."""
    alike: dict[tuple[float, ...], list[SurfaceComparison]] = {}
    for row in rows:
        alike.setdefault(row.setting, []).append(row)
    return tuple(Setting(tuple(alike[key])) for key in sorted(alike))


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
        surfaces=len(setting.rows),
        n_point=row.n_point,
        interaction_range=row.interaction_range,
    )
