"""One simulation: its parameters, the sizes that the numerics choose, its key, seed and field."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from crackfront.core.adhesion import (
    AdhesionMap,
    FieldKind,
    correlation_length,
)
from crackfront.core.field.fields import TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.solver.relax import Solver, named_solver
from crackfront.core.spectrum import ENSEMBLE, Spectrum
from crackfront.simulate.contact import Schedule
from crackfront.simulate.ensembles import GAUSSIAN, Ensemble
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings
from crackfront.simulate.tiles import Fineness, RandomSurface, Resolution

Recorded = Literal["fronts", "energy", "jumps"]
"""What may be recorded in addition to the curves."""


@dataclass(frozen=True, slots=True)
class Simulation:
    """Everything that determines one cycle, and the name of its spectrum."""

    spectrum_name: str
    """Name of the spectrum in the configuration; the only item without effect on the result."""
    kind: FieldKind
    """What the spectrum describes: heights, or the work of adhesion itself."""
    spectrum: Spectrum
    """Shape of the spectrum, whatever its plateau. (Units: reduced lateral length)"""
    elastic_energy: float
    """Requested e_el / w_int; for a chemical field the equivalent (w_rms / w_int)^2 / 4."""
    realisation: int
    """Number of the realisation of the noise."""
    sweep_seed: int
    """Seed of the sweep."""
    resolution: Resolution
    """Sizes of the front and of the tile."""
    schedule: Schedule
    """Loads of a kind, such as the penetrations of a full cycle."""
    solver: Solver
    """How its fronts are found."""
    ensemble: Ensemble = GAUSSIAN
    """Surfaces of the spectrum."""
    record_fronts: bool = False
    """Whether to record the fronts of all states."""
    record_energy: bool = False
    """Whether to record the energy that each step dissipates."""
    record_jumps: bool = False
    """Whether to record the jumps of the steady load steps."""

    @property
    def parameters(self) -> dict[str, Any]:
        """What determines the result, except the number of the realisation, as a JSON object.

        A field with a default is left out at that default: one that is added later changes no
        key. The limit of sweeps is not a parameter: a result that did not reach it is the same.
        """
        lengths, numbers = self.spectrum.identity
        parameters: dict[str, Any] = {
            "field": self.kind,
            "spectrum": {"lengths": lengths, "numbers": numbers},
            "elastic_energy": self.elastic_energy,
            "seed": self.sweep_seed,
            "resolution": _stated(self.resolution),
            "load": {"kind": self.schedule.load_name} | _stated(self.schedule),
            "tolerance": self.solver.tolerance,
        }
        if self.solver.name != "newton":
            parameters["solver"] = self.solver.name
        if self.ensemble != GAUSSIAN:
            parameters["ensemble"] = {"kind": self.ensemble.ensemble_name} | self.ensemble.key
        if record := [name for name, is_recorded in self._recorded if is_recorded]:
            parameters["record"] = record
        rounded: dict[str, Any] = _rounded(parameters)
        return rounded

    @property
    def _recorded(self) -> tuple[tuple[str, bool], ...]:
        """What may be recorded in addition to the curves, and whether it is."""
        return (
            ("fronts", self.record_fronts),
            ("energy", self.record_energy),
            ("jumps", self.record_jumps),
        )

    @property
    def series(self) -> str:
        """Sixteen hexadecimal digits that identify a simulation but for its realisation."""
        text = json.dumps(self.parameters, sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def key(self) -> str:
        """What identifies a simulation: its series, and the number of its realisation."""
        return f"{self.series}-{self.realisation}"

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
        return self.schedule.tile(self.resolution)

    @property
    def surface(self) -> RandomSurface:
        """The surface on the tile."""
        return RandomSurface(
            self.kind,
            self.spectrum,
            self.elastic_energy,
            self.seed,
            *self.tile,
            self.ensemble,
            self.realisation,
        )

    @property
    def stated_parameters(self) -> dict[str, Any]:
        """Parameters of the spectrum, and a description of surfaces that are not Gaussian."""
        description = self.ensemble.description
        return self.spectrum.parameters | ({ENSEMBLE: description} if description else {})

    @property
    def is_covered(self) -> bool:
        """Whether the laws of k and of numerical errors were measured on such surfaces."""
        return self.spectrum.is_isotropic and self.ensemble == GAUSSIAN

    @property
    def label(self) -> str:
        """Name of this simulation in messages."""
        return f"{self.spectrum_name} e_el={self.elastic_energy:g} r={self.realisation}"

    @property
    def stem(self) -> str:
        """Name of its checkpoints, without their digest and suffix; the series ends it."""
        return f"{self.spectrum_name}-e{self.elastic_energy:g}-r{self.realisation}-{self.series}"

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


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation."""
    return simulation.schedule.adhesion(simulation.surface)


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    return simulation.schedule.field(adhesion, simulation.resolution)


def resolution(
    spectrum: Spectrum,
    numerics: Numerics,
    settings: Settings,
    schedule: Schedule,
    ensemble: Ensemble = GAUSSIAN,
) -> Resolution:
    """Sizes of the front and of the tile for one spectrum.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> from crackfront.simulate.sphere.full_cycle import FullCycle
    >>> flat = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=1.0)
    >>> settings = Settings(None, 2, 4, "cubic", 4, 1e-6)
    >>> numerics = Numerics(settings=settings, tile_roll_offs=10, tile_cutoffs=20)
    >>> resolution(flat, numerics, settings, FullCycle(max_penetration=1.0, step=0.1))
    Resolution(n_angle=240, spacing=0.025, interpolation='cubic', tile_side=2.0, n_point=80)
    """
    side = ensemble.tile_side or numerics.tile_side(spectrum)
    fineness = Fineness(spectrum.short_cutoff, side, settings)
    return schedule.resolution(fineness)


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
    record: Collection[Recorded] = (),
    ensemble: Ensemble = GAUSSIAN,
) -> Simulation:
    """The simulation of a surface; the largest penetration of the schedule decides its sites.

    `name` names the spectrum, `numerics` say how it is resolved and solved, and `record` what is
    stored in addition to the curves; the rest is as in :class:`Simulation`. ValueError if the
    numerics are chosen for an error, and no errors were measured on such surfaces.
    """
    if numerics.error is not None and ensemble != GAUSSIAN:
        raise ValueError(
            f"error is {numerics.error:g}, but errors were measured for Gaussian surfaces alone; "
            "give the resolution and the tolerance instead"
        )
    settings = numerics.settings_of(
        kind, spectrum, elastic_energy, schedule.usual_cutoffs(spectrum)
    )
    return Simulation(
        spectrum_name=name,
        kind=kind,
        spectrum=spectrum,
        elastic_energy=elastic_energy,
        realisation=realisation,
        sweep_seed=seed,
        resolution=resolution(spectrum, numerics, settings, schedule, ensemble),
        schedule=schedule,
        solver=named_solver(numerics.solver, settings.tolerance, numerics.max_sweeps),
        ensemble=ensemble,
        record_fronts="fronts" in record,
        record_energy="energy" in record,
        record_jumps="jumps" in record,
    )


def _stated(record: Any) -> dict[str, Any]:
    """Fields of a dataclass by their names, without those that have their default."""
    return {
        item.name: getattr(record, item.name)
        for item in fields(record)
        if getattr(record, item.name) != item.default
    }


def _rounded(content: Any) -> Any:
    """Content of JSON with numbers of twelve digits: units and processors change the last ones."""
    if isinstance(content, dict):
        return {name: _rounded(value) for name, value in content.items()}
    if isinstance(content, list | tuple):
        return [_rounded(value) for value in content]
    return float(f"{content:.12g}") if isinstance(content, float) else content
