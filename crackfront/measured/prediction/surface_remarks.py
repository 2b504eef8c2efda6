"""Remarks on a measured surface: its scans, its spectrum, and what another scan would change."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from crackfront.measured.density.bands import Scan
from crackfront.measured.prediction.remarks import Remark
from crackfront.measured.scan.channels import is_doubtful
from crackfront.measured.spectrum.joining import JointSpectrum, part_of_energy
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.surfaces.written_units import prefixed

_MOST_ANISOTROPY = 1.25
"""Largest ratio of the rms slope in a direction to that across it without a reservation."""

_MOST_STRIPES = 0.5
"""Largest part of e_el that may be left out as that of shifted rows without a reservation."""

_MOST_UNMEASURED = 0.1
"""Largest part of e_el that shorter waves may add without a reservation."""

_LEAST_MEASURED = 0.5
"""Least part of e_el that must be measured, without a reservation."""

_MOST_UNSETTLED = 0.009
"""Largest standard error of the ends of intervals over their width, without a reservation.

Of five other seeds the furthest then differs by 2 to 3% of the width."""

_UNSURE, _NARROWER = 1.5, 1.1
"""Factor within which e_el is known that needs no other scan, and that by which one must narrow."""

_WAVES_OF_SIDE, _PIXELS_OF_WAVE, _OVERLAP = 2.0, 4.0, 2.0
"""Longest waves in a side and pixels in the shortest wave that are trusted, and the ratio of waves
over which another scan should overlap."""

_LEFT_OUT = 0.1
"""Part of e_el of the waves that are missing which a new scan may leave out."""

_LEAST_UNEVEN = 0.02
"""Least relative standard error of e_el at which a note says that a surface is not Gaussian."""

_EDGE, _MATTERS = 0.05, 0.1
"""Distance of a Hurst exponent from 0 or 1, and continued part of e_el, that are a reservation."""


_NOT_CHECKED = (
    "Without heights it cannot be checked whether the roughness is random (no wave that stands "
    "out), isotropic and Gaussian, nor what instrument and noise did to the spectrum."
)
"""What only scans show."""

_EXACT = (
    "The spectrum is taken as exact: intervals hold only the errors of the law of k and of the "
    "ratio to boundary elements."
)


def surface_remarks(surface: Surface) -> list[Remark]:
    """All remarks on a surface that need no sphere."""
    return [
        *channel_remarks(surface),
        *spectrum_remarks(surface),
        *scan_remarks(surface.scans),
        measure_next(surface),
    ]


def scan_remarks(scans: Iterable[Scan], contact_radius: float | None = None) -> Iterator[Remark]:
    """Remarks on what was done to scans, and on those smaller than a contact (Units: m)."""
    for one in scans:
        path = str(one.measurement.path)
        for sentence in one.measurement.outliers:
            yield Remark(path, "reservation", f"{path}: {sentence}.")
        for sentence in one.measurement.unusable:
            yield Remark(path, "reservation", f"Left out of the container: {sentence}.")
        for sentence in _treatments(one):
            yield Remark(path, "note", sentence)
        if contact_radius is not None and min(one.measurement.size) < 2 * contact_radius:
            yield Remark(
                path,
                "note",
                f"{path} is smaller than the contact ({1e6 * min(one.measurement.size):.3g} um "
                f"against {2e6 * contact_radius:.3g} um across): it stands for the whole surface "
                "by its spectrum.",
            )


def _treatments(one: Scan) -> Iterator[str]:
    """Sentences on what was filled, assumed or left out of a scan."""
    item = one.measurement
    if item.missing > 0:
        yield (
            f"{item.path}: {item.missing:.2%} of the points were missing and interpolated, "
            f"{one.missing_weight:.1%} by the weight of the window; the density is corrected for "
            "the interpolation, by its effect on random surfaces of the same density."
        )
    if item.is_line:
        yield (
            f"{item.path} is a line scan: its density is that of an isotropic surface with "
            "this projection."
        )
    elif max(item.pixels) > 1.001 * min(item.pixels):
        yield (
            f"{item.path}: the pixels are oblong; the density covers the waves that both sides "
            "resolve."
        )
    if item.tip_is_assumed:
        yield (
            f"{item.path}: the file does not state the radius of the tip, which is assumed to be "
            f"{1e9 * item.tip_radius:g} nm; --tip-radius gives another."
        )
    if most := item.log_hidden_energy:
        yield (
            f"{item.path}: valleys are deep, and the tip may not reach into narrow ones; e_el may "
            f"be {np.exp(most):.1g} times as large, which its interval includes."
        )
    if one.unevenness > _LEAST_UNEVEN:
        yield (
            f"{item.path}: parts of the scan differ more than those of a Gaussian surface, so that "
            f"e_el is known to {one.unevenness:.1%} at best."
        )
    for axis in one.band.stripes:
        yield (
            f"{item.path}: the density of waves along {'xy'[axis]} alone differs from that of "
            "all others, as if rows were shifted or levelled one by one; these waves are left out."
        )


def measure_next(surface: Surface) -> Remark:
    """Note on which scan would narrow the interval of e_el, and by how much."""
    if isinstance(surface, StatedSurface):
        sentence = "Measure next: a scan, which gives e_el an interval and shows missing waves."
        return Remark("next scan", "note", sentence)
    joint = surface.joint
    known, (longer, shorter) = joint.draws.factor, joint.draws.factors_with
    advice = []
    if known > _NARROWER * longer:
        gain = f"would narrow it to {longer:.2g}"
        advice.append((known / longer, f"{_larger_scan(joint)} {gain}"))
    if known > _NARROWER * shorter or joint.shares.missing_short > _MATTERS:
        narrows = known > _NARROWER * shorter
        gain = f"would narrow it to {shorter:.2g}" if narrows else "would hardly narrow it"
        if joint.shares.missing_short > _MATTERS:
            joined = ", and" if narrows else ", but"
            gain += f"{joined} may add {part_of_energy(joint.shares.missing_short)}"
        factor = max(known / shorter, 1 + joint.shares.missing_short)
        advice.append((factor, f"{_finer_scan(surface)} {gain}"))
    text = f"e_el is known within a factor of {known:.3g}"
    if advice:
        ways = "; ".join(way for _, way in sorted(advice, reverse=True))
        sentence = f"Measure next: {text}. {ways[0].upper()}{ways[1:]}."
    elif known < _UNSURE:
        sentence = f"{text}; a finer or larger scan would hardly narrow it."
    else:
        sentence = f"Measure next: {text}. More scans of the same waves would narrow it."
    return Remark("next scan", "note", sentence)


def _larger_scan(joint: JointSpectrum) -> str:
    """A scan that holds nine tenths of e_el of the waves longer than all that are measured."""
    beyond = joint.spectrum.longer_than(joint.longest)
    side = _WAVES_OF_SIDE * beyond.dominant_wavelengths(0.5)[1]
    pixel = joint.longest / _OVERLAP / _PIXELS_OF_WAVE
    return f"a scan with a side of {_rounded(side)} and pixels of at most {_rounded(pixel)}"


def _finer_scan(surface: MeasuredSurface) -> str:
    """A scan that holds nine tenths of e_el of the waves shorter than all that are measured."""
    joint = surface.joint
    total = joint.extended.mean_square(0.5)
    below = joint.extended.mean_square_between(0.5, joint.extended.short_cutoff, joint.shortest)
    # Of waves down to the shortest of the scan a share is left out: a tenth to either side.
    shortest = joint.extended.dominant_wavelengths(0.5, 1 - 2 * _LEFT_OUT * below / total)[0]
    side = _WAVES_OF_SIDE * _OVERLAP * joint.shortest
    text = f"a scan with pixels of at most {_rounded(shortest / _PIXELS_OF_WAVE)}"
    if any(one.measurement.tip_radius for one in surface.scans):
        # The tip is no blunter than the surface: 3/8 of the mean square of the Laplacian is that of
        # the curvature of profiles of an isotropic surface.
        curvature = math.sqrt(3 / 8 * joint.extended.longer_than(shortest).mean_square(2.0))
        text += f", a tip radius of at most {_rounded(1 / curvature)}"
    return f"{text} and a side of at least {_rounded(side)}"


def _rounded(length: float) -> str:
    """A length of two digits (Units: m)."""
    return prefixed("m", float(f"{length:.2g}"))


def channel_remarks(surface: Surface) -> Iterator[Remark]:
    """Reservations on scans whose channel may hold no heights."""
    for item in (one.measurement for one in surface.scans):
        if is_doubtful(item.channel):
            yield Remark(
                str(item.path),
                "reservation",
                f"{item.path}: channel {item.channel} has a unit of length, but the name of a "
                "quantity other than heights; --list-channels lists all channels.",
            )


def spectrum_remarks(surface: Surface) -> Iterator[Remark]:
    """Reservations on the spectrum of a surface, scans that disagree first.

    Without scans they say what cannot be checked.
    """
    if isinstance(surface, StatedSurface):
        for sentence in (*surface.doubts, _NOT_CHECKED):
            yield Remark("spectrum", "reservation", sentence)
        yield Remark("spectrum", "note", _EXACT)
        return
    yield from disagreements(surface)
    for one in surface.scans:
        ratio, angle = one.band.anisotropy
        if ratio > _MOST_ANISOTROPY:
            path = str(one.measurement.path)
            yield Remark(
                path,
                "reservation",
                f"{path}: the rms slope at {angle:.0f} degrees from x is {ratio:.2g} times that "
                "across it; the theory is for isotropic surfaces.",
            )
        if one.band.stripes_share > _MOST_STRIPES:
            path = str(one.measurement.path)
            axes = " and ".join("xy"[axis] for axis in one.band.stripes)
            yield Remark(
                path,
                "reservation",
                f"{path}: {one.band.stripes_share:.0%} of e_el would be in waves along {axes} "
                "alone, which are left out as rows that the instrument has shifted; if they are "
                "grooves of the surface, e_el is far too low and the theory does not apply.",
            )
    for sentence in _spectrum_doubts(surface.joint):
        yield Remark("spectrum", "reservation", sentence)


def is_lower_bound(surface: Surface) -> bool:
    """Whether e_el is a least one, as waves shorter than all that are known would add to it."""
    return surface.shares.missing_short > _MOST_UNMEASURED


def disagreements(surface: Surface) -> Iterator[Remark]:
    """Reservations on scans whose density departs from that of the others."""
    if isinstance(surface, StatedSurface):
        return
    density = surface.joint.density
    for index, one in enumerate(surface.scans):
        if density.disagrees(index):
            path, level = str(one.measurement.path), density.levels[index]
            yield Remark(
                path,
                "reservation",
                f"{path} disagrees with the other scans: its density is {level.value:.2g} "
                f"({level.low:.2g} to {level.high:.2g}) times theirs where they overlap; the "
                "intervals include this difference.",
            )


def _spectrum_doubts(joint: JointSpectrum) -> Iterator[str]:
    """Sentences on what is not measured, and on intervals that are not settled."""
    if joint.shares.measured < _LEAST_MEASURED:
        yield (
            f"Only {joint.shares.measured:.0%} of e_el is measured, the rest comes from a model; "
            "add a scan of the missing waves."
        )
    if joint.draws.unsettled > _MOST_UNSETTLED:
        yield (
            "The ends of the intervals have a standard error of "
            f"{joint.draws.unsettled:.1%} of their width: the {len(joint.draws.weight)} weighted "
            f"spectra that were drawn count as {joint.draws.effective:.0f} of equal weight."
        )
    hurst = joint.fit.hurst.value
    if min(hurst, 1 - hurst) < _EDGE and joint.shares.continued > _MATTERS:
        yield (
            f"The Hurst exponent of the shortest waves, {hurst:.2g}, is at the edge of the fitted "
            f"range, 0 to 1: {joint.shares.continued:.0%} of e_el comes from a model that may not "
            "describe the surface."
        )
    if not joint.fit.has_roll_off:
        yield (
            "The density shows no plateau within the trusted wavelengths: longer waves have about "
            f"{joint.shares.continued_long:.0%} of e_el, and its interval includes roll-offs of up "
            "to four sides of the scan; add a larger scan."
        )
    if joint.shares.missing_short > _MOST_UNMEASURED:
        yield (
            "Waves shorter than the points hold are left out: two more decades of the power law "
            f"would add {part_of_energy(joint.shares.missing_short)}; add a finer scan."
        )
