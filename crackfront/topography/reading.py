"""Measurements of surfaces: read by a library, completed by what files do not state, detrended."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from crackfront.core.optional_libraries import MissingExtraError

Array = NDArray[np.float64]

_PIXELS_PER_WAVE = 4
"""Points in the shortest wavelength that is trusted where a file knows no resolution of its own:
shorter waves hold an aliased part of those below the pixels."""

_WAVES_PER_SIDE = 2
"""Longest wavelength that is trusted, in a side of the scan: detrending and the window take part
of longer waves away."""

_MOST_MISSING = 0.1
"""Part of the points that may be missing; more leave too much to the interpolation."""

_FEWEST_OCTAVES = 2
"""Octaves between the shortest and the longest trusted wavelength that a spectrum needs."""

Detrend = Literal["center", "height", "slope", "curvature"]
"""What is taken off: the mean, the plane of least height, that of least slope, the paraboloid."""


@dataclass(frozen=True, slots=True)
class Treatment:
    """How files are read.

    Attributes
    ----------
    detrend : {"center", "height", "slope", "curvature"}
        What is taken off, as the library's modes of the same names.
    unit : str or None
        Unit of lengths, for files that state none.
    size : tuple of float or None
        Sides of the scan, or the length of a line, for files that state none.
        (Units: those of `unit`, or of the file)
    shortest : float or None
        Shortest wavelength to trust. (Units: m)
    """

    detrend: Detrend = "curvature"
    unit: str | None = None
    size: tuple[float, ...] | None = None
    shortest: float | None = None

    def __post_init__(self) -> None:
        if self.detrend not in get_args(Detrend):
            raise ValueError(
                f"detrend is {self.detrend!r}; choose one of {', '.join(get_args(Detrend))}"
            )
        for name, values in (("size", self.size or ()), ("shortest", (self.shortest or 1.0,))):
            if not all(math.isfinite(value) and value > 0 for value in values):
                raise ValueError(f"{name} is {getattr(self, name)}; it must be positive and finite")


@dataclass(frozen=True, slots=True)
class Measurement:
    """A scan of a surface, ready for analysis.

    Attributes
    ----------
    path : Path
        Where it comes from.
    format : str
        Name of the format, as the library calls it.
    comment : str
        What the file says of itself.
    checksum : str
        Eight hexadecimal digits of its content.
    size : tuple of float
        Sides of a map, or the length of a line. (Units: m)
    heights : (n_x, n_y) or (n_x,) array
        Detrended heights without gaps. (Units: m)
    periodic : bool
        Whether the file says that opposite edges belong together.
    missing : float
        Part of the points that were interpolated.
    shortest, longest : float
        Wavelengths that are trusted. (Units: m)
    """

    path: Path
    format: str
    comment: str
    checksum: str
    size: tuple[float, ...]
    heights: Array
    periodic: bool
    missing: float
    shortest: float
    longest: float

    @property
    def pixels(self) -> tuple[float, ...]:
        """Distances of points in the directions (Units: m)."""
        return tuple(
            side / count for side, count in zip(self.size, self.heights.shape, strict=True)
        )

    @property
    def is_line(self) -> bool:
        """Whether it is a line scan."""
        return self.heights.ndim == 1


def read_measurements(
    paths: Sequence[Path], treatment: Treatment | None = None
) -> tuple[Measurement, ...]:
    """Measurements of one surface, from files in any format that SurfaceTopography reads.

    Raises
    ------
    ValueError
        If the library is missing or a file cannot be used; one sentence.
    OSError
        If a file cannot be opened.
    """
    if not paths:
        raise ValueError("no file is named; name one measurement of the surface or several")
    repeated = sorted({str(path) for path in paths if list(paths).count(path) > 1})
    if repeated:
        raise ValueError(f"{repeated[0]} is named twice; a measurement counts once")
    return tuple(_measurement(path, treatment or Treatment()) for path in paths)


def _measurement(path: Path, treatment: Treatment) -> Measurement:
    """One measurement."""
    content = path.read_bytes()
    if not content:
        raise ValueError(f"{path} is empty; export it from the instrument again")
    raw, name, comment = _raw(path, treatment)
    heights = np.ma.asarray(raw.heights())
    missing = float(np.mean(np.ma.getmaskarray(heights)))
    if missing > _MOST_MISSING:
        raise ValueError(
            f"{path}: {missing:.0%} of the points are missing; more than {_MOST_MISSING:.0%} are "
            "too many to interpolate, so crop the scan or measure again"
        )
    if not np.ptp(np.ma.compressed(heights)) > 0:
        raise ValueError(f"{path}: all heights are equal; a smooth surface has no spectrum")
    level = raw.detrend(treatment.detrend)
    if missing > 0:
        level = level.interpolate_undefined_data()
    level = level.to_unit("m")
    size = tuple(map(float, level.physical_sizes))
    pixel = max(side / count for side, count in zip(size, heights.shape, strict=True))
    stated = level.short_reliability_cutoff() or 0.0
    shortest = max(_PIXELS_PER_WAVE * pixel, stated, treatment.shortest or 0.0)
    longest = min(size) / _WAVES_PER_SIDE
    if longest < 2**_FEWEST_OCTAVES * shortest:
        raise ValueError(
            f"{path}: wavelengths from {shortest:.3g} m to {longest:.3g} m can be trusted; a "
            f"spectrum needs {_FEWEST_OCTAVES} octaves of them, so use a larger or finer scan"
        )
    return Measurement(
        path=path,
        format=name,
        comment=comment,
        checksum=hashlib.sha256(content).hexdigest()[:8],
        size=size,
        heights=np.array(np.ma.getdata(level.heights()), dtype=float),
        periodic=bool(level.is_periodic),
        missing=missing,
        shortest=shortest,
        longest=longest,
    )


def surface_library() -> ModuleType:
    """The library SurfaceTopography; seconds to import, hence imported where it is needed.

    Raises
    ------
    ValueError
        If it is not installed, with the command that installs it.
    """
    try:
        import SurfaceTopography
    except ModuleNotFoundError as error:
        raise MissingExtraError("measured surfaces", error, "surfaces") from error
    return SurfaceTopography


def _raw(path: Path, treatment: Treatment) -> tuple[Any, str, str]:
    """The library's map or line of a file, the name of its format, and its comment."""
    library = surface_library()
    try:
        reader = library.open_topography(str(path))
        channel = reader.default_channel
    except library.Exceptions.CannotDetectFileFormat as error:
        raise ValueError(
            f"{path} is in no format that SurfaceTopography reads, or damaged; export it from the "
            "instrument again, as X3P if there is a choice"
        ) from error
    # A damaged file may fail anywhere in a parser that is not ours.
    except Exception as error:
        raise _unreadable(path, "what its head says", error) from error
    if channel.data_kind.value != "height":
        raise ValueError(
            f"{path}: channel {channel.name!r} holds {channel.data_kind.value}, no heights; export "
            "the channel of the heights alone"
        )
    given = _completed(path, reader.format(), channel, treatment)
    try:
        raw = reader.topography(channel_index=channel.index, **given)
        raw.heights()
    except Exception as error:
        raise _unreadable(path, reader.format(), error) from error
    if not raw.is_uniform:
        raise ValueError(
            f"{path}: the points are not equally spaced; resample the line on a uniform grid"
        )
    comment = raw.info.get("comment") or ""
    return raw, reader.format(), str(comment).strip()


def _completed(path: Path, name: str, channel: Any, treatment: Treatment) -> dict[str, Any]:
    """What a file does not state, from the treatment."""
    given: dict[str, Any] = {}
    if channel.unit is None:
        if treatment.unit is None:
            raise ValueError(
                f"{path}, read as {name}, states no unit of length; name it, as in --unit um"
            )
        if not surface_library().Support.UnitConversion.is_length_unit(treatment.unit):
            raise ValueError(f"--unit {treatment.unit} is no unit of length; name one, as in um")
        given["unit"] = treatment.unit
    elif treatment.unit not in (None, channel.unit):
        raise ValueError(
            f"{path} states its own unit, {channel.unit}; leave --unit {treatment.unit} out"
        )
    if channel.physical_sizes is None or None in channel.physical_sizes:
        if treatment.size is None:
            raise ValueError(f"{path} states no size of the scan; name it, as in --size 50,50")
        if len(treatment.size) != channel.dim:
            raise ValueError(
                f"{path} has {channel.dim} dimension(s) and the size that is named "
                f"{len(treatment.size)}; name one length for each, as in --size 50,50"
            )
        given["physical_sizes"] = treatment.size
    elif treatment.size is not None:
        stated = " x ".join(f"{side:g}" for side in channel.physical_sizes)
        raise ValueError(f"{path} states its own size, {stated} {channel.unit}; leave --size out")
    return given


def _unreadable(path: Path, name: str, error: Exception) -> ValueError:
    """What is said of a file at which a reader fails."""
    return ValueError(
        f"{path} cannot be read as {name}: {_first_line(error)}; export it from the instrument "
        "again"
    )


def _first_line(error: Exception) -> str:
    """First line of a message, or what kind it is."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__
