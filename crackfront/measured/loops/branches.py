"""Approach and retraction of a loop, and the steady part of each, which is averaged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import Branches, shared_window, within
from crackfront.core.arrays import Array
from crackfront.measured.loops.calibration import CalibratedLoop, Contact
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Segment
from crackfront.surfaces.written_units import prefixed

_AFTER_JUMP = 0.02
"""Travel of the edge before the approach is steady, over the largest contact radius.

A jump into contact leaves nothing behind.
"""

_AFTER_TURN = 0.1
"""Travel of the edge before the retraction is steady, over the largest contact radius.

The edge has to leave what pinned it in approach; `python -m studies accuracy loops` compares the
intervals with simulated spheres.
"""

_RETURN = 0.2
"""Part of the largest travel by which mount or edge may come back within a branch.

Noise and instabilities move the edge by less, a second turn by more.
"""

_LEAST_TRAVEL = 0.1
"""Travel of a branch over the travel of the other, below which few rows are not a branch."""

_FEWEST_ROWS = 2 * FEWEST_STATES
"""Averaged rows of each branch, so that both halves of the window have enough."""


_BRANCH_NAMES = ("approach", "retraction")


@dataclass(frozen=True, slots=True)
class SteadyPart:
    """Rows of a calibrated loop that have a work of adhesion, and those that are averaged."""

    branches: Branches
    """Rows of approach and of retraction that have a work of adhesion."""
    averaged: Branches
    """Rows of both within the window, after the edge has travelled."""
    window: tuple[float, float]
    """Smallest and largest contact radius that are averaged. (Units: m)"""


def driving(recording: Recording) -> Array:
    """The column that the machine drives: displacement (Units: m), or force (Units: N)."""
    return np.asarray(recording.force if recording.displacement is None else recording.displacement)


def check_sign(recording: Recording) -> None:
    """Raise ValueError if the force pulls where the contact is largest or the sphere deepest."""
    force = recording.force
    path, place = recording.displacement, "displacement"
    if path is None:
        path, place = recording.radius, "contact radius"
    if force is None or path is None or not np.any(np.isfinite(force + path)):
        return
    turn = int(np.nanargmax(np.where(np.isfinite(force), path, np.nan)))
    if force[turn] < min(0.5 * np.nanmin(force), 0.0):
        raise ValueError(
            f"the force is {prefixed('N', float(force[turn]))} at the largest {place}, and "
            "has the wrong sign; displacement and force are positive where they press. Give "
            "--invert force (invert='force'), or displacement if its sign is wrong"
        )


def branches(recording: Recording, touches: NDArray[np.bool_]) -> Branches:
    """Rows in contact of approach and of retraction, which share the row of the turn.

    The turn is at the largest displacement, or at the largest force. Raises ValueError if the loop
    turns more than once.
    """
    driven = driving(recording)
    rows = np.flatnonzero(touches & np.isfinite(driven))
    turn = int(np.argmax(driven[rows]))
    approach, retraction = rows[: turn + 1], rows[turn:]
    # The force may fall within a branch, as at a jump; the radius may not.
    path = driven if recording.displacement is not None else np.asarray(recording.radius)
    span = float(np.nanmax(path[rows]) - np.nanmin(path[rows]))
    for direction, branch in ((1, approach), (-1, retraction)):
        recorded = path[branch][np.isfinite(path[branch])]
        # The median of five rows is free of their noise.
        smooth = direction * scipy.ndimage.median_filter(recorded, 5, mode="nearest")
        returns = np.maximum.accumulate(smooth) - smooth
        if smooth.size and float(np.max(returns)) > _RETURN * span:
            raise ValueError(
                "the loop turns more than once, or a column has the wrong sign; displacement and "
                "force are positive where they press. Cut the table to one approach and one "
                "retraction, or give --invert displacement (invert='displacement')"
            )
    return approach, retraction


def present_branches(recording: Recording, touching: Branches, segment: Segment) -> Branches:
    """Rows of the branches that are evaluated: of a segment, or of what was recorded.

    A branch with a small part of the travel of the other, as at the turn of a recorded retraction,
    lacks rows. Raises ValueError if the segment was not recorded.
    """
    path = np.asarray(recording.displacement if recording.radius is None else recording.radius)
    recorded = [path[rows][np.isfinite(path[rows])] for rows in touching]
    spans = [float(np.ptp(values)) if values.size else 0.0 for values in recorded]
    approach, retraction = touching
    if recorded[0].size < _FEWEST_ROWS and spans[0] < _LEAST_TRAVEL * spans[1]:
        approach = approach[:0]
    if recorded[1].size < _FEWEST_ROWS and spans[1] < _LEAST_TRAVEL * spans[0]:
        retraction = retraction[:0]
    if segment == "approach":
        retraction = retraction[:0]
    elif segment == "retract":
        approach = approach[:0]
    if approach.size + retraction.size == 0:
        raise ValueError(
            f"the loop lacks rows in contact of the segment {segment}; record them, or choose the "
            "other one"
        )
    return approach, retraction


def steady_part(loop: CalibratedLoop, contact: Contact, touching: Branches) -> SteadyPart:
    """Rows of both branches within the window of the rig, or what both pass when they are steady.

    Raises ValueError if a contact is larger than the sphere, or too few rows are averaged.
    """
    radius, window = contact.radius, loop.rig.window
    approach, retraction = (rows[np.isfinite(contact.work_of_adhesion[rows])] for rows in touching)
    in_contact = radius[np.concatenate([approach, retraction])]
    _check_below_sphere(in_contact, loop.rig.radius)
    has_both = all(rows.size for rows in touching)
    # The row of the turn belongs to both branches.
    if has_both and min(approach.size, retraction.size) <= 1:
        raise ValueError("the loop lacks an approach or a retraction in contact; record both")
    if window is None:
        averaged, window = _steady_rows(radius, approach, retraction)
        branch = "that both pass after" if has_both else "after"
        range_of_radii = f"{branch} the edge has travelled"
        advice = "retract further, record more rows, check the modulus, or name a --window"
    else:
        averaged = within(radius, (approach, retraction), window)
        range_of_radii = "within the window"
        low, high = (prefixed("m", float(end(in_contact))) for end in (np.min, np.max))
        advice = f"choose another one; the radii are {low} to {high}"
    _check_enough_rows(touching, averaged, range_of_radii, advice)
    return SteadyPart((approach, retraction), averaged, window)


def _check_below_sphere(radii: Array, sphere_radius: float) -> None:
    """Raise if a contact is larger than the sphere."""
    if radii.size and np.max(radii) > sphere_radius:
        largest = prefixed("m", float(np.max(radii)))
        raise ValueError(
            f"the contact radius reaches {largest} on a sphere of "
            f"{prefixed('m', sphere_radius)}; check the units of both"
        )


def _check_enough_rows(
    touching: Branches, averaged: Branches, range_of_radii: str, advice: str
) -> None:
    """Raise if a branch that touches has too few rows to average."""
    counts = {
        name: rows.size
        for name, rows, touched in zip(_BRANCH_NAMES, averaged, touching, strict=True)
        if touched.size
    }
    if min(counts.values()) >= _FEWEST_ROWS:
        return
    numbers = " and ".join(map(str, counts.values())) if any(counts.values()) else "no"
    verb, per_branch = ("have", " each") if len(counts) == 2 else ("has", "")
    if max(counts.values()) >= _FEWEST_ROWS:
        advice += ", or evaluate the other branch alone by --segment"
    raise ValueError(
        f"{' and '.join(counts)} {verb} {numbers} rows at contact radii {range_of_radii}; "
        f"{_FEWEST_ROWS}{per_branch} are needed, so {advice}"
    )


def _steady_rows(
    radius: Array, approach: NDArray[np.int64], retraction: NDArray[np.int64]
) -> tuple[Branches, tuple[float, float]]:
    """Rows at the contact radii that both branches pass after the edge has travelled, and these.

    If one branch lacks rows, the radii of the other count.
    """
    largest = float(radius[np.concatenate([approach, retraction])].max(initial=0.0))
    began = radius[approach].min(initial=math.inf)
    turned = radius[retraction].max(initial=0.0)
    steady = (
        approach[radius[approach] >= began + _AFTER_JUMP * largest],
        retraction[radius[retraction] <= turned - _AFTER_TURN * largest],
    )
    if min(approach.size, retraction.size) == 0 < steady[0].size + steady[1].size:
        ends = radius[np.concatenate(steady)]
        return steady, (float(ends.min()), float(ends.max()))
    if min(rows.size for rows in steady) == 0:
        return steady, (math.nan, math.nan)
    return shared_window(radius, steady)
