"""A sweep: its parameters, its simulations, and the files that they become."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from crackfront.analysis.table import SweepRow, row_type
from crackfront.core.adhesion import FieldKind
from crackfront.core.arguments import nearest_name
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import Scales
from crackfront.simulate.contact import SurfaceLoads, SweepLoad
from crackfront.simulate.ensembles import GAUSSIAN, Ensemble
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.simulation import Recorded, Simulation, simulation_of


@dataclass(frozen=True, slots=True)
class NamedSpectrum:
    """A spectrum, lengths in the reduced lateral unit, and what the configuration calls it.

    The ensemble makes its surfaces. `spring` is the length of the springs that pull a straight
    front, in the unit of the load, and 0 for a sphere.
    """

    name: str
    spectrum: Spectrum
    ensemble: Ensemble = GAUSSIAN
    spring: float = 0.0


@dataclass(frozen=True, slots=True)
class Shard:
    """What one job runs: a spectrum with all its amplitudes, and a block of its realisations.

    Its name is the name of the spectrum, with the first and last realisation if it lacks some.
    """

    item: NamedSpectrum
    realisations: range
    name: str


MOST_SHARDS = 1000
"""Jobs of one sweep; a graph of more takes seconds to build and minutes to submit."""


_ROUND_OFF = 1e-9
"""Relative distance by which an amplitude may lie outside the range of the fit."""


@dataclass(frozen=True, slots=True)
class FitRange:
    """Requested e_el / w_int that enter a fit, and the number of bootstrap samples."""

    lowest_elastic_energy: float
    highest_elastic_energy: float
    n_bootstrap: int

    def chosen(self, elastic_energies: Iterable[float]) -> list[float]:
        """The elastic energies that enter the fit, of some of them (Units: w_int)."""
        lowest = self.lowest_elastic_energy * (1 - _ROUND_OFF)
        highest = self.highest_elastic_energy * (1 + _ROUND_OFF)
        return [energy for energy in elastic_energies if lowest <= energy <= highest]


@dataclass(frozen=True, slots=True)
class Sweep:
    """All parameters of a sweep, in reduced units."""

    seed: int
    kind: FieldKind
    """What the spectra describe."""
    scales: Scales | None
    """Scene that the configuration was written for, where it was in SI units."""
    spectra: tuple[NamedSpectrum, ...]
    elastic_energies: tuple[float, ...]
    """Requested e_el / w_int."""
    n_realisation: int
    """Realisations of the noise for every spectrum."""
    numerics: Numerics
    """How simulations are resolved and solved."""
    schedule: SweepLoad
    """Loads of all simulations, or the springs of straight fronts."""
    record: tuple[Recorded, ...]
    """What to record in addition to the curves."""
    failed_fraction: float
    """Part of the simulations that may end without a value."""
    fit: FitRange

    @property
    def row_type(self) -> type[SweepRow]:
        """Class of its rows."""
        return row_type("jumps" in self.record)

    def named(self, name: str) -> NamedSpectrum:
        """Spectrum of a name; a ValueError names the nearest where there is none."""
        spectra = {item.name: item for item in self.spectra}
        if name in spectra:
            return spectra[name]
        raise ValueError(f"the sweep lacks a spectrum {name!r}; {nearest_name(name, spectra)}")

    def simulation(
        self, item: NamedSpectrum, elastic_energy: float, realisation: int
    ) -> Simulation:
        """One simulation of the sweep, with the settings that its numerics choose."""
        kind, loads, numerics = self.kind, self.schedule, self.numerics
        if isinstance(loads, SurfaceLoads):
            loads = loads.for_surface(kind, item.spectrum, elastic_energy, item.spring, numerics)
        return simulation_of(
            kind,
            item.spectrum,
            elastic_energy,
            loads,
            numerics,
            seed=self.seed,
            realisation=realisation,
            name=item.name,
            record=self.record,
            ensemble=item.ensemble,
        )

    def simulations(
        self, item: NamedSpectrum | None = None, realisations: range | None = None
    ) -> Iterator[Simulation]:
        """Simulations, by default all: by spectrum, amplitude and realisation."""
        block = range(self.n_realisation) if realisations is None else realisations
        for spectrum in self.spectra if item is None else (item,):
            for first in self.one_per_amplitude(spectrum):
                yield from (replace(first, realisation=number) for number in block)

    def one_per_amplitude(self, item: NamedSpectrum) -> tuple[Simulation, ...]:
        """First realisation of a spectrum for each amplitude."""
        return _one_per_amplitude(self, item)

    def series(self, item: NamedSpectrum) -> tuple[str, ...]:
        """Series of the simulations of a spectrum, for each amplitude."""
        return _series(self, item)

    @property
    def n_simulation(self) -> int:
        """Number of simulations."""
        return len(self.spectra) * len(self.elastic_energies) * self.n_realisation

    def shards(self, block: int | str | None = None) -> tuple[Shard, ...]:
        """Shards of a number of realisations each, by default of all.

        ValueError if the number is not positive, or there are more than :data:`MOST_SHARDS` shards.
        """
        size = self.n_realisation if block is None else block
        if not isinstance(size, int) or size < 1:
            raise ValueError(f"a block is {size} realisations; it must be 1 or more of them")
        n_block = -(-self.n_realisation // size)
        if len(self.spectra) * n_block > MOST_SHARDS:
            least = -(-self.n_realisation // max(1, MOST_SHARDS // len(self.spectra)))
            raise ValueError(
                f"blocks of {size} realisations are {len(self.spectra) * n_block} shards, more "
                f"than {MOST_SHARDS} jobs; use blocks of {least} or more"
            )
        return tuple(
            self.named_shard(item, range(first, min(first + size, self.n_realisation)))
            for item in self.spectra
            for first in range(0, self.n_realisation, size)
        )

    def named_shard(self, item: NamedSpectrum, realisations: range) -> Shard:
        """Shard of a spectrum and a block of realisations, which the sweep must have."""
        everything = range(self.n_realisation)
        if realisations.stop > everything.stop:
            raise ValueError(
                f"realisations {realisations.start} to {realisations.stop - 1} are not all in the "
                f"sweep, which has 0 to {self.n_realisation - 1}"
            )
        block = f".{realisations.start}-{realisations.stop - 1}"
        return Shard(item, realisations, item.name + ("" if realisations == everything else block))


@functools.lru_cache(maxsize=4096)
def _one_per_amplitude(sweep: Sweep, item: NamedSpectrum) -> tuple[Simulation, ...]:
    """First realisations; the laws of the numerics take a millisecond for each."""
    return tuple(
        sweep.simulation(item, elastic_energy, 0) for elastic_energy in sweep.elastic_energies
    )


@functools.lru_cache(maxsize=4096)
def _series(sweep: Sweep, item: NamedSpectrum) -> tuple[str, ...]:
    """Series of the first realisations."""
    return tuple(first.series for first in _one_per_amplitude(sweep, item))
