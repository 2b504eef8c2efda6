"""Contact modulus and zero of the displacement whose JKR curves fit a loop best."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import Branches, Rows
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.contact_relations import force_at, radius_at
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig

_TRIED_ZEROS = 151
"""Displacements among which the zero is first sought: 50 for each travel of the mount."""

_NO_CURVE = 1e300
"""Misfit at a displacement with too few contacts; finite, as the minimiser computes with it."""

_AT_ONCE = 2**14
"""Rows times zeros whose misfits are computed at once, so that their numbers stay in the cache."""


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
    vertical = loop.scales.vertical
    # Rows out of contact may be many more, and do not depend on the zero.
    parts = [_part(loop, branch) for branch in rows if branch.size]
    moved = np.asarray(loop.recording.displacement)[np.concatenate(rows)] / vertical
    low, high = float(np.nanmin(moved)), float(np.nanmax(moved))
    if near is None:
        tried = np.linspace(low - (high - low), high + (high - low), _TRIED_ZEROS)
        middle = float(tried[np.argmin(_misfits(parts, tried))])
    else:
        middle = near / vertical
    step = 3 * (high - low) / (_TRIED_ZEROS - 1)
    best = scipy.optimize.minimize_scalar(
        lambda zero: float(_misfits(parts, np.array([zero]))[0]),
        bounds=(middle - step, middle + step),
        method="bounded",
        options={"xatol": 1e-7 * (high - low)},
    )
    return float(best.x) * vertical


class _Part(NamedTuple):
    """Rows of a branch without contact radii, in reduced units."""

    force: Array
    displacement: Array
    """Displacement without what bends in the machine: penetration plus zero."""


def _part(loop: CalibratedLoop, rows: Rows) -> _Part:
    """Some rows of a loop without contact radii."""
    recording, scales = loop.recording, loop.scales
    force = np.asarray(recording.force)[rows] / scales.force
    displacement = np.asarray(recording.displacement)[rows] / scales.vertical
    displacement = displacement - loop.compliance * force
    known = np.isfinite(displacement)
    return _Part(force[known], displacement[known])


def _misfits(parts: Sequence[_Part], zeros: Array) -> Array:
    """Mean squares of the forces about a JKR curve for each part, added up.

    The parts share each of the zeros of the displacement (Units: reduced vertical length).
    """
    largest = max(1, *(part.force.size for part in parts))
    number = max(1, _AT_ONCE // largest)
    totals = [
        sum(_misfits_of_part(part, zeros[first : first + number]) for part in parts)
        for first in range(0, zeros.size, number)
    ]
    return np.minimum(np.concatenate(totals), _NO_CURVE)


def _misfits_of_part(part: _Part, zeros: Array) -> Array:
    """Misfits of one part at some zeros; infinite at zeros with too few contacts."""
    penetration = part.displacement - zeros[:, None]
    radius = radius_at(part.force, penetration)
    with np.errstate(divide="ignore", invalid="ignore"):
        work = jkr.apparent_work_of_adhesion(radius, penetration)
    is_contact = np.isfinite(work)
    count = np.count_nonzero(is_contact, axis=1)
    misfits, enough = np.full(zeros.size, np.inf), count >= FEWEST_STATES
    mean = np.sum(work[enough], axis=1, where=is_contact[enough]) / count[enough]
    curve = force_at(penetration[enough], mean[:, None])
    misfits[enough] = np.mean((part.force - curve) ** 2, axis=1)
    return misfits


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
