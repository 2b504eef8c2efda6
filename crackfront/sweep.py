"""A sweep: its parameters, its simulations, and the files that they become."""

from __future__ import annotations

import difflib
import hashlib
from dataclasses import dataclass

from crackfront.cycle import LoadSchedule
from crackfront.laws import chosen_numerics
from crackfront.scene import FieldKind, Numerics, Simulation, correlation_length, resolution
from crackfront.spectrum import SelfAffineSpectrum
from crackfront.steady import SteadySchedule
from crackfront.units import Scales


@dataclass(frozen=True, slots=True)
class NamedSpectrum:
    """A spectrum and what the configuration calls it.

    Attributes
    ----------
    name : str
        Name of the spectrum.
    spectrum : SelfAffineSpectrum
        Its shape. (Units: reduced lateral length)
    """

    name: str
    spectrum: SelfAffineSpectrum


@dataclass(frozen=True, slots=True)
class FitRange:
    """Amplitudes that enter a fit, and the number of bootstrap samples.

    Attributes
    ----------
    lowest_elastic_energy, highest_elastic_energy : float
        Smallest and largest requested e_el / w_int.
    n_bootstrap : int
        Resamplings of the realisations.
    """

    lowest_elastic_energy: float
    highest_elastic_energy: float
    n_bootstrap: int


@dataclass(frozen=True, slots=True)
class Sweep:
    """All parameters of a sweep, in reduced units.

    Attributes
    ----------
    seed : int
        Seed of all noise.
    kind : {"roughness", "chemical"}
        What the spectra describe.
    scales : Scales or None
        Scene that the configuration was written for, where it was in SI units.
    spectra : tuple of NamedSpectrum
        Shapes of the spectra.
    elastic_energies : tuple of float
        Requested e_el / w_int.
    n_realisation : int
        Realisations of the noise for every spectrum.
    numerics : Numerics
        Resolution and solver.
    numerical_error : float or None
        Standard error of k that the numerics may leave. Where it is given, it decides the
        resolution and the tolerance for every spectrum and amplitude.
    schedule : LoadSchedule or SteadySchedule
        Penetrations to visit: full cycles, or the steady parts of their branches.
    record_fronts, record_energy : bool
        What to record beside the curves.
    failed_fraction : float
        Part of the simulations that may end without a value.
    fit : FitRange
        Amplitudes that enter the fit.
    """

    seed: int
    kind: FieldKind
    scales: Scales | None
    spectra: tuple[NamedSpectrum, ...]
    elastic_energies: tuple[float, ...]
    n_realisation: int
    numerics: Numerics
    numerical_error: float | None
    schedule: LoadSchedule | SteadySchedule
    record_fronts: bool
    record_energy: bool
    failed_fraction: float
    fit: FitRange

    def named(self, name: str) -> NamedSpectrum:
        """Spectrum of a name.

        Raises
        ------
        ValueError
            If there is none, with the nearest name.
        """
        for item in self.spectra:
            if item.name == name:
                return item
        names = [item.name for item in self.spectra]
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"did you mean {near[0]}?" if near else f"choose one of {', '.join(names)}"
        raise ValueError(f"the sweep has no spectrum {name!r}; {hint}")

    def correlation_length(self, item: NamedSpectrum) -> float:
        """Wavelength of the mean wavevector of w_loc, in reduced lateral lengths."""
        return correlation_length(self.kind, item.spectrum)

    def numerics_of(self, item: NamedSpectrum, energy: float) -> Numerics:
        """Numerics of one spectrum and amplitude."""
        if self.numerical_error is None:
            return self.numerics
        return chosen_numerics(
            self.numerical_error, self.kind, item.spectrum, energy, self.numerics
        )

    def simulation(self, item: NamedSpectrum, energy: float, realisation: int) -> Simulation:
        """One simulation of the sweep."""
        numerics = self.numerics_of(item, energy)
        return Simulation(
            spectrum_name=item.name,
            kind=self.kind,
            spectrum=item.spectrum,
            elastic_energy=energy,
            realisation=realisation,
            sweep_seed=self.seed,
            resolution=resolution(item.spectrum, numerics, self.schedule.max_penetration),
            schedule=self.schedule,
            tolerance=numerics.tolerance,
            max_sweeps=numerics.max_sweeps,
            solver=numerics.solver,
            record_fronts=self.record_fronts,
            record_energy=self.record_energy,
        )

    def shard(self, item: NamedSpectrum) -> tuple[Simulation, ...]:
        """Simulations of one spectrum, amplitude by amplitude."""
        return tuple(
            self.simulation(item, energy, realisation)
            for energy in self.elastic_energies
            for realisation in range(self.n_realisation)
        )


def shard_fingerprint(shard: tuple[Simulation, ...]) -> str:
    """Twelve hexadecimal digits that change with any simulation of a shard."""
    text = "\n".join(simulation.stem for simulation in shard)
    return hashlib.sha256(text.encode()).hexdigest()[:12]
