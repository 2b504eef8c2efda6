"""Zero and drift of the force, from the rows out of contact."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

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


@dataclass(frozen=True, slots=True)
class Baseline:
    """A recording whose force is zero out of contact, and how well this zero is determined."""

    recording: Recording
    """The columns, with the zero and the drift of the force subtracted."""
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
        return Baseline(recording)
    rows, touching = rows_without_spikes(force), np.flatnonzero(touches)
    rows = rows[~touches[rows]]
    sides = rows[rows < touching[0]], rows[rows > touching[-1]]
    sides_used = [side for side in sides if side.size >= FEWEST_FREE_ROWS]
    if not sides_used:
        sentence = "The zero of the force is that of the file, as no rows are out of contact."
        return Baseline(recording, remark=sentence)
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
    return Baseline(replace(recording, force=force - zero), tuple(errors), sentence)


def _bend(time: Array, force: Array, all_times: Array) -> list[Array]:
    """Error of a linear drift at all times, if a parabola fits the force significantly better."""
    parabola, covariance = np.polyfit(time, force, 2, cov=True)
    if abs(parabola[0]) <= _BENT * math.sqrt(max(covariance[0, 0], 0.0)):
        return []
    line = np.polyfit(time, force, 1)
    return [np.polyval(parabola, all_times) - np.polyval(line, all_times)]
