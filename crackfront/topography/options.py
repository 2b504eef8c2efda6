"""Options of reading scans and of predictions, each declared once, as a field of a record.

Commands (`cli/surface.py`), functions of the library (`topography/library.py`) and configurations
(`sweep/configuration.py`) take their options from these fields.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar, get_args

from crackfront.data.arguments import refuse_other_type
from crackfront.data.bounds import SI, Range, refuse_outside
from crackfront.data.written_units import si_value

Record = TypeVar("Record")

DetrendName = Literal["center", "height", "slope", "curvature"]

Detrend = DetrendName | int
"""Trend that is taken off: one by name, as in curvature, or a polynomial by its order."""

HIGHEST_ORDER = 9
"""Highest order of a polynomial; more would be a filter of waves, which its fit is not."""

Region = tuple[tuple[float, float], ...]
"""Ends of a part of a scan along every direction (Units: m)."""

Times = Literal["once", "for each", "repeated"]

_OFTEN = {
    "once": "",
    "for each": "; one for all scans, or one for each",
    "repeated": "; may be repeated",
}

_ZERO = re.compile(r"\s*0(\.0*)?\s*[a-zµ]*\s*")


class Kind(NamedTuple):
    """A kind of values: how one is understood, and what commands and the library call it."""

    parsed: Callable[[Any, str], Any]
    """Value of what a user gives, and its name in refusals."""
    accepts: str
    metavar: str | None = None


class Option(NamedTuple):
    """An option, as commands, library and configurations need it."""

    name: str
    meaning: str
    kind: Kind
    default: Any
    times: Times
    """Whether one value holds for all scans, each scan may have its own, or one scan several."""

    @property
    def sentence(self) -> str:
        """What it means, and how often it may be given."""
        return f"{self.meaning}{_OFTEN[self.times]}."


def option(meaning: str, kind: Kind, *, default: Any = None, times: Times = "once") -> Any:
    """Field of a record of options; see :class:`Option`."""
    return field(default=default, metadata={"option": (meaning, kind, default, times)})


def declared(*records: type[Any]) -> Iterator[Option]:
    """Options of records, in the order of their fields."""
    for item in (one for record in records for one in fields(record)):
        yield Option(item.name, *item.metadata["option"])


def parsed_options(record: type[Record], given: Mapping[str, Any], prefix: str = "") -> Record:
    """Record of the options among what a user gives; None is not given.

    The prefix stands before names in refusals: -- in commands. ValueError if a value cannot be
    used, TypeError if it is of another type.
    """
    [found] = options_for_each(record, given, 1, prefix)
    return found


def options_for_each(
    record: type[Record], given: Mapping[str, Any], n_scan: int, prefix: str = ""
) -> list[Record]:
    """Records of the options of so many scans; otherwise as :func:`parsed_options`."""
    columns = {
        one.name: _values(one, given.get(one.name), n_scan, prefix) for one in declared(record)
    }
    return [
        record(**{name: column[scan] for name, column in columns.items()}) for scan in range(n_scan)
    ]


def _values(item: Option, given: Any, n_scan: int, prefix: str) -> Sequence[Any]:
    """Values of an option for each of so many scans."""
    what = prefix + (item.name.replace("_", "-") if prefix else item.name)
    is_list = isinstance(given, (list, tuple)) and item.times != "once"
    every = given if is_list else () if given is None else (given,)
    found = [item.kind.parsed(one, what) for one in every]
    if not found:
        return [item.default] * n_scan
    if item.times == "repeated":
        if n_scan > 1:
            raise ValueError(
                f"{what} is for one scan, and {n_scan} are named; read them one by one"
            )
        return [tuple(found)]
    if len(found) not in (1, n_scan):
        raise ValueError(
            f"{what} is given {len(found)} times for {n_scan} scan(s); give it once, or once for "
            "each in their order"
        )
    return found * n_scan if len(found) == 1 else found


def parameters_text(*records: type[Any]) -> str:
    """Paragraphs of a docstring on the options of records."""
    lines, indent = [], " " * 8
    for item in declared(*records):
        several = "" if item.times == "once" else " or list of such"
        lines.append(f"    {item.name} : {item.kind.accepts}{several}, optional")
        lines += textwrap.wrap(item.sentence, 100, initial_indent=indent, subsequent_indent=indent)
    return "\n".join(lines).lstrip()


def quantity(unit: str, name: str, example: str) -> Kind:
    """Values with units, as texts, or as numbers in the SI unit."""

    def parsed(value: Any, what: str) -> float:
        refuse_other_type(what, value, (str, Real), f"a {name}, as '{example}' or in {unit}")
        if isinstance(value, str):
            return si_value(value, unit, what=what)
        refuse_outside(what, float(value), SI[unit], unit)
        return float(value)

    return Kind(parsed, "str or float", name.replace(" ", "-").upper())


def number(bounds: Range) -> Kind:
    """Numbers within bounds."""

    def parsed(value: Any, what: str) -> float:
        try:
            found = float(value)
        except ValueError as error:
            raise ValueError(f"{what} is {value!r}; write a number") from error
        refuse_outside(what, found, bounds)
        return found

    return Kind(parsed, "float", "NUMBER")


def _text(value: Any, what: str) -> str:
    """A text, or a number as one."""
    refuse_other_type(what, value, (str, Integral), "a text or a number")
    return str(value)


def region_named(value: Any, what: str) -> Region:
    """Region of a text like 2um:8um,0um:5um."""
    refuse_other_type(what, value, str, "a text, as in '2um:8um,0um:5um'")
    ends = [part.split(":") for part in value.split(",")]
    if not all(len(part) == 2 for part in ends) or len(ends) > 2:
        raise ValueError(
            f"{what} is {value!r}; write both ends along every direction, as in 2um:8um,0um:5um"
        )

    def place(end: str) -> float:
        return 0.0 if _ZERO.fullmatch(end) else si_value(end, "m", what=what)

    found = tuple((place(low), place(high)) for low, high in ends)
    if any(low >= high for low, high in found):
        raise ValueError(f"{what} is {value!r}, which ends where it begins or before; swap them")
    return found


def _region_or_file(value: Any, what: str) -> Region | Path:
    """Region of a text with colons, or the path of a file."""
    refuse_other_type(what, value, (str, PathLike), "a part, or the path of a file")
    is_region = isinstance(value, str) and ":" in value
    return region_named(value, what) if is_region else Path(value)


def _detrend(value: Any, what: str) -> Detrend:
    """Name of a trend, or the order of a polynomial."""
    names = get_args(DetrendName)
    found: Any = int(value) if str(value).isdecimal() else value
    if found in names or (isinstance(found, int) and 0 <= found <= HIGHEST_ORDER):
        return found
    raise ValueError(
        f"{what} is {value!r}; choose one of {', '.join(names)}, or an order from 0 to "
        f"{HIGHEST_ORDER}"
    )


def _sides(value: Any, what: str) -> tuple[float, ...]:
    """Sides of a scan, from a text with commas, a number or a sequence of numbers."""
    value = (value,) if isinstance(value, Real) else value
    try:
        found = tuple(map(float, value.split(",") if isinstance(value, str) else value))
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{what} is {value!r}; write one number for each direction, as in 50,50"
        ) from error
    if not all(0 < side < float("inf") for side in found):
        raise ValueError(f"{what} is {value!r}; sides must be positive and finite")
    return found


LENGTH = quantity("m", "length", "0.4um")


@dataclass(frozen=True, slots=True)
class ReadingOptions:
    """How the file of a scan is read, and which of its waves are trusted; lengths in metres."""

    channel: str | None = option(
        "Channel by name or number, for files with several",
        Kind(_text, "str or int", "NAME|NUMBER"),
        times="for each",
    )
    crop: Region | None = option(
        "Part of the scan to use, as in 2um:8um,0um:5um",
        Kind(region_named, "str"),
        times="for each",
    )
    detrend: Detrend = option(
        "What is taken off: center (mean), height (plane of least height), slope (that of least "
        "slope), curvature (paraboloid), or the polynomial of an order up to 9",
        Kind(_detrend, "str or int", "NAME|ORDER"),
        default="curvature",
    )
    mask: tuple[Region | Path, ...] = option(
        "What the levelling leaves out and the map keeps: a part of the scan as in crop, or a file "
        "with a number for each point, not zero there",
        Kind(_region_or_file, "str or path"),
        default=(),
        times="repeated",
    )
    unit: str | None = option(
        "Unit of length of files that state none, as in um", Kind(_text, "str")
    )
    height_unit: str | None = option(
        "Unit of the heights alone, as in nm, where a file states none or one that cannot be",
        Kind(_text, "str"),
    )
    size: tuple[float, ...] | None = option(
        "Sides of scans that state none, in --unit, as in 50,40; 50 for a square or a line",
        Kind(_sides, "str, float or sequence of float"),
    )
    tip_radius: float | None = option(
        "Radius of the tip that scanned it, as in 20nm; by default what the file says, and 10nm "
        "for formats of scanning probes that do not",
        LENGTH,
        times="for each",
    )
    shortest: float | None = option(
        "Shortest wavelength to trust, as in 0.4um; by default found by resolution, noise, tip, "
        "and four pixels",
        LENGTH,
    )
    longest: float | None = option(
        "Longest wavelength to trust; by default found by what is left of the form, and half a "
        "side",
        LENGTH,
    )


@dataclass(frozen=True, slots=True)
class PredictionOptions:
    """What a prediction takes into account beside the surface and the sphere."""

    pull_off: float | None = option(
        "Measured pull-off force, as in 0.4mN; the w_int that it implies is told",
        quantity("N", "force", "0.4mN"),
    )
    range: float | None = option(
        "Range of the attraction, as in 0.3nm; by default 0.5nm, that of van der Waals forces",
        LENGTH,
    )
