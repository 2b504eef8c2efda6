"""From a recording to works of adhesion, by the definition of simulations, with intervals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.analysis.steady_adhesion import Branches, Rows
from crackfront.core.arrays import Array
from crackfront.measured.loops.baseline import baseline
from crackfront.measured.loops.branches import (
    SteadyPart,
    branches,
    check_sign,
    present_branches,
    steady_part,
)
from crackfront.measured.loops.calibration import CalibratedLoop, Contact
from crackfront.measured.loops.contact_rows import rows_in_contact
from crackfront.measured.loops.intervals import Works, machine_stiffness, works_of_adhesion
from crackfront.measured.loops.loop_fit import fitted_modulus, fitted_zero
from crackfront.measured.loops.loop_remarks import loop_remarks
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.loops.lost_energy import lost_energy
from crackfront.measured.loops.pull_off import (
    PullOff,
    least_pull_off,
    pull_off,
    pull_off_sentence,
)
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from crackfront.measured.loops.saturation import without_saturated_rows
from crackfront.measured.loops.trends import retraction_changes_modulus
from crackfront.surfaces.written_units import prefixed

_MOST_LOST = 0.1
"""Part of the rows in contact that noise may leave without a work of adhesion.

Beyond it the other rows are not a fair sample.
"""

_FAR_BEYOND = 3.0
"""Force beyond the contact of Hertz, over its noise, that is not noise."""

_CLEAR_PULL = 4.0
"""Pull-off force over the noise of the force from which on contact is found without radii."""


def analyse_loop(measured: Recording, rig: Rig) -> MeasuredLoop:
    """Works of adhesion of approach and retraction of a measured loop.

    Every row has the apparent work of adhesion of a JKR contact of its force and radius. The works
    of adhesion are means over the rows of each branch within one window of contact radii, as in
    simulations; the window leaves out what the edge travels before it is steady.

    Parameters
    ----------
    measured : Recording
        Two of force, contact radius and displacement, or all three.
    rig : Rig
        The sphere and the machine.

    Returns
    -------
    MeasuredLoop
        Works of adhesion, modulus and more, with 95% intervals. These include the noise of the rows
        (one of ten blocks of each branch is left out in turn), the errors of modulus and radius
        that are given or fitted, the errors of the zeros of force and displacement, and what half
        of the window changes.

    Raises
    ------
    ValueError
        If the branches share too few rows, the loop turns more than once, a column has the wrong
        sign, noise hides the pull-off of a loop without radii, or no modulus is given and none can
        be fitted.
    """
    saturation = without_saturated_rows(measured)
    free = baseline(saturation.recording)
    recording = free.recording
    check_sign(recording)
    touches = rows_in_contact(recording)
    touching = present_branches(recording, branches(recording, touches), rig.segment)
    loop, steady = _calibrated(recording, rig, touching)
    contact = loop.contact()
    works = works_of_adhesion(loop, steady.averaged, free.errors)
    _check_works(works, steady.averaged)
    # Force and displacement count also in rows without a contact radius.
    pulling = steady.branches if recording.radius is None else touching
    pull = _pull_off(loop, contact, pulling[1], works, free.errors)
    if saturation.pull_rows.size:
        force = np.asarray(measured.force) - free.zero
        pull = replace(pull, force=least_pull_off(force, saturation.pull_rows, free.errors))
    if recording.radius is None:
        _check_noise(loop, contact, touching, pull)
    is_closed = min(rows.size for rows in touching) > 0 and not (touches[0] or touches[-1])
    energy = math.nan
    if is_closed and not saturation.lost_force:
        closed = steady.branches if recording.displacement is None else pulling
        energy = lost_energy(recording.displacement, contact, closed)
    result = MeasuredLoop(
        force=contact.force,
        contact_radius=contact.radius,
        work_of_adhesion=contact.work_of_adhesion,
        direction=_direction(steady.branches, contact.force.size),
        in_window=np.isin(np.arange(contact.force.size), np.concatenate(steady.averaged)),
        w_appr=works.w_appr,
        w_retr=works.w_retr,
        hysteresis=works.hysteresis,
        contact_modulus=works.modulus,
        fitted_modulus=_modulus_by_fit(loop, steady.averaged, free.errors),
        stiffness=machine_stiffness(loop, works.modulus, steady.averaged),
        lost_energy=energy,
        pull_off_force=pull.force,
        sphere_radius=rig.radius,
        window=steady.window,
    )
    first = (free.remark,) if free.remark else ()
    remarks = loop_remarks(loop, result, touches, steady.averaged)
    return replace(result, remarks=(*measured.remarks, *saturation.remarks, *first, *remarks))


def _calibrated(
    recording: Recording, rig: Rig, touching: Branches
) -> tuple[CalibratedLoop, SteadyPart]:
    """Loop with its modulus and its zero of the displacement, and its steady part."""
    modulus = rig.contact_modulus
    if recording.force is not None and recording.radius is not None:
        # The fit also shows a force of the wrong sign.
        fitted = fitted_modulus(recording, rig, touching)
        modulus = modulus or fitted
    if modulus is None:
        raise ValueError(
            "without a contact radius and a force in each row no modulus is fitted; give --modulus"
        )
    loop = CalibratedLoop(recording, rig, modulus)
    loop = replace(loop, zero=fitted_zero(loop, touching))
    steady = steady_part(loop, loop.contact(), touching)
    if not loop.has_force_and_radius:
        # Rows before the steady parts do not enter the zero.
        loop = replace(loop, zero=fitted_zero(loop, steady.averaged, near=loop.zero))
        steady = steady_part(loop, loop.contact(), touching)
    by_approach = retraction_changes_modulus(loop, steady.averaged)
    return replace(loop, by_approach=by_approach), steady


def _modulus_by_fit(
    loop: CalibratedLoop, averaged: Branches, errors: tuple[Array, ...]
) -> Estimate[float]:
    """Contact modulus that fits force and radius, whether or not the rig states one."""
    if not loop.has_force_and_radius:
        return UNKNOWN
    rig = replace(loop.rig, contact_modulus=None, modulus_error=0.0)
    return works_of_adhesion(replace(loop, rig=rig), averaged, errors).modulus


def _pull_off(
    loop: CalibratedLoop,
    contact: Contact,
    retraction: Rows,
    works: Works,
    errors: tuple[Array, ...],
) -> PullOff:
    """Pull-off force, with the errors of the zero of the force; unknown without a retraction."""
    if retraction.size == 0:
        return PullOff(UNKNOWN, math.nan)
    if loop.recording.force is None:
        # Forces that follow from radii have the relative error of their work of adhesion.
        errors = (contact.force * (works.w_retr.standard_error / works.w_retr.value),)
    return pull_off(contact.force, retraction, errors)


def _check_works(works: Works, averaged: Branches) -> None:
    """Raise ValueError if works of adhesion have no interval, or no adhesion pulls."""
    measured = [
        work for work, rows in zip((works.w_appr, works.w_retr), averaged, strict=True) if rows.size
    ]
    if len(measured) == 2:
        measured.append(works.hysteresis)
    if not all(math.isfinite(work.high) for work in measured):
        raise ValueError(
            "the works of adhesion have no interval: the noise of the force, or the error of its "
            "zero, is as large as the adhesion in some rows; check the units and the modulus, "
            "press less, or record the contact radius"
        )
    if works.w_retr.value <= 0:
        raise ValueError(
            "the work of adhesion of the retraction is not positive; give --stiffness if the "
            "machine is not far stiffer than the contact, and check the displacement, the modulus "
            "and the radius of the sphere"
        )


def _check_noise(loop: CalibratedLoop, contact: Contact, touching: Branches, pull: PullOff) -> None:
    """Raise ValueError if noise hides the pull-off, or the work of adhesion of too many rows."""
    if 0 < pull.force.value < _CLEAR_PULL * pull.noise:
        raise ValueError(
            f"the pull-off force, {prefixed('N', pull.force.value)}, is hardly beyond the noise of "
            f"the force, {prefixed('N', pull.noise)}; press less, average rows, or record the "
            "contact radius"
        )
    rows = np.concatenate(touching)
    measured = rows[np.isfinite((contact.force + contact.penetration)[rows])]
    lost = measured[~np.isfinite(contact.work_of_adhesion[measured])]
    part = lost.size / measured.size
    if loop.rig.window is not None or part <= _MOST_LOST:
        return
    sentence = f"{part:.0%} of the rows in contact have no work of adhesion, as "
    if _is_beyond_noise(loop, contact, lost, pull.noise):
        sentence += (
            "they press more than the contact of Hertz, by more than the noise: a contact modulus "
            f"of {prefixed('Pa', loop.modulus)} does not fit the loop, or the stiffness of the "
            "machine or the radius of the sphere is wrong; check --modulus, --stiffness and "
            "--radius, or record the contact radius"
        )
    else:
        sentence += (
            "noise presses more than the contact of Hertz; check the units, the modulus and "
            "--stiffness, average rows, use a stiffer machine, or record the contact radius"
        )
    raise ValueError(f"{sentence}. {pull_off_sentence(pull.force, loop.rig.radius)}".strip(". "))


def _is_beyond_noise(loop: CalibratedLoop, contact: Contact, lost: Rows, noise: float) -> bool:
    """Whether rows press more than the contact of Hertz by more than the noise of the force."""
    scales = loop.scales
    penetration = np.maximum(contact.penetration[lost] / scales.vertical, 0.0)
    excess = contact.force[lost] - scales.force * penetration**1.5
    # The noise also bends the machine in the record, and the contact responds with 3/2 b^(1/2).
    amplified = noise * (1 + 1.5 * loop.compliance * np.sqrt(penetration))
    return bool(np.median(excess / amplified) > _FAR_BEYOND)


def _direction(branches: Branches, n_row: int) -> Array:
    """1 in approach, -1 in retraction, 0 elsewhere."""
    direction = np.zeros(n_row)
    direction[branches[0]] = 1
    direction[branches[1]] = -1
    return direction
