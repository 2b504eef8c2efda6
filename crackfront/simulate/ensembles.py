"""Ensembles of random surfaces: how the surfaces of one spectrum are distributed.

A new ensemble is a frozen dataclass that derives from :class:`Ensemble`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.fft import next_fast_len

from crackfront.core.arrays import Array
from crackfront.core.marginal import Marginal, field_of_marginal
from crackfront.core.spectrum import Spectrum
from crackfront.core.synthesis import gaussian_field, resampled

if TYPE_CHECKING:
    from crackfront.simulate.tiles import RandomSurface

_POINTS_PER_CUTOFF = 3
"""Points per short cutoff of the grid on which phases are changed, whatever the numerics."""


class Ensemble(ABC):
    """Surfaces of one spectrum."""

    __slots__ = ()

    ensemble_name: ClassVar[str]
    """Name in keys, whatever the class is named."""

    point_seconds: ClassVar[float] = 0.0
    """Time per point of the tile that a surface takes beyond a Gaussian one. (Units: s)"""

    @property
    @abstractmethod
    def key(self) -> dict[str, Any]:
        """What determines the surfaces in addition to spectrum and seed, as a JSON object."""

    @property
    @abstractmethod
    def description(self) -> str:
        """The surfaces in words; empty if they are Gaussian."""

    @property
    def tile_side(self) -> float | None:
        """Side of the tiles, if the ensemble decides it (Units: reduced lateral length)."""
        return None

    @abstractmethod
    def values(self, spectrum: Spectrum, surface: RandomSurface) -> Array:
        """Values of a surface on its tile, by a spectrum that has an amplitude.

        (Units: as of :func:`crackfront.core.synthesis.gaussian_field`)
        """


@dataclass(frozen=True, slots=True)
class GaussianEnsemble(Ensemble):
    """Modes with random phases: the values are normally distributed."""

    ensemble_name = "gaussian"

    @property
    def key(self) -> dict[str, Any]:
        """Nothing."""
        return {}

    @property
    def description(self) -> str:
        """Nothing."""
        return ""

    def values(self, spectrum: Spectrum, surface: RandomSurface) -> Array:
        """The Gaussian field of the seed."""
        rng = np.random.default_rng(surface.seed)
        return gaussian_field(spectrum, surface.shape, surface.sides, rng)


@dataclass(frozen=True, slots=True)
class MarginalEnsemble(Ensemble):
    """Gaussian fields whose phases are changed until values have a distribution.

    All modes keep their magnitudes, so that e_el of a surface is as of the Gaussian one.
    """

    ensemble_name = "marginal"
    point_seconds = 2e-6

    marginal: Marginal

    @property
    def key(self) -> dict[str, Any]:
        """The distribution and its parameters."""
        return asdict(self.marginal)

    @property
    def description(self) -> str:
        """The distribution."""
        values = (f"{name} {value:g}" for name, value in self.marginal.parameters)
        return f"values of the distribution {' '.join((self.marginal.distribution, *values))}"

    def values(self, spectrum: Spectrum, surface: RandomSurface) -> Array:
        """The field of the seed, the same on every grid that resolves the spectrum."""
        n_x, n_y = (
            int(next_fast_len(math.ceil(_POINTS_PER_CUTOFF * side / spectrum.short_cutoff)))
            for side in surface.sides
        )
        rng = np.random.default_rng(surface.seed)
        field = gaussian_field(spectrum, (n_x, n_y), surface.sides, rng)
        return resampled(field_of_marginal(field, self.marginal), surface.shape)


GAUSSIAN = GaussianEnsemble()
"""Surfaces of a sweep where nothing else is said."""
