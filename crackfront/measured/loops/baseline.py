"""Zero and drift of the force, from the rows out of contact."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.measured.loops.contact_rows import (
    FEWEST_FREE_ROWS,
    rows_in_contact,
    rows_without_spikes,
)
from crackfront.measured.loops.recording import Recording
from crackfront.surfaces.written_units import prefixed

_BENT = 4.5
"""Curvature of the force out of contact over its error, beyond which the drift is not linear."""

_UNEVEN = 12.0
"""F ratio of a cubic over a line out of contact, beyond which the drift is not one line.

Normal noise of sixty rows exceeds it once in 20 000 recordings.
"""


@dataclass(frozen=True, slots=True)
class Baseline:
    """A recording whose force is zero out of contact, and how well this zero is determined."""

    recording: Recording
    """The columns, with the zero and the drift of the force subtracted."""
    zero: Array
    """The force that was subtracted from each row. (Units: N)"""
    errors: tuple[Array, ...] = ()
    """Independent errors of the force of all rows, each of one standard error. (Units: N)"""
    remark: str = ""
    """Sentence on how the zero was found; empty without a force."""


def baseline(recording: Recording) -> Baseline:
    """Subtract a line through the rows before and after the contact from the force.

    If only one side has enough rows, their mean is subtracted; if neither has, nothing is.
    """
    force, touches = recording.force, rows_in_contact(recording)
    if force is None:
        return Baseline(recording, np.zeros(touches.size))
    rows, touching = rows_without_spikes(force), np.flatnonzero(touches)
    rows = rows[~touches[rows]]
    sides = rows[rows < touching[0]], rows[rows > touching[-1]]
    sides_used = [side for side in sides if side.size >= FEWEST_FREE_ROWS]
    if not sides_used:
        sentence = "The zero of the force is taken from the file, as all rows are in contact."
        return Baseline(recording, np.zeros(touches.size), remark=sentence)
    has_drift = len(sides_used) == 2
    free = np.concatenate(sides_used)
    time, powers = free / force.size, np.vander(np.arange(force.size) / force.size, has_drift + 1)
    line, covariance = np.polyfit(time, force[free], int(has_drift), cov=True)
    # Independent errors of the line; a baseline may have no noise.
    squares, directions = np.linalg.eigh(covariance)
    errors = list((powers @ (directions * np.sqrt(np.maximum(squares, 0.0)))).T)
    if has_drift:
        errors += _bend(time, force[free], powers[:, 0])
    zero = powers @ line
    largest = prefixed("N", float(np.max(np.abs(zero[touching]))))
    kind = "a drift and a zero" if has_drift else "a zero"
    sentence = f"{free.size} rows out of contact give {kind} of the force, up to {largest}."
    if not has_drift:
        sentence += " Its drift is unknown, as no rows are out of contact on the other side."
    if has_drift and _is_uneven(time, force[free]):
        sentence += (
            " The force before and after the contact does not drift along one line: rows are not "
            "equally far apart in time, as with a rest, a gap or two rates of recording, or the "
            "drift changes. Cut out a rest, interpolate to equal times, or let the drift settle."
        )
    if recording.radius is not None:
        sentence += _radius_sentence(recording.radius > 0, touches)
    return Baseline(replace(recording, force=force - zero), zero, tuple(errors), sentence)


def _radius_sentence(has_radius: NDArray[np.bool_], touches: NDArray[np.bool_]) -> str:
    """Sentence on radii that begin or end in other rows than the force, with a blank before it."""
    (first, last), (begin, end) = (np.flatnonzero(rows)[[0, -1]] for rows in (has_radius, touches))
    if last > end:
        sentence = f" The contact radius is positive in {last - end} rows after the pull-off"
        if first > begin:
            sentence += f" and begins {first - begin} rows after the jump into contact"
        return (
            f"{sentence}: it was recorded late. Each row needs force and radius of one moment; "
            f"move the radii up by {last - end} rows."
        )
    if first < begin:
        return (
            f" The contact radius is positive from {begin - first} rows before the jump into "
            "contact: it was recorded early, or is not a contact there. Move the radii "
            f"down by {begin - first} rows, or empty those cells."
        )
    n_missing = first - begin + end - last
    if n_missing == 0:
        return ""
    return (
        f" {n_missing} rows next to the contact have a force and lack a contact radius: they count "
        "as contact, not as the zero. If the camera lags behind the force, move the radii up."
    )


def _bend(time: Array, force: Array, all_times: Array) -> list[Array]:
    """Error of a linear drift at all times, if a parabola fits the force significantly better."""
    parabola, covariance = np.polyfit(time, force, 2, cov=True)
    if abs(parabola[0]) <= _BENT * math.sqrt(max(covariance[0, 0], 0.0)):
        return []
    line = np.polyfit(time, force, 1)
    return [np.polyval(parabola, all_times) - np.polyval(line, all_times)]


def _is_uneven(time: Array, force: Array) -> bool:
    """Whether a cubic, with other slopes or a step between both sides, fits far better."""
    line, cubic = (
        float(np.sum((force - np.polyval(np.polyfit(time, force, order), time)) ** 2))
        for order in (1, 3)
    )
    return (line - cubic) / 2 > _UNEVEN * cubic / (force.size - 4)
