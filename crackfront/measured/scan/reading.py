"""Measurements of surfaces: read by a library, completed by what files do not state, levelled."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.words import counted
from crackfront.measured.options import ReadingOptions, Region
from crackfront.measured.scan.containers import (
    ContainedMeasurement,
    InstrumentLength,
    chosen_surface,
    contained_surfaces,
    stated_length,
    unpacked,
)
from crackfront.measured.scan.instruments import RawScan, is_stated, raw_scan, unscaled_array
from crackfront.measured.scan.levelling import (
    PointMask,
    levelled,
    trend_name,
    trend_order,
)
from crackfront.measured.scan.library import (
    in_metres,
    library_part,
    library_scan,
    surface_library,
)
from crackfront.measured.scan.outliers import outliers
from crackfront.measured.scan.scan_files import check_readable, checksum
from crackfront.measured.scan.sides import are_possible_heights, shown_sides
from crackfront.surfaces.written_units import prefixed

_PIXELS_PER_WAVE = 4
"""Points in the shortest wave to trust without a stated resolution: shorter ones are aliased."""

_WAVES_PER_SIDE = 2
"""Longest waves to trust in a side: levelling and window take part of longer ones away."""

_MOST_MISSING = 0.1
"""Part of the points that may be missing; more leave too much to the interpolation."""

_FEWEST_OCTAVES = 2
"""Octaves between the shortest and the longest trusted wavelength that a spectrum needs."""

_FEWEST_POINTS = 8
"""Points along a side that a crop must leave."""

_ROUNDING = 1e-3
"""Rms difference of heights that are written with other digits, over their rms."""

_SCANNING_PROBES = {"di", "ezd", "ibw", "jpk", "mdt", "mi", "ps", "wsxm"}
"""Formats of scanning probes, whose files seldom say what their tip is."""

_TIP = 10e-9
"""Radius of a tip of which nothing is known (Units: m)."""

_DEEP = -1.0
"""Skewness of the heights below which valleys are deep, and a tip may not reach into them."""

_HIDDEN = 0.7
"""Ln of the largest e_el of such a surface over the recorded one."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """A scan of a surface, ready for analysis."""

    path: Path
    format: str
    """Name of the format, as the library calls it."""
    comment: str
    """What the file says of itself."""
    checksum: str
    """Eight hexadecimal digits of its content."""
    size: tuple[float, ...]
    """Sides of a map, or the length of a line. (Units: m)"""
    heights: Array
    """Detrended heights without gaps. Shape (n_x, n_y) or (n_x,). (Units: m)"""
    periodic: bool
    """Whether the file says that opposite edges belong together."""
    shortest: float
    longest: float
    """Wavelengths that pixels, resolution and size of the scan allow to trust. (Units: m)"""
    tip_radius: float = 0.0
    tip_wavelength: float = 0.0
    """Radius of the tip, and wavelength below which it shapes what it records; 0 where there is
    none. (Units: m)"""
    tip_is_assumed: bool = False
    """Whether the radius of the tip is assumed, because nothing is known of it."""
    channel: str = ""
    """Name of the channel in the file, and which of how many of heights it is."""
    levelling: str = ""
    """What was taken off, in words."""
    outliers: tuple[str, ...] = ()
    """Sentences on heights that were taken as missing, since no surface has them."""
    unusable: tuple[str, ...] = ()
    """Sentences on other measurements of its container, which cannot be used."""
    gaps: PointMask | None = None
    """Which points were missing and interpolated; None if none were. As `heights`."""

    @property
    def pixels(self) -> tuple[float, ...]:
        """Distances of points in the directions (Units: m)."""
        return tuple(
            side / count for side, count in zip(self.size, self.heights.shape, strict=True)
        )

    @property
    def missing(self) -> float:
        """Part of the points that were interpolated."""
        return 0.0 if self.gaps is None else float(np.mean(self.gaps))

    @property
    def is_line(self) -> bool:
        """Whether it is a line scan."""
        return self.heights.ndim == 1

    @property
    def log_hidden_energy(self) -> float:
        """Ln of the largest e_el over the recorded one, as the tip does not reach into valleys."""
        deviation = self.heights - np.mean(self.heights)
        skewness = np.mean(deviation**3) / np.mean(deviation**2) ** 1.5
        shapes = self.tip_wavelength > 2 * max(self.pixels)  # waves that the pixels resolve
        return _HIDDEN if shapes and skewness < _DEEP else 0.0


def read_measurements(
    paths: Sequence[Path], options: ReadingOptions | Sequence[ReadingOptions] | None = None
) -> tuple[Measurement, ...]:
    """Measurements of one surface, from files in any format that SurfaceTopography reads.

    The options say how the files are read: one record for all, or one for each. ValueError, of one
    sentence, if the library is missing or a file cannot be used; OSError if one cannot be opened.
    """
    if not paths:
        raise ValueError("no file is named; name one measurement of the surface or several")
    repeated = sorted({str(path) for path in paths if list(paths).count(path) > 1})
    if repeated:
        raise ValueError(f"{repeated[0]} is named twice; a measurement counts once")
    if options is None or isinstance(options, ReadingOptions):
        options = [options or ReadingOptions()] * len(paths)
    pairs = zip(paths, options, strict=True)
    measurements = tuple(item for path, record in pairs for item in _measurements(path, record))
    spreads = [float(np.std(item.heights)) for item in measurements]
    for (first, spread), (second, second_spread) in itertools.combinations(
        zip(measurements, spreads, strict=True), 2
    ):
        is_alike = first.heights.shape == second.heights.shape
        is_alike = is_alike and abs(spread - second_spread) <= _ROUNDING * spread
        is_copy = (first.checksum, first.channel) == (second.checksum, second.channel)
        if is_copy or (is_alike and np.std(second.heights - first.heights) <= _ROUNDING * spread):
            raise ValueError(
                f"{second.path} has the heights of {first.path}; a measurement counts once"
            )
    return measurements


def _measurements(path: Path, options: ReadingOptions) -> Iterator[Measurement]:
    """Measurement of one file, or usable measurements of a surface in a container."""
    check_readable(path)
    surfaces = contained_surfaces(path)
    if not surfaces:
        if options.surface is not None:
            raise ValueError(f"{path} is not a container of surfaces; leave --surface out")
        yield _measurement(path, options)
        return
    members = chosen_surface(path, surfaces, options.surface).topographies
    usable: list[Measurement] = []
    unusable: list[str] = []
    with unpacked(path, members) as files:
        for member, file in zip(members, files, strict=True):
            shown = path / member.shown
            try:
                measurement = _measurement(file, _member_options(file, member, options), member)
            except ValueError as error:
                unusable.append(str(error).replace(str(file), str(shown)))
            else:
                usable.append(replace(measurement, path=shown))
    if not usable:
        raise ValueError(unusable[0])
    yield replace(usable[0], unusable=tuple(unusable))
    yield from usable[1:]


def _member_options(
    file: Path, member: ContainedMeasurement, options: ReadingOptions
) -> ReadingOptions:
    """Options of a measurement in a container, with what this states and the data file does not."""
    changes: dict[str, Any] = {}
    if options.channel is None and member.is_original and member.data_source is not None:
        changes["channel"] = str(member.data_source)
    has_unit, has_size = is_stated(file, changes.get("channel", options.channel))
    if not has_unit and member.unit is not None:
        if options.unit is not None:
            raise ValueError(
                f"{file} has the unit {member.unit} in its container; leave --unit {options.unit} "
                "out"
            )
        changes["unit"] = member.unit
    if not has_size and member.size is not None:
        changes["size"] = member.size
    return options.model_copy(update=changes)


def _measurement(
    path: Path, options: ReadingOptions, member: ContainedMeasurement | None = None
) -> Measurement:
    """Measurement of one file, completed by what its container states of it."""
    scan = raw_scan(path, options, member.scale if member else 1.0)
    raw = scan.topography
    heights, fitted, size, sentences = _used_part(path, raw, options)
    gaps = np.ma.getmaskarray(heights)
    try:
        values = levelled(np.ma.getdata(heights), fitted, options.detrend)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    periodic = raw.is_periodic and options.crop is None and not trend_order(options.detrend)
    level = library_scan(
        np.ma.array(values, mask=gaps), size, periodic=bool(periodic), info=raw.info
    )
    if gaps.any():
        level = interpolated(level)
    levelling = trend_name(options.detrend)
    if options.mask:
        left_out = 1 - np.count_nonzero(fitted) / np.ma.count(heights)
        levelling += f" of all but {left_out:.2%} of the points"
    radius, is_assumed = _tip(path, scan, options, member)
    tip = 0.0
    if radius:
        surface_library()
        tip = float(level.scanning_probe_reliability_cutoff(radius) or 0.0)
    resolution = _instrument_length(path, raw, "resolution", member) or 0.0
    shortest, longest = _trusted_wavelengths(path, level, size, resolution)
    return Measurement(
        path=path,
        format=scan.format,
        comment=str(raw.info.get("comment") or "").strip(),
        checksum=checksum(path),
        size=size,
        heights=np.array(np.ma.getdata(level.heights()), dtype=float),
        periodic=bool(level.is_periodic),
        shortest=shortest,
        longest=longest,
        tip_radius=radius,
        tip_wavelength=tip,
        tip_is_assumed=is_assumed,
        channel=scan.channel,
        levelling=levelling,
        outliers=sentences,
        gaps=gaps if gaps.any() else None,
    )


def interpolated(level: Any) -> Any:
    """A scan of the library with its missing points interpolated by harmonic functions."""
    library_part("Uniform.Imputation")
    return level.interpolate_undefined_data()


def _used_part(
    path: Path, raw: Any, options: ReadingOptions
) -> tuple[np.ma.MaskedArray[Any, Any], PointMask, tuple[float, ...], tuple[str, ...]]:
    """Heights of a part, points that its trend is fitted to, its sides, and on its outliers."""
    heights = np.ma.masked_invalid(raw.heights())
    counts, size = heights.shape, tuple(map(float, raw.physical_sizes))
    fitted = ~np.ma.getmaskarray(heights) & ~_masked(path, options, counts, size)
    if options.crop is not None:
        part = _slices(path, "crop", options.crop, counts, size)
        heights, fitted = heights[part], fitted[part]
        if min(heights.shape) < _FEWEST_POINTS:
            raise ValueError(
                f"{path}: the crop leaves fewer than {_FEWEST_POINTS} points along a side; widen it"
            )
    size = tuple(
        side * part_count / count
        for side, part_count, count in zip(size, heights.shape, counts, strict=True)
    )
    impossible, sentences = outliers(heights)
    heights = np.ma.array(np.ma.getdata(heights), mask=np.ma.getmaskarray(heights) | impossible)
    fitted = fitted & ~impossible
    missing = float(np.mean(np.ma.getmaskarray(heights)))
    if missing > _MOST_MISSING:
        reasons = f" ({'; '.join(sentences)})" if sentences else ""
        raise ValueError(
            f"{path}: {missing:.0%} of the points are missing{reasons}; more than "
            f"{_MOST_MISSING:.0%} are too many to interpolate, so use a part with "
            "--crop, or measure again"
        )
    present = np.ma.compressed(heights)
    rms, span = float(np.std(present)), float(np.ptp(present))
    if not span > 0:
        raise ValueError(f"{path}: all heights are equal; a smooth surface lacks a spectrum")
    if not are_possible_heights(present, size):
        raise ValueError(
            f"{path}: the heights vary by {prefixed('m', rms)} rms and span {prefixed('m', span)} "
            f"on {shown_sides(size)}, which cannot be; their unit is wrong, so name the right "
            "one, as in --height-unit nm"
        )
    return heights, fitted, size, sentences


def _tip(
    path: Path, scan: RawScan, options: ReadingOptions, member: ContainedMeasurement | None
) -> tuple[float, bool]:
    """Radius of the tip of a scan, 0 where it has none, and whether it is assumed (Units: m)."""
    if options.tip_radius is not None:
        return options.tip_radius, False
    radius = _instrument_length(path, scan.topography, "tip_radius", member)
    if radius is not None:
        return radius, False
    is_assumed = scan.format in _SCANNING_PROBES
    return (_TIP if is_assumed else 0.0), is_assumed


def _instrument_length(
    path: Path, raw: Any, name: InstrumentLength, member: ContainedMeasurement | None
) -> float | None:
    """A length that a file states of its instrument, or else its container (Units: m)."""
    length = raw.info.get("instrument", {}).get("parameters", {}).get(name)
    if length:
        return in_metres(length["unit"], length["value"])[0]
    return None if member is None else stated_length(path, member, name)


def _trusted_wavelengths(
    path: Path, level: Any, size: tuple[float, ...], resolution: float
) -> tuple[float, float]:
    """Wavelengths that points, resolution and sides allow to trust; ValueError if they are few."""
    shortest = _PIXELS_PER_WAVE * max(np.divide(size, level.nb_grid_pts).tolist())
    shortest = max(shortest, resolution)
    longest = min(size) / _WAVES_PER_SIDE
    if longest < 2**_FEWEST_OCTAVES * shortest:
        raise ValueError(
            f"{path}: a spectrum needs {_FEWEST_OCTAVES} octaves of waves to trust, above "
            f"{prefixed('m', shortest)} (points or instrument) and below {prefixed('m', longest)} "
            "(half a side); use a larger or finer scan"
        )
    return shortest, longest


def _masked(
    path: Path, options: ReadingOptions, counts: tuple[int, ...], size: tuple[float, ...]
) -> PointMask:
    """Points that the levelling leaves out."""
    is_masked = np.zeros(counts, dtype=bool)
    for mask in options.mask:
        if not isinstance(mask, Path):
            is_masked[_slices(path, "mask", mask, counts, size)] = True
            continue
        numbers = unscaled_array(mask)
        if numbers.shape != counts:
            mask_points, needed = (" x ".join(map(str, shape)) for shape in (numbers.shape, counts))
            raise ValueError(
                f"mask {mask} has {mask_points} points and {path} {needed}; a mask has a number "
                "for each point, not zero where the levelling leaves it out"
            )
        is_masked |= numbers != 0
    return is_masked


def _slices(
    path: Path, option: str, region: Region, counts: tuple[int, ...], size: tuple[float, ...]
) -> tuple[slice, ...]:
    """Slices of the points within a region of a scan."""
    if len(region) != len(counts):
        raise ValueError(
            f"{path} has {counted(len(counts), 'dimension')} and the {option} "
            f"{len(region)}; name both ends along each, as in 2um:8um,0um:5um"
        )
    for (_, high), side in zip(region, size, strict=True):
        if high > side * (1 + 1e-9):
            raise ValueError(
                f"{path} ends at {prefixed('m', side)} and the {option} at {prefixed('m', high)}; "
                "name ends within the scan"
            )
    return tuple(
        slice(*(math.ceil(end / side * count - 1e-6) for end in ends))
        for ends, side, count in zip(region, size, counts, strict=True)
    )
