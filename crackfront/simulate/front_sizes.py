"""Sizes of the fronts on which numerical errors were measured and for which numerics are chosen.

A size is the number of states times the length of the front over the short cutoff. The loads of
each kind of contact know the usual one of their fronts; the laws that turn a size into numerics
stand in :mod:`crackfront.simulate.laws`, which no simulation needs.
"""

from __future__ import annotations

from crackfront.core.spectrum import Spectrum

LAW_SIZE = 4000.0
"""Size of the fronts on which the laws were measured: states times circumference over the short
cutoff, for eight states, cutoff 0.02 and mean radius 1.6."""

LAW_CUTOFF = 0.02
"""Short cutoff of all spectra of the laws. (Units: reduced lateral length)"""


def sphere_size(spectrum: Spectrum) -> float:
    """Size of a sphere's front for which settings are chosen: eight states, mean radius 1.6."""
    return LAW_SIZE * (LAW_CUTOFF / spectrum.short_cutoff)
