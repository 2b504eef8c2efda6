"""The sphere that gives reduced units their values in SI, from numbers, texts and attributes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Annotated, Any

from crackfront.core import units
from crackfront.core.bounds import POISSON
from crackfront.surfaces.written_units import si_value
from crackfront.validation import checked_call, within

CONVERTED_FOR = "sphere_"
"""Prefix of the attributes with the sphere for which data were converted to SI units."""

CONFIGURED = "scale_"
"""Prefix of the attributes in which a table of a sweep states the sphere of its configuration."""


class Scales(units.Scales):
    """Values of the reduced units in SI, from a sphere and the surface it touches.

    Parameters
    ----------
    radius : float or str
        Radius R of the sphere; a number of metres, or a text with a unit, as '1.25mm'.
        (Units: m)
    work_of_adhesion : float or str
        Intrinsic work of adhesion w_int, as '63mJ/m2'. (Units: J / m^2)
    contact_modulus : float or str, optional
        Contact modulus E' = E / (1 - nu^2), as '0.93MPa', in place of `modulus` and `poisson`.
        (Units: Pa)
    modulus : float or str, optional
        Young's modulus E, as '0.7MPa'. (Units: Pa)
    poisson : float, optional
        Poisson's ratio nu, as 0.5.

    Raises
    ------
    ValueError
        If a parameter is not positive and finite, a text is not such a quantity, or the modulus is
        stated twice or incompletely.
    TypeError
        If a parameter is neither a number nor a text.

    Examples
    --------
    >>> sphere = Scales(radius="1.25mm", work_of_adhesion="63mJ/m2", modulus="0.7MPa", poisson=0.5)
    >>> f"{sphere.lateral * 1e6:.1f} um, {sphere.vertical * 1e6:.2f} um"
    '62.9 um, 3.16 um'
    """

    __slots__ = ()

    @checked_call
    def __init__(
        self,
        radius: float | str,
        work_of_adhesion: float | str,
        contact_modulus: float | str | None = None,
        *,
        modulus: float | str | None = None,
        poisson: Annotated[float, within(POISSON)] | None = None,
    ) -> None:
        super().__init__(
            in_si("radius", radius, "m"),
            in_si("work_of_adhesion", work_of_adhesion, "J/m^2"),
            stated_modulus(contact_modulus, modulus, poisson),
        )


def stated_modulus(
    contact_modulus: float | str | None, modulus: float | str | None, poisson: float | None
) -> float:
    """Contact modulus, from itself or from Young's modulus and Poisson's ratio (Units: Pa).

    ValueError unless it is stated in one way, and completely.
    """
    if contact_modulus is not None:
        if modulus is not None or poisson is not None:
            name, value = ("poisson", poisson) if modulus is None else ("modulus", modulus)
            raise ValueError(
                f"contact_modulus is {contact_modulus!r} and {name} is {value!r}; give the contact "
                "modulus E / (1 - nu^2) alone, or Young's modulus E as modulus with poisson"
            )
        return in_si("contact_modulus", contact_modulus, "Pa")
    if modulus is None or poisson is None:
        raise ValueError(
            f"modulus is {modulus!r} and poisson is {poisson!r}; give both, or contact_modulus, "
            "which is E / (1 - nu^2)"
        )
    return units.plane_strain_modulus(in_si("modulus", modulus, "Pa"), poisson)


def in_si(name: str, value: float | str, unit: str) -> float:
    """Value in SI of an argument that is a number or a text with a unit."""
    if isinstance(value, str):
        return si_value(value, unit, name=name)
    return value


def sphere_attributes(sphere: units.Scales) -> dict[str, float]:
    """Attributes of data that were converted to SI units for a sphere."""
    return {CONVERTED_FOR + name: value for name, value in asdict(sphere).items()}


def attributes_sphere(attributes: Mapping[Any, Any], prefix: str) -> units.Scales | None:
    """The sphere that attributes with a prefix state; None if they state none."""
    names = [prefix + field.name for field in fields(units.Scales)]
    if not all(name in attributes for name in names):
        return None
    return units.Scales(*(float(attributes[name]) for name in names))


def are_equal(sphere: units.Scales, second: units.Scales) -> bool:
    """Whether two spheres are the same but for round-off."""
    pairs = zip(asdict(sphere).values(), asdict(second).values(), strict=True)
    return all(math.isclose(*pair, rel_tol=1e-9) for pair in pairs)
