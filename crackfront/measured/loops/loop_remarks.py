"""Sentences on what a loop assumes, what it does not give, and what contradicts itself."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import REACH
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.surfaces.written_units import prefixed

_LARGE = 0.3
"""Contact radius over the radius of the sphere, whose profile a paraboloid misses by 3%."""

_FAR = 1.5
"""Ratio of pull-off force and work of adhesion beyond which they contradict each other.

Roughness pins the edge also at pull-off, so that they are never quite equal.
"""


def loop_remarks(
    loop: CalibratedLoop, result: MeasuredLoop, touches: NDArray[np.bool_]
) -> Iterator[str]:
    """Remarks on a loop and its result; `touches` says which rows are in contact."""
    if not loop.has_force_and_radius:
        yield (
            "The zero of the displacement was fitted, with one work of adhesion for each branch. "
            "Its drift is not known, and no interval includes it."
        )
    yield from _size(result)
    if touches[0] or touches[-1]:
        which = "approach does not begin" if touches[0] else "retraction does not end"
        yield f"The energy lost is not known: the {which} out of contact."
    if result.hysteresis.high < 0:
        yield (
            "The hysteresis is negative, as in a loop whose rows are not in the order of time: "
            "check the order and the sign of the columns."
        )
    yield from _modulus(loop, result)
    yield from _stiffness(loop)
    yield from _pull_off(result)


def _size(result: MeasuredLoop) -> Iterator[str]:
    """Whether the contact is not small compared with the sphere."""
    ratio = float(np.nanmax(result.contact_radius)) / result.sphere_radius
    if ratio > _LARGE:
        yield (
            f"The contact radius reaches {ratio:.2g} of that of the sphere, whose profile a "
            "paraboloid misses there; the works of adhesion and the modulus are those of a "
            "paraboloid."
        )


def _modulus(loop: CalibratedLoop, result: MeasuredLoop) -> Iterator[str]:
    """Whether the modulus that fits the loop contradicts the modulus of the rig."""
    modulus, fitted = loop.rig.contact_modulus, result.fitted_modulus
    if modulus is None or not math.isfinite(fitted.low):
        return
    least, most = (modulus * (1 + sign * REACH * loop.rig.modulus_error) for sign in (-1, 1))
    if least > fitted.high or most < fitted.low:
        yield (
            "Force and contact radius fit a contact modulus of "
            f"{prefixed('Pa', fitted.value, fitted.low, fitted.high)}, not "
            f"{prefixed('Pa', modulus)}: leave out --modulus, or check the radius of the sphere "
            "and the zero of the force."
        )


def _stiffness(loop: CalibratedLoop) -> Iterator[str]:
    """Whether a stiffness of the machine is given but not used, or used but not given."""
    is_given = loop.rig.stiffness is not None
    if is_given and loop.has_force_and_radius:
        yield (
            "The given stiffness of the machine has no part in the works of adhesion: they follow "
            "from force and contact radius."
        )
    elif not is_given and not loop.has_force_and_radius:
        yield (
            "The machine is taken as infinitely stiff; give --stiffness unless it is far stiffer "
            "than the contact, 2 E' a."
        )


def _pull_off(result: MeasuredLoop) -> Iterator[str]:
    """Whether the pull-off force contradicts the work of adhesion of the retraction.

    A retraction that does not end out of contact, whose lost energy is NaN, may end before it.
    """
    pull, work = result.pull_off_force, result.w_retr.value
    if pull.high <= 0:
        yield (
            "No force pulls in the retraction: check the zero of the force, the modulus and the "
            "stiffness of the machine."
        )
        return
    expected = 1.5 * math.pi * result.sphere_radius * work
    is_less = expected > _FAR * pull.high and math.isfinite(result.lost_energy)
    if is_less or pull.low > _FAR * expected:
        yield (
            f"A work of adhesion of {prefixed('J/m2', work)} pulls with up to "
            f"{prefixed('N', expected)}, and the loop with {prefixed('N', pull.value)}: check the "
            "units, the modulus, the radius of the sphere and the stiffness of the machine."
        )
