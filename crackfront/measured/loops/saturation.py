"""Rows in which a detector or an actuator was at the end of its range."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from crackfront.analysis.steady_adhesion import Rows
from crackfront.core.arrays import Array
from crackfront.measured.loops.contact_rows import rows_in_contact
from crackfront.measured.loops.recording import UNITS, Recording
from crackfront.surfaces.written_units import prefixed

_FEWEST = 4
"""Rows at the end of a range, and their number over the usual number in as many levels."""

_STEEPNESS = 6
"""Rows at the end of a range over the rows in as many levels next to it.

The rounded values of a smooth extreme have 2.4 times as many there, up to 4 with noise.
"""

_LEVELS = (1, 3)
"""Levels of a converter that are the end of its range: it may jitter by one step."""

_LIMITED = {"force": "the detector of the force", "radius": "the field of view of the camera"}
"""What ends the range of a column; else the travel of the mount."""


@dataclass(frozen=True, slots=True)
class Saturation:
    """A recording without the values at the ends of a range."""

    recording: Recording
    """The columns, NaN where one of them is at the end of its range."""
    pull_rows: Rows
    """Rows whose pulling force is at the end of the range of its detector."""
    lost_force: bool
    """Whether rows of the force were left out, so that its work is unknown."""
    remarks: tuple[str, ...]
    """A sentence on each column with such values."""


def without_saturated_rows(recording: Recording) -> Saturation:
    """Leave out rows in contact in which a column is at the end of its range.

    Many rows have the same extreme value there, while another column changes: the force at its
    smallest or largest value, radius and displacement at their largest.
    """
    touching = np.flatnonzero(rows_in_contact(recording))
    columns, remarks = {}, []
    pull_rows, lost_force = np.zeros(0, int), False
    for name, unit in UNITS.items():
        column = getattr(recording, name)
        if column is None:
            continue
        high = _rows_at_end(column, touching, _rows_before_turn(recording, name, touching))
        low = high[:0]
        if name == "force":
            low = _rows_at_end(-column, touching, touching)
            pull_rows, lost_force = low, low.size + high.size > 0
        columns[name] = column.copy()
        columns[name][np.concatenate([low, high])] = np.nan
        for rows, extreme in ((low, "smallest"), (high, "largest")):
            if rows.size:
                value = prefixed(unit, float(column[rows[0]]))
                end = _LIMITED.get(name, "the travel of the mount")
                unknown = "; the energy lost is unknown" if name == "force" else ""
                remarks.append(
                    f"{rows.size} rows in contact have the {extreme} {name}, {value}, where {end} "
                    f"seems to end. These rows are not used{unknown}."
                )
    return Saturation(replace(recording, **columns), pull_rows, lost_force, tuple(remarks))


def _rows_before_turn(recording: Recording, name: str, touching: Rows) -> Rows:
    """Rows in contact up to the turn, which is the largest value of another column.

    After it an edge is pinned, and a rig may rest: a column is constant without a limit.
    """
    driving_column = next(
        column
        for column in (recording.displacement, recording.force, recording.radius)
        if column is not None and column is not getattr(recording, name)
    )
    turn = touching[np.nanargmax(driving_column[touching])]
    return touching[touching < int(turn)]


def _rows_at_end(column: Array, touching: Rows, compared: Rows) -> Rows:
    """Rows in contact with the largest value of a column, if the compared rows show its limit."""
    values = column[compared][np.isfinite(column[compared])]
    steps = np.diff(np.unique(values))
    if steps.size == 0:
        return touching[:0]
    step, end = float(np.min(steps)), float(np.max(values))
    for n_level in _LEVELS:
        # Half a step allows for the last bits.
        lowest = end - (n_level - 0.5) * step
        n_end = int(np.sum(values >= lowest))
        n_next = int(np.sum(values >= lowest - n_level * step)) - n_end
        usual = values.size * n_level * step / float(np.ptp(values))
        if n_end >= max(_FEWEST, _STEEPNESS * n_next, _FEWEST * usual):
            return touching[column[touching] >= lowest]
    return touching[:0]
