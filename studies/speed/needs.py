"""What each request of a scene costs: time, memory, bytes on disk, samples of the field.

python -m studies.speed.needs --output results/benchmark

The scenes are rings (a scalar problem), the hysteresis alone, and full cycles with more and more of
what can be recorded; all but the rings are on one surface.
"""

from __future__ import annotations

import argparse
import functools
import multiprocessing
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, astuple, dataclass, replace
from pathlib import Path
from typing import Literal

import click
import numpy as np
import xarray as xr

from crackfront.core.cycle.record import CycleRecord
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.field.fields import Field, first_place, polar_field
from crackfront.core.field.samples import make_memory
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.files import write_dataset
from crackfront.data.provenance import provenance
from crackfront.simulate.contact import contact_field, simulation_adhesion
from crackfront.simulate.files import cycle_dataset, write_simulation
from crackfront.simulate.laws import Knobs
from crackfront.simulate.run import compile_solver, run_simulation
from crackfront.simulate.simulation import Numerics, Simulation, simulation_of
from studies.speed.machine import described_machine, peak_memory, restart_peak

TOLERANCE = 1e-5
RING_AMPLITUDE = 0.2
RING_SAMPLES = 16
"""Samples a period of the rings."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The surface, the rings and the loads that all requests share.

    Attributes
    ----------
    spectrum : SelfAffineSpectrum
        That of the heights; its short cutoff is the period of the rings.
        (Units: reduced lateral length)
    tile_cutoffs : float
        Side of the tile in short cutoffs, at the least; it holds four roll-offs.
    cycle : LoadSchedule
        Loads of the full cycles.
    steady : SteadySchedule
        Loads of the hysteresis alone.
    """

    spectrum: SelfAffineSpectrum
    tile_cutoffs: float
    cycle: LoadSchedule
    steady: SteadySchedule


SCENE = Scene(
    SelfAffineSpectrum(0.0025, 0.04, 0.8),
    tile_cutoffs=200,
    cycle=LoadSchedule(1.0, 0.05),
    steady=SteadySchedule(start=0.5, max_penetration=1.0, travel=1.5, standard_error=0.1),
)
"""The surface h08 of config/default.yaml at its numerics and e_el = 0.05 w_int."""

SMALL = replace(SCENE, spectrum=SelfAffineSpectrum(0.2, 0.4, 0.8), tile_cutoffs=20)
"""A scene that takes no time, to compile by and to test."""


@dataclass(frozen=True, slots=True)
class Need:
    """One request.

    Attributes
    ----------
    name : str
        What the tables call it.
    asked : str
        What is computed and stored because of it.
    load : {"cycle", "steady"}
        Full cycle, or the steady parts of its branches.
    rays : int
        Rays of a field of rings; 0 for the surface.
    fronts, energy : bool
        What is recorded beside the curves.
    """

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
    """What one request cost.

    Attributes
    ----------
    name, status : str
        The request, and how its run ended.
    n_angle, n_step : int
        Sites of the front, load steps.
    samples : float
        Samples of w_loc that the front crosses; each is evaluated once when the front gets there.
    seconds : float
        CPU time, the making of the field included. (Units: s)
    peak : float
        Largest memory above that of the imported package. (Units: MB)
    field, record : float
        Memory of the arrays that describe the field while the front moves, and of what is
        recorded of it. (Units: MB)
    file : float
        Size of the file. (Units: kB)
    """

    name: str
    status: str
    n_angle: int
    n_step: int
    samples: float
    seconds: float
    peak: float
    field: float
    record: float
    file: float


def simulation(scene: Scene, need: Need) -> Simulation:
    """Simulation on the surface."""
    knobs = Knobs(None, 2.4, 5, "cubic", 4, TOLERANCE)
    return simulation_of(
        "roughness",
        scene.spectrum,
        0.05,
        scene.steady if need.load == "steady" else scene.cycle,
        Numerics(knobs, tile_cutoffs=scene.tile_cutoffs, max_sweeps=10_000_000),
        seed=1,
        name="surface",
        record=[name for name in ("fronts", "energy") if getattr(need, name)],
    )


def ring_field(scene: Scene, rays: int) -> Field:
    """Rings w_int (1 + 0.2 sin(2 pi a / d)) on one ray or more."""
    period = scene.spectrum.short_cutoff
    radii = period / RING_SAMPLES * np.arange(1, int(2.1 / period * RING_SAMPLES))
    ring = WORK_OF_ADHESION * (1 + RING_AMPLITUDE * np.sin(2 * np.pi * radii / period))
    return polar_field(radii, np.broadcast_to(ring[:, None], (radii.size, rays)), "cubic")


def measure(scene: Scene, need: Need) -> Row:
    """Run one request and write its file; compiled kernels are loaded before."""
    compile_solver("newton")
    run_cycle(ring_field(SMALL, 1), LoadSchedule(0.0, 1.0))
    before, start = restart_peak(), time.process_time()
    if need.rays:
        field = ring_field(scene, need.rays)
        record = run_cycle(field, scene.cycle, Newton(TOLERANCE))
        write = functools.partial(write_dataset, dataset=cycle_dataset(record))
    else:
        result = run_simulation(simulation(scene, need))
        record = result.record
        write = functools.partial(write_simulation, result=result)
    seconds, peak = time.process_time() - start, peak_memory() - before
    if not need.rays:
        field = surface_field(simulation(scene, need))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        write(path, origin=provenance())
        size = path.stat().st_size
    return Row(
        name=need.name,
        status=record.status.name.lower(),
        n_angle=field.geometry.n_site,
        n_step=record.states.penetration.size,
        samples=field.geometry.n_site * _way(record) / first_place(field),
        seconds=seconds,
        peak=peak,
        field=(_bytes(field) + _bytes(make_memory(field))) / 1e6,
        record=_bytes((*asdict(record.states).values(), *astuple(record)[3:])) / 1e6,
        file=size / 1e3,
    )


def measure_apart(scene: Scene, need: Need) -> Row:
    """The same in a process of its own."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as fresh:
        return fresh.submit(measure, scene, need).result()


def surface_field(one: Simulation) -> Field:
    """Field of a simulation, as its run has it."""
    adhesion, sizes = simulation_adhesion(one), one.resolution
    largest = one.schedule.max_penetration
    return contact_field(adhesion, sizes.n_angle, sizes.spacing, largest, band_limited=True)


def _way(record: CycleRecord) -> float:
    """Mean way of a site over both branches, and to the centre where contact was lost."""
    way = 0.0
    for direction in (1, -1):
        branch = record.states.direction == direction
        radius = record.states.mean_radius[branch]
        way += float(
            np.sum(record.states.least_travel[branch][:1]) + np.sum(np.abs(np.diff(radius)))
        )
    return way + (
        float(record.states.mean_radius[-1]) if record.status is Status.LOST_CONTACT else 0.0
    )


def _bytes(values: object) -> int:
    """Bytes of an array, or of all among values."""
    if isinstance(values, tuple):
        return sum(_bytes(item) for item in values)
    return values.nbytes if isinstance(values, np.ndarray) else 0


def table(rows: list[Row]) -> str:
    """Markdown table of rows."""
    lines = [
        "| asked for | CPU s | sites | load steps | samples crossed | peak MB | field MB "
        "| record kB | file kB |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.name} | {row.seconds:.3g} | {row.n_angle} | {row.n_step} | {row.samples:.2g} "
        f"| {row.peak:.1f} | {row.field:.2f} | {1e3 * row.record:.1f} | {row.file:.1f} |"
        for row in rows
    ]
    return "\n".join(lines)


def dataset(rows: list[Row]) -> xr.Dataset:
    """All rows on one dimension."""
    meanings = {
        "name": ("1", "request"),
        "status": ("1", "how its run ended"),
        "n_angle": ("1", "sites of the front"),
        "n_step": ("1", "load steps"),
        "samples": ("1", "samples of w_loc that the front crosses"),
        "seconds": ("s", "CPU time"),
        "peak": ("MB", "largest memory above that of the imported package"),
        "field": ("MB", "arrays of the field while the front moves"),
        "record": ("MB", "arrays of the record"),
        "file": ("kB", "size of the file"),
    }
    return xr.Dataset(
        {
            name: (
                "request",
                np.array([getattr(row, name) for row in rows]),
                {"units": units, "long_name": meaning},
            )
            for name, (units, meaning) in meanings.items()
        }
    )


def report(rows: list[Row]) -> str:
    """The whole page."""
    listed = [f"- {need.name}: {need.asked}" for need in NEEDS]
    parts = ["# What each request costs", "", *listed, "", described_machine(), "", table(rows)]
    return "\n".join(parts) + "\n"


def main() -> None:
    """Measure all requests."""
    parser = argparse.ArgumentParser(description="what each request of a scene costs")
    parser.add_argument("--output", type=Path, default=Path("results/benchmark"))
    chosen = parser.parse_args()
    # A process for each, so that its memory is its own; the first of all compiles.
    measure_apart(SMALL, NEEDS[0])
    rows = []
    for need in NEEDS:
        rows.append(row := measure_apart(SCENE, need))
        click.echo(f"{row.name}: {row.seconds:.3g} s, {row.peak:.1f} MB, {row.file:.1f} kB")
    chosen.output.mkdir(parents=True, exist_ok=True)
    text = report(rows)
    (chosen.output / "needs.md").write_text(text, encoding="utf-8")
    write_dataset(chosen.output / "needs.nc", dataset(rows), provenance())
    click.echo(text)
    click.echo(f"Results: {chosen.output}/")


if __name__ == "__main__":
    main()
