"""What each request of a scene costs: time, memory, bytes on disk, samples of the field.

The scenes are rings (a scalar problem), the hysteresis alone, and full cycles with more and more of
what can be recorded; all but the rings are on one surface.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from crackfront.core.cycle.record import CycleRecord
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import Field, first_place
from crackfront.core.field.samples import make_memory
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.outcome import Status
from crackfront.core.resources import peak_memory
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import variable
from crackfront.simulate.cycle_files import cycle_dataset
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import compile_solver, run_simulation
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import Simulation, simulation_field, simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.storage import write_dataset
from crackfront.sweep.curves import FinishedSimulation, curves_dataset
from crackfront.sweep.rows import sweep_row
from studies.speed.machine import restart_peak
from studies.tables import Table, make_table

if TYPE_CHECKING:
    import xarray as xr

TOLERANCE = 1e-5
"""Force that may be left on a front, per length, in w_int."""

RING_AMPLITUDE = 0.2
"""Amplitude of the rings in w_int."""

RING_SAMPLES = 16
"""Samples a period of the rings."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The surface, the rings and the loads that all requests share.

    The short cutoff of the heights is the period of the rings.
    """

    spectrum: SelfAffineSpectrum
    tile_cutoffs: float
    cycle: FullCycle
    steady: SteadySchedule


SCENE = Scene(
    SelfAffineSpectrum(0.0025, 0.04, 0.8),
    tile_cutoffs=200,
    cycle=FullCycle(1.0, 0.05),
    steady=SteadySchedule(start=0.5, max_penetration=1.0, travel=1.5, standard_error=0.1),
)
"""The surface h08 of config/default.yaml at its numerics and e_el = 0.05 w_int."""

SMALL = replace(SCENE, spectrum=SelfAffineSpectrum(0.2, 0.4, 0.8), tile_cutoffs=20)
"""A scene that takes no time, to compile by and to test."""


@dataclass(frozen=True, slots=True)
class Need:
    """One request: what is asked of rings on some rays, or of the surface where these are 0."""

    name: str
    asked: str
    load: Literal["cycle", "steady"] = "cycle"
    rays: int = 0
    fronts: bool = False
    energy: bool = False


NEEDS = (
    Need("rings", "one scalar equation: the radius at every load", rays=1),
    Need("rings as a front", "the same rings sampled on 256 rays, a front of 256 sites", rays=256),
    Need("hysteresis", "steady parts of both branches; curves", load="steady"),
    Need("cycle", "approach, retraction and pull-off; curves"),
    Need("cycle, energies", "also the energy lost in each load step", energy=True),
    Need("cycle, fronts", "also every front", fronts=True),
    Need("cycle, fronts, energies", "all of it", fronts=True, energy=True),
)


@dataclass(frozen=True, slots=True)
class Row:
    """What one request cost."""

    name: str = variable("request", "1")
    status: str = variable("how its run ended", "1")
    n_angle: int = variable("sites of the front", "1")
    n_step: int = variable("load steps", "1")
    samples: float = variable("samples of w_loc that the front crosses, each counted once", "1")
    seconds: float = variable("processor time, the making of the field included", "s")
    peak: float = variable("largest memory in addition to the imported package", "MB")
    field: float = variable("arrays of the field while the front moves", "MB")
    record: float = variable("arrays of the record", "MB")
    file: float = variable("size of the file", "kB")


def simulation(scene: Scene, need: Need) -> Simulation:
    """Simulation on the surface."""
    settings = Settings(None, 2.4, 5, "cubic", 4, TOLERANCE)
    return simulation_of(
        "roughness",
        scene.spectrum,
        0.05,
        scene.steady if need.load == "steady" else scene.cycle,
        Numerics(settings=settings, tile_cutoffs=scene.tile_cutoffs),
        seed=1,
        name="surface",
        record=[name for name in ("fronts", "energy") if getattr(need, name)],
    )


def ring_field(scene: Scene, rays: int) -> Field:
    """Rings w_int (1 + 0.2 sin(2 pi a / d)) on one ray or more."""
    period = scene.spectrum.short_cutoff
    radii = period / RING_SAMPLES * np.arange(1.0, int(2.1 / period * RING_SAMPLES))
    ring = WORK_OF_ADHESION * (1 + RING_AMPLITUDE * np.sin(2 * np.pi * radii / period))
    return polar_field(radii, np.tile(ring[:, None], rays), "cubic")


def measured(scene: Scene, need: Need) -> Row:
    """Cost of one request, kernels loaded; then its file, whose dataset first imports xarray."""
    compile_solver("newton", FullCycle)
    run_cycle(ring_field(SMALL, 1), FullCycle(0.0, 1.0))
    before, start = restart_peak(), time.process_time()
    run = _ring_run(scene, need.rays) if need.rays else _surface_run(scene, need)
    seconds, peak = time.process_time() - start, 1e-6 * (peak_memory() - before)
    field, record = run.field(), run.record
    recorded = record.dissipated_energy, record.pull_off_energy, record.fronts
    return Row(
        name=need.name,
        status=record.status.name.lower(),
        n_angle=field.geometry.n_site,
        n_step=record.states.penetration.size,
        samples=field.geometry.n_site * _way(record) / first_place(field),
        seconds=seconds,
        peak=peak,
        field=(_bytes(field) + _bytes(make_memory(field))) / 1e6,
        record=_bytes((*asdict(record.states).values(), *recorded)) / 1e6,
        file=_file_bytes(run.dataset()) / 1e3,
    )


class _Run(NamedTuple):
    """A record, and how its field and its dataset are made."""

    record: CycleRecord
    field: Callable[[], Field]
    dataset: Callable[[], xr.Dataset]


def _ring_run(scene: Scene, rays: int) -> _Run:
    """Cycle on rings."""
    field = ring_field(scene, rays)
    record = run_cycle(field, scene.cycle, Newton(TOLERANCE))
    return _Run(record, lambda: field, lambda: cycle_dataset(record, field.geometry))


def _surface_run(scene: Scene, need: Need) -> _Run:
    """Simulation on the surface; its field is made again, since a result lacks it."""
    result = run_simulation(simulation(scene, need))

    def dataset() -> xr.Dataset:
        row, origin = sweep_row(result), provenance()
        finished = FinishedSimulation(result.simulation, row, result.record, origin.arithmetic)
        return curves_dataset([finished])

    return _Run(result.record, lambda: simulation_field(simulation(scene, need)), dataset)


def _file_bytes(dataset: xr.Dataset) -> int:
    """Size of a dataset in a file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        write_dataset(path, dataset, provenance())
        return path.stat().st_size


def _way(record: CycleRecord) -> float:
    """Mean way of a site over both branches, and to the centre where contact was lost."""
    way = 0.0
    for direction in (1, -1):
        branch = record.states.direction == direction
        radius = record.states.mean_radius[branch]
        begun = np.sum(record.states.least_travel[branch][:1])
        way += float(begun + np.sum(np.abs(np.diff(radius))))
    lost = record.status is Status.LOST_CONTACT
    return way + (float(record.states.mean_radius[-1]) if lost else 0.0)


def _bytes(values: object) -> int:
    """Bytes of an array, or of all among values."""
    if isinstance(values, tuple):
        return sum(_bytes(item) for item in values)
    return values.nbytes if isinstance(values, np.ndarray) else 0


def need_table(rows: list[Row]) -> Table:
    """What each request costs, and what it contains."""
    asked = {need.name: need.asked for need in NEEDS}
    return make_table(
        "asked for | CPU s | sites | load steps | samples crossed | peak MB | field MB | record kB "
        "| file kB | contains",
        (
            (
                row.name,
                f"{row.seconds:.3g}",
                f"{row.n_angle}",
                f"{row.n_step}",
                f"{row.samples:.2g}",
                f"{row.peak:.1f}",
                f"{row.field:.2f}",
                f"{1e3 * row.record:.1f}",
                f"{row.file:.1f}",
                asked[row.name],
            )
            for row in rows
        ),
    )
