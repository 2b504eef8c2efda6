"""Works of adhesion, modulus and stiffness of the machine of a loop, with 95% intervals."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from crackfront.analysis.estimate import REACH, UNKNOWN, Estimate
from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import Branches, Rows, within
from crackfront.core.arrays import Array
from crackfront.measured.loops.calibration import CalibratedLoop, Contact
from crackfront.measured.loops.loop_fit import fitted_modulus, fitted_zero

_BLOCKS = 10
"""Blocks of a branch, each of which is left out once to measure the errors by noise."""

_RIG_STEP = 1e-4
"""Relative change of modulus or radius by which the derivative of the works is measured."""


@dataclass(frozen=True, slots=True)
class Works:
    """Works of adhesion of both branches and the modulus, with their intervals."""

    w_appr: Estimate[float]
    """Of the approach. (Units: J/m^2)"""
    w_retr: Estimate[float]
    """Of the retraction. (Units: J/m^2)"""
    hysteresis: Estimate[float]
    """w_retr - w_appr. (Units: J/m^2)"""
    modulus: Estimate[float]
    """Contact modulus. (Units: Pa)"""


def works_of_adhesion(loop: CalibratedLoop, averaged: Branches, errors: Sequence[Array]) -> Works:
    """Works of adhesion of both branches, and the modulus, from the averaged rows.

    Modulus and zero of the displacement are fitted again to whatever rows are used, as far as they
    are not known.

    Parameters
    ----------
    loop : CalibratedLoop
    averaged : two arrays of int
        Averaged rows of approach and retraction.
    errors : sequence of (n_row,) arrays
        Standard errors of the zero of the force. (Units: N)

    Returns
    -------
    Works
        The intervals include noise, a trend along the window, and the errors of modulus, radius,
        and both zeros. They are NaN where an error of the zero leaves a row without adhesion, and
        for a branch without rows.
    """
    value = _numbers(loop, averaged)
    n_blocks = min(_BLOCKS, min(rows.size for rows in averaged if rows.size) // 2)
    parts = zip(*(_without_blocks(rows, n_blocks) for rows in averaged), strict=True)
    left_out = np.array([_numbers(loop, part) for part in parts])
    squares = np.sum((left_out - left_out.mean(axis=0)) ** 2, axis=0)
    noise = np.sqrt((n_blocks - 1) / n_blocks * squares)
    variance = np.zeros_like(value)
    for change in _changes(loop, averaged, errors, value):
        variance += change**2
    variance += _trend(loop, averaged, noise)
    reach = np.sqrt((float(stdtrit(n_blocks - 1, 0.975)) * noise) ** 2 + REACH**2 * variance)
    error = np.sqrt(noise**2 + variance)
    columns = np.stack([value, error, value - reach, value + reach], axis=1)
    return Works(*(Estimate(*row) for row in columns.tolist()))


def _without_blocks(rows: Rows, n_blocks: int) -> list[Rows]:
    """Rows without the first of some equal blocks, without the second, and so on."""
    blocks = np.array_split(rows, n_blocks)
    return [np.concatenate(blocks[:i] + blocks[i + 1 :]) for i in range(n_blocks)]


def _numbers(loop: CalibratedLoop, rows: Branches) -> Array:
    """w_appr, w_retr, hysteresis and modulus, with the loop calibrated by the same rows."""
    recording, rig = loop.recording, loop.rig
    fitted_rows = (rows[0], rows[1][:0]) if loop.by_approach else rows
    modulus = rig.contact_modulus or fitted_modulus(recording, rig, fitted_rows)
    loop = replace(loop, modulus=modulus)
    return _at_zero(loop, fitted_zero(loop, rows, near=loop.zero), rows)


def _at_zero(loop: CalibratedLoop, zero: float, rows: Branches) -> Array:
    """w_appr, w_retr, hysteresis and modulus with a zero of the displacement."""
    appr, retr = _means(replace(loop, zero=zero).contact(), rows)
    return np.array([appr, retr, retr - appr, loop.modulus])


def _means(contact: Contact, rows: Branches) -> list[float]:
    """Works of adhesion of both branches, from the rows that have one; NaN if a branch has none."""
    work = contact.work_of_adhesion
    branches = (branch[np.isfinite(work[branch])] for branch in rows)
    return [float(np.mean(work[branch])) if branch.size else math.nan for branch in branches]


def _changes(
    loop: CalibratedLoop, averaged: Branches, errors: Sequence[Array], value: Array
) -> Iterator[Array]:
    """Changes of the numbers by one standard error of each zero, of the modulus and of the radius.

    The value is what the numbers are without an error.
    """
    for error in errors:
        recording = replace(loop.recording, force=np.asarray(loop.recording.force) + error)
        yield _numbers(replace(loop, recording=recording), averaged) - value
    if not loop.has_force_and_radius:
        # A true trend of either branch moves the zero; a zero by one branch alone says how far.
        for branch in filter(len, averaged):
            yield _by_zero_of_branch(loop, averaged, branch) - value
    rig, raised = loop.rig, 1 + _RIG_STEP
    if rig.contact_modulus is not None and rig.modulus_error > 0:
        stiffer = replace(rig, contact_modulus=rig.contact_modulus * raised)
        change = _numbers(replace(loop, rig=stiffer), averaged) - value
        yield rig.modulus_error * change / _RIG_STEP
    if rig.radius_error > 0:
        larger = replace(rig, radius=rig.radius * raised)
        change = _numbers(replace(loop, rig=larger), averaged) - value
        yield rig.radius_error * change / _RIG_STEP


def _by_zero_of_branch(loop: CalibratedLoop, averaged: Branches, branch: Rows) -> Array:
    """Numbers with the zero of the displacement that fits one branch.

    It is sought anywhere, or, if the other branch lacks works there, near the zero of both.
    """
    numbers = _at_zero(loop, fitted_zero(loop, [branch]), averaged)
    if all(math.isfinite(numbers[place]) for place, rows in enumerate(averaged) if rows.size):
        return numbers
    return _at_zero(loop, fitted_zero(loop, [branch], near=loop.zero), averaged)


def _trend(loop: CalibratedLoop, averaged: Branches, noise: Array) -> Array:
    """Squared half of the change along the window, beyond what noise makes of two halves."""
    radius = loop.contact().radius
    middle = float(np.median(radius[np.concatenate(averaged)]))
    lower = within(radius, averaged, (0.0, middle))
    upper = within(radius, averaged, (middle, math.inf))
    is_present = [rows.size > 0 for rows in averaged]
    halves = (rows for half in (lower, upper) for rows in itertools.compress(half, is_present))
    if min(rows.size for rows in halves) < FEWEST_STATES:
        return np.zeros_like(noise)
    half = (_numbers(loop, upper) - _numbers(loop, lower)) / 2
    return np.asarray(np.maximum(half**2 - noise**2, 0.0))


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
    left_out = [_compliance(loop, part) for part in _without_blocks(rows, _BLOCKS)]
    noise = math.sqrt((_BLOCKS - 1) * float(np.var(left_out)))
    stiffer = replace(loop, modulus=modulus.value + modulus.standard_error)
    by_modulus = REACH * (_compliance(stiffer, rows) - value)
    reach = math.hypot(float(stdtrit(_BLOCKS - 1, 0.975)) * noise, by_modulus)
    low, high = value - reach, value + reach
    if not high > 0:
        return UNKNOWN
    stiffness = 1 / value if value > 0 else math.inf
    return Estimate(stiffness, math.nan, 1 / high, 1 / low if low > 0 else math.inf)


def _compliance(loop: CalibratedLoop, rows: Rows) -> float:
    """Bending of the machine per force in some rows (Units: m/N)."""
    bending = np.asarray(loop.recording.displacement) - loop.contact().penetration
    rows = rows[np.isfinite(bending[rows])]
    return float(np.polyfit(np.asarray(loop.recording.force)[rows], bending[rows], 1)[0])
