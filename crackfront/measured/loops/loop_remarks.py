"""Sentences on what a loop assumes, what it does not give, and what contradicts itself."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import REACH
from crackfront.analysis.steady_adhesion import Branches
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.loop_fit import best_modulus
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.loops.pull_off import pull_off_sentence
from crackfront.measured.loops.trends import trends
from crackfront.surfaces.written_units import prefixed

_LARGE = 0.3
"""Contact radius over the radius of the sphere, whose profile a paraboloid misses by 3%."""

_FAR = 1.5
"""Ratio of pull-off force and work of adhesion beyond which they contradict each other.

Roughness pins the edge also at pull-off, so that they are never quite equal.
"""

_SOFT = 0.1
"""Stiffness of the machine over the contact's below which the displacement shows its bending.

An error of the stiffness by 1% is then an error of the penetration by 10% of what the force causes.
"""

_LEAST_WORK, _MOST_WORK = 1e-3, 10.0
"""Works of adhesion of elastic solids lie between them. (Units: J/m^2)"""

_PENETRATION = "penetration|indentation|depth|eindring"
"""Names of a displacement that does not include the bending of the machine."""


def loop_remarks(
    loop: CalibratedLoop, result: MeasuredLoop, touches: NDArray[np.bool_], averaged: Branches
) -> Iterator[str]:
    """Remarks on a loop and its result.

    `touches` says which rows are in contact, `averaged` has the averaged rows of each branch.
    """
    yield from _branches(averaged)
    if not loop.has_force_and_radius:
        yield (
            "The zero of the displacement was fitted, with one work of adhesion for each branch. "
            "Its drift is not known, and no interval includes it."
        )
    yield from _exact_numbers(loop)
    yield from _size(result)
    yield from _magnitude(loop, result)
    if touches[0] or touches[-1]:
        which = "approach does not begin" if touches[0] else "retraction does not end"
        yield f"The energy lost is not known: the {which} out of contact."
    if result.hysteresis.high < 0:
        yield (
            "The hysteresis is negative, as in a loop whose rows are not in the order of time: "
            "check the order and the sign of the columns."
        )
    if not _has_radii_elsewhere(loop, touches):
        yield from _modulus_and_trends(loop, result, averaged)
    yield from _stiffness(loop, result)
    yield from _pull_off(result)


def _branches(averaged: Branches) -> Iterator[str]:
    """Which branch is missing, with what it leaves unknown."""
    names = ("approach", "w_appr"), ("retraction", "w_retr")
    for (branch, work), rows in zip(names, averaged, strict=True):
        if rows.size == 0:
            yield f"Without rows of the {branch} {work} and the hysteresis are unknown."


def _exact_numbers(loop: CalibratedLoop) -> Iterator[str]:
    """Which numbers of the rig have no error and count as exact."""
    rig = loop.rig
    exact = []
    if rig.contact_modulus is not None and rig.modulus_error == 0:
        exact.append(("modulus", "--modulus-error"))
    if rig.radius_error == 0:
        exact.append(("radius of the sphere", "--radius-error"))
    if exact:
        names, options = (" and ".join(texts) for texts in zip(*exact, strict=True))
        subject = "Both count" if len(exact) > 1 else "It counts"
        yield f"No error of the {names} is given. {subject} as exact; state {options}."


def _size(result: MeasuredLoop) -> Iterator[str]:
    """Whether the contact is not small compared with the sphere."""
    ratio = float(np.nanmax(result.contact_radius)) / result.sphere_radius
    if ratio > _LARGE:
        yield (
            f"The contact radius reaches {ratio:.2g} of the radius of the sphere, where a "
            "paraboloid misses its profile; the works of adhesion and the modulus belong to a "
            "paraboloid."
        )


def _magnitude(loop: CalibratedLoop, result: MeasuredLoop) -> Iterator[str]:
    """Whether a work of adhesion is so large or small that a unit is likely to be wrong.

    With a fitted modulus nothing else shows it: a force in a wrong unit changes both by one factor.
    """
    works = [work.value for work in (result.w_appr, result.w_retr) if work.value > 0]
    if all(_LEAST_WORK <= work <= _MOST_WORK for work in works):
        return
    heading = loop.recording.headings.get("force", "force")
    yield (
        f"Works of adhesion of {' and '.join(prefixed('J/m2', work) for work in works)} are "
        f"outside {prefixed('J/m2', _LEAST_WORK)} to {prefixed('J/m2', _MOST_WORK)}, where "
        f"elastic solids have them: check the unit of the column {heading!r} and the radius of the "
        "sphere."
    )


def _has_radii_elsewhere(loop: CalibratedLoop, touches: NDArray[np.bool_]) -> bool:
    """Whether rows out of contact have a radius: it is late, and fits no modulus."""
    radius = loop.recording.radius
    return radius is not None and bool(np.any(radius[~touches] > 0))


def _modulus_and_trends(
    loop: CalibratedLoop, result: MeasuredLoop, averaged: Branches
) -> Iterator[str]:
    """Whether the modulus of the rig contradicts the loop, or a work of adhesion changes in it.

    A wrong modulus changes both works along the window, a rate or an ageing surface mostly one.
    """
    sentences = trends(replace(loop, modulus=result.contact_modulus.value), averaged)
    modulus, fitted = loop.rig.contact_modulus, result.fitted_modulus
    if modulus is not None and math.isfinite(fitted.low) and len(sentences) != 1:
        least, most = (modulus * (1 + sign * REACH * loop.rig.modulus_error) for sign in (-1, 1))
        if least > fitted.high or most < fitted.low:
            yield (
                "Force and contact radius fit a contact modulus of "
                f"{prefixed('Pa', fitted.value, fitted.low, fitted.high)}, not "
                f"{prefixed('Pa', modulus)}: leave out --modulus, or check the radius of the "
                "sphere and the zero of the force."
            )
            return
    if loop.by_approach:
        best = best_modulus(loop.recording, loop.rig, averaged)
        yield (
            "The modulus by fit is the one of the approach; with the retraction it would be "
            f"{prefixed('Pa', best)}, as w_retr is not constant."
        )
    if len(sentences) == 2 and not loop.has_force_and_radius:
        yield (
            f"{' and '.join(sentences.values())}: one of them changes, which the fitted zero of "
            "the displacement shares between both, or modulus, radius or stiffness are wrong."
        )
        return
    for sentence in sentences.values():
        yield (
            f"{sentence}, as if it depended on the speed of the edge or on time: its mean depends "
            "on the window. Repeat at a tenth of the speed, or name a --window."
        )


def _stiffness(loop: CalibratedLoop, result: MeasuredLoop) -> Iterator[str]:
    """Whether the stiffness of the machine is unused, unknown, used twice or too small."""
    stiffness, heading = loop.rig.stiffness, loop.recording.headings.get("displacement", "")
    is_penetration = re.search(_PENETRATION, heading, re.IGNORECASE) is not None
    if loop.has_force_and_radius:
        if stiffness is not None:
            yield (
                "The given stiffness of the machine does not enter the works of adhesion: they "
                "follow from force and contact radius."
            )
        return
    if is_penetration and stiffness is not None:
        yield (
            f"By its name the column {heading!r} is the penetration, without the bending of the "
            "machine, which --stiffness subtracts again: leave out --stiffness, or name the travel "
            "of the mount by --displacement."
        )
    elif is_penetration:
        yield (
            f"The column {heading!r} counts as the penetration, without the bending of the machine."
        )
    elif stiffness is None:
        yield (
            "The machine is taken as infinitely stiff; give --stiffness unless it is far stiffer "
            "than the contact, 2 E' a."
        )
    if stiffness is not None:
        contact = 2 * loop.modulus * float(np.mean(result.window))
        if stiffness < _SOFT * contact:
            alone = pull_off_sentence(result.pull_off_force, result.sphere_radius)
            yield (
                f"The machine of {prefixed('N/m', stiffness)} is far softer than the contact, "
                f"2 E' a = {prefixed('N/m', contact)}: the displacement is mostly its bending, and "
                "an error of the stiffness, which no interval includes, spoils the works of "
                f"adhesion. {alone}".rstrip()
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
