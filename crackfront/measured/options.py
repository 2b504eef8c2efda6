"""Options of reading scans and of predictions: each is one field of a pydantic model.

Commands (`cli/surface_commands.py`), functions (`measured/predict.py`) and configurations
(`sweep/spectrum_sections.py`) take their options from the fields, and their meaning from the text
below.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails

from crackfront.core.arguments import nearest_name, refuse_other_type
from crackfront.core.bounds import SI, Range, refuse_outside
from crackfront.core.units import Scales
from crackfront.core.words import counted
from crackfront.surfaces.written_units import is_unit, si_value

DetrendName = Literal["center", "height", "slope", "curvature"]

Detrend = DetrendName | int
"""Trend that is taken off: one by name, as in curvature, or a polynomial by its order."""

HIGHEST_ORDER = 9
"""Highest order of a polynomial; more would be a filter of waves, which its fit is not."""

PsdKind = Literal["1d", "2d", "radial", "q2d"]
PsdAbscissa = Literal["wavevector", "frequency", "wavelength"]

Region = tuple[tuple[float, float], ...]
"""Ends of a part of a scan along every direction (Units: m)."""

PER_SCAN = "One for all scans, one for each in order, or FILE=VALUE."
"""Marks a field for which every scan of a surface may have its own value."""

REPEATED = "May be repeated."
"""Marks a field of which one scan may have several values."""


_ZERO = re.compile(r"\s*[-+]?0*\.?0+\.?\s*([^\s\d.].*?)?\s*")
"""Zero, and its unit if it has one, which begins with no digit: 0.1um is not zero."""


class Options(BaseModel):
    """A record of options; the text below a field is its description."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


Record = TypeVar("Record", bound=Options)


def checked_options(record: type[Record], given: Mapping[str, Any], prefix: str = "") -> Record:
    """Record of its options among those that a user gives; None is not given.

    The prefix stands before names in refusals: -- in commands. ValueError, of one sentence, if a
    value cannot be used, TypeError if it is of another type.
    """
    known = {
        name: value
        for name, value in given.items()
        if name in record.model_fields and value is not None
    }
    try:
        return record.model_validate(known, context=prefix)
    except ValidationError as error:
        first, *_ = error.errors(include_url=False)
        raise ValueError(_sentence(first, prefix)) from None


def named_options(record: type[Options], given: Mapping[str, Any]) -> list[str]:
    """Names of the options of a record that a user gives, and not by their defaults."""
    return [
        name
        for name, field in record.model_fields.items()
        if given.get(name) not in (None, (), [], field.default)
    ]


def reading_options(
    given: Mapping[str, Any], n_scan: int, prefix: str = ""
) -> list[ReadingOptions]:
    """Options of reading so many scans of one surface; otherwise as :func:`checked_options`.

    A list or tuple gives every scan its own value, where a field allows this.
    """
    for name, field in ReadingOptions.model_fields.items():
        value = given.get(name)
        is_named = value is not None and not (isinstance(value, (list, tuple)) and not value)
        if REPEATED in field.metadata and is_named and n_scan > 1:
            raise ValueError(
                f"{_shown_name(name, prefix)} is for one scan, and {n_scan} are named; read them "
                "one by one"
            )
    for name, values in _values_per_scan(given):
        if len(values) not in (1, n_scan):
            raise ValueError(
                f"{_shown_name(name, prefix)} is given {len(values)} times for "
                f"{counted(n_scan, 'scan')}; give it once, or once for each in their order"
            )
    found = []
    for scan in range(n_scan):
        own = {name: values[scan % len(values)] for name, values in _values_per_scan(given)}
        found.append(checked_options(ReadingOptions, {**given, **own}, prefix))
    return found


def _values_per_scan(given: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Names and lists of the options that are given as lists, one entry a scan."""
    return [
        (name, given[name] or [None])
        for name, field in ReadingOptions.model_fields.items()
        if PER_SCAN in field.metadata and _is_per_scan(name, given.get(name))
    ]


def _is_per_scan(name: str, value: Any) -> bool:
    """Whether a value has an entry for each scan, and is no pair of sides or region for all."""
    if not isinstance(value, (list, tuple)):
        return False
    if name == "crop":
        return not (value and all(map(_are_numbers, value)))
    return not (name == "size" and value and _are_numbers(value))


def _are_numbers(value: Any) -> bool:
    """Whether a value is a list or tuple of numbers alone."""
    return isinstance(value, (list, tuple)) and all(isinstance(one, Real) for one in value)


def for_files(given: Mapping[str, Any], files: Sequence[Path]) -> dict[str, Any]:
    """Options of a command with FILE=VALUE, as lists with a value or None for every file.

    ValueError, of one sentence, where a FILE is none of the files, or has two values.
    """
    found = dict(given)
    for name, field in ReadingOptions.model_fields.items():
        values = given.get(name)
        if PER_SCAN not in field.metadata or not values or not any("=" in one for one in values):
            continue
        shown, own = _shown_name(name, "--"), dict[int, str]()
        parts = [value.rpartition("=") for value in values]
        named = [
            [i for i, one in enumerate(files) if part[0] in (str(one), one.name)] for part in parts
        ]
        if name in ("channel", "surface") and not any(named):
            continue  # A name with this sign in it.
        for value, (_, sign, text), places in zip(values, parts, named, strict=True):
            if not sign or len(places) != 1 or places[0] in own:
                raise ValueError(
                    f"{shown} is {value!r}; write FILE=VALUE once for each of some files, which "
                    f"are {', '.join(map(str, files))}"
                )
            own[places[0]] = text
        found[name] = [own.get(place) for place in range(len(files))]
    return found


def refuse_unknown(function: str, names: Iterable[str], *records: type[Options]) -> None:
    """Raise TypeError if a keyword of a function is no option of some records."""
    known = [name for record in records for name in record.model_fields]
    for name in names:
        if name not in known:
            hint = nearest_name(name, known, "the options are")
            raise TypeError(f"{function}() got an unexpected keyword argument {name!r}; {hint}")


def _sentence(error: ErrorDetails, prefix: str) -> str:
    """What one error of pydantic means: the sentence of a validator, or its own."""
    if "error" in error.get("ctx", {}):
        return str(error["ctx"]["error"])
    must = error["msg"].replace("Input should", "it must")
    return f"{_shown_name(str(error['loc'][0]), prefix)} is {error['input']!r}; {must}"


def _shown_name(name: str, prefix: str) -> str:
    """Name of an option as the user writes it: --tip-radius in commands, else tip_radius."""
    return f"{prefix}{name.replace('_', '-')}" if prefix else name


def _named(info: ValidationInfo) -> str:
    """Name of the option that is validated, as the user writes it."""
    return _shown_name(str(info.field_name), info.context or "")


def quantity(unit: str, name: str, example: str) -> BeforeValidator:
    """Validator of values with units, as texts, or as numbers in the SI unit."""

    def checked(value: Any, info: ValidationInfo) -> float:
        what = _named(info)
        refuse_other_type(what, value, (str, Real), f"a {name}, as '{example}' or in {unit}")
        if isinstance(value, str):
            return si_value(value, unit, what=what)
        refuse_outside(what, float(value), SI[unit], unit)
        return float(value)

    return BeforeValidator(checked)


def number(bounds: Range) -> BeforeValidator:
    """Validator of numbers within bounds."""

    def checked(value: Any, info: ValidationInfo) -> float:
        try:
            found = float(value)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{_named(info)} is {value!r}; write a number") from error
        refuse_outside(_named(info), found, bounds)
        return found

    return BeforeValidator(checked)


def _text(value: Any, info: ValidationInfo) -> str:
    """A text, or a whole number as one."""
    refuse_other_type(_named(info), value, (str, Integral), "a text or a number")
    return str(value)


def _region(value: Any, info: ValidationInfo) -> Region:
    """A part of a scan, from a text as in 2um:8um,0um:5um or from pairs of ends in metres."""
    if isinstance(value, (list, tuple)) and value and all(map(_are_numbers, value)):
        return _checked_region(value, str(value), _named(info))
    refuse_other_type(_named(info), value, str, "a text, as in '2um:8um,0um:5um'")
    return _region_of(value, _named(info))


def _region_of(text: str, what: str) -> Region:
    """The part of a scan that a text names."""
    ends = [[_place(end, what) for end in part.split(":")] for part in text.split(",")]
    return _checked_region(ends, repr(text), what)


def _checked_region(ends: Sequence[Sequence[float]], shown: str, what: str) -> Region:
    """A part of a scan, whose ends along every direction are two in their order."""
    if not all(len(part) == 2 for part in ends) or len(ends) > 2:
        raise ValueError(
            f"{what} is {shown}; write both ends along every direction, as in 2um:8um,0um:5um"
        )
    if not all(low < high for low, high in ends):
        raise ValueError(f"{what} is {shown}, which ends where it begins or before; swap them")
    return tuple((low, high) for low, high in ends)


def _place(end: str, what: str) -> float:
    """An end of a part of a scan, for which 0 needs no unit (Units: m)."""
    found = _ZERO.fullmatch(end)
    if found is None or (found[1] and not is_unit(found[1], "m")):
        return si_value(end, "m", what=what)
    return 0.0


def _masks(value: Any, info: ValidationInfo) -> tuple[Region | Path, ...]:
    """Parts of a scan and files, from one or several of them."""
    given = value if isinstance(value, (list, tuple)) else (value,)
    return tuple(_region_or_file(one, _named(info)) for one in given)


def _region_or_file(value: Any, what: str) -> Region | Path:
    """A part of a scan, from a text with colons, or the path of a file."""
    if isinstance(value, tuple) and value and all(map(_are_numbers, value)):
        return _checked_region(value, str(value), what)
    refuse_other_type(what, value, (str, PathLike), "a part, or the path of a file")
    is_region = isinstance(value, str) and ":" in value
    return _region_of(value, what) if is_region else Path(value)


def _detrend(value: Any, info: ValidationInfo) -> Detrend:
    """Name of a trend, or the order of a polynomial."""
    names = get_args(DetrendName)
    found: Any = int(value) if str(value).isdecimal() else value
    is_order = isinstance(found, int) and not isinstance(found, bool)
    if found in names or (is_order and 0 <= found <= HIGHEST_ORDER):
        return found
    raise ValueError(
        f"{_named(info)} is {value!r}; choose one of {', '.join(names)}, or an order from 0 to "
        f"{HIGHEST_ORDER}"
    )


def _sides(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    """Sides of a scan, from a text with commas, a number or a sequence of numbers."""
    given = (value,) if isinstance(value, Real) else value
    try:
        found = tuple(map(float, given.split(",") if isinstance(given, str) else given))
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{_named(info)} is {value!r}; write one number for each direction, as in 50,50"
        ) from error
    if not all(0 < side < float("inf") for side in found):
        raise ValueError(f"{_named(info)} is {value!r}; sides must be positive and finite")
    return found


Length = Annotated[float, quantity("m", "length", "0.4um")]
Energy = Annotated[float, quantity("J/m^2", "energy per area", "63mJ/m2")]
Force = Annotated[float, quantity("N", "force", "0.4mN")]
Text = Annotated[str, BeforeValidator(_text)]


class ReadingOptions(Options):
    """How the file of a scan is read, and which of its waves are trusted.

    Lengths are texts with a unit, as in 0.4um, or numbers in metres.
    """

    channel: Annotated[Text | None, PER_SCAN] = None
    """Channel by name or number, for files with several."""

    crop: Annotated[Annotated[Region, BeforeValidator(_region)] | None, PER_SCAN] = None
    """Part of the scan to use, as in 2um:8um,0um:5um."""

    detrend: Annotated[Detrend, BeforeValidator(_detrend)] = "curvature"
    """Trend to subtract: center (mean), height (plane of least height), slope (plane of least
    slope), curvature (paraboloid), or the polynomial of an order up to 9."""

    mask: Annotated[tuple[Region | Path, ...], BeforeValidator(_masks), REPEATED] = ()
    """Points that the levelling ignores and the map keeps: a part of the scan as in crop, or a
    file with a number for each point, which is not zero there."""

    surface: Annotated[Text | None, PER_SCAN] = None
    """Surface by name or number, for containers of contact.engineering with several."""

    unit: Annotated[Text | None, PER_SCAN] = None
    """Unit of length of files that do not state it, as in um."""

    height_unit: Annotated[Text | None, PER_SCAN] = None
    """Unit of the heights, as in nm, if it differs or if that of the file is impossible."""

    size: Annotated[Annotated[tuple[float, ...], BeforeValidator(_sides)] | None, PER_SCAN] = None
    """Sides of scans that do not state them, in --unit, as in 50,40; 50 for a square or a line."""

    tip_radius: Annotated[Length | None, PER_SCAN] = None
    """Radius of the tip, as in 20nm; by default that of the file, or 10nm for formats of scanning
    probes that do not state it."""

    shortest: Length | None = None
    """Shortest wavelength to trust, as in 0.4um; by default found from resolution, noise, tip and
    four pixels."""

    longest: Length | None = None
    """Longest wavelength to trust; by default found from the remaining form and half a side."""


class PredictionOptions(Options):
    """What a prediction takes into account beside the surface and the sphere."""

    pull_off: Force | None = None
    """Measured pull-off force, as in 0.4mN; the w_int that would explain it is printed too."""

    range: Length | None = None
    """Range of the attraction, as in 0.3nm; by default 0.5nm, that of van der Waals forces."""


class PsdOptions(Options):
    """What a file of a spectral density does not say of its convention."""

    psd_series: Text | None = None
    """Series by name or number, for files with several."""

    psd_units: Text | None = None
    """Units of both columns, as in 1/um,um^3, in place of those in their headings."""

    psd_kind: PsdKind | None = None
    """Kind of the density: 1d (profiles), 2d (isotropic), radial (its integral is the mean
    square), q2d (q/pi times 2d); by default from its unit and heading."""

    psd_abscissa: PsdAbscissa | None = None
    """Quantity of the first column: wavevector (2 pi / wavelength), frequency (1 / wavelength) or
    wavelength; by default from its heading."""

    psd_sides: Literal["one", "two"] | None = None
    """Whether a 1d density counts every wave once (one) or with its negative (two)."""

    psd_norm: Literal["2pi", "1"] | None = None
    """Variable over which the integral of the density is the mean square: q/2pi (2pi) or q (1, as
    in Gwyddion)."""


class SelfAffineOptions(Options):
    """Numbers of a self-affine surface: flat to the roll-off, a power law to the short cutoff."""

    rms: Length | None = None
    """Rms height of a surface without scans, as in 60nm."""

    correlation_length: Length | None = None
    """Distance at which the autocorrelation of its heights is 1/e, as in 1um."""

    roll_off: Length | None = None
    """Roll-off wavelength, instead of the correlation length."""

    hurst: Annotated[float, number(Range(1e-3, 1.0))] | None = None
    """Hurst exponent, as in 0.8."""

    short_cutoff: Length | None = None
    """Shortest wavelength of the roughness, as in 10nm; by default 1nm if H is above 0.5."""


class SphereOptions(Options):
    """What is pressed on a surface; the library and configurations have its scales instead."""

    modulus: Annotated[float, quantity("Pa", "pressure", "0.7MPa")] | None = None
    """Young's modulus, as in 0.7MPa."""

    poisson: Annotated[float, number(Range(-0.99, 0.5))] | None = None
    """Poisson's ratio, as in 0.5."""

    radius: Length | None = None
    """Radius of the sphere, as in 1.25mm."""

    work_of_adhesion: Energy | None = None
    """w_int, as in 63mJ/m2."""


def sphere_scales(given: SphereOptions, prefix: str = "") -> Scales:
    """Scene of a sphere, in SI units; ValueError where a number of it is missing."""
    modulus, poisson, radius = given.modulus, given.poisson, given.radius
    adhesion = given.work_of_adhesion
    if modulus is None or poisson is None or radius is None or adhesion is None:
        names = [_shown_name(name, prefix) for name in SphereOptions.model_fields]
        raise ValueError(
            f"the sphere is incomplete; name all of {', '.join(names[:-1])} and {names[-1]}"
        )
    return Scales(radius, adhesion, modulus / (1 - poisson**2))
