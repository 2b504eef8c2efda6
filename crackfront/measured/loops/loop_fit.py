"""Contact modulus and zero of the displacement whose JKR curves fit a loop best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import Branches, Rows
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.contact_relations import force_at
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig

_TRIED_ZEROS = 151
"""Displacements among which the zero is first sought: 50 for each travel of the mount."""

_NO_CURVE = 1e6
"""Misfit at a displacement with too few contacts; any curve has less."""

_SMALLEST_VARIANCE = np.finfo(float).tiny
"""Smallest variance of the force that divides another. (Units: N^2)"""


def fitted_modulus(recording: Recording, rig: Rig, rows: Branches) -> float:
    """Contact modulus (Units: Pa) of the JKR curves that fit the force best, one work a branch.

    The force is linear in E' and in the roots of E' w: F = 4/3 E' a^3 / R - sqrt(8 pi E' w a^3).
    Force and radius must be recorded. Raises ValueError if the modulus is not positive.
    """
    modulus = best_modulus(recording, rig, rows)
    if not modulus > 0:
        raise ValueError(
            "no positive modulus fits force and contact radius; the force must be positive where "
            "it pushes, so check its sign"
        )
    return modulus


def best_modulus(recording: Recording, rig: Rig, rows: Branches) -> float:
    """Contact modulus as :func:`fitted_modulus` has it, of any sign."""
    radius, force = np.asarray(recording.radius), np.asarray(recording.force)
    in_contact = np.isfinite(force) & (radius > 0)
    approach, retraction = (branch[in_contact[branch]] for branch in rows)
    used = np.concatenate([approach, retraction])
    a = radius[used]
    is_approach = np.arange(used.size) < approach.size
    adhesion = -(a**1.5)
    branches = (adhesion * is_branch for is_branch in (is_approach, ~is_approach) if any(is_branch))
    columns = np.stack([a**3, *branches], axis=1)
    scale = np.max(np.abs(columns), axis=0)
    coefficients, *_ = np.linalg.lstsq(columns / scale, force[used], rcond=None)
    return 0.75 * rig.radius * float(coefficients[0] / scale[0])


def fitted_zero(loop: CalibratedLoop, rows: Sequence[Rows], near: float | None = None) -> float:
    """Displacement without penetration (Units: m) whose JKR curves fit best, one work a branch.

    `rows` has the rows of each branch. Without a contact radius the zero is sought near a known
    one, or anywhere. It is 0 if force and radius are recorded.
    """
    if loop.has_force_and_radius:
        return 0.0
    if loop.recording.radius is None:
        return _zero_by_force(loop, rows, near)
    return _zero_by_radius(loop, rows)


def _zero_by_force(loop: CalibratedLoop, rows: Sequence[Rows], near: float | None) -> float:
    """Zero with the smallest misfit of the forces."""
    displacement = np.asarray(loop.recording.displacement)
    # Rows out of contact may be many more, and do not depend on the zero.
    parts = [_part(loop, branch) for branch in rows if branch.size]
    moved = displacement[np.concatenate(rows)]
    low, high = float(np.nanmin(moved)), float(np.nanmax(moved))
    if near is None:
        tried = np.linspace(low - (high - low), high + (high - low), _TRIED_ZEROS)
        near = float(tried[np.argmin([_misfit(parts, zero) for zero in tried])])
    step = 3 * (high - low) / (_TRIED_ZEROS - 1)
    best = scipy.optimize.minimize_scalar(
        lambda zero: _misfit(parts, zero),
        bounds=(near - step, near + step),
        method="bounded",
        options={"xatol": 1e-7 * (high - low)},
    )
    return float(best.x)


def _part(loop: CalibratedLoop, rows: Rows) -> CalibratedLoop:
    """Some rows of a loop without contact radii."""
    recording = loop.recording
    force, displacement = np.asarray(recording.force), np.asarray(recording.displacement)
    return replace(loop, recording=Recording(force[rows], None, displacement[rows]))


def _misfit(parts: Sequence[CalibratedLoop], zero: float) -> float:
    """Variance of the forces about one JKR curve for each part, over the variance of the forces."""
    total = 0.0
    for part in parts:
        contact, scales = replace(part, zero=zero).contact(), part.scales
        works = contact.work_of_adhesion[np.isfinite(contact.work_of_adhesion)]
        if works.size < FEWEST_STATES:
            return _NO_CURVE
        curve = force_at(contact.penetration / scales.vertical, float(np.mean(works)))
        misfit = float(np.nanmean((contact.force - scales.force * curve) ** 2))
        variance = float(np.nanvar(np.asarray(part.recording.force)))
        total += misfit / max(variance, _SMALLEST_VARIANCE)
    return total


def _zero_by_radius(loop: CalibratedLoop, rows: Sequence[Rows]) -> float:
    """Zero from contact radii.

    The displacement is linear in it and in the root of the work of adhesion of each branch, also
    with what bends in the machine: b = a^2 - sqrt(8 w a / 3) and F = a^3 - sqrt(6 w a^3).
    """
    scales, compliance = loop.scales, loop.compliance
    recording = loop.recording
    radius, displacement = np.asarray(recording.radius), np.asarray(recording.displacement)
    in_contact = np.isfinite(displacement) & (radius > 0)
    branches = [branch[in_contact[branch]] for branch in rows]
    used = np.concatenate(branches)
    a, moved = radius[used] / scales.lateral, displacement[used] / scales.vertical
    number_of_branch = np.repeat(np.arange(len(branches)), [branch.size for branch in branches])
    pulled = np.sqrt(8 * a / 3) + compliance * np.sqrt(6 * a**3)
    columns = [-pulled * (number_of_branch == number) for number in range(len(branches))]
    without_adhesion = moved - a**2 - compliance * a**3
    coefficients, *_ = np.linalg.lstsq(
        np.stack([np.ones(a.size), *columns], axis=1), without_adhesion, rcond=None
    )
    return float(coefficients[0]) * scales.vertical
