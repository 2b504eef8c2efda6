"""Numbers and sizes of the jumps in the steady part of each branch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from crackfront.analysis.steady_adhesion import Branches
from crackfront.core.arrays import Array
from crackfront.core.cycle.jumps import Jumps
from crackfront.core.variables import AREA, ENERGY, LATERAL, variable

JUMP_DEFINITION = (
    "A jump (avalanche) is the motion of the front from an unstable state to the next stable one. "
    "Load steps are halved until no site moves by more than 0.05 correlation lengths of w_loc, "
    "which is smooth motion, or until jumps that start in the same step would coincide in about 1% "
    "of the cases. Jumps are counted in the load steps that end at the states that w_appr and "
    "w_retr average. jump_energy over swept_area, added over both branches, equals the hysteresis "
    "w_retr - w_appr, except for the energy that smooth motion dissipates and for the difference "
    "between a mean over states and their integral. The extent is the width along the front of the "
    "largest contiguous part that moves: its area over its largest depth."
)
"""What a jump is; an attribute of every file with these variables."""


@dataclass(frozen=True)
class JumpMeasures:
    """Jumps of the steady part of each branch, as :data:`JUMP_DEFINITION` says.

    Without jumps their mean, median and largest sizes are NaN.
    """

    n_jump_appr: int = variable("jumps of the steady approach", "1")
    n_jump_retr: int = variable("jumps of the steady retraction", "1")
    swept_area_appr: float = variable("area that the steady approach sweeps", AREA)
    swept_area_retr: float = variable("area that the steady retraction sweeps", AREA)
    jump_energy_appr: float = variable("energy that jumps of the steady approach dissipate", ENERGY)
    jump_energy_retr: float = variable(
        "energy that jumps of the steady retraction dissipate", ENERGY
    )
    jump_energy_mean_appr: float = variable("mean energy of a jump, approach", ENERGY)
    jump_energy_mean_retr: float = variable("mean energy of a jump, retraction", ENERGY)
    jump_energy_median_appr: float = variable("median energy of a jump, approach", ENERGY)
    jump_energy_median_retr: float = variable("median energy of a jump, retraction", ENERGY)
    jump_energy_max_appr: float = variable("largest energy of a jump, approach", ENERGY)
    jump_energy_max_retr: float = variable("largest energy of a jump, retraction", ENERGY)
    jump_area_mean_appr: float = variable("mean area of a jump, approach", AREA)
    jump_area_mean_retr: float = variable("mean area of a jump, retraction", AREA)
    jump_area_median_appr: float = variable("median area of a jump, approach", AREA)
    jump_area_median_retr: float = variable("median area of a jump, retraction", AREA)
    jump_area_max_appr: float = variable("largest area of a jump, approach", AREA)
    jump_area_max_retr: float = variable("largest area of a jump, retraction", AREA)
    jump_extent_mean_appr: float = variable("mean width of a jump, approach", LATERAL)
    jump_extent_mean_retr: float = variable("mean width of a jump, retraction", LATERAL)
    jump_extent_median_appr: float = variable("median width of a jump, approach", LATERAL)
    jump_extent_median_retr: float = variable("median width of a jump, retraction", LATERAL)
    jump_extent_max_appr: float = variable("largest width of a jump, approach", LATERAL)
    jump_extent_max_retr: float = variable("largest width of a jump, retraction", LATERAL)


def jump_measures(jumps: Jumps, averaged: Branches) -> JumpMeasures:
    """Measures of the jumps in the load steps that end at the averaged states of both branches.

    Parameters
    ----------
    jumps : Jumps
        Jumps of a cycle, arrays (n_jump,), and the area of each load step, (n_state,).
    averaged : tuple of int arrays
        Numbers of the averaged states of the approach and of the retraction.

    Returns
    -------
    JumpMeasures
        In reduced units.
    """
    values: dict[str, Any] = {}
    for branch, states in zip(("appr", "retr"), averaged, strict=True):
        inside = np.isin(jumps.jump_state, states)
        values[f"n_jump_{branch}"] = int(np.count_nonzero(inside))
        values[f"swept_area_{branch}"] = float(np.nansum(jumps.swept_area[states]))
        values[f"jump_energy_{branch}"] = float(np.sum(jumps.jump_energy[inside]))
        for name in ("energy", "area", "extent"):
            sizes = getattr(jumps, f"jump_{name}")[inside]
            for statistic, value in _statistics(sizes).items():
                values[f"jump_{name}_{statistic}_{branch}"] = value
    return JumpMeasures(**values)


def _statistics(sizes: Array) -> dict[str, float]:
    """Mean, median and largest of the sizes of jumps; NaN without any."""
    if not sizes.size:
        return dict.fromkeys(("mean", "median", "max"), np.nan)
    return {
        "mean": float(np.mean(sizes)),
        "median": float(np.median(sizes)),
        "max": float(np.max(sizes)),
    }
