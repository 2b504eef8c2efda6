"""Conditions of the theory for a sphere on a surface, each with changes that would meet it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from scipy.special import ndtr, ndtri

from crackfront.analysis.validity import shipped_validity
from crackfront.core import jkr
from crackfront.core.adhesion import overlap_share
from crackfront.core.units import Scales
from crackfront.measured.density.bands import MOST_PERIODIC
from crackfront.measured.prediction.next_scan import measure_next
from crackfront.measured.prediction.remarks import LimitCheck, Remark, Verdict
from crackfront.measured.prediction.remedies import (
    lower_energy,
    modulus_beyond,
    radius_above,
)
from crackfront.measured.prediction.surface_remarks import (
    channel_remarks,
    scan_remarks,
    spectrum_remarks,
)
from crackfront.measured.spectrum.measured_surface import RmsMeasure
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.surfaces.written_units import prefixed

ASSUMED_RANGE = 0.5e-9
"""Range of van der Waals attraction, the default (Units: m)."""

# Pairs: a condition is in doubt beyond the first number and fails beyond the second.

_CONTACT_LIMITS = (0.3, 0.7)
"""Contact radius over radius of the sphere; a paraboloid approximates it to 3% and 24% there."""

_TABOR_LIMITS = (5.0, 1.0)
"""Tabor parameter, below which the edge of the contact is less and less a crack."""

_SLOPE_LIMITS = (0.3, 1.0)
"""Rms slope, whose square linear elasticity neglects."""

_MOST_PERIODIC = 0.5
"""Part of e_el in a single wave above which the law of k does not apply."""

_MOST_NEGATIVE = 0.25
"""Part of the surface where w_loc is negative at the strongest disorder of the law."""

_DEVIATE = float(ndtri(_MOST_NEGATIVE))
"""Quantile (e_el - w_int) / w_rms of the normal distribution at this part."""

LARGEST_ENERGY = (_DEVIATE + math.sqrt(_DEVIATE**2 + 1)) ** 2
"""The e_el at which w_loc is negative on this part of the surface. (Units: w_int)"""

_THICK = 10.0
"""Thickness over contact radius at which a bonded layer is 13% stiffer than a half-space.

Dimitriadis et al., Biophys. J. 82, 2798 (2002), for an incompressible layer."""

_FAR_INSIDE = 1000.0
"""Margin of a condition above which the text has "far inside" instead of a number."""

_JUST_INSIDE = 1.05
"""Margin of a condition below which the text has "just inside" instead of a number."""

_MOST_UNCERTAIN = 2.0
"""Ratio of the ends of the interval of e_el above which a reservation states it."""

_HALF_SPACE = Remark(
    "thickness",
    "note",
    "The soft body is taken as a half-space: a thin layer on a stiff support is stiffer; "
    "--thickness compares its thickness with the contact.",
)
"""Note if the user did not name the thickness of the soft body."""

_ASSUMPTION = Remark(
    "range of attraction",
    "note",
    f"The range of attraction is unknown and assumed to be {1e9 * ASSUMED_RANGE:g} nm, as for van "
    "der Waals forces; --range gives another.",
)
"""Note if the user did not name a range of attraction."""


def zero_load_radius(scales: Scales) -> float:
    """Radius of the smooth contact at zero load (Units: m)."""
    return scales.lateral * jkr.radius_at_force(0.0)


def theory_verdict(
    surface: Surface,
    scales: Scales,
    attraction_range: float | None = None,
    further: Iterable[Remark] = (),
    *,
    thickness: float | None = None,
) -> Verdict:
    """Whether the theory applies to a surface under a sphere, with scales in SI units.

    The range of attraction (Units: m) is by default :data:`ASSUMED_RANGE`, the soft body a
    half-space unless its thickness (Units: m) is named. `further` has more remarks for the verdict,
    for example on the law of k.
    """
    assumption = [_ASSUMPTION] if attraction_range is None else []
    assumed_range = ASSUMED_RANGE if attraction_range is None else attraction_range
    half_space = _HALF_SPACE if thickness is None else _layer_remark(surface, scales, thickness)
    conditions = [*condition_remarks(surface, scales, assumed_range)]
    is_predicted = all(condition.severity != "fails" for condition in conditions)
    return Verdict(
        (
            *channel_remarks(surface),
            *conditions,
            half_space,
            *_energy_remarks(surface, scales),
            *(_limited_energy_remarks(surface, scales) if is_predicted else ()),
            *spectrum_remarks(surface),
            *further,
            *scan_remarks(surface.scans, zero_load_radius(scales)),
            measure_next(surface),
            *assumption,
        )
    )


def condition_remarks(
    surface: Surface, scales: Scales, attraction_range: float
) -> Iterator[Remark]:
    """A remark for every condition of the theory, whether it is met or not."""
    yield from _energy_conditions(surface, scales)
    yield from _contact_conditions(surface, scales)
    yield from _range_conditions(surface, scales, attraction_range)
    yield from _roughness_conditions(surface)


def _condition(
    name: str,
    finding: str,
    reason: str,
    comparison: LimitCheck,
    remedies: tuple[str, ...],
    *,
    is_share: bool = False,
) -> Remark:
    """Remark on a condition.

    The sentence has the finding with its value and, if the condition is not met, the reason for
    the limit. Remedies are changes that would meet it. A share is printed in per cent.
    """
    severity = comparison.severity
    if severity == "holds":
        margin = comparison.margin
        factor = f"inside by a factor of {float(f'{margin:.2g}'):g}"
        if margin > _FAR_INSIDE:
            factor = "far inside"
        elif margin < _JUST_INSIDE:
            factor = "just inside"
        sentence = f"{name}: {finding}, {factor}."
        return Remark(name, severity, sentence, comparison=comparison)
    value, doubtful, limit = (
        _shown(number, comparison.units, is_share=is_share)
        for number in (comparison.value, comparison.doubtful, comparison.limit)
    )
    beyond = "below" if comparison.rising else "above"
    if severity == "reservation":
        just = "just " if value == doubtful else ""
        sentence = f"{name}: {finding}, in doubt {just}{beyond} {doubtful}; {reason}."
        return Remark(name, severity, sentence, comparison=comparison)
    just = "just " if value == limit else ""
    sentence = f"{name} fails: {finding}, {just}{beyond} the limit of {limit}; {reason}."
    if severity == "undecided":
        sentence = (
            f"{name} cannot be decided: {finding}, and the limit of {limit} lies within the "
            f"uncertainty; beyond it {reason}."
        )
    return Remark(name, severity, sentence, remedies, comparison)


def _shown(number: float, units: str, *, is_share: bool) -> str:
    """A limit of a condition as text."""
    if units != "1":
        return prefixed(units, number)
    return f"{number:.2%}" if is_share else f"{number:.3g}"


def _energy_conditions(surface: Surface, scales: Scales) -> Iterator[Remark]:
    """Conditions on e_el against w_int."""
    w_int = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    e_el = energy.value
    conformity = _condition(
        "full conformity",
        f"e_el of {prefixed('J/m2', e_el)} against w_int of {prefixed('J/m2', w_int)}",
        "the contact does not conform to the roughness",
        LimitCheck(e_el, w_int, w_int, "J/m2", best_case=e_el / energy.low),
        lower_energy(scales, e_el / w_int),
    )
    yield (
        conformity
        if conformity.severity != "holds"
        else _with_missing_waves(conformity, surface, scales)
    )
    share, least = _negative_share(e_el / w_int), _negative_share(energy.low / w_int)
    yield _condition(
        "attraction nearly everywhere",
        f"w_loc negative on {share:.2%} of the surface (and the solids overlap on "
        f"{overlap_share(e_el / w_int):.2%} of the front)",
        "the linearisation of the roughness cannot be trusted where w_loc is negative, and "
        "the comparison with boundary elements ends there",
        LimitCheck(
            share,
            _negative_share(max(row.elastic_energy for row in shipped_validity())),
            _MOST_NEGATIVE,
            "1",
            best_case=share / least if least > 0 else math.inf,
        ),
        lower_energy(scales, e_el / w_int / LARGEST_ENERGY),
        is_share=True,
    )


def _with_missing_waves(conformity: Remark, surface: Surface, scales: Scales) -> Remark:
    """The condition of full conformity, undecided if waves that are left out may break it."""
    e_el, w_int = surface.conformity_energy(scales.contact_modulus).value, scales.work_of_adhesion
    total = surface.shares.missing_short.each(lambda part: e_el * (1 + part))
    if total.value < w_int:
        return conformity
    sentence = (
        f"full conformity cannot be decided: e_el of {prefixed('J/m2', e_el)} would be "
        f"{prefixed('J/m2', total.value, total.low, total.high)} with the waves that are left out, "
        f"against w_int of {prefixed('J/m2', w_int)}; beyond it the contact does not conform to "
        "the roughness."
    )
    comparison = LimitCheck(total.value, w_int, w_int, "J/m2", best_case=total.value / total.low)
    return replace(conformity, severity="undecided", sentence=sentence, comparison=comparison)


def _contact_conditions(surface: Surface, scales: Scales) -> Iterator[Remark]:
    """Conditions on the contact at zero load, against the sphere and against the roughness."""
    modulus, radius, contact = scales.contact_modulus, scales.radius, zero_load_radius(scales)
    excess = contact / radius / _CONTACT_LIMITS[1]
    yield _condition(
        "contact small against the sphere",
        f"contact of {prefixed('m', contact)} on a sphere of {prefixed('m', radius)}",
        "the paraboloid that approximates the sphere deviates from it",
        LimitCheck(contact, _CONTACT_LIMITS[0] * radius, _CONTACT_LIMITS[1] * radius, "m"),
        # a / R goes as the cube root of w_int / (E' R).
        (*modulus_beyond("above", modulus, excess**3), *radius_above(radius * excess**3)),
    )
    half, waves = _dominant_waves(surface)
    excess = half.shortest / contact
    yield _condition(
        "roughness fine against the contact",
        f"waves that matter to e_el of {waves} under a contact of {prefixed('m', contact)}",
        "too few of them are in the contact for an average",
        LimitCheck(half.longest, contact, contact * half.longest / half.shortest, "m"),
        (
            *radius_above(radius * excess**1.5),
            *modulus_beyond("below", modulus, excess**-3.0),
            "a finer roughness",
        ),
    )


def _range_conditions(
    surface: Surface, scales: Scales, attraction_range: float
) -> Iterator[Remark]:
    """Conditions on the range of attraction (Units: m)."""
    w_int, modulus, radius = scales.work_of_adhesion, scales.contact_modulus, scales.radius
    half, waves = _dominant_waves(surface)
    tabor = (radius * w_int**2 / (modulus**2 * attraction_range**3)) ** (1 / 3)
    excess = _TABOR_LIMITS[1] / tabor
    yield _condition(
        "attraction short against the sphere",
        f"Tabor parameter of {tabor:.3g}",
        "the edge of the contact is not a crack",
        LimitCheck(tabor, *_TABOR_LIMITS, "1", rising=True),
        (*modulus_beyond("below", modulus, excess**-1.5), *radius_above(radius * excess**3)),
    )
    # Dugdale's zone for a stress w/z over a range z: (pi/8) (K z/w)^2 with K^2 = 2 E' w.
    zone = math.pi / 4 * modulus * attraction_range**2 / w_int
    yield _condition(
        "attraction short against the roughness",
        f"cohesive zone of {prefixed('m', zone)} under waves of {waves}",
        "the edge does not see waves that are shorter than its cohesive zone",
        LimitCheck(zone, half.shortest, half.longest, "m"),
        (*modulus_beyond("below", modulus, half.longest / zone), "a coarser roughness"),
    )


def _dominant_waves(surface: Surface) -> tuple[RmsMeasure, str]:
    """Measure of the half-derivative, and its dominant waves as text."""
    half = surface.measures[1]
    return half, f"{prefixed('m', half.shortest)} to {prefixed('m', half.longest)}"


def _roughness_conditions(surface: Surface) -> Iterator[Remark]:
    """Conditions on the rms slope, and on single strong waves such as grooves."""
    yield _slope_condition(surface)
    if not surface.scans:
        return
    part, wavelength = max(scan.band.periodic for scan in surface.scans)
    finding = "no wave stands out"
    if part:
        finding = f"the wave of {prefixed('m', wavelength)} alone has {part:.0%} of e_el"
    yield _condition(
        "random roughness",
        finding,
        "the law of k is for random surfaces, and grooves pin a front differently",
        LimitCheck(part, MOST_PERIODIC, _MOST_PERIODIC, "1"),
        ("another place or direction without the grooves",),
        is_share=True,
    )


def _slope_condition(surface: Surface) -> Remark:
    """Condition on the rms slope, which may depend on a short cutoff that is only assumed."""
    rms = surface.measures[2].rms
    slope, least = rms.value, rms.low
    reason, remedies = "linear elasticity neglects the square of slopes", []
    if isinstance(surface, StatedSurface) and surface.longest_cutoff is not None:
        least = math.sqrt(surface.spectrum.longer_than(surface.longest_cutoff).mean_square(1.0))
        reason += (
            f"; the slope depends on the short cutoff, which is assumed to be "
            f"{prefixed('m', surface.shortest)}: without waves below "
            f"{prefixed('m', surface.longest_cutoff)} it would be {least:.3g}"
        )
        remedies = ["the measured cutoff of the roughness as --short-cutoff, if it is longer"]
    return _condition(
        "small slopes",
        f"rms slope of {slope:.3g}",
        reason,
        LimitCheck(slope, *_SLOPE_LIMITS, "1", best_case=slope / least),
        (f"slopes lower by a factor of {slope / _SLOPE_LIMITS[1]:.3g}", *remedies),
    )


def _layer_remark(surface: Surface, scales: Scales, thickness: float) -> Remark:
    """Whether the soft body is thick enough for a half-space (Units: m)."""
    contact, longest = zero_load_radius(scales), surface.measures[1].longest
    needed = max(_THICK * contact, longest)
    is_thick = thickness >= needed
    verb = "is thick enough" if is_thick else "may be too thin"
    radii, waves = (f"{float(f'{thickness / x:.2g}'):g}" for x in (contact, longest))
    sentence = (
        f"thickness: a layer of {prefixed('m', thickness)} {verb} for a half-space, with {radii} "
        f"radii of the contact ({prefixed('m', contact)}) and {waves} times the longest waves that "
        f"matter to e_el; at {_THICK:g} radii a layer on a stiff support is about 13% stiffer."
    )
    return Remark("thickness", "holds" if is_thick else "reservation", sentence)


def _negative_share(energy: float) -> float:
    """Part of the surface where a Gaussian w_loc is negative, at an e_el (Units: w_int)."""
    return float(ndtr((energy - 1) / (2 * math.sqrt(energy))))


def _energy_remarks(surface: Surface, scales: Scales) -> Iterator[Remark]:
    """Reservations on an e_el that is uncertain, or may be above w_int."""
    w_int = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    shown = prefixed("J/m2", energy.value, energy.low, energy.high)
    if energy.value < w_int <= energy.high:
        sentence = (
            f"The interval of e_el reaches w_int, where the contact does not conform: {shown}."
        )
        yield Remark("e_el", "reservation", sentence)
    elif energy.high > _MOST_UNCERTAIN * energy.low:
        sentence = f"The interval of e_el spans more than a factor of {_MOST_UNCERTAIN:g}: {shown}."
        yield Remark("e_el", "reservation", sentence)


def _limited_energy_remarks(surface: Surface, scales: Scales) -> Iterator[Remark]:
    """Reservation on numbers for a smaller e_el, as the surface is beyond the law of k."""
    w_int = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    if LARGEST_ENERGY * w_int < energy.value:
        shown = prefixed("J/m2", energy.value, energy.low, energy.high)
        sentence = (
            f"The numbers are for an e_el of {LARGEST_ENERGY:.2g} w_int, the largest at which the "
            f"law of k applies; the spectrum gives {shown}, {energy.value / w_int:.2g} w_int."
        )
        yield Remark("e_el", "reservation", sentence)
