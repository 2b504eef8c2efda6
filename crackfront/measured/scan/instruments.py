"""Files of instruments: opened by a library, and completed by what they do not state."""

from __future__ import annotations

import importlib
import io
import math
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.core.words import counted
from crackfront.measured.optional_libraries import MissingExtraError
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.containers import contained_surfaces
from crackfront.measured.scan.deferred_import import import_without_executing, import_without_mpi
from crackfront.measured.scan.netcdf import Grid, netcdf_grids
from crackfront.measured.scan.points import (
    Points,
    are_points,
    even_line,
    point_columns,
    read_points,
    refuse_positions,
)
from crackfront.measured.scan.psd import column_heads, refuse_spectrum
from crackfront.measured.scan.scan_files import refuse_too_many_points, refuse_unreadable
from crackfront.measured.scan.text import NumberText, number_text
from crackfront.surfaces.written_units import is_unit, prefixed, unit_value

_LIBRARY = "SurfaceTopography"

_BEGIN = 512
"""Bytes of a file that hold its signature."""

_NO_HEIGHTS = re.compile("ampl|phase|error|deflection|friction|potential|adhesion", re.IGNORECASE)
"""Names of channels that are not of heights, also where the file gives them a unit of length."""

_HEIGHTS = re.compile(
    r"height|topograph|elevation|surface|(?:^|[^a-z])z(?:$|[^a-z]|sensor)", re.IGNORECASE
)
"""Names of arrays that are of heights."""

_BARE_ARRAYS = {"h5", "mat", "npz", "nc"}
"""Formats of arrays that say by their names alone what they hold."""

_SHARED_SUFFIXES = {"zip", "txt", "dat", "csv", "asc"}
"""Suffixes that do not say what a file is."""

_TEXT_HEADS = {"X;Y;valid": "hfm", "Scan Parameters": "dektak", "#": "comments"}
"""First line of a text of points, and the function of the library that reads this head."""

_REASONS = (
    (
        r"number of (rows|columns) \(=(\d+)\).*metadata \(=(\d+)\)",
        r"it has \2 \1, and its head says \3",
    ),
    (r"Units for x-coordinate and heights.*", "its sides and heights have different units"),
    (r"Units for x- and y-coordinate.*", "its sides have different units"),
    (r"Could not find any topography data.*", "none of its channels has a unit of length"),
    (r".*'NoneType' object .*", "a part of it is missing or damaged"),
)
"""Reasons of the library, and what they say to one who has only the file."""

_SIDES = (1e-9, 1.0)
"""Sides of a scan within which instruments measure (Units: m): beyond, the unit is wrong."""

_SAME_SIDE = 0.01
"""Relative difference of sides that are rounded, and the same."""

_LEAST_HEIGHT, _MOST_HEIGHT = 1e-12, 10.0
"""Least rms of heights (Units: m), and most span over the side, that instruments measure."""


@dataclass(frozen=True, slots=True)
class Channel:
    """What a file says of one of its channels."""

    number: int
    name: str
    quantity: str
    """Such as height or phase."""
    points: tuple[int, ...]
    is_default: bool
    """Whether it is read where none is named."""

    def __str__(self) -> str:
        """A line on it."""
        warned = self.quantity == "height" and is_doubtful(self.name)
        quantity = f"{self.quantity}{', by its name another quantity' if warned else ''}"
        points = f", {' x '.join(map(str, self.points))} points" if self.points else ""
        return f"{self.number} {self.name!r} ({quantity}){points}{', default' * self.is_default}"


@dataclass(frozen=True, slots=True)
class RawScan:
    """A channel of a file as it stands there."""

    topography: Any
    """Object of the library: heights, sides, what the file says of the instrument. (Units: m)"""
    format: str
    """Name of the format, as the library calls it."""
    channel: str
    """Name of the channel, and which of how many of heights it is."""


def library_part(name: str) -> Any:
    """A module of the library SurfaceTopography, and of the others only those that it imports.

    All of them take seconds, most of which is for formats and analyses that are not used.
    """
    with _importing():
        for package in (_LIBRARY, f"{_LIBRARY}.IO"):
            import_without_executing(package)
        return importlib.import_module(f"{_LIBRARY}.{name}")


def surface_library() -> Any:
    """The library SurfaceTopography as a whole, with all methods of its objects."""
    with _importing():
        import SurfaceTopography

        SurfaceTopography.Topography  # noqa: B018
    return SurfaceTopography


@contextmanager
def _importing() -> Iterator[None]:
    """Import the library without MPI, or say how it is installed."""
    try:
        with _silenced():
            import_without_mpi()
            yield
    except ModuleNotFoundError as error:
        raise MissingExtraError("measured surfaces", error, "surfaces") from error


@contextmanager
def _silenced() -> Iterator[None]:
    """Keep from users what the library warns of, also at files that it leaves open."""
    with warnings.catch_warnings(action="ignore"):
        yield


@_silenced()
def raw_scan(path: Path, options: ReadingOptions, height_scale: float = 1.0) -> RawScan:
    """The heights of a file in metres, multiplied by a scale that others state."""
    reader = _reader(path)
    channel, name = _channel(path, reader, options.channel)
    if channel.nb_grid_pts is not None:
        refuse_too_many_points(path, channel.nb_grid_pts)
    given, sides = _units_and_sides(path, reader.format(), channel, options)
    with _errors_as_sentences(path, reader.format()):
        raw = reader.topography(channel_index=channel.index, **given)
    if not raw.is_uniform:
        line = even_line(path, raw.positions(), raw.heights())
        raw = _library_object(line, raw.unit, raw.info)
    with _errors_as_sentences(path, reader.format()):
        level = raw.to_unit("m")
        level.heights()
    if sides is not None:
        level = library_scan(level.heights(), sides, periodic=False, info=raw.info)
    if options.height_unit is not None:
        height_unit = _length_unit("--height-unit", options.height_unit)
        heights, sides = level.heights(), tuple(map(float, level.physical_sizes))
        if channel.unit is not None and are_possible_heights(heights, sides):
            raise ValueError(
                f"{path} states heights in {channel.unit}, which are possible; leave out "
                f"--height-unit {options.height_unit}"
            )
        [factor] = in_metres(height_unit, 1.0)
        heights = factor * raw.heights()
        level = library_scan(heights, sides, periodic=bool(level.is_periodic), info=raw.info)
    if height_scale != 1:
        sides = tuple(map(float, level.physical_sizes))
        heights = height_scale * level.heights()
        level = library_scan(heights, sides, periodic=bool(level.is_periodic), info=raw.info)
    return RawScan(level, reader.format(), name)


@_silenced()
def is_stated(path: Path, channel: str | None) -> tuple[bool, bool]:
    """Whether a file states the unit and the sides of a channel."""
    found, _ = _channel(path, _reader(path), channel)
    return found.unit is not None, _is_sized(found)


@_silenced()
def array_of(path: Path) -> np.ndarray[Any, Any]:
    """Numbers of a file without units, as of a mask."""
    reader = _reader(path)
    channel, _ = _channel(path, reader, None)
    sized = {} if channel.physical_sizes else {"physical_sizes": (1.0,) * channel.dim}
    with _errors_as_sentences(path, reader.format()):
        return np.ma.filled(reader.topography(channel_index=channel.index, **sized).heights(), 0.0)


def library_scan(
    heights: np.ndarray[Any, Any],
    size: tuple[float, ...],
    *,
    periodic: bool,
    info: dict[str, Any] | None = None,
) -> Any:
    """Heights in metres as an object of the library."""
    return _library_object(Points(heights, size), "m", info, periodic=periodic)


def _library_object(
    points: Points, unit: str | None, info: dict[str, Any] | None, *, periodic: bool = False
) -> Any:
    """Heights on a grid as an object of the library."""
    kinds = library_part("UniformLineScanAndTopography")
    kind = kinds.Topography if points.heights.ndim > 1 else kinds.UniformLineScan
    return kind(points.heights, points.size, periodic=periodic, unit=unit, info=info or {})


@contextmanager
def _errors_as_sentences(path: Path, name: str = "what its head says") -> Iterator[None]:
    """Turn what the library raises at a file into a sentence."""
    exceptions = library_part("Exceptions")
    try:
        yield
    except exceptions.CannotDetectFileFormat as error:
        if (found := _format_and_reason(path, str(error))) is not None:
            name, reason = found
            raise ValueError(f"{path} cannot be read as {name}: {_plain_reason(reason)}") from error
        raise ValueError(
            f"{path} is in no format that SurfaceTopography reads, or damaged; export it from the "
            "instrument again, as X3P if there is a choice"
        ) from error
    # A damaged file may fail anywhere in a parser that is not ours.
    except Exception as error:
        reason = next(iter(str(error).splitlines()), "") or type(error).__name__
        raise ValueError(f"{path} cannot be read as {name}: {_plain_reason(reason)}") from error


def _plain_reason(reason: str) -> str:
    """Reason of the library in plain words, and what to do."""
    for pattern, words in _REASONS:
        if (found := re.search(pattern, reason)) is not None:
            reason = found.expand(words)
    return f"{reason.strip().rstrip('.')}; export it from the instrument again"


def _format_and_reason(path: Path, tried: str) -> tuple[str, str] | None:
    """Format that a file has by signature or name, and why its reader refuses; None if unknown."""
    base, suffix = library_part("IO.Reader"), path.suffix[1:].lower()
    with path.open("rb") as file:
        begin = file.read(_BEGIN)
    kinds = [(one.can_read(begin), one) for one in library_part("IO").readers]
    by_name = [
        one for kind, one in kinds if kind != base.MagicMatch.NO and suffix in _suffixes(one)
    ]
    by_signature = [one for kind, one in kinds if kind == base.MagicMatch.YES]
    for fitting in (by_name, by_signature):
        if len(fitting) == 1:
            [one] = fitting
            reason = re.search(rf"tried {one.__name__}: *\n *(\S.*)", tried)
            return (one.format(), reason[1]) if reason else None
    return None


def _suffixes(reader: Any) -> set[str]:
    """Suffixes of a format that are of no other one."""
    return set(reader.file_extensions() or ()) - _SHARED_SUFFIXES


def _reader(path: Path) -> Any:
    """Reader of a file, which is regular and not too large."""
    refuse_unreadable(path)
    text = number_text(path)
    if text is not None and not text.lines[0].startswith("aISO"):
        return _text_reader(path, text)
    if grids := netcdf_grids(path):
        return _GridsReader("nc", grids)
    with _errors_as_sentences(path):
        # A file that is not what it begins as is left to the readers in their order.
        with suppress(Exception):
            if (reader := _reader_by_signature(path)) is not None:
                return reader(str(path))
        return library_part("IO").open_topography(str(path))


def _text_reader(path: Path, text: NumberText) -> Any:
    """Reader of a text, of points or of a matrix of heights."""
    kind = next((_TEXT_HEADS[one] for one in _TEXT_HEADS if text.lines[0].startswith(one)), None)
    unit, factor, info = None, None, {}
    heads: Sequence[tuple[str, str]] = ()
    if kind in (None, "comments"):
        refuse_spectrum(path, text)
        heads = column_heads(text)
        if heads and (places := point_columns(path, [name for name, _ in heads])):
            text, heads = text.with_columns(places), [heads[place] for place in places]
    is_matrix = kind != "dektak" and not are_points(text)
    if kind is not None and not is_matrix:
        library_part("IO").readers  # noqa: B018  # Its modules for texts import each other.
        read_head = getattr(library_part("IO.XYZ"), f"read_text_header_{kind}")
        try:
            with _errors_as_sentences(path, kind):
                head = io.StringIO("".join(f"{line}\n" for line in text.head))
                *_, unit, factor, info = read_head(head, None, None)
        except ValueError as error:
            # The library says so where a head has the sides of a matrix.
            if not isinstance(error.__cause__, library_part("Exceptions").FileFormatMismatch):
                raise
            is_matrix = True
    if is_matrix:
        refuse_positions(path, text)
        with _errors_as_sentences(path, "text"):
            return library_part("IO").AscReader(io.StringIO("\n".join([*text.lines, ""])))
    if unit is None:
        unit, factor = _stated_units(path, heads)
    points = read_points(path, text, kind)
    heights = points.heights * (factor or 1.0)
    grid = Grid("default", Points(heights, points.size), None)
    return _GridsReader("xyz", [grid], unit, info)


def _stated_units(path: Path, heads: Sequence[tuple[str, str]]) -> tuple[str | None, float]:
    """Unit of the places of points, and that of their heights in it, as the heads state them.

    The unit is None where no column has one; ValueError where some have none, or places several.
    """
    lengths = [unit for _, unit in heads if _is_length(unit)]
    if not lengths:
        return None, 1.0
    units = [_length_unit("", unit) for unit in lengths]
    if len(units) < len(heads) or len(set(units[:-1])) > 1:
        shown = ", ".join(f"{name} ({unit})" if unit else name for name, unit in heads)
        raise ValueError(
            f"{path}: its columns are {shown}; name those of the points x, y and z, each with its "
            "unit of length and x and y in the same, as in x (um),y (um),z (nm), which options do "
            "not replace"
        )
    place, height = units[0], units[-1]
    return place, in_metres(height, 1.0)[0] / in_metres(place, 1.0)[0]


def _is_length(unit: str) -> bool:
    """Whether a text is the name of a unit of length."""
    return unit != "" and not unit[0].isdigit() and is_unit(unit, "m")


@dataclass(frozen=True, slots=True)
class _GridsReader:
    """Grids that were read here, with the face of the library's readers."""

    name: str
    """Name of the format, as the library calls it."""
    grids: Sequence[Grid]
    unit: str | None = "m"
    """Unit of sides and heights, where the file states it."""
    info: dict[str, Any] | None = None

    def format(self) -> str:
        """Name of the format."""
        return self.name

    @property
    def channels(self) -> list[Any]:
        """What the library says of each grid."""
        return [
            library_part("IO.Reader").ChannelInfo(
                self,
                number,
                name=grid.name,
                dim=grid.points.heights.ndim,
                nb_grid_pts=grid.points.heights.shape,
                physical_sizes=grid.points.size,
                unit=self.unit,
                data_unit=grid.unit,
                info=self.info or {},
            )
            for number, grid in enumerate(self.grids)
        ]

    @property
    def default_channel(self) -> Any:
        """The first of them."""
        return self.channels[0]

    def topography(self, channel_index: int, unit: str | None = None) -> Any:
        """Heights in the unit of the file, or in a named one."""
        points = self.grids[channel_index].points
        return _library_object(points, self.unit or unit, self.info)


def _reader_by_signature(path: Path) -> Any:
    """Reader whose signature a file begins with, found by few imports; None if none or several."""
    base = library_part("IO.Reader")
    with path.open("rb") as file:
        begin = file.read(_BEGIN)

    def is_signed(reader: Any) -> bool:
        return bool(reader.can_read(begin) == base.MagicMatch.YES)

    found: list[Any] = []
    if (name := path.suffix[1:].upper()).isalnum():
        # Most readers stand in a module of the name of their files' suffix.
        with suppress(Exception):
            kinds = vars(library_part(f"IO.{name}")).values()
            readers = (one for one in kinds if isinstance(one, type(base.ReaderBase)))
            found = [one for one in readers if hasattr(one, "can_read") and is_signed(one)]
    found = found or list(filter(is_signed, library_part("IO").readers))
    return found[0] if len(found) == 1 else None


@_silenced()
def list_channels(path: str | PathLike[str]) -> tuple[Channel, ...]:
    """Channels of a file, as options `channel` name them.

    Parameters
    ----------
    path : str or path
        File of an instrument, in any format that SurfaceTopography reads.

    Returns
    -------
    tuple of Channel
        Number, name, quantity and points of each, and whether it is read by default.

    Raises
    ------
    ValueError
        If the file cannot be read.
    OSError
        If it cannot be opened.
    """
    refuse_unreadable(Path(path))
    members = [
        f"{surface.name}: {one.shown}"
        for surface in contained_surfaces(Path(path))
        for one in surface.topographies
    ]
    if members:
        return tuple(
            Channel(number, name, "height", (), True) for number, name in enumerate(members)
        )
    return _channels(Path(path), _reader(Path(path)))


def _channels(path: Path, reader: Any) -> tuple[Channel, ...]:
    """Channels of a file, numbered as its reader has them."""
    with _errors_as_sentences(path):
        default = _default(reader)
        return tuple(
            Channel(one.index, one.name, _kind(one), one.nb_grid_pts or (), one.index == default)
            for one in reader.channels
        )


def _default(reader: Any) -> int | None:
    """Number of the channel that is read where none is named; None where nothing says which."""
    channels = reader.channels
    if reader.format() not in _BARE_ARRAYS or len(channels) < 2:
        return int(reader.default_channel.index) if channels else None
    lengths = [one for one in channels if _kind(one) == "height"]
    named = [one for one in lengths if _HEIGHTS.search(one.name) and not is_doubtful(one.name)]
    found = named or (lengths if reader.format() == "nc" else [])
    return int(found[0].index) if len(found) == 1 else None


def _channel(path: Path, reader: Any, wanted: str | None) -> tuple[Any, str]:
    """A channel of heights, the library's own choice if none is named, and what it is called."""
    known = _channels(path, reader)
    if not known and _is_tiff(path):
        raise ValueError(
            f"{path} is a picture in TIFF, which states no unit of its heights; export it from the "
            "instrument again, as X3P if there is a choice, or the heights as text"
        )
    if not known:
        raise ValueError(
            f"{path} holds no array of numbers in two dimensions; export the heights as one"
        )
    named = [one for one in known if (one.is_default if wanted is None else one.name == wanted)]
    if wanted is None and not named:
        raise ValueError(
            f"{path} holds {len(known)} arrays, and their names do not say which one has the "
            f"heights; {_choice(known)}"
        )
    named = named or [one for one in known if str(one.number) == wanted]
    if len(named) != 1:
        raise ValueError(
            f"{path} has {'several channels' if named else 'no channel'} {wanted!r}; "
            f"{_choice(known)}"
        )
    [found] = named
    if found.quantity != "height":
        of_heights = [one for one in known if one.quantity == "height"]
        raise ValueError(
            f"{path}: channel {found.name!r} holds {found.quantity}, no heights; "
            + (_choice(of_heights) if of_heights else "export the channel of the heights")
        )
    several = f", {found.number} of {len(known)}" if len(known) > 1 else ""
    [channel] = [one for one in reader.channels if one.index == found.number]
    return channel, f"{found.name!r}{several}"


def _is_tiff(path: Path) -> bool:
    """Whether a file begins as a picture in TIFF."""
    with path.open("rb") as file:
        return file.read(4) in (b"II*\0", b"MM\0*")


def _kind(channel: Any) -> str:
    """Quantity that a channel holds: height, phase and others."""
    # A reader takes any quantity over lengths for heights, and has two units for it.
    return "another quantity" if isinstance(channel.unit, tuple) else str(channel.data_kind.value)


def is_doubtful(channel: str) -> bool:
    """Whether the name of a channel says that it holds no heights."""
    return _NO_HEIGHTS.search(channel) is not None


def _choice(channels: Sequence[Channel]) -> str:
    """Sentence that lists channels."""
    return f"choose by number or name with --channel: {'; '.join(map(str, channels))}"


def _units_and_sides(
    path: Path, name: str, channel: Any, options: ReadingOptions
) -> tuple[dict[str, Any], tuple[float, ...] | None]:
    """Unit and sides that options add to a file; sides in metres if those of the file are wrong."""
    unit, size = channel.unit, channel.physical_sizes
    is_sized = _is_sized(channel)
    if unit is not None and is_sized and not _are_possible(stated := in_metres(unit, *size)):
        if options.size is None or options.unit is None:
            raise ValueError(
                f"{path} states sides of {shown_sides(stated)}, which no instrument measures; its "
                "unit is wrong, so name the sides, as in --size "
                f"{','.join(f'{side:g}' for side in stated)} --unit um"
            )
        named = _length_unit("--unit", options.unit)
        return {}, _named_sides(path, _sides(path, options.size, len(stated)), named)
    given: dict[str, Any] = {}
    if unit is None:
        if options.unit is None:
            raise ValueError(
                f"{path}, read as {name}, states no unit of length; name it, as in --unit um"
            )
        given["unit"] = unit = _length_unit("--unit", options.unit)
    elif options.unit is not None and _length_unit("--unit", options.unit) != _length_unit(
        "", unit
    ):
        raise ValueError(f"{path} states its own unit, {unit}; leave --unit {options.unit} out")
    if not is_sized and size is not None and None not in size:
        return given, _sides_with_one(path, channel, options, unit)
    if not is_sized:
        if options.size is None:
            raise ValueError(f"{path} states no size of the scan; name it, as in --size 50,50")
        given["physical_sizes"] = size = _sides(path, options.size, channel.dim)
    elif options.size is not None:
        known = " x ".join(f"{side:g}" for side in size)
        raise ValueError(f"{path} states its own size, {known} {unit}; leave --size out")
    _named_sides(path, size, unit)
    return given, None


def _is_sized(channel: Any) -> bool:
    """Whether a file states a side of a channel for each of its directions."""
    size = channel.physical_sizes
    return size is not None and None not in size and len(size) == channel.dim


def _sides_with_one(
    path: Path, channel: Any, options: ReadingOptions, unit: str
) -> tuple[float, ...]:
    """Sides that options name of a map of which the file states one alone (Units: m).

    ValueError, of one sentence, where no sides are named, or others than the one that is stated.
    """
    stated, *others = channel.physical_sizes
    if others:
        raise ValueError(
            f"{path} holds a line and states the sides of a map; write one side in its head"
        )
    known = f"{path} states one side of its map, {stated:g} {unit}"
    advice = f"name both in {unit}, as in --size {stated:g},{stated:g}"
    if options.size is None:
        raise ValueError(f"{known}, and not the other; {advice}")
    named = _sides(path, options.size, channel.dim)
    is_same = math.isclose(named[0], stated, rel_tol=_SAME_SIDE)
    if not is_same and _are_possible(in_metres(unit, stated)):
        raise ValueError(f"{known}, and --size names {named[0]:g} {unit} for it; {advice}")
    return _named_sides(path, named, unit)


def _length_unit(option: str, given: str) -> str:
    """Name by which the library knows a unit of length, refused where it has none."""
    known = library_part("Support.UnitConversion").length_units
    if given in known:
        return str(next(name for name in known if known[name] == known[given]))
    with suppress(ValueError):
        metres = unit_value(given, "m")
        for name, value in known.items():
            if math.isclose(value, metres, rel_tol=1e-9) and not given.strip()[0].isdigit():
                return str(name)
    raise ValueError(f"{option} {given} is no unit of length; name one, as in um")


def _sides(path: Path, named: tuple[float, ...], n_side: int) -> tuple[float, ...]:
    """Sides of a scan that are named, one number for a square."""
    found = named * n_side if len(named) == 1 else named
    if len(found) != n_side:
        raise ValueError(
            f"{path} has {counted(n_side, 'dimension')} and the size that is named "
            f"{len(named)}; name one length for each, as in --size 50,40, or one for a square"
        )
    return found


def in_metres(unit: str, *lengths: float) -> tuple[float, ...]:
    """Lengths of a unit in metres."""
    factor = library_part("Support.UnitConversion").get_unit_conversion_factor(unit, "m")
    return tuple(float(factor * float(length)) for length in lengths)


def are_possible_heights(heights: np.ndarray[Any, Any], sides: tuple[float, ...]) -> bool:
    """Whether an instrument measures heights on such sides, all in metres."""
    known = np.ma.compressed(np.ma.masked_invalid(heights))
    return bool(np.std(known) >= _LEAST_HEIGHT and np.ptp(known) <= _MOST_HEIGHT * max(sides))


def _are_possible(sides: tuple[float, ...]) -> bool:
    """Whether an instrument measures sides of so many metres."""
    return all(_SIDES[0] <= side <= _SIDES[1] for side in sides)


def _named_sides(path: Path, sides: tuple[float, ...], unit: str) -> tuple[float, ...]:
    """Sides in metres, refused where no instrument measures them."""
    found = in_metres(unit, *sides)
    if not _are_possible(found):
        raise ValueError(
            f"{path} cannot have sides of {shown_sides(found)}: instruments measure from "
            f"{shown_sides(_SIDES[:1])} to {shown_sides(_SIDES[1:])}; check --size and --unit"
        )
    return found


def shown_sides(sides: tuple[float, ...]) -> str:
    """Sides of a scan as a text (Units: m)."""
    return " x ".join(prefixed("m", side) for side in sides)
