"""The standard error of a mean over the states of a branch."""

from __future__ import annotations

import math

import numpy as np

from crackfront.core.arrays import Array

FEWEST_STATES = 3
"""Smallest number of steady states that gives a standard error."""

_INDEPENDENT_DISTANCE = 3.0
"""Distance between independent states (Units: rms roughness of the front); see docs/model.md."""


def standard_error(
    values: Array, radius: Array, roughness: Array, correlation_length: float
) -> float:
    """Standard error of the mean apparent work of adhesion over steady states of one branch.

    States count as independent if they are at least one distance apart: the correlation length of
    w_loc or three times the rms roughness of the front, whichever is larger. A rough front
    has to pass its own depth before it has left what pinned it (docs/model.md). Values and their
    error are in w_int, mean radii and rms roughness of the states in reduced lateral lengths.
    Infinite for fewer than :data:`FEWEST_STATES` states.
    """
    if values.size < FEWEST_STATES:
        return math.inf
    distance = max(correlation_length, _INDEPENDENT_DISTANCE * float(np.mean(roughness)))
    independent = min(values.size, 1 + np.ptp(radius) / distance)
    return float(np.std(values, ddof=1) / math.sqrt(independent))
