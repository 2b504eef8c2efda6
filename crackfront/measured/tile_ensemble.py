"""Measured maps as the surfaces of a sweep, one for each realisation."""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crackfront.analysis.estimate import exact_estimate
from crackfront.core.adhesion import half_derivative_mean_square
from crackfront.core.arrays import Array
from crackfront.core.spectrum import Spectrum, TabulatedSpectrum
from crackfront.core.synthesis import resampled
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.scan.scan_files import checksum
from crackfront.measured.spectrum.measured_surface import RoughSurface
from crackfront.measured.tile_heights import tile_heights
from crackfront.simulate.ensembles import Ensemble
from crackfront.surfaces.tile_measures import Modes, tile_modes
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    from crackfront.simulate.tiles import RandomSurface

_UNEQUAL = 1e-6
"""Relative difference of two sides that count as equal."""

_BINS_A_DECADE = 20
"""Bins of the mean density of the maps, as many as densities of scans have."""

_CACHED = 4
"""Maps that a process keeps in memory."""


@dataclass(frozen=True, slots=True)
class Tile:
    """A measured map on a square periodic tile."""

    heights: Array
    """(n, n) (Units: m)"""
    pixel: float
    shortest: float
    """Distance of points, and shortest wavelength. (Units: m)"""
    checksum: str
    """Eight hexadecimal digits of the content of the file."""

    @property
    def side(self) -> float:
        """Side of the tile (Units: m)."""
        return self.pixel * len(self.heights)

    @property
    def half_derivative(self) -> float:
        """Mean square of the half-derivative (Units: m)."""
        return half_derivative_mean_square(self.heights, self.pixel)


def read_tile(path: Path, options: ReadingOptions) -> Tile:
    """Tile of a map, levelled, made periodic and without waves that cannot be trusted.

    ValueError if the file cannot be used or the tile is not a square; OSError if it cannot be
    opened.
    """
    return _tile(path, options, checksum(path))


@functools.lru_cache(maxsize=_CACHED)
def _tile(path: Path, options: ReadingOptions, content: str) -> Tile:
    """Tile of a file of some content."""
    measurements = read_measurements([path], options)
    if len(measurements) > 1:
        raise ValueError(
            f"{path} contains {len(measurements)} measurements; name a file with a single one"
        )
    scan = analysed_scan(measurements[0], options.shortest, options.longest)
    measurement = scan.trusted_measurement
    heights, pixel = tile_heights(measurement)
    if len(set(heights.shape)) > 1:
        sides = " by ".join(prefixed("m", pixel * count) for count in heights.shape)
        raise ValueError(f"the tile of {path} is {sides}; crop it to a square")
    return Tile(heights, pixel, measurement.shortest, content)


@dataclass(frozen=True, slots=True)
class TileEnsemble(Ensemble):
    """Maps of files, the first for realisation 0; all have one factor to the requested e_el."""

    ensemble_name = "tiles"

    paths: tuple[Path, ...]
    options: tuple[ReadingOptions, ...]
    checksums: tuple[str, ...]
    """Of the content of each file."""
    half_derivative: float
    """Mean square of the half-derivative, mean over all maps. (Units: m)"""
    side: float
    """Side of the tiles. (Units: as the spectrum of the sweep)"""

    @property
    def key(self) -> dict[str, Any]:
        """The contents of the files, and how they are read."""
        options = [record.model_dump(mode="json", exclude_defaults=True) for record in self.options]
        return {"checksums": self.checksums, "options": options}

    @property
    def description(self) -> str:
        """The number of files."""
        return f"tiles of {len(self.paths)} files with the checksums {' '.join(self.checksums)}"

    @property
    def tile_side(self) -> float:
        """Side of the tiles."""
        return self.side

    def in_units(self, length: float) -> TileEnsemble:
        """The ensemble with its side divided by a unit."""
        return replace(self, side=self.side / length)

    def values(self, spectrum: Spectrum, surface: RandomSurface) -> Array:
        """Heights of the map of a realisation; the mean e_el of all maps is as of the spectrum."""
        number = surface.realisation
        tile = read_tile(self.paths[number], self.options[number])
        if tile.checksum != self.checksums[number]:
            raise ValueError(
                f"{self.paths[number]} changed while the sweep ran; run the command again"
            )
        # Half-derivatives are heights squared over a length, whose unit is the sweep's.
        half_derivative = self.half_derivative * tile.side / self.side
        return resampled(
            math.sqrt(spectrum.mean_square(0.5) / half_derivative) * tile.heights, surface.shape
        )


@dataclass(frozen=True, slots=True)
class TileFiles:
    """What the maps of some files have in common."""

    ensemble: TileEnsemble
    """Units: m."""
    spectrum: TabulatedSpectrum
    """Mean density over all directions and maps. (Units: m)"""

    @property
    def surface(self) -> RoughSurface:
        """Measures of the maps together."""
        half_derivative = exact_estimate(self.ensemble.half_derivative)
        return RoughSurface((), half_derivative, half_derivative)

    @property
    def checksum(self) -> str:
        """Eight hexadecimal digits from the contents of all files."""
        text = "".join(self.ensemble.checksums)
        return hashlib.sha256(text.encode()).hexdigest()[:8]


def tile_files(paths: Sequence[Path], options: Sequence[ReadingOptions]) -> TileFiles:
    """Maps of some files; ValueError if one cannot be used or their sides differ."""
    modes, checksums, half_derivatives, shortest = [], [], [], []
    sides: list[float] = []
    for path, record in zip(paths, options, strict=True):
        tile = read_tile(path, record)
        if sides and abs(tile.side / sides[0] - 1) > _UNEQUAL:
            raise ValueError(
                f"the tile of {path} has a side of {prefixed('m', tile.side)} and the tile of "
                f"{paths[0]} one of {prefixed('m', sides[0])}; crop them to equal sides"
            )
        sides.append(tile.side)
        modes.append(tile_modes(tile.heights, tile.pixel))
        checksums.append(tile.checksum)
        half_derivatives.append(tile.half_derivative)
        shortest.append(tile.shortest)
    ensemble = TileEnsemble(
        tuple(paths),
        tuple(options),
        tuple(checksums),
        half_derivative=float(np.mean(half_derivatives)),
        side=sides[0],
    )
    return TileFiles(ensemble, _mean_spectrum(modes, sides[0], min(shortest)))


def _mean_spectrum(modes: Sequence[Modes], side: float, shortest: float) -> TabulatedSpectrum:
    """Mean density of tiles over all directions, down to the shortest wavelength (Units: m)."""
    together = Modes(
        *(
            np.concatenate([getattr(item, name) for item in modes])
            for name in ("wavevector", "power", "count")
        )
    )
    wavevector, density = together.isotropic_density(_BINS_A_DECADE, side**2)
    inside = wavevector < 2 * np.pi / shortest * (1 - 1e-9)
    wavelengths = [*(2 * np.pi / wavevector[inside]).tolist(), shortest]
    densities = density[inside].tolist()
    return TabulatedSpectrum(tuple(wavelengths), (*densities, densities[-1]))
