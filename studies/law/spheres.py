"""Spheres compared with the law of k, to which nothing is adjusted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.analysis.csv_records import csv_rows
from crackfront.analysis.estimate import REACH, Estimate, with_error
from crackfront.analysis.law import spectral_breadth
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, adhesion_rms
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import simulation_of
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.storage import read_dataset
from crackfront.sweep.rows import sweep_row
from crackfront.sweep.sweep import Sweep
from studies.law.cells import COLUMNS, Means, cell_means, mean_factors
from studies.law.drawing import LawPoints
from studies.tables import Table, interval_cells, interval_header, make_table


@dataclass(frozen=True)
class Sphere:
    """Surface and contact of spheres that were simulated."""

    spectrum: str
    kind: FieldKind
    short_cutoff: float
    roll_off: float
    hurst: float
    contact_radius: float

    @property
    def shape(self) -> SelfAffineSpectrum:
        """Spectrum of the surface."""
        return SelfAffineSpectrum(self.short_cutoff, self.roll_off, self.hurst)


@dataclass(frozen=True)
class SphereRow(Means, Sphere):
    """k of spheres as simulated: a row of `spheres.csv` or `held-out.csv`."""


def read_spheres(paths: Sequence[Path]) -> list[SphereRow]:
    """Rows of tables of spheres."""
    return [row for path in paths for row in csv_rows(path.read_text(encoding="utf-8"), SphereRow)]


def _row(
    name: str, kind: FieldKind, spectrum: SelfAffineSpectrum, radius: float, means: Means
) -> SphereRow:
    """Row of spheres on surfaces of a spectrum."""
    return SphereRow(
        spectrum=name,
        kind=kind,
        short_cutoff=spectrum.short_cutoff,
        roll_off=spectrum.roll_off,
        hurst=spectrum.hurst,
        contact_radius=radius,
        **asdict(means),
    )


def sphere_rows(sweep: Sweep, dataset: xr.Dataset) -> Iterator[SphereRow]:
    """Spheres of a sweep from its table.

    Full cycles, straight fronts, and spectra that are not self-affine are a ValueError.
    """
    if not isinstance(sweep.schedule, SteadySchedule):
        raise ValueError("the sweep does not run the steady branches of spheres")
    radius = (dataset.lowest_radius + dataset.highest_radius).mean("realisation") / 2
    for (place, amplitude), means in cell_means(sweep.kind, dataset).items():
        item = sweep.spectra[place]
        if not isinstance(item.spectrum, SelfAffineSpectrum):
            raise ValueError(f"spectrum {item.name} is not self-affine; leave it out")
        yield _row(item.name, sweep.kind, item.spectrum, float(radius[place, amplitude]), means)


def _steady(start: float, reach: float = 1.0, travel: float = 1.5) -> SteadySchedule:
    """Steady branches from a penetration on."""
    return SteadySchedule(start, start + reach, travel, standard_error=0.05)


@dataclass(frozen=True, slots=True)
class Scene:
    """A sphere that is not part of any fit."""

    name: str
    kind: FieldKind
    spectrum: SelfAffineSpectrum
    elastic_energy: float
    schedule: SteadySchedule


SCENES = (
    Scene("short-0.1", "roughness", SelfAffineSpectrum(0.1, 0.1, 1.0), 0.05, _steady(1.0, 4, 0.5)),
    Scene("from-0", "roughness", SelfAffineSpectrum(0.01, 0.01, 1.0), 0.05, _steady(0.0)),
    Scene("from-3", "roughness", SelfAffineSpectrum(0.01, 0.04, 0.6), 0.05, _steady(3.0)),
    Scene("chemical", "chemical", SelfAffineSpectrum(0.01, 0.01, 1.0), 0.08, _steady(1.0)),
    # The spectrum of Main Fig. 5 in reduced lengths.
    Scene(
        "nanodiamond", "roughness", SelfAffineSpectrum(0.00104, 0.0334, 1.0), 0.173, _steady(1.0)
    ),
    Scene("weak", "roughness", SelfAffineSpectrum(0.006, 0.06, 0.2), 0.01, _steady(1.0)),
    Scene("strong", "roughness", SelfAffineSpectrum(0.008, 0.128, 0.5), 0.25, _steady(1.0)),
    Scene("strongest", "roughness", SelfAffineSpectrum(0.013, 0.013, 1.0), 0.4, _steady(1.0)),
)


def scene_rows(scenes: Sequence[Scene] = SCENES, realisations: int = 3) -> Iterator[SphereRow]:
    """Scenes, simulated."""
    for scene in scenes:
        surface = scene.kind, scene.spectrum, scene.elastic_energy
        first = simulation_of(*surface, scene.schedule, Numerics(error=0.015), seed=20261122)
        runs = [
            sweep_row(run_simulation(replace(first, realisation=number)))
            for number in range(realisations)
        ]
        columns = {name: [getattr(run, name) for run in runs] for name in COLUMNS}
        radius = np.mean([(run.lowest_radius + run.highest_radius) / 2 for run in runs])
        means = mean_factors(scene.kind, columns)
        yield _row(scene.name, scene.kind, scene.spectrum, float(radius), means)


def reference_rows(path: Path, schedule: SteadySchedule) -> Iterator[SphereRow]:
    """Spheres of the kept data of SI Fig. S-5, whose schedule these data do not state."""
    dataset = read_dataset(path)
    radius = jkr.equilibrium_radius((schedule.start + schedule.max_penetration) / 2)
    for (place, _), means in cell_means("roughness", dataset).items():
        item = dataset.isel(spectrum=place)
        shape = (float(item[name]) for name in ("short_cutoff", "roll_off", "hurst"))
        name = f"{item.spectrum.item()}, paper"
        yield _row(name, "roughness", SelfAffineSpectrum(*shape), radius, means)


def law_of(row: SphereRow) -> SphereFactors:
    """Factors k that the law gives for the sphere of a row."""
    return sphere_factors(row.kind, row.shape, row.elastic_energy, row.contact_radius)


def is_covered(row: SphereRow, law: SphereFactors) -> bool:
    """Whether a simulated k lies in the interval of the law, widened by the row's own errors."""
    return is_within(row.both, float(np.hypot(row.both_error, row.numerical_error)), law.both)


def is_within(k: float, error: float, law: Estimate[float]) -> bool:
    """Whether a k with a standard error lies in the interval of a law, widened by the error."""
    reach = (law.high if k > law.value else law.low) - law.value
    return bool(abs(k - law.value) <= np.hypot(reach, REACH * error))


def departures(rows: Sequence[SphereRow]) -> list[float]:
    """Relative differences of the law's k from simulated ones where g is above 1."""
    rows_with_law = ((law_of(row), row) for row in rows)
    return [law.both.value / row.both - 1 for law, row in rows_with_law if law.size > 1]


def sphere_table(rows: Sequence[SphereRow]) -> Table:
    """Table of simulated and predicted k, and how far they are apart.

    Compares the law's intervals with simulations, with the errors of both.
    """
    laws = [law_of(row) for row in rows]
    cells = [
        (
            row.spectrum,
            f"{row.elastic_energy:.3g}",
            f"{row.contact_radius:.3g}",
            f"{law.size:.2g}",
            *interval_cells(law.both),
            *with_error(row.both, row.both_error).split(" ± "),
            f"{100 * (law.both.value / row.both - 1):+.1f}",
        )
        for row, law in zip(rows, laws, strict=True)
    ]
    differences = departures(rows)
    rms, worst = np.sqrt(np.mean(np.square(differences))), np.max(np.abs(differences))
    inside = sum(is_covered(row, law) for row, law in zip(rows, laws, strict=True) if law.size > 1)
    return make_table(
        f"spectrum | e_el/w_int | radius | g | {interval_header('k, line alone')} "
        "| k simulated | k simulated error | difference %",
        cells,
        f"For g above 1, {len(differences)} rows: rms {rms:.1%}, worst {worst:.1%}; the 95% "
        f"intervals cover {inside}.",
    )


def sphere_points(rows: Sequence[SphereRow]) -> LawPoints:
    """Spheres as the figure of the law draws them."""
    return LawPoints(
        name="spheres",
        disorder=adhesion_rms(np.array([row.elastic_energy for row in rows])),
        size=np.array([law_of(row).size for row in rows]),
        factor=np.array([row.both for row in rows]),
        error=np.array([row.both_error for row in rows]),
        breadth=np.array([spectral_breadth(row.kind, row.shape) for row in rows]),
    )
