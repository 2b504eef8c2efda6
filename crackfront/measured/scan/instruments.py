"""Files of instruments: opened by a library, and completed by what they do not state."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.channels import Channel, channels_of, chosen_channel
from crackfront.measured.scan.containers import contained_surfaces
from crackfront.measured.scan.grids_reader import Grid, GridsReader
from crackfront.measured.scan.library import (
    errors_as_sentences,
    has_part,
    in_metres,
    library_part,
    library_scan,
    silenced,
)
from crackfront.measured.scan.netcdf import netcdf_grids
from crackfront.measured.scan.points import even_line
from crackfront.measured.scan.scan_files import check_points, check_readable
from crackfront.measured.scan.sides import (
    are_possible_heights,
    is_sized,
    length_unit,
    units_and_sides,
)
from crackfront.measured.scan.text_scans import is_plain_text, text_reader
from crackfront.measured.tables.number_tables import number_tables
from crackfront.validation import PathName, checked_call

_BEGIN = 512
"""Bytes at the beginning of a file that have its signature."""

_NPY = b"\x93NUMPY"
"""First bytes of an array that NumPy has saved."""


@dataclass(frozen=True, slots=True)
class RawScan:
    """A channel of a file as it stands there."""

    topography: Any
    """Object of the library: heights, sides, what the file says of the instrument. (Units: m)"""
    format: str
    """Name of the format, as the library calls it."""
    channel: str
    """Name of the channel, and which of how many of heights it is."""


@silenced()
def raw_scan(path: Path, options: ReadingOptions, height_scale: float = 1.0) -> RawScan:
    """The heights of a file in metres, multiplied by a scale that others state."""
    reader = _reader(path)
    channel, name = chosen_channel(path, reader, options.channel)
    if channel.nb_grid_pts is not None:
        check_points(path, channel.nb_grid_pts)
    added, sides = units_and_sides(path, reader.format(), channel, options)
    with errors_as_sentences(path, reader.format()):
        raw = reader.topography(channel_index=channel.index, **added)
    if not raw.is_uniform:
        line = even_line(path, raw.positions(), raw.heights())
        raw = library_scan(line.heights, line.size, unit=raw.unit, info=raw.info)
    with errors_as_sentences(path, reader.format()):
        level = raw.to_unit("m")
        level.heights()
    if sides is not None:
        level = library_scan(level.heights(), sides, info=raw.info)
    if options.height_unit is not None:
        height_unit = length_unit("--height-unit", options.height_unit)
        if channel.unit is not None and are_possible_heights(level.heights(), _sides(level)):
            raise ValueError(
                f"{path} states heights in {channel.unit}, which are possible; leave out "
                f"--height-unit {options.height_unit}"
            )
        [factor] = in_metres(height_unit, 1.0)
        level = _with_heights(level, factor * raw.heights(), raw.info)
    if height_scale != 1:
        level = _with_heights(level, height_scale * level.heights(), raw.info)
    return RawScan(level, reader.format(), name)


def _sides(level: Any) -> tuple[float, ...]:
    """Sides of a scan of the library, in its unit."""
    return tuple(map(float, level.physical_sizes))


def _with_heights(level: Any, heights: np.ndarray[Any, Any], info: dict[str, Any]) -> Any:
    """A scan in metres with other heights on its points."""
    return library_scan(heights, _sides(level), periodic=bool(level.is_periodic), info=info)


@silenced()
def is_stated(path: Path, channel: str | None) -> tuple[bool, bool]:
    """Whether a file states the unit and the sides of a channel."""
    stated, _ = chosen_channel(path, _reader(path), channel)
    return stated.unit is not None, is_sized(stated)


@silenced()
def unscaled_array(path: Path) -> np.ndarray[Any, Any]:
    """Numbers of a file without units, as of a mask."""
    reader = _reader(path)
    channel, _ = chosen_channel(path, reader, None)
    sized = {} if channel.physical_sizes else {"physical_sizes": (1.0,) * channel.dim}
    with errors_as_sentences(path, reader.format()):
        return np.ma.filled(reader.topography(channel_index=channel.index, **sized).heights(), 0.0)


def _reader(path: Path) -> Any:
    """Reader of a file, which is regular and not too large."""
    check_readable(path)
    text = number_tables(path)
    if text is not None and is_plain_text(text):
        return text_reader(path, text)
    if grids := netcdf_grids(path):
        return GridsReader("nc", grids)
    with path.open("rb") as file:
        is_array = file.read(len(_NPY)) == _NPY
    return _array_reader(path) if is_array else _library_reader(path)


def _array_reader(path: Path) -> Any:
    """Reader of a .npy by numpy.

    The library takes what is missing at the end of one from unused memory.
    """
    with errors_as_sentences(path, "npy"):
        heights = np.load(path, allow_pickle=False)
    if heights.ndim not in (1, 2) or heights.size == 0 or heights.dtype.kind not in "biuf":
        raise ValueError(
            f"{path} contains an array of {heights.dtype} numbers of shape {heights.shape}; save "
            "the real heights of a map or of a line"
        )
    return GridsReader("npy", [Grid("Default", heights, None)], unit=None)


def _library_reader(path: Path) -> Any:
    """The library's reader of a file."""
    reader, is_signed = _reader_by_suffix(path)
    if not is_signed:
        try:
            return library_part("IO").open_topography(str(path))
        except library_part("Exceptions").CannotDetectFileFormat as error:
            if reader is None and zipfile.is_zipfile(path):
                raise ValueError(
                    f"{path} is a ZIP file in no format that SurfaceTopography reads; unpack it, "
                    "and name the files in it"
                ) from error
            if reader is None:
                raise ValueError(
                    f"{path} is in no format that SurfaceTopography reads, or damaged; export it "
                    "from the instrument again, as X3P if there is a choice"
                ) from error
    # Where the format is known by the suffix alone, this fails again and says why.
    with errors_as_sentences(path, reader.format()):
        return reader(str(path))


def _reader_by_suffix(path: Path) -> tuple[Any, bool]:
    """Reader in the module that is named as the suffix, and whether the file has its signature.

    The library itself would import the readers of all formats, which takes a second.
    """
    base = library_part("IO.Reader")
    name = path.suffix[1:].upper()
    if not (name.isalnum() and has_part(f"IO.{name}")):
        return None, False
    with path.open("rb") as file:
        begin = file.read(_BEGIN)
    module = library_part(f"IO.{name}")
    matches = {
        reader: reader.can_read(begin)
        for reader in vars(module).values()
        if getattr(reader, "__module__", "") == module.__name__ and hasattr(reader, "can_read")
    }
    for match in (base.MagicMatch.YES, base.MagicMatch.MAYBE):
        readers = [reader for reader in matches if matches[reader] == match]
        if len(readers) == 1:
            return readers[0], match == base.MagicMatch.YES
    return None, False


@silenced()
@checked_call
def list_channels(path: PathName) -> tuple[Channel, ...]:
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
    check_readable(path)
    members = [
        f"{surface.name}: {measurement.shown}"
        for surface in contained_surfaces(path)
        for measurement in surface.topographies
    ]
    if members:
        return tuple(
            Channel(number, name, "height", (), True) for number, name in enumerate(members)
        )
    return channels_of(path, _reader(path))
