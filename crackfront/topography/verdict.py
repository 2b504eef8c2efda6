"""Whether the theory applies to a sphere on a surface: every condition, with what would meet it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from scipy.special import ndtr, ndtri

from crackfront.analysis.law_spheres import SphereFactors
from crackfront.analysis.validity import shipped_validity
from crackfront.core.units import Scales
from crackfront.data.written_units import prefixed
from crackfront.topography.bands import MOST_PERIODIC
from crackfront.topography.cautions import channel_doubts, surface_doubts
from crackfront.topography.measures import MeasuredSurface, RmsMeasure
from crackfront.topography.tile import zero_load_radius

Standing = Literal["holds", "in doubt", "undecided", "fails"]
Outcome = Literal["applies", "applies with reservations", "cannot be decided", "does not apply"]

ASSUMED_RANGE = 0.5e-9
"""Range of van der Waals attraction, where no other is named (Units: m)."""

_CONTACT = (0.3, 0.7)
"""Contact radius over that of the sphere, whose depth a paraboloid misses by 3% and by 24%."""

_TABOR = (5.0, 1.0)
"""Tabor parameter down to which adhesion is that of cracks, and to which there are cracks."""

_SLOPES = (0.3, 1.0)
"""Rms slope, whose square linear elasticity leaves out."""

_MOST_PERIODIC = 0.5
"""Part of e_el in one wave from which on the law of k is that of another surface."""

_MOST_NEGATIVE = 0.25
"""Part of the surface where w_loc is negative at the strongest disorder of the law."""

_DEVIATE = float(ndtri(_MOST_NEGATIVE))

LARGEST_ENERGY = (_DEVIATE + math.sqrt(_DEVIATE**2 + 1)) ** 2
"""The e_el at which w_loc is negative on the largest part of the surface. (Units: w_int)"""

_BORDER = 1.1
"""Factor by which a limit is known: beyond it by less than that, nothing is decided."""

_MOST_UNSURE = 2.0
"""Ends of the interval of e_el over each other from which on it is said."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition of the theory, in SI units."""

    name: str
    """What must hold, as in 'small slopes'."""
    found: str
    """What is compared with what, in words with numbers."""
    reason: str
    """What is wrong near the limit and beyond."""
    value: float
    doubtful: float
    limit: float
    """Values up to which it holds and up to which it is in doubt; down to which if `rising`."""
    units: str
    """Units of value, doubtful and limit."""
    rising: bool = False
    """Whether the value must be above the limit, not below."""
    remedies: tuple[str, ...] = ()
    """What would bring the value to the limit, one change alone; empty where it holds."""
    reach: float = 1.0
    """Factor to the end of the interval of the value that meets the condition best."""

    @property
    def standing(self) -> Standing:
        """Whether it holds.

        Undecided where the value fails, but its interval or the border of the limit holds values
        that do not.
        """
        margin = self._margin(self.limit)
        if margin <= 1:
            return "fails" if margin * max(self.reach, _BORDER) <= 1 else "undecided"
        return "holds" if self.margin > 1 else "in doubt"

    def shown(self, number: float) -> str:
        """A number as what was found is written."""
        if self.units != "1":
            return prefixed(self.units, number)
        return f"{number:.2%}" if "%" in self.found else f"{number:.3g}"

    @property
    def margin(self) -> float:
        """Factor to where it comes into doubt; above 1 where it holds."""
        return self._margin(self.doubtful)

    def _margin(self, end: float) -> float:
        """Factor to one of the ends."""
        if self.rising:
            return self.value / end
        return end / self.value if self.value > 0 else math.inf


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether the theory applies."""

    conditions: tuple[Condition, ...]
    """All conditions that were checked."""
    reservations: tuple[str, ...]
    """What is in doubt, one sentence each."""
    assumption: str
    """What was assumed of the range of attraction; empty where it was named."""

    @property
    def outcome(self) -> Outcome:
        """What follows from all of them."""
        standings = {item.standing for item in self.conditions}
        if "fails" in standings:
            return "does not apply"
        if "undecided" in standings:
            return "cannot be decided"
        return "applies with reservations" if self.reservations else "applies"

    @property
    def remedies(self) -> tuple[str, ...]:
        """What would make the theory apply, for every condition that is not met."""
        return tuple(
            f"{item.name}: {', or '.join(item.remedies)}"
            for item in self.conditions
            if item.standing in ("undecided", "fails")
        )


def verdict(
    surface: MeasuredSurface,
    scales: Scales,
    attraction_range: float | None = None,
    factors: SphereFactors | None = None,
) -> Verdict:
    """Whether the theory applies to a surface under a sphere, of scales in SI units.

    The range of attraction (Units: m) is :data:`ASSUMED_RANGE` where none is given; factors k are
    in doubt where the law was not measured.
    """
    reach = ASSUMED_RANGE if attraction_range is None else attraction_range
    conditions = (
        *_energy_conditions(surface, scales),
        *_contact_conditions(surface, scales),
        *_range_conditions(surface, scales, reach),
        *_roughness_conditions(surface),
    )
    doubts = [
        *channel_doubts(surface),
        *(_undecided(item) for item in conditions if item.standing == "undecided"),
        *(_unsure(item) for item in conditions if item.standing == "in doubt"),
        *_energy_doubts(surface, scales),
        *surface_doubts(surface),
    ]
    if factors is not None and factors.warning:
        doubts.append(f"The law of k was not measured there: {factors.warning}.")
    assumption = ""
    if attraction_range is None:
        assumption = (
            f"The range of attraction is unknown and taken for {1e9 * reach:g} nm, that of van "
            "der Waals forces; --range names another."
        )
    return Verdict(conditions, tuple(dict.fromkeys(doubts)), assumption)


def _undecided(item: Condition) -> str:
    """Why a condition may hold, though the value fails it."""
    return (
        f"{item.name} cannot be decided: {item.found}, and the limit of {item.shown(item.limit)} "
        f"lies within what is known of them; beyond it {item.reason}."
    )


def _unsure(item: Condition) -> str:
    """Why a condition is in doubt."""
    return f"{item.name}: {item.found}; {item.reason}."


def _energy_conditions(surface: MeasuredSurface, scales: Scales) -> Iterator[Condition]:
    """Conditions on e_el against w_int."""
    w_int = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    e_el = energy.value
    yield Condition(
        "full conformity",
        f"e_el of {prefixed('J/m2', e_el)} against w_int of {prefixed('J/m2', w_int)}",
        "no contact conforms to the roughness",
        e_el,
        w_int,
        w_int,
        "J/m2",
        remedies=_softer(scales, e_el / w_int),
        reach=e_el / energy.low,
    )
    share, least = (_negative_share(one / w_int) for one in (e_el, energy.low))
    yield Condition(
        "attraction nearly everywhere",
        f"w_loc negative on {share:.2%} of the surface",
        "the linearisation of the roughness is not to be trusted where w_loc is negative, and "
        "boundary elements were compared up to there alone",
        share,
        _negative_share(max(row.elastic_energy for row in shipped_validity())),
        _MOST_NEGATIVE,
        "1",
        remedies=_softer(scales, e_el / w_int / LARGEST_ENERGY),
        reach=share / least if least > 0 else math.inf,
    )


def _contact_conditions(surface: MeasuredSurface, scales: Scales) -> Iterator[Condition]:
    """Conditions on the contact at zero load, against the sphere and against the roughness."""
    modulus, radius, contact = scales.contact_modulus, scales.radius, zero_load_radius(scales)
    part = contact / radius / _CONTACT[1]
    yield Condition(
        "contact small against the sphere",
        f"contact of {prefixed('m', contact)} on a sphere of {prefixed('m', radius)}",
        "the paraboloid that stands for the sphere departs from it",
        contact,
        _CONTACT[0] * radius,
        _CONTACT[1] * radius,
        "m",
        # a / R goes as the cube root of w_int / (E' R).
        remedies=(_modulus("above", modulus, part**3), _larger(radius * part**3)),
    )
    half, waves = _waves(surface)
    part = half.shortest / contact
    yield Condition(
        "roughness fine against the contact",
        f"waves that matter to e_el of {waves} under a contact of {prefixed('m', contact)}",
        "the contact holds too few of them for an average",
        half.longest,
        contact,
        contact * half.longest / half.shortest,
        "m",
        remedies=(
            _larger(radius * part**1.5),
            _modulus("below", modulus, part**-3.0),
            "a finer roughness",
        ),
    )


def _range_conditions(
    surface: MeasuredSurface, scales: Scales, reach: float
) -> Iterator[Condition]:
    """Conditions on the range of attraction (Units: m)."""
    w_int, modulus, radius = scales.work_of_adhesion, scales.contact_modulus, scales.radius
    half, waves = _waves(surface)
    tabor = (radius * w_int**2 / (modulus**2 * reach**3)) ** (1 / 3)
    part = _TABOR[1] / tabor
    yield Condition(
        "attraction short against the sphere",
        f"Tabor parameter of {tabor:.3g}",
        "adhesion is not that of a crack at the edge of the contact",
        tabor,
        *_TABOR,
        "1",
        rising=True,
        remedies=(_modulus("below", modulus, part**-1.5), _larger(radius * part**3)),
    )
    # Dugdale's zone of a stress w/z over a range z: (pi/8) (K z/w)^2 with K^2 = 2 E' w.
    zone = math.pi / 4 * modulus * reach**2 / w_int
    yield Condition(
        "attraction short against the roughness",
        f"cohesive zone of {prefixed('m', zone)} under waves of {waves}",
        "the edge does not see waves that are shorter than its cohesive zone",
        zone,
        half.shortest,
        half.longest,
        "m",
        remedies=(_modulus("below", modulus, half.longest / zone), "a coarser roughness"),
    )


def _waves(surface: MeasuredSurface) -> tuple[RmsMeasure, str]:
    """Measure of the half-derivative, and the waves that dominate it as a text."""
    half = surface.measures[1]
    return half, f"{prefixed('m', half.shortest)} to {prefixed('m', half.longest)}"


def _roughness_conditions(surface: MeasuredSurface) -> Iterator[Condition]:
    """Conditions on the rms slope, and on waves that stand out, as grooves do."""
    rms = surface.measures[2].rms
    slope = rms.value
    yield Condition(
        "small slopes",
        f"rms slope of {slope:.3g}",
        "linear elasticity leaves the square of slopes out",
        slope,
        *_SLOPES,
        "1",
        remedies=(f"slopes lower by a factor of {slope / _SLOPES[1]:.3g}",),
        reach=slope / rms.low,
    )
    part, wavelength = max(one.band.periodic for one in surface.scans)
    found = f"the wave of {prefixed('m', wavelength)} alone has {part:.0%} of e_el"
    yield Condition(
        "random roughness",
        found if part else "no wave stands out",
        "k is that of random surfaces, and grooves pin a front otherwise",
        part,
        MOST_PERIODIC,
        _MOST_PERIODIC,
        "1",
        remedies=("another place or direction without the grooves",),
    )


def _softer(scales: Scales, excess: float) -> tuple[str, ...]:
    """Changes each of which lowers e_el over w_int by a factor."""
    return (
        _modulus("below", scales.contact_modulus, 1 / excess),
        f"a roughness lower by a factor of {math.sqrt(excess):.3g}",
        f"w_int above {prefixed('J/m2', scales.work_of_adhesion * excess)}",
    )


def _modulus(side: Literal["above", "below"], known: float, factor: float) -> str:
    """A contact modulus that is the known one times a factor, or beyond (Units: Pa)."""
    return (
        f"a contact modulus E / (1 - nu^2) {side} {prefixed('Pa', known * factor)}, not "
        f"{prefixed('Pa', known)}"
    )


def _larger(radius: float) -> str:
    """A radius of the sphere or a larger one (Units: m)."""
    return f"a radius above {prefixed('m', radius)}"


def _negative_share(energy: float) -> float:
    """Part of the surface where a Gaussian w_loc is negative, by e_el over w_int."""
    return float(ndtr((energy - 1) / (2 * math.sqrt(energy))))


def _energy_doubts(surface: MeasuredSurface, scales: Scales) -> Iterator[str]:
    """Doubts from the width of the interval of e_el."""
    energy = surface.conformity_energy(scales.contact_modulus)
    shown = prefixed("J/m2", energy.value, energy.low, energy.high)
    if energy.value < scales.work_of_adhesion <= energy.high:
        yield f"The interval of e_el reaches w_int, where no contact conforms: {shown}."
    elif energy.high > _MOST_UNSURE * energy.low:
        yield f"e_el is not known to a factor of {_MOST_UNSURE:g}: {shown}."
