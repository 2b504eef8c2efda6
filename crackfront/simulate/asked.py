"""One simulation of which the surface and an error are given, and the numerics are not."""

from __future__ import annotations

from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import chosen_numerics
from crackfront.simulate.simulation import FieldKind, Numerics, Simulation, resolution

EXCESS = 1.2
"""By how much an expected error may exceed the asked one: knobs have two digits."""


def asked_simulation(
    kind: FieldKind,
    spectrum: SelfAffineSpectrum,
    elastic_energy: float,
    schedule: LoadSchedule | SteadySchedule,
    *,
    error: float,
    tile_roll_offs: float,
    tile_cutoffs: float,
    seed: int,
    realisation: int = 0,
) -> Simulation:
    """Simulation whose numerics the measured laws choose for an asked error.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : SelfAffineSpectrum
        Its shape. (Units: reduced lateral length)
    elastic_energy : float
        Energy of full conformity. (Units: w_int)
    schedule : LoadSchedule or SteadySchedule
        Penetrations; the largest decides the number of sites.
    error : float
        Standard error of the factor k of either branch that the numerics may leave.
    tile_roll_offs, tile_cutoffs : float
        Side of the tile in roll-off wavelengths, and at least so many short cutoffs.
    seed, realisation : int
        Which surface.
    """
    # What the error decides is that of a coarse resolution here, and replaced.
    given = Numerics(
        angles=None,
        angles_per_cutoff=1.0,
        samples_per_cutoff=4.0,
        interpolation="cubic",
        pixels_per_cutoff=4.0,
        tile_roll_offs=tile_roll_offs,
        tile_cutoffs=tile_cutoffs,
        tolerance=1e-3,
        max_sweeps=100_000_000,
        solver="newton",
    )
    numerics = chosen_numerics(error, kind, spectrum, elastic_energy, given)
    return Simulation(
        spectrum_name="asked",
        kind=kind,
        spectrum=spectrum,
        elastic_energy=elastic_energy,
        realisation=realisation,
        sweep_seed=seed,
        resolution=resolution(spectrum, numerics, schedule.max_penetration),
        schedule=schedule,
        tolerance=numerics.tolerance,
        max_sweeps=numerics.max_sweeps,
        solver=numerics.solver,
        record_fronts=False,
        record_energy=False,
    )
