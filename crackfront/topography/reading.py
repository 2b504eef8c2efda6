"""Measurements of surfaces: read, detrended and completed by a library."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crackfront.topography.files import Treatment, raw_topography

Array = NDArray[np.float64]

PIXELS_PER_WAVE = 4
"""Points in the shortest wavelength that is trusted where a file knows no resolution of its own:
shorter waves hold an aliased part of those below the pixels."""

WAVES_PER_SIDE = 2
"""Longest wavelength that is trusted, in a side of the scan: detrending and the window take part
of longer waves away."""

MOST_MISSING = 0.1
"""Part of the points that may be missing; more leave too much to the interpolation."""

FEWEST_OCTAVES = 2
"""Octaves between the shortest and the longest trusted wavelength that a spectrum needs."""


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
    """Measurements of one surface.

    Parameters
    ----------
    paths : sequence of Path
        Files in any format that SurfaceTopography reads.
    treatment : Treatment, optional
        How they are read.

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
    raw, name, comment = raw_topography(path, treatment)
    heights = np.ma.asarray(raw.heights())
    missing = float(np.mean(np.ma.getmaskarray(heights)))
    if missing > MOST_MISSING:
        raise ValueError(
            f"{path}: {missing:.0%} of the points are missing; more than {MOST_MISSING:.0%} are "
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
    shortest = max(PIXELS_PER_WAVE * pixel, stated, treatment.shortest or 0.0)
    longest = min(size) / WAVES_PER_SIDE
    if longest < 2**FEWEST_OCTAVES * shortest:
        raise ValueError(
            f"{path}: wavelengths from {shortest:.3g} m to {longest:.3g} m can be trusted; a "
            f"spectrum needs {FEWEST_OCTAVES} octaves of them, so use a larger or finer scan"
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
