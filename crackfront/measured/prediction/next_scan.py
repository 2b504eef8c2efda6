"""The scan that would narrow the interval of e_el, or show waves that the others lack."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from crackfront.core.words import counted
from crackfront.measured.prediction.remarks import Remark
from crackfront.measured.spectrum.joining import JointSpectrum, part_of_energy
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.surfaces.written_units import prefixed

NOTABLE_SHARE = 0.1
"""Part of e_el above which continued or missing waves matter."""

LEAST_MEASURED = 0.5
"""Measured part of e_el below which there is a reservation."""

_UNCERTAIN = 1.5
"""Uncertainty factor of e_el above which another scan is recommended."""

_NARROWER = 1.1
"""Least improvement of this factor by a scan that is recommended."""

_WAVES_OF_SIDE = 2.0
"""Side of a scan over its longest trusted wavelength."""

_PIXELS_OF_WAVE = 4.0
"""Shortest trusted wavelength of a scan over its pixel."""

_OVERLAP = 2.0
"""Ratio of wavelengths over which another scan should overlap."""

_LEFT_OUT = 0.1
"""Part of the missing e_el that a recommended scan may leave out."""

_FINEST_PIXEL = 0.3e-9
"""Smallest pixel that is recommended: about the distance of atoms. (Units: m)"""

_SHARPEST_TIP = 1e-9
"""Radius of the sharpest tips that are sold. (Units: m)"""

_MOST_POINTS = 4096
"""Largest number of points along a side that instruments record."""

_NEXT_SIDE = _WAVES_OF_SIDE * _OVERLAP * _PIXELS_OF_WAVE
"""Side of a scan over the pixel of the coarser scan that it continues."""


class _Advice(NamedTuple):
    """A scan, or several, with what they would bring."""

    gain: float
    """Factor by which they improve e_el, to sort by."""
    text: str


def measure_next(surface: Surface) -> Remark:
    """Note on the scan that would narrow the interval of e_el most."""
    if isinstance(surface, StatedSurface):
        sentence = "Measure next: a scan, which gives e_el an interval and shows missing waves."
        return Remark("next scan", "note", sentence)
    factor = surface.joint.draws.factor
    advice = sorted((*_larger_scans(surface.joint), *_finer_scans(surface)), reverse=True)
    is_incomplete = surface.shares.missing_short.value > NOTABLE_SHARE
    waves = " without the waves that are left out" if is_incomplete else ""
    text = f"e_el{waves} is known within a factor of {factor:.3g}"
    if advice:
        scans = "; ".join(scan.text for scan in advice)
        sentence = f"Measure next: {text}. {scans[0].upper()}{scans[1:]}."
    elif factor < _UNCERTAIN:
        sentence = f"{text}; a finer or larger scan would hardly narrow it."
    else:
        sentence = f"Measure next: {text}. More scans of the same waves would narrow it."
    return Remark("next scan", "note", sentence)


def _larger_scans(joint: JointSpectrum) -> Iterator[_Advice]:
    """Advice on waves that are longer than the measured ones, if they matter."""
    factor, (remaining, _) = joint.draws.factor, joint.draws.factors_if_known
    longer = joint.shares.continued_long.value
    is_modelled = _is_modelled(joint) and longer >= joint.shares.continued / 2
    if factor <= _NARROWER * remaining and not is_modelled:
        return
    # Nine tenths of e_el in the longer waves are in the scan.
    beyond = joint.spectrum.longer_than(joint.longest)
    side = _WAVES_OF_SIDE * beyond.dominant_wavelengths(0.5)[1]
    pixel = joint.longest / _OVERLAP / _PIXELS_OF_WAVE
    effect = _effect(factor, remaining, [_measured_text(longer)] if is_modelled else [])
    scans = _scans(side, pixel, "a side of {side} and pixels of at most {pixel}")
    yield _Advice(factor / remaining, f"{scans} {effect}")


def _finer_scans(surface: MeasuredSurface) -> Iterator[_Advice]:
    """Advice on waves that are shorter than the measured ones, if they matter."""
    joint = surface.joint
    factor, (_, remaining) = joint.draws.factor, joint.draws.factors_if_known
    missing = joint.shares.missing_short
    shorter = joint.shares.continued - joint.shares.continued_long.value
    is_modelled = _is_modelled(joint) and shorter > joint.shares.continued / 2
    is_missing = missing.value > NOTABLE_SHARE
    finest = _FINEST_PIXEL * _PIXELS_OF_WAVE
    if finest >= joint.shortest or not (
        factor > _NARROWER * remaining or is_missing or is_modelled
    ):
        return
    shortest = max(_shortest_needed(joint), finest)
    tip = _tip_radius(joint, shortest) if _has_tip(surface) else math.inf
    is_limited = shortest == finest or tip < _SHARPEST_TIP
    further = [_measured_text(shorter)] if is_modelled else []
    if is_missing:
        further.append(f"may add {part_of_energy(missing)}")
    effect = _effect(factor, remaining, further, at_best=is_limited)
    scans = _scans(
        _WAVES_OF_SIDE * _OVERLAP * joint.shortest,
        shortest / _PIXELS_OF_WAVE,
        "pixels of at most {pixel}{tip} and a side of at least {side}",
        _tip_text(tip),
    )
    yield _Advice(max(factor / remaining, 1 + missing.value), f"{scans} {effect}")


def _is_modelled(joint: JointSpectrum) -> bool:
    """Whether most of e_el comes from the model that continues the density."""
    return joint.shares.measured < LEAST_MEASURED


def _measured_text(part: float) -> str:
    """What a scan measures, as a part of e_el."""
    return f"would measure {part:.0%} of e_el that now comes from a model"


def _effect(factor: float, remaining: float, further: list[str], *, at_best: bool = False) -> str:
    """Effects of a scan: the uncertainty factor of e_el would be `known`, and further ones."""
    narrower, word = f"would narrow it to {'at best ' if at_best else ''}{remaining:.2g}", "and"
    if factor <= _NARROWER * remaining:
        narrower, word = "would hardly narrow it", "but"
    return f"{narrower}, {word} {' and '.join(further)}" if further else narrower


def _shortest_needed(joint: JointSpectrum) -> float:
    """Wavelength above which nine tenths of e_el in the shorter waves lie (Units: m)."""
    total = joint.extended.mean_square(0.5)
    below = joint.extended.mean_square_between(0.5, joint.extended.short_cutoff, joint.shortest)
    # dominant_wavelengths leaves out equal parts at both ends.
    return joint.extended.dominant_wavelengths(0.5, 1 - 2 * _LEFT_OUT * below / total)[0]


def _has_tip(surface: MeasuredSurface) -> bool:
    """Whether a tip has recorded one of the scans."""
    return any(scan.measurement.tip_radius for scan in surface.scans)


def _tip_radius(joint: JointSpectrum, shortest: float) -> float:
    """Radius of a tip that is sharper than a surface without shorter waves (Units: m)."""
    # The mean square curvature of profiles of an isotropic surface is 3/8 of the mean square of
    # its Laplacian.
    return (3 / 8 * joint.extended.longer_than(shortest).mean_square(2.0)) ** -0.5


def _tip_text(radius: float) -> str:
    """Radius of a recommended tip, for a list; empty for an instrument without a tip."""
    if math.isinf(radius):
        return ""
    if radius < _SHARPEST_TIP:
        return f", the sharpest tip (radius about {_rounded(_SHARPEST_TIP)})"
    return f", a tip radius of at most {_rounded(radius)}"


def _scans(side: float, pixel: float, description: str, tip: str = "") -> str:
    """One scan in words, or several that overlap if it has too many points (Units: m).

    The description has the fields `side`, `pixel` and `tip`; the tip is for the finest scan.
    """
    count, points = 1, side / pixel
    while points > _MOST_POINTS:
        count += 1
        points = (side / pixel * _NEXT_SIDE ** (count - 1)) ** (1 / count)
    texts = []
    for number in range(count):
        is_finest = number == count - 1
        width = side / points
        texts.append(
            description.format(
                side=_rounded(side), pixel=_rounded(width), tip=tip if is_finest else ""
            )
        )
        side = _NEXT_SIDE * width
    if count == 1:
        return f"a scan with {texts[0]}"
    return f"{counted(count, 'scan')} ({'; '.join(texts)})"


def _rounded(length: float) -> str:
    """A length with two digits and its unit (Units: m)."""
    return prefixed("m", float(f"{length:.2g}"))
