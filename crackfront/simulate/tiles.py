"""Random surfaces on periodic tiles, their works of adhesion, and the sizes of front and tile."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.fft import next_fast_len

from crackfront.core.adhesion import (
    AdhesionMap,
    FieldKind,
    chemical_adhesion,
    correlation_length,
    rough_adhesion,
)
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Interpolation
from crackfront.core.geometry.base import fast_site_count
from crackfront.core.spectrum import Spectrum
from crackfront.core.synthesis import uncorrelated_rows
from crackfront.simulate.ensembles import GAUSSIAN, Ensemble
from crackfront.simulate.settings import Settings


@dataclass(frozen=True, slots=True)
class Resolution:
    """Sizes that the numerics give to one spectrum: sites, samples along a ray, points of the tile.

    `spacing` is the distance of samples, `tile_side` the side. (Units: reduced lateral length)
    """

    n_angle: int
    spacing: float
    interpolation: Interpolation
    tile_side: float
    n_point: int


@dataclass(frozen=True, slots=True)
class Fineness:
    """How finely the numerics resolve one spectrum."""

    short_cutoff: float
    """Shortest wavelength. (Units: reduced lateral length)"""
    tile_side: float
    """Least side of the tile. (Units: reduced lateral length)"""
    settings: Settings
    """Sites, samples and points per short cutoff."""

    def resolution(self, side: float, front_length: float) -> Resolution:
        """Sizes on a tile of a side along the front, for a front of a length (Units: length)."""
        settings, cutoff = self.settings, self.short_cutoff
        points = math.ceil(side / cutoff * settings.pixels_per_cutoff * (1 - 1e-12))
        sites = front_length / cutoff * settings.angles_per_cutoff
        return Resolution(
            n_angle=settings.angles or fast_site_count(sites),
            spacing=cutoff / settings.samples_per_cutoff,
            interpolation=settings.interpolation,
            tile_side=side,
            n_point=next_fast_len(points, real=True),
        )


@dataclass(frozen=True, slots=True)
class RandomSurface:
    """One realisation of a spectrum on a tile."""

    kind: FieldKind
    """What the spectrum describes: heights, or the work of adhesion itself."""
    spectrum: Spectrum
    """Shape of the spectrum, whatever its plateau. (Units: reduced lateral length)"""
    elastic_energy: float
    """Requested e_el / w_int; for a chemical field the equivalent (w_rms / w_int)^2 / 4."""
    seed: int
    """Seed of the noise, as of `numpy.random.default_rng`."""
    shape: tuple[int, int]
    """Points of the tile along x and y."""
    sides: tuple[float, float]
    """Sides of the tile along x and y. (Units: reduced lateral length)"""
    ensemble: Ensemble = GAUSSIAN
    """Surfaces of this spectrum, of which it is one."""
    realisation: int = 0
    """Its number among them."""

    @property
    def correlation_length(self) -> float:
        """Wavelength of the mean wavevector of w_loc (Units: reduced lateral length)."""
        return correlation_length(self.kind, self.spectrum)

    @property
    def pixel(self) -> float:
        """Distance of points of the tile (Units: reduced lateral length)."""
        return self.sides[1] / self.shape[1]


def surface_values(surface: RandomSurface) -> Array:
    """Heights on the tile (Units: reduced vertical length), or deviations of w_loc (Units: w_int).

    The noise of a realisation is scaled to the amplitude, so that all amplitudes of a spectrum
    see the same surface.
    """
    unit = surface.spectrum.with_elastic_energy(1.0)
    values = surface.ensemble.values(unit, surface)
    if surface.kind == "roughness":
        values *= math.sqrt(surface.elastic_energy)
    else:
        values *= 2 * math.sqrt(surface.elastic_energy / unit.mean_square(0.0))
    return values


def correlated_adhesion(surface: RandomSurface) -> AdhesionMap:
    """Work of adhesion of a surface."""
    adhesion = rough_adhesion if surface.kind == "roughness" else chemical_adhesion
    return adhesion(surface_values(surface), surface.pixel)


def uncorrelated_adhesion(surface: RandomSurface) -> AdhesionMap:
    """Rows of the spectrum of w_loc integrated along the front; e_el is w_rms^2 / 4 w_int."""
    spectrum, order = surface.spectrum, 0.5 if surface.kind == "roughness" else 0.0
    rng, pixel = np.random.default_rng(surface.seed), surface.pixel
    rows = uncorrelated_rows(spectrum, order, surface.shape, pixel, rng)
    ratio = spectrum.mean_square(order - 0.5) / spectrum.mean_square(order)
    adhesion = chemical_adhesion(rows, pixel)
    rows *= math.sqrt(8 * surface.elastic_energy * ratio / pixel)
    energy = surface.elastic_energy * adhesion.w_rms**2
    return replace(chemical_adhesion(rows, pixel), e_el=energy)
