"""What determines one simulation: its parameters, sizes, key and seed; and its field."""

from __future__ import annotations

import functools
import hashlib
import json
import math
from collections.abc import Collection
from dataclasses import astuple, dataclass
from typing import Any, Literal, cast

import numpy as np
from scipy.fft import next_fast_len

from crackfront.analysis.steady import SteadyAdhesion
from crackfront.core.adhesion import (
    AdhesionMap,
    FieldKind,
    correlation_length,
)
from crackfront.core.field.fields import Interpolation, TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.solver import DEFAULT_MAX_SWEEPS
from crackfront.core.solver.relax import Solver, named_solver
from crackfront.core.spectrum import Spectrum
from crackfront.data.fingerprint import fingerprint
from crackfront.simulate.laws import Knob, Knobs, chosen_knobs, combined_error
from crackfront.simulate.schedule import Schedule
from crackfront.simulate.sphere.cycle import FullCycle


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
        """Knobs for one spectrum and amplitude; size as of :func:`laws.chosen_knobs`."""
        if isinstance(self.knobs, Knobs):
            return self.knobs
        return chosen_knobs(self.knobs, kind, spectrum, elastic_energy, usual_size)

    def tile_side(self, spectrum: Spectrum) -> float:
        """Least side of a tile (Units: that of the spectrum)."""
        return max(
            self.tile_roll_offs * spectrum.longest_feature,
            self.tile_cutoffs * spectrum.short_cutoff,
        )


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


def resolution(
    spectrum: Spectrum, numerics: Numerics, knobs: Knobs, schedule: Schedule
) -> Resolution:
    """Sizes of the front and of the tile for one spectrum; those of a line are of its schedule.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
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


@dataclass(frozen=True, slots=True)
class Simulation:
    """Everything that determines one cycle, and the name of its spectrum."""

    spectrum_name: str
    """Name of the spectrum in the configuration; the only item without effect on the result."""
    kind: FieldKind
    """What the spectrum describes: heights, or the work of adhesion itself."""
    spectrum: Spectrum
    """Shape of the spectrum; its plateau has no effect. (Units: reduced lateral length)"""
    elastic_energy: float
    """Requested e_el / w_int; for a chemical field the equivalent (w_rms / w_int)^2 / 4."""
    realisation: int
    """Number of the realisation of the noise."""
    sweep_seed: int
    """Seed of the sweep."""
    resolution: Resolution
    """Sizes of the front and of the tile."""
    schedule: Schedule
    """Loads of a kind, such as penetrations of a full cycle, or those of a straight front."""
    solver: Solver
    """How its fronts are found."""
    record_fronts: bool = False
    record_energy: bool = False
    """What to record beside the curves."""

    @property
    def key(self) -> str:
        """Sixteen hexadecimal digits that change with anything that determines the result."""
        return _digest(self._content())[:16]

    @property
    def parts(self) -> dict[str, str]:
        """Eight hexadecimal digits for each part of the key, which show what has changed."""
        return {name: _digest(part)[:8] for name, part in self._content().items()}

    def _content(self) -> dict[str, Any]:
        """What determines the result, part by part."""
        lengths, numbers = self.spectrum.identity
        return {
            "kind": self.kind,
            "spectrum": (*lengths, *numbers),
            "elastic_energy": self.elastic_energy,
            "realisation": self.realisation,
            "seed": self.sweep_seed,
            "resolution": astuple(self.resolution),
            "load": astuple(cast(Any, self.schedule)),
            "numerics": (self.solver.tolerance, self.solver.max_sweeps, self.solver.name),
            "record": (self.record_fronts, self.record_energy),
            "sources": simulation_fingerprint(type(self.schedule)),
        }

    @property
    def correlation_length(self) -> float:
        """Wavelength of the mean wavevector of w_loc (Units: reduced lateral length)."""
        return correlation_length(self.kind, self.spectrum)

    @property
    def geometry(self) -> Geometry:
        """The contact, whose springs do not pull at w_int."""
        return self.schedule.geometry(self.resolution.n_angle)

    @property
    def tile(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """Points and sides of the tile, along x and y (Units: reduced lateral length)."""
        return self.schedule.tile(self.resolution.n_point, self.resolution.tile_side)

    @property
    def label(self) -> str:
        """Name of this simulation in messages."""
        return f"{self.spectrum_name} e_el={self.elastic_energy:g} r={self.realisation}"

    @property
    def stem(self) -> str:
        """Name of its file, without a suffix."""
        return f"{self.spectrum_name}-e{self.elastic_energy:g}-r{self.realisation}-{self.key}"

    @property
    def seed(self) -> int:
        """Seed of the surface: `numpy.random.default_rng(seed)` gives its noise.

        It follows from the seed of the sweep, the spectrum, the tile's side and the number of
        the realisation, never from a position in a list. All amplitudes and all grids share it.
        """
        lengths, numbers = self.spectrum.identity
        sizes = (*lengths, self.resolution.tile_side, *numbers)
        # Ten digits: the same surface whether lengths were given in metres or reduced.
        text = " ".join(f"{value:.10g}" for value in sizes)
        words = np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4")
        sequence = np.random.SeedSequence(
            self.sweep_seed, spawn_key=(*(int(word) for word in words), self.realisation)
        )
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))


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
    is what is kept beside the curves; the rest is as in :class:`Simulation`.
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


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation."""
    return simulation.schedule.adhesion(simulation)


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    sizes = simulation.resolution
    return simulation.schedule.field(adhesion, sizes.n_angle, sizes.spacing, sizes.interpolation)


def missed_error(simulation: Simulation, wanted: float) -> float:
    """Error of k that the numerics are expected to leave, 0 where it is the wanted one."""
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


def _digest(content: Any) -> str:
    """Hexadecimal digits that change with the content."""
    text = json.dumps(content, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


@functools.cache
def simulation_fingerprint(kind: type[Schedule] = FullCycle) -> str:
    """Twelve hexadecimal digits that change with what determines a simulation of a kind of load."""
    schedule = f"{kind.__module__}.{kind.__qualname__}"
    return fingerprint("crackfront.simulate.run.run_simulation", schedule)
