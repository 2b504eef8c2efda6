"""Codes with which compiled solvers and their steps end."""

from __future__ import annotations

import enum


class Code(enum.IntEnum):
    """How a relaxation, or a step of it, ended."""

    MOVING = 0
    """Nothing has ended: the front lies inside the field and may go on."""

    CONVERGED = 1
    """The drives are below the tolerance."""

    LEFT_FIELD_INWARD = 2
    """A site receded beyond the first sample of its ray."""

    LEFT_FIELD_OUTWARD = 3
    """A site advanced beyond the last sample of its ray."""

    SWEEP_LIMIT = 4
    """The limit on the sweeps is reached."""

    STANDS_STILL = 5
    """Drives are left, but they move no site by the last digit of its place."""

    PASSED_EQUILIBRIUM = 6
    """A site is driven backward by more than round-off explains, which is a defect."""

    FIELD_TOO_STEEP = 7
    """A site is driven backward by round-off of its place; the reference goes on."""

    PASSES_LOWEST = 8
    """A step of the whole front would move a site beyond the lowest place; windows go on."""

    MET_NEEDLES = 9
    """Before a step of the whole front: the field is much stiffer than the line at some site."""
