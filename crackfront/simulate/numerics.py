"""How simulations are resolved and solved, and what error of k that leaves."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from scipy.fft import next_fast_len

from crackfront.analysis.steady import SteadyAdhesion
from crackfront.core.adhesion import FieldKind
from crackfront.core.solver import DEFAULT_MAX_SWEEPS
from crackfront.core.solver.relax import named_solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.laws import Knob, Knobs, chosen_knobs, combined_error
from crackfront.simulate.schedule import Schedule
from crackfront.simulate.simulation import Resolution, Simulation


@dataclass(frozen=True, slots=True)
class Numerics:
    """How simulations are resolved and solved."""

    knobs: Knobs | float
    """Resolution and tolerance, or the standard error of the factor k of either branch that they
    may leave: measured laws then choose them for every spectrum and amplitude."""
    tile_roll_offs: float = 4.0
    tile_cutoffs: float = 200.0
    """Side of the tile in roll-off wavelengths, of other spectra in the longest wavelengths that
    matter, and at least so many short cutoffs."""
    max_sweeps: int = DEFAULT_MAX_SWEEPS
    """Limit on the sweeps of one load step."""
    solver: str = "newton"
    """A name in :data:`crackfront.core.solver.relax.SOLVERS`."""

    def knobs_of(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        usual_size: float | None = None,
    ) -> Knobs:
        """Knobs for one spectrum and amplitude.

        The size is as of :func:`crackfront.simulate.laws.chosen_knobs`.
        """
        if isinstance(self.knobs, Knobs):
            return self.knobs
        return chosen_knobs(self.knobs, kind, spectrum, elastic_energy, usual_size)

    def tile_side(self, spectrum: Spectrum) -> float:
        """Least side of a tile (Units: that of the spectrum)."""
        return max(
            self.tile_roll_offs * spectrum.longest_feature,
            self.tile_cutoffs * spectrum.short_cutoff,
        )


def resolution(
    spectrum: Spectrum, numerics: Numerics, knobs: Knobs, schedule: Schedule
) -> Resolution:
    """Sizes of the front and of the tile for one spectrum; those of a line are of its schedule.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> from crackfront.simulate.sphere.cycle import FullCycle
    >>> flat = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=1.0)
    >>> knobs = Knobs(None, 2, 4, "cubic", 4, 1e-6)
    >>> numerics = Numerics(knobs, tile_roll_offs=10, tile_cutoffs=20)
    >>> resolution(flat, numerics, knobs, FullCycle(max_penetration=1.0, step=0.1))
    Resolution(n_angle=240, spacing=0.025, interpolation='cubic', tile_side=2.0, n_point=80)
    """
    cutoff = spectrum.short_cutoff
    sites = schedule.front_length / cutoff * knobs.angles_per_cutoff
    side, spacing = schedule.fitted(numerics.tile_side(spectrum), cutoff / knobs.samples_per_cutoff)
    points = math.ceil(side / cutoff * knobs.pixels_per_cutoff * (1 - 1e-12))
    n_point = next_fast_len(points, real=True)
    return Resolution(
        n_angle=schedule.site_count(knobs.angles, sites, n_point),
        spacing=spacing,
        interpolation=knobs.interpolation,
        tile_side=side,
        n_point=n_point,
    )


def simulation_of(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    schedule: Schedule,
    numerics: Numerics,
    *,
    seed: int,
    realisation: int = 0,
    name: str = "single",
    record: Collection[Literal["fronts", "energy"]] = (),
) -> Simulation:
    """The simulation of a surface; the largest penetration of the schedule decides its sites.

    The name is that of the spectrum, the numerics are how it is resolved and solved, and `record`
    is what is kept beside the curves; the rest is as in
    :class:`crackfront.simulate.simulation.Simulation`.
    """
    knobs = numerics.knobs_of(kind, spectrum, elastic_energy, schedule.usual_size(spectrum))
    return Simulation(
        spectrum_name=name,
        kind=kind,
        spectrum=spectrum,
        elastic_energy=elastic_energy,
        realisation=realisation,
        sweep_seed=seed,
        resolution=resolution(spectrum, numerics, knobs, schedule),
        schedule=schedule,
        solver=named_solver(numerics.solver, knobs.tolerance, numerics.max_sweeps),
        record_fronts="fronts" in record,
        record_energy="energy" in record,
    )


def missed_error(simulation: Simulation, wanted: float) -> float:
    """Error of k that the numerics are expected to leave; 0 where it is at most the wanted one."""
    left = max(numerical_error(simulation)) / simulation.elastic_energy
    # Knobs have two digits.
    return left if left > 1.2 * wanted else 0.0


def numerical_error(
    simulation: Simulation, size: float | None = None, front_length: float | None = None
) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) that the numerics leave (Units: w_int).

    The size is the number of states times length of the front over the short cutoff, by default the
    usual one; the front length that of the longest front, by default that of a smooth contact.
    (Units: reduced lateral length)
    """
    sizes, cutoff = simulation.resolution, simulation.spectrum.short_cutoff
    if front_length is None:
        front_length = simulation.schedule.front_length
    usual_size = simulation.schedule.usual_size(simulation.spectrum)
    values: dict[Knob, float] = {
        "sites": sizes.n_angle * cutoff / front_length,
        sizes.interpolation: cutoff / sizes.spacing,
        "pixels": cutoff * sizes.n_point / sizes.tile_side,
        "tolerance": simulation.solver.tolerance,
    }
    return combined_error(
        simulation.kind,
        simulation.spectrum,
        simulation.elastic_energy,
        values,
        usual_size if size is None else size,
        usual_size,
    )


def stated_error(
    simulation: Simulation, steady: SteadyAdhesion, correlation_length: float
) -> tuple[float, float]:
    """Numerical standard errors of the w_appr and w_retr that a simulation found (Units: w_int).

    States closer than a correlation length of w_loc count as one.
    """
    *sizes, longest = simulation.schedule.averaged_sizes(
        steady, correlation_length, simulation.spectrum.short_cutoff
    )
    approach, _ = numerical_error(simulation, sizes[0], longest)
    _, retraction = numerical_error(simulation, sizes[1], longest)
    return approach, retraction
