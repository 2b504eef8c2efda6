"""Simulations of surfaces, with the sizes that the numerics choose."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Literal

from scipy.fft import next_fast_len

from crackfront.core.adhesion import FieldKind
from crackfront.core.solver.relax import named_solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.laws import Settings
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.schedule import Schedule
from crackfront.simulate.simulation import Resolution, Simulation


def resolution(
    spectrum: Spectrum, numerics: Numerics, settings: Settings, schedule: Schedule
) -> Resolution:
    """Sizes of the front and of the tile for one spectrum; those of a line are of its schedule.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> from crackfront.simulate.sphere.cycle import FullCycle
    >>> flat = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=1.0)
    >>> settings = Settings(None, 2, 4, "cubic", 4, 1e-6)
    >>> numerics = Numerics(settings, tile_roll_offs=10, tile_cutoffs=20)
    >>> resolution(flat, numerics, settings, FullCycle(max_penetration=1.0, step=0.1))
    Resolution(n_angle=240, spacing=0.025, interpolation='cubic', tile_side=2.0, n_point=80)
    """
    cutoff = spectrum.short_cutoff
    sites = schedule.front_length / cutoff * settings.angles_per_cutoff
    side, spacing = schedule.fitted(
        numerics.tile_side(spectrum), cutoff / settings.samples_per_cutoff
    )
    points = math.ceil(side / cutoff * settings.pixels_per_cutoff * (1 - 1e-12))
    n_point = next_fast_len(points, real=True)
    return Resolution(
        n_angle=schedule.site_count(settings.angles, sites, n_point),
        spacing=spacing,
        interpolation=settings.interpolation,
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
    settings = numerics.settings_of(kind, spectrum, elastic_energy, schedule.usual_size(spectrum))
    return Simulation(
        spectrum_name=name,
        kind=kind,
        spectrum=spectrum,
        elastic_energy=elastic_energy,
        realisation=realisation,
        sweep_seed=seed,
        resolution=resolution(spectrum, numerics, settings, schedule),
        schedule=schedule,
        solver=named_solver(numerics.solver, settings.tolerance, numerics.max_sweeps),
        record_fronts="fronts" in record,
        record_energy="energy" in record,
    )
