"""Energy that a loop loses."""

from __future__ import annotations

import math

import numpy as np
import scipy

from crackfront.analysis.steady_adhesion import Branches
from crackfront.core.arrays import Array
from crackfront.measured.loops.calibration import Contact


def lost_energy(displacement: Array | None, contact: Contact, branches: Branches) -> float:
    """Energy lost in a whole loop per largest contact area (Units: J/m^2).

    It is the work of the force along the displacement of the mount (Units: m), since the machine
    gives back what bends it; without a displacement, along the penetration.
    """
    rows = np.concatenate([branches[0], branches[1][1:]])
    moved = contact.penetration if displacement is None else displacement
    radius = contact.radius[rows]
    # The largest of noisy radii would be too large.
    radius = scipy.ndimage.median_filter(radius[np.isfinite(radius)], 5, mode="nearest")
    rows = rows[np.isfinite(moved[rows] + contact.force[rows])]
    return work_per_area(moved[rows], contact.force[rows], radius)


def work_per_area(displacement: Array, force: Array, radius: Array) -> float:
    """Work of the force over all states of a loop, per largest contact area.

    The loop is closed by the jumps, at the displacements of the first and the last contact.
    """
    work = float(np.sum(np.diff(displacement) * (force[1:] + force[:-1]) / 2))
    return work / (math.pi * float(np.max(radius)) ** 2)
