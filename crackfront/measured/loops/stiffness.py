"""Stiffness of the machine that recorded force, contact radius and displacement."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.special import stdtrit

from crackfront.analysis.estimate import REACH, UNKNOWN, Estimate
from crackfront.analysis.steady_adhesion import Branches, Rows
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.intervals import BLOCKS, without_blocks


def machine_stiffness(
    loop: CalibratedLoop, modulus: Estimate[float], averaged: Branches
) -> Estimate[float]:
    """Stiffness of the machine (Units: N/m), from its bending under the force.

    The displacement exceeds the penetration of force and radius by this bending. NaN if a column is
    missing or the machine does not bend.
    """
    if not loop.has_force_and_radius or loop.recording.displacement is None:
        return UNKNOWN
    loop = replace(loop, modulus=modulus.value)
    rows = np.concatenate(averaged)
    value = _compliance(loop, rows)
    left_out = [_compliance(loop, part) for part in without_blocks(rows, BLOCKS)]
    noise = math.sqrt((BLOCKS - 1) * float(np.var(left_out)))
    stiffer = replace(loop, modulus=modulus.value + modulus.standard_error)
    by_modulus = REACH * (_compliance(stiffer, rows) - value)
    reach = math.hypot(float(stdtrit(BLOCKS - 1, 0.975)) * noise, by_modulus)
    low, high = value - reach, value + reach
    if not high > 0:
        return UNKNOWN
    stiffness = 1 / value if value > 0 else math.inf
    return Estimate(stiffness, math.nan, 1 / high, 1 / low if low > 0 else math.inf)


def _compliance(loop: CalibratedLoop, rows: Rows) -> float:
    """Bending of the machine per force in some rows (Units: m/N)."""
    bending = np.asarray(loop.recording.displacement) - loop.contact().penetration
    return float(np.polyfit(np.asarray(loop.recording.force)[rows], bending[rows], 1)[0])
