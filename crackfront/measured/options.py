"""Options for reading scans and for predictions, as fields of pydantic models.

Commands (`cli/surface_commands.py`), functions (`measured/predict.py`) and configurations
(`sweep/spectrum_sections.py`) take their options and the help texts from these fields.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo

from crackfront.core.arguments import check_type, nearest_name
from crackfront.core.bounds import POISSON, SI, check_within
from crackfront.core.units import Scales, plane_strain_modulus
from crackfront.core.words import counted
from crackfront.surfaces.written_units import is_unit, si_value
from crackfront.validation import sentence

DetrendName = Literal["center", "height", "slope", "curvature"]

Detrend = DetrendName | int
"""Trend that is subtracted, by name, or a polynomial by its order."""

HIGHEST_ORDER = 9
"""Highest order of a polynomial; higher orders would remove roughness."""

PsdKind = Literal["1d", "2d", "radial", "q2d"]
PsdAbscissa = Literal["wavevector", "frequency", "wavelength"]

Region = tuple[tuple[float, float], ...]
"""Part of a scan: both ends along each direction (Units: m)."""

PER_SCAN = "One for all scans, one for each in order, or FILE=VALUE."
"""Marks a field for which every scan of a surface may have its own value."""

REPEATED = "May be repeated."
"""Marks a field with several values for one scan."""

_ZERO = re.compile(r"\s*[-+]?0*\.?0+\.?\s*([^\s\d.].*?)?\s*")
"""Zero with an optional unit, which cannot begin with a digit: 0.1um is not zero."""


class Options(BaseModel):
    """A record of options; the docstring of a field is its help text."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


Record = TypeVar("Record", bound=Options)


def checked_options(record: type[Record], options: Mapping[str, Any], prefix: str = "") -> Record:
    """Record of the user's options that are its fields; None means the default.

    Messages have the prefix before names, which is -- in commands. ValueError if a value cannot be
    used, TypeError if it is of another type.
    """
    values = {
        name: value
        for name, value in options.items()
        if name in record.model_fields and value is not None
    }
    try:
        return record.model_validate(values, context=prefix)
    except ValidationError as error:
        first, *_ = error.errors(include_url=False)
        raise ValueError(sentence(first, _shown_name(str(first["loc"][0]), prefix))) from None


def named_options(record: type[Options], options: Mapping[str, Any]) -> list[str]:
    """Names of a record's fields among a user's options, without empty and default values."""
    return [
        name
        for name, field in record.model_fields.items()
        if options.get(name) not in (None, (), [], field.default)
    ]


def reading_options(
    options: Mapping[str, Any], n_scan: int, prefix: str = ""
) -> list[ReadingOptions]:
    """Options for reading each of several scans of a surface; see :func:`checked_options`.

    If the field allows it, a list or tuple has a value for each scan.
    """
    if n_scan > 1:
        for name in named_options(ReadingOptions, options):
            if REPEATED in ReadingOptions.model_fields[name].metadata:
                raise ValueError(
                    f"{_shown_name(name, prefix)} is for one scan, and {n_scan} are named; read "
                    "them one by one"
                )
    lists = _values_per_scan(options)
    for name, values in lists.items():
        if len(values) not in (1, n_scan):
            raise ValueError(
                f"{_shown_name(name, prefix)} is given {len(values)} times for "
                f"{counted(n_scan, 'scan')}; give it once, or once for each in their order"
            )
    records = []
    for scan in range(n_scan):
        scan_values = {name: values[scan % len(values)] for name, values in lists.items()}
        records.append(checked_options(ReadingOptions, {**options, **scan_values}, prefix))
    return records


def _values_per_scan(options: Mapping[str, Any]) -> dict[str, Sequence[Any]]:
    """Options that are lists with an entry for each scan, or with one for all."""
    return {
        name: options[name] or [None]
        for name, field in ReadingOptions.model_fields.items()
        if PER_SCAN in field.metadata and _is_per_scan(name, options.get(name))
    }


def _is_per_scan(name: str, value: Any) -> bool:
    """Whether a value is a list with entries for scans, not the sides or region of one scan."""
    if not isinstance(value, (list, tuple)):
        return False
    if name == "crop":
        return not (value and all(map(_are_numbers, value)))
    return not (name == "size" and value and _are_numbers(value))


def _are_numbers(value: Any) -> bool:
    """Whether a value is a list or tuple of numbers."""
    return isinstance(value, (list, tuple)) and all(isinstance(entry, Real) for entry in value)


def for_files(options: Mapping[str, Any], files: Sequence[Path]) -> dict[str, Any]:
    """Options of a command, with FILE=VALUE replaced by lists of a value or None for each file.

    ValueError if FILE is not one of the files, or has two values.
    """
    replaced = dict(options)
    for name, field in ReadingOptions.model_fields.items():
        texts = options.get(name)
        if PER_SCAN not in field.metadata or not texts or not any("=" in text for text in texts):
            continue
        assignments = [text.rpartition("=") for text in texts]
        indices = [_file_indices(file, files) for file, _, _ in assignments]
        if name in ("channel", "surface") and not any(indices):
            continue  # The name of a channel or surface contains an equals sign.
        values: dict[int, str] = {}
        for text, (_, sign, value), matches in zip(texts, assignments, indices, strict=True):
            if not sign or len(matches) != 1 or matches[0] in values:
                raise ValueError(
                    f"{_shown_name(name, '--')} is {text!r}; write FILE=VALUE once for each of "
                    f"some files, which are {', '.join(map(str, files))}"
                )
            values[matches[0]] = value
        replaced[name] = [values.get(index) for index in range(len(files))]
    return replaced


def _file_indices(text: str, files: Sequence[Path]) -> list[int]:
    """Numbers of the files with a path or name."""
    return [index for index, file in enumerate(files) if text in (str(file), file.name)]


def check_option_names(function: str, names: Iterable[str], *records: type[Options]) -> None:
    """Raise TypeError if a keyword of a function is not an option of the records."""
    options = [name for record in records for name in record.model_fields]
    for name in names:
        if name not in options:
            hint = nearest_name(name, options, "the options are")
            raise TypeError(f"{function}() got an unexpected keyword argument {name!r}; {hint}")


def _shown_name(name: str, prefix: str) -> str:
    """Name of an option as a user writes it: --tip-radius in commands, else tip_radius."""
    return f"{prefix}{name.replace('_', '-')}" if prefix else name


def _named(info: ValidationInfo) -> str:
    """Name of the validated option, as a user writes it."""
    return _shown_name(str(info.field_name), info.context or "")


def quantity(unit: str, name: str, example: str) -> BeforeValidator:
    """Validator of quantities, from texts with a unit or numbers in the SI unit."""

    def checked(value: Any, info: ValidationInfo) -> float:
        option = _named(info)
        check_type(option, value, (str, Real), f"a {name}, as '{example}' or in {unit}")
        if isinstance(value, str):
            return si_value(value, unit, name=option)
        check_within(option, float(value), SI[unit], unit)
        return float(value)

    return BeforeValidator(checked)


def _text(value: Any, info: ValidationInfo) -> str:
    """Text, also from a whole number."""
    check_type(_named(info), value, (str, Integral), "a text or a number")
    return str(value)


def _region(value: Any, info: ValidationInfo) -> Region:
    """Part of a scan, from a text as in 2um:8um,0um:5um or from pairs of ends in metres."""
    if isinstance(value, (list, tuple)) and value and all(map(_are_numbers, value)):
        return _checked_region(value, str(value), _named(info))
    check_type(_named(info), value, str, "a text, as in '2um:8um,0um:5um'")
    return _region_from_text(value, _named(info))


def _region_from_text(text: str, option: str) -> Region:
    """Part of a scan from a text."""
    ends = [[_position(end, option) for end in part.split(":")] for part in text.split(",")]
    return _checked_region(ends, repr(text), option)


def _checked_region(ends: Sequence[Sequence[float]], shown: str, option: str) -> Region:
    """Part of a scan from both ends along each direction; ValueError if they are not in order."""
    if not all(len(part) == 2 for part in ends) or len(ends) > 2:
        raise ValueError(
            f"{option} is {shown}; write both ends along every direction, as in 2um:8um,0um:5um"
        )
    if not all(low < high for low, high in ends):
        raise ValueError(f"{option} is {shown}, which ends where it begins or before; swap them")
    return tuple((low, high) for low, high in ends)


def _position(text: str, option: str) -> float:
    """Position in a scan from a text, whose unit may be missing if it is zero (Units: m)."""
    zero = _ZERO.fullmatch(text)
    if zero is None or (zero[1] and not is_unit(zero[1], "m")):
        return si_value(text, "m", name=option)
    return 0.0


def _masks(value: Any, info: ValidationInfo) -> tuple[Region | Path, ...]:
    """Parts of a scan and files, from a single one or a list."""
    entries = value if isinstance(value, (list, tuple)) else (value,)
    return tuple(_region_or_file(entry, _named(info)) for entry in entries)


def _region_or_file(value: Any, option: str) -> Region | Path:
    """Part of a scan from a text with colons or from numbers, else the path of a file."""
    if isinstance(value, tuple) and value and all(map(_are_numbers, value)):
        return _checked_region(value, str(value), option)
    check_type(option, value, (str, PathLike), "a part, or the path of a file")
    is_region = isinstance(value, str) and ":" in value
    return _region_from_text(value, option) if is_region else Path(value)


def _detrend(value: Any, info: ValidationInfo) -> Detrend:
    """Name of a trend, or the order of a polynomial."""
    names = get_args(DetrendName)
    trend: Any = int(value) if str(value).isdecimal() else value
    is_order = isinstance(trend, int) and not isinstance(trend, bool)
    if trend in names or (is_order and 0 <= trend <= HIGHEST_ORDER):
        return trend
    raise ValueError(
        f"{_named(info)} is {value!r}; choose one of {', '.join(names)}, or an order from 0 to "
        f"{HIGHEST_ORDER}"
    )


def _sides(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    """Sides of a scan, from a text with commas, a number or a sequence of numbers."""
    entries: Any = value
    if isinstance(value, str):
        entries = value.split(",")
    elif isinstance(value, Real):
        entries = [value]
    try:
        sides = tuple(map(float, entries))
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{_named(info)} is {value!r}; write one number for each direction, as in 50,50"
        ) from error
    if not all(0 < side < float("inf") for side in sides):
        raise ValueError(f"{_named(info)} is {value!r}; sides must be positive and finite")
    return sides


Length = Annotated[float, quantity("m", "length", "0.4um")]
Energy = Annotated[float, quantity("J/m^2", "energy per area", "63mJ/m2")]
Force = Annotated[float, quantity("N", "force", "0.4mN")]
Text = Annotated[str, BeforeValidator(_text)]


class ReadingOptions(Options):
    """Options for reading the file of a scan, and for its trusted waves.

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
    """Unit of the heights, as in nm, if it differs or the unit in the file is impossible."""

    size: Annotated[Annotated[tuple[float, ...], BeforeValidator(_sides)] | None, PER_SCAN] = None
    """Sides of scans that do not state them, in --unit, as in 50,40; 50 for a square or a line."""

    tip_radius: Annotated[Length | None, PER_SCAN] = None
    """Radius of the tip, as in 20nm; by default as in the file, or 10nm for formats of scanning
    probes that do not state it."""

    shortest: Length | None = None
    """Shortest wavelength to trust, as in 0.4um; by default found from resolution, noise, tip and
    four pixels."""

    longest: Length | None = None
    """Longest wavelength to trust; by default found from the remaining form and half a side."""


class PredictionOptions(Options):
    """Further options of a prediction."""

    pull_off: Force | None = None
    """Measured pull-off force, as in 0.4mN; the w_int that would explain it is printed too."""

    range: Length | None = None
    """Range of the attraction, as in 0.3nm; by default 0.5nm, as for van der Waals forces."""

    thickness: Length | None = None
    """Thickness of the soft body, as in 2mm, which is compared with the contact; by default a
    half-space is assumed."""

    work_of_adhesion_error: Energy | None = None
    """Standard error of w_int, as in 3mJ/m2, which widens the intervals; by default w_int is
    exact."""


class PsdOptions(Options):
    """Convention of a spectral density, if its file does not state it."""

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

    hurst: Annotated[float, Field(ge=1e-3, le=1)] | None = None
    """Hurst exponent, as in 0.8."""

    short_cutoff: Length | None = None
    """Shortest wavelength of the roughness, as in 10nm; by default 1nm if H is above 0.5."""


class SphereOptions(Options):
    """Sphere of a command; configurations and the library have :class:`crackfront.Scales`."""

    modulus: Annotated[float, quantity("Pa", "pressure", "0.7MPa")] | None = None
    """Young's modulus, as in 0.7MPa."""

    poisson: Annotated[float, Field(ge=POISSON.least, le=POISSON.most)] | None = None
    """Poisson's ratio, as in 0.5."""

    radius: Length | None = None
    """Radius of the sphere, as in 1.25mm."""

    work_of_adhesion: Energy | None = None
    """Work of adhesion of the smooth surface (w_int), as in 63mJ/m2."""


def sphere_scales(options: SphereOptions, prefix: str = "") -> Scales:
    """Scales of a sphere, in SI units; ValueError if a number is missing."""
    modulus, poisson, radius = options.modulus, options.poisson, options.radius
    adhesion = options.work_of_adhesion
    if modulus is None or poisson is None or radius is None or adhesion is None:
        names = [_shown_name(name, prefix) for name in SphereOptions.model_fields]
        raise ValueError(
            f"the sphere is incomplete; name all of {', '.join(names[:-1])} and {names[-1]}"
        )
    return Scales(radius, adhesion, plane_strain_modulus(modulus, poisson))
