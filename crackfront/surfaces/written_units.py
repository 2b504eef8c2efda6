"""Units as people write them, read from texts such as 0.7MPa; the only importer of pint."""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from typing import Any

from crackfront.core.bounds import SI, check_within

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*")
"""A number and what stands behind it."""

_COMMA = re.compile(r"(?<=\d),(?=\d)")
"""A comma in a number, which stands for a point in one country and for nothing in another."""

_PIXELS = re.compile(r"[a-z_]*(px|pixels?|dots?)(?![a-z])", re.IGNORECASE)
"""Pixels of a picture; pint would convert them by the length that style sheets define."""

_NAMES = {
    "m": "length",
    "Pa": "pressure",
    "J/m^2": "energy per area",
    "N": "force",
    "N/m": "stiffness",
}
_EXAMPLES = {"m": "1.25mm", "Pa": "0.7MPa", "J/m^2": "63mJ/m2", "N": "0.4mN", "N/m": "200N/m"}

_POWER = re.compile(r"([A-Za-z]+)(-?[1-9](?:\.\d+)?)(?![\w.])")
"""A power without a sign for it, as in J/m2, J m-2 or Pa m0.5."""

_SIGNS = str.maketrans(
    {"\u03bc": "u", "\u2212": "-", "\u2010": "-", "\u2013": "-", "\u00b7": "*", "\u22c5": "*"}
)
"""Signs that pint does not know, or knows by another letter: Greek mu, dashes, dots of products."""

_PRODUCT = re.compile(r"(?<=[A-Za-z])\.(?=[A-Za-z])")
"""A full stop between two units, as in mJ.m-2."""


def si_value(text: str, unit: str, *, name: str) -> float:
    """Value, in an SI unit, of a positive number and its unit, as in 0.7MPa or 63 mJ/m2.

    The unit may be any of the same dimension; errors mention `name`. ValueError if the unit is
    missing, unknown or of another dimension, or the number is not positive and finite.

    Examples
    --------
    >>> round(si_value("63mJ/m2", "J/m^2", name="work of adhesion"), 12)
    0.063
    """
    example = f"write a number and a unit of {_NAMES[unit]}, as in {_EXAMPLES[unit]}"
    number, written_unit = _number_and_unit(text, name, example)
    try:
        value = _converted(number, _unit_for_pint(written_unit), unit)
    except ValueError as error:
        raise ValueError(f"{name} is {text!r}, whose unit {error}; {example}") from error
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{name} is {text!r}; it must be positive and finite")
    if written_unit.startswith("mPa"):
        meant = text.replace("mPa", "MPa")
        raise ValueError(
            f"{name} is {text!r}, {value:g} Pa, too soft to be solid; was {meant!r} meant?"
        )
    check_within(name, value, SI[unit], unit)
    return value


def _number_and_unit(text: str, name: str, example: str) -> tuple[float, str]:
    """Number and unit of a text; errors have the name of the quantity and an example."""
    if _COMMA.search(text):
        raise ValueError(
            f"{name} is {text!r}, a number with a comma; write {_COMMA.sub('.', text)!r} if that "
            "is meant"
        )
    quantity = _QUANTITY.fullmatch(_plain_signs(text))
    if quantity is None:
        raise ValueError(f"{name} is {text!r}, which is not a number with a unit; {example}")
    if quantity[2] is None:
        raise ValueError(f"{name} is {text!r}, without a unit; {example}")
    return float(quantity[1]), quantity[2]


def _plain_signs(text: str) -> str:
    """A text with plain letters, digits and signs in place of their variants in Unicode."""
    return unicodedata.normalize("NFKC", text).translate(_SIGNS)


def _unit_for_pint(written: str) -> str:
    """A unit in the notation of pint, from the notations of people and of this package's files."""
    with_products = _PRODUCT.sub("*", _plain_signs(written))
    return _POWER.sub(r"\1^\2", with_products)


def unit_value(written: str, unit: str) -> float:
    """Value of a unit in another unit; ValueError if their dimensions differ.

    Examples
    --------
    >>> unit_value("mJ / m^2", "J / m^2")
    0.001
    """
    try:
        return _converted(1.0, _unit_for_pint(written), unit)
    except ValueError as error:
        raise ValueError(f"the unit {written} cannot be converted to {unit}: it {error}") from error


def is_unit(written: str, unit: str) -> bool:
    """Whether a text is a unit of the same dimension as a unit."""
    try:
        unit_value(written, unit)
    except ValueError:
        return False
    return True


def _converted(value: float, written: str, unit: str) -> float:
    """A number in a written unit, converted to a unit; a ValueError says why it cannot be."""
    import pint

    if _PIXELS.search(written):
        raise ValueError("is one of pixels, which have no length")
    registry = _registry()
    try:
        return float(registry.Quantity(value, written).to(unit).magnitude)
    except pint.DimensionalityError as error:
        raise ValueError(f"is not a unit of {_NAMES.get(unit, unit)}") from error
    # A text that is not a unit fails anywhere in pint, whose parser asserts and divides.
    except Exception as error:
        raise ValueError("is unknown") from error


@functools.cache
def _registry() -> Any:
    """Registry of units, made once in a process."""
    import pint

    # pint's cache names files of one environment, and fails once that environment is removed.
    return pint.UnitRegistry()


_PREFIXES = {-12: "p", -9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""Prefixes of units, by their powers of ten."""


def prefixed(unit: str, *values: float, digits: int = 3) -> str:
    """A value, and the ends of its interval if they are given, with the prefix that suits it.

    Values are in an SI unit without a prefix. They are written with so many significant digits; an
    interval that these digits do not show is left out.

    Examples
    --------
    >>> prefixed("m", 2.1e-6), prefixed("J/m2", 0.0329, 0.0282, 0.0376)
    ('2.1 um', '32.9 mJ/m2 (28.2 to 37.6)')
    >>> prefixed("N", 105.01e-6, 104.99e-6, 105.02e-6)
    '105 uN'
    """
    power = _prefix_power(values[0])
    # The second format drops the zeros at the end: 2.10 becomes 2.1.
    first, *ends = (f"{float(f'{value / 10.0**power:.{digits}g}'):g}" for value in values)
    text = f"{first} {_PREFIXES[power]}{unit}"
    if ends and math.isfinite(values[1]) and (ends[0] != first or ends[1] != first):
        return f"{text} ({ends[0]} to {ends[1]})"
    return text


def _prefix_power(value: float) -> int:
    """Power of ten of the prefix that leaves one to three digits before the decimal point."""
    if value == 0 or not math.isfinite(value):
        return 0
    power = 3 * math.floor(math.log10(abs(value) * (1 + 1e-9)) / 3)
    return min(max(power, min(_PREFIXES)), max(_PREFIXES))
