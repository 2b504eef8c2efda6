"""Remarks on a measured surface: its scans and its spectrum."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from crackfront.measured.density.bands import Scan
from crackfront.measured.prediction.next_scan import LEAST_MEASURED, NOTABLE_SHARE, measure_next
from crackfront.measured.prediction.remarks import Remark
from crackfront.measured.scan.channels import is_doubtful
from crackfront.measured.spectrum.joining import JointSpectrum, part_of_energy
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.surfaces.written_units import prefixed

_MOST_ANISOTROPY = 1.25
"""Ratio of rms slopes in perpendicular directions above which there is a reservation."""

_MOST_STRIPES = 0.5
"""Part of e_el in waves that are left out as shifted rows, above which there is a reservation."""

_MOST_UNMEASURED = 0.1
"""Additional e_el of shorter waves, relative to e_el, above which there is a reservation."""

_MOST_UNSETTLED = 0.009
"""Standard error of the ends of intervals over their width, above which there is a reservation.

Intervals with other seeds then differ by 2 to 3% of the width."""

_LEAST_UNEVEN = 0.02
"""Relative standard error of e_el by unevenness above which there is a note."""

_HURST_EDGE = 0.05
"""Distance of a Hurst exponent from 0 or 1 below which there is a reservation."""

_NOT_CHECKED = (
    "Without heights it cannot be checked whether the roughness is random (no wave that stands "
    "out), isotropic and Gaussian, nor what instrument and noise did to the spectrum."
)

_EXACT = (
    "The spectrum is taken as exact: intervals only include the errors of the law of k and of the "
    "ratio to boundary elements."
)


def surface_remarks(surface: Surface) -> list[Remark]:
    """All remarks on a surface that do not depend on a sphere."""
    return [
        *channel_remarks(surface),
        *spectrum_remarks(surface),
        *scan_remarks(surface.scans),
        measure_next(surface),
    ]


def scan_remarks(scans: Iterable[Scan], contact_radius: float | None = None) -> Iterator[Remark]:
    """Remarks on the treatment of scans, and on scans smaller than a contact (Units: m)."""
    for scan in scans:
        path = str(scan.measurement.path)
        for sentence in scan.measurement.outliers:
            yield Remark(path, "reservation", f"{path}: {sentence}.")
        for sentence in scan.measurement.unusable:
            yield Remark(path, "reservation", f"Left out of the container: {sentence}.")
        for sentence in _treatments(scan):
            yield Remark(path, "note", sentence)
        if contact_radius is not None and min(scan.measurement.size) < 2 * contact_radius:
            yield Remark(
                path,
                "note",
                f"{path} is smaller than the contact ({1e6 * min(scan.measurement.size):.3g} um "
                f"against {2e6 * contact_radius:.3g} um across): its spectrum represents the "
                "whole surface.",
            )


def _treatments(scan: Scan) -> Iterator[str]:
    """Sentences on corrections, assumptions and left-out waves of a scan."""
    measurement, path = scan.measurement, scan.measurement.path
    if measurement.missing > 0:
        missing, weight = 100 * measurement.missing, 100 * scan.missing_weight
        yield (
            f"{path}: {missing:.2g}% of the points were missing and interpolated, {weight:.2g}% by "
            "the weight of the window; the density is corrected for the interpolation, by its "
            "effect on random surfaces of the same density."
        )
    if measurement.is_line:
        yield (
            f"{path} is a line scan: its density is converted to the density of an "
            "isotropic surface with this projection."
        )
    elif max(measurement.pixels) > 1.001 * min(measurement.pixels):
        yield (
            f"{path}: the pixels are oblong; the density covers the waves that both sides resolve."
        )
    if measurement.tip_is_assumed:
        yield (
            f"{path}: the file does not state the radius of the tip, which is assumed to be "
            f"{1e9 * measurement.tip_radius:g} nm; --tip-radius gives another."
        )
    if most := measurement.log_hidden_energy:
        yield (
            f"{path}: valleys are deep, and the tip may not reach into narrow ones; e_el may "
            f"be {np.exp(most):.1g} times as large, which its interval includes."
        )
    if scan.unevenness > _LEAST_UNEVEN:
        yield (
            f"{path}: parts of the scan differ more than for a Gaussian surface, so that "
            f"e_el is known to {scan.unevenness:.1%} at best."
        )
    for axis in scan.band.stripes:
        yield (
            f"{path}: the density of waves along {'xy'[axis]} alone differs from all "
            "others, as if rows were shifted or levelled one by one; these waves are left out."
        )


def channel_remarks(surface: Surface) -> Iterator[Remark]:
    """Reservations on scans whose channel may not contain heights."""
    for measurement in (scan.measurement for scan in surface.scans):
        if is_doubtful(measurement.channel):
            yield Remark(
                str(measurement.path),
                "reservation",
                f"{measurement.path}: channel {measurement.channel} has a unit of length, but "
                "the name of a quantity other than heights; --list-channels lists all channels.",
            )


def spectrum_remarks(surface: Surface) -> Iterator[Remark]:
    """Reservations on the spectrum of a surface, beginning with scans that disagree.

    Without scans they say what cannot be checked.
    """
    if isinstance(surface, StatedSurface):
        for sentence in (*surface.doubts, _NOT_CHECKED):
            yield Remark("spectrum", "reservation", sentence)
        yield Remark("spectrum", "note", _EXACT)
        return
    yield from disagreements(surface)
    for scan in surface.scans:
        path, (ratio, angle) = str(scan.measurement.path), scan.band.anisotropy
        if ratio > _MOST_ANISOTROPY:
            yield Remark(
                path,
                "reservation",
                f"{path}: the rms slope at {angle:.0f} degrees from x is {ratio:.2g} times the "
                "slope perpendicular to it; the theory is for isotropic surfaces.",
            )
        if scan.band.stripes_share > _MOST_STRIPES:
            axes = " and ".join("xy"[axis] for axis in scan.band.stripes)
            yield Remark(
                path,
                "reservation",
                f"{path}: {scan.band.stripes_share:.0%} of e_el would be in waves along {axes} "
                "alone, which are left out as rows that the instrument has shifted; if they are "
                "grooves of the surface, e_el is far too low and the theory does not apply.",
            )
    for sentence in _spectrum_doubts(surface.joint):
        yield Remark("spectrum", "reservation", sentence)


def is_lower_bound(surface: Surface) -> bool:
    """Whether e_el is a lower bound, because shorter waves would add to it."""
    return surface.shares.missing_short.value > _MOST_UNMEASURED


def disagreements(surface: Surface) -> Iterator[Remark]:
    """Reservations on scans whose density differs from the other scans."""
    if isinstance(surface, StatedSurface):
        return
    density = surface.joint.density
    for index, scan in enumerate(surface.scans):
        if density.disagrees(index):
            path, level = str(scan.measurement.path), density.levels[index]
            yield Remark(
                path,
                "reservation",
                f"{path} disagrees with the other scans: its density is {level.value:.2g} "
                f"({level.low:.2g} to {level.high:.2g}) times theirs where they overlap; the "
                "intervals include this difference.",
            )


def _spectrum_doubts(joint: JointSpectrum) -> Iterator[str]:
    """Sentences on unmeasured parts of the spectrum, and on imprecise intervals."""
    if joint.shares.measured < LEAST_MEASURED:
        yield (
            f"Only {joint.shares.measured:.0%} of e_el is measured, the rest comes from a model."
        )
    if joint.draws.unsettled > _MOST_UNSETTLED:
        yield (
            "The ends of the intervals have a standard error of "
            f"{joint.draws.unsettled:.1%} of their width: the {len(joint.draws.weight)} weighted "
            f"spectra that were drawn count as {joint.draws.effective:.0f} of equal weight."
        )
    hurst = joint.fit.hurst.value
    longer = joint.shares.continued_long
    continued = joint.shares.continued - longer.value
    if min(hurst, 1 - hurst) < _HURST_EDGE and continued > NOTABLE_SHARE:
        yield (
            f"The Hurst exponent of the shortest waves, {hurst:.2g}, is at the edge of the fitted "
            f"range, 0 to 1: waves shorter than the measured ones have {continued:.0%} of e_el, by "
            "a model that may not describe the surface."
        )
    if not joint.fit.has_roll_off and longer.high > NOTABLE_SHARE:
        yield (
            "The density shows no plateau within the trusted wavelengths: longer waves have "
            f"{part_of_energy(longer)}, with roll-offs of up to four sides of the scan; the "
            "interval of e_el includes this range."
        )
    if joint.shares.missing_short.value > _MOST_UNMEASURED:
        yield (
            f"Waves shorter than {prefixed('m', joint.spectrum.short_cutoff)}, where points, "
            "instrument or noise end the spectrum, are left out of all numbers and intervals: down "
            f"to {prefixed('m', joint.extended.short_cutoff)} the power law would add "
            f"{part_of_energy(joint.shares.missing_short)}."
        )
