"""What the instabilities of Fig. 3a and b dissipate, how wide they are, and the radii at b = 0."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from crackfront.core.adhesion import correlation_length
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.studies.paper.contact import STRONG, WEAK
from crackfront.studies.paper.figure import Check, close_to
from crackfront.studies.paper.instabilities import InstabilityRecord


def instability_checks(record: InstabilityRecord) -> tuple[Check, ...]:
    """Energies and extents of the instabilities, and the radii at b = 0.

    Parameters
    ----------
    record : InstabilityRecord
        Data of the figure.
    """
    checks = []
    for index, name in ((STRONG, "strong"), (WEAK, "weak")):
        checks += [*_energy_checks(record, index, name), _extent_check(record, index, name)]
    inner, outer = radii_at_zero(record)
    smallest = [smallest_extent(record, index) for index in (STRONG, WEAK)]
    larkin = record.larkin_length[WEAK] / record.larkin_length[STRONG]
    checks += [
        Check(
            "the smallest extent grows for weaker disorder",
            "> 1",
            f"{smallest[WEAK] / smallest[STRONG]:.3g} times",
            smallest[WEAK] > smallest[STRONG],
            f"Larkin lengths: {larkin:.3g} times",
        ),
        Check(
            "b = 0: the radius in approach (A) is below that in retraction (B)",
            "a(A) < a(B)",
            f"{inner:.4f} < {outer:.4f}",
            inner < outer,
            "strong disorder; reduced lateral length",
        ),
    ]
    return tuple(checks)


def smallest_extent(record: InstabilityRecord, index: int) -> float:
    """Extent that a tenth of the instabilities of one disorder stay below."""
    return float(np.quantile(record.extent[record.disorder_index == index], 0.1))


def radii_at_zero(record: InstabilityRecord) -> tuple[float, float]:
    """Mean radii of the states A and B at b = 0, in approach and in retraction."""
    zero = record.state_penetration == 0
    radii = [record.state_radius[zero & (record.state_direction == sign)] for sign in (1, -1)]
    return float(radii[0][0]), float(radii[1][-1])


def _energy_checks(record: InstabilityRecord, index: int, name: str) -> Iterable[Check]:
    """Signs and sum of the energies that one retraction dissipates."""
    energy = record.energy[record.disorder_index == index]
    yield Check(
        f"{name} disorder: every instability dissipates energy",
        "> 0",
        f"{energy.size} from {energy.min():.2g} to {energy.max():.2g}",
        bool(np.all(energy > 0)),
        "reduced energy",
    )
    lost = record.work[index] - record.energy_change[index]
    yield close_to(
        f"{name} disorder: the instabilities dissipate the work that is not stored",
        float(np.sum(energy)) / lost,
        1.0,
        0.02,
        remark=f"smooth steps add {record.smooth_energy[index] / lost:.2g} where each is taken at "
        "fixed penetration, in proportion to its size; integral of F db by trapezia over all "
        "steps, from the turn to the last state, pull-off not included",
    )


def _extent_check(record: InstabilityRecord, index: int, name: str) -> Check:
    """Smallest extent of one disorder against the length that pins collectively."""
    larkin, found = float(record.larkin_length[index]), smallest_extent(record, index)
    correlation = correlation_length(
        "roughness", SelfAffineSpectrum(record.short_cutoff, record.short_cutoff, hurst=1.0)
    )
    expected = max(larkin, correlation)
    return Check(
        f"{name} disorder: smallest extent, the Larkin length or, if that is shorter, the "
        "correlation length of w_loc",
        f"{expected:.3g}, within a factor of 2",
        f"{found:.3g}",
        expected / 2 < found < expected * 2,
        f"tenth percentile of area over depth; Larkin length {larkin:.3g}, whose factor is a "
        f"convention; correlation length {correlation:.3g}",
    )
