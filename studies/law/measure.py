"""Measure the law behind k on straight fronts, fit it, and hold spheres against it.

make SWEEP=config/line.yaml; make SWEEP=config/line-chemical.yaml; make SWEEP=config/line-weak.yaml
make SWEEP=config/spheres.yaml
python -m studies.law.measure fit config/line.yaml config/line-chemical.yaml config/line-weak.yaml
python -m studies.law.measure spheres config/spheres.yaml
python -m studies.law.measure spheres --table docs/reference/spheres.csv
python -m studies.law.measure held-out
python -m studies.law.measure figure --table docs/reference/*.csv --output docs/figures
python -m studies.law.measure pages --table docs/reference/{spheres,held-out}.csv --output .

`fit` writes `law.csv`, a row for every spectrum, amplitude and spring, and `law.json`, the law that
is fitted to them; copied to `crackfront/analysis`, they are what predictions rest on. `spheres`
writes `spheres.csv`, what spheres were simulated to have, and prints it beside what the law says;
with `--table` it reads such a file instead. `held-out` simulates scenes that had no part in any
fit, and adds the paper's sweep that is kept in docs/reference: `held-out.csv`. `figure` draws the
shipped law, and `pages` writes its numbers into README.md, docs/index.md and docs/law.md.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, astuple, dataclass, fields, replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from crackfront.analysis.estimate import REACH, mean_estimate, with_error
from crackfront.analysis.finding import departure_of_spheres, finding
from crackfront.analysis.law import shipped_law, slope_breadth
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.table import SweepTable
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, force_correlation_length, larkin_length
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.variables import variables
from crackfront.data.files import read_dataset, write_text
from crackfront.plots.style import save_picture
from crackfront.simulate.lines import LineLoad
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import Numerics, simulation_of
from crackfront.sweep.configuration import load_configuration, results_folder
from crackfront.sweep.sweep import NamedSpectrum, Sweep
from crackfront.sweep.table import read_table, sweep_row
from studies.law.drawing import LawPoints, law_figure, spectra_points
from studies.law.fitting import LawCell, cells_of, fitted_law, measured_cells
from studies.law.page import renewed_page

PAGES = ("README.md", "docs/index.md", "docs/law.md")
"""Pages that tell numbers of the law."""


@dataclass(frozen=True, slots=True)
class Means:
    """k of one spectrum and amplitude with standard errors over realisations."""

    realisations: int
    approach: float
    approach_error: float
    retraction: float
    retraction_error: float
    both: float
    both_error: float
    numerical_error: float


@dataclass(frozen=True, slots=True)
class SphereRow:
    """k of a sphere as simulated: a row of `spheres.csv`, as the law's predictions are held to."""

    spectrum: str
    kind: str
    short_cutoff: float
    roll_off: float
    hurst: float
    contact_radius: float
    elastic_energy: float
    realisations: int
    approach: float
    approach_error: float
    retraction: float
    retraction_error: float
    both: float
    both_error: float
    numerical_error: float


def means(table: SweepTable, kind: FieldKind) -> dict[tuple[int, int], tuple[float, Means]]:
    """Mean e_el and factors of every spectrum and amplitude of a sweep."""
    energy = np.where(table.finite, table.e_el, np.nan)
    mean = 1 - energy if kind == "roughness" else np.ones_like(energy)
    lowering, raising = (mean - table.w_appr) / energy, (table.w_retr - mean) / energy
    branches = [mean_estimate(item) for item in (lowering, raising, (lowering + raising) / 2)]
    energies, numerical = mean_estimate(energy)[0], mean_estimate(table.numerical_error)[0]
    found = {}
    for cell in np.ndindex(energies.value.shape):
        numbers = [
            float(values[cell])
            for estimate, _ in branches
            for values in (estimate.value, estimate.standard_error)
        ]
        count = int(branches[0][1][cell])
        found[cell[0], cell[1]] = (
            float(energies.value[cell]),
            Means(count, *numbers, float(numerical.value[cell])),
        )
    return found


def law_cells(configuration: Path) -> list[LawCell]:
    """Rows of the table of one sweep of straight fronts that has been run."""
    sweep = load_configuration(configuration)
    load = sweep.schedule
    if not isinstance(load, LineLoad):
        raise ValueError(f"{configuration} runs spheres; the law is measured on straight fronts")
    path = results_folder(configuration) / "hysteresis.nc"
    dataset, known = read_dataset(path), means(read_table(path), sweep.kind)
    cells = []
    for (place, amplitude), (energy, found) in known.items():
        item, requested = sweep.spectra[place], sweep.elastic_energies[amplitude]
        simulation = sweep.simulation(item, requested, 0)
        larkin = larkin_length(sweep.kind, item.spectrum, 2 * np.sqrt(requested))
        depth = force_correlation_length(sweep.kind, item.spectrum)
        cell = dataset.isel(spectrum=place, amplitude=amplitude)
        cells.append(
            LawCell(
                spectrum=f"{_shape(sweep, item)}",
                breadth=slope_breadth(sweep.kind, item.spectrum),
                disorder=0.0 if load.uncorrelated else 2 * float(np.sqrt(energy)),
                size=simulation.spring / larkin,
                realisations=found.realisations,
                approach=found.approach,
                retraction=found.retraction,
                both=found.both,
                error=found.both_error,
                numerical_error=found.numerical_error,
                front_rms=float(cell.front_rms.mean()) / depth,
                negative_share=float(cell.negative_share.mean()),
            )
        )
    return _without_spacing(sweep, cells) if load.uncorrelated else cells


def _shape(sweep: Sweep, item: NamedSpectrum) -> str:
    """Name of a spectrum without that of its spring, and what it describes."""
    name = item.name.rpartition("-L")[0]
    return name if sweep.kind == "roughness" else f"{name}-{sweep.kind}"


def _without_spacing(sweep: Sweep, cells: Sequence[LawCell]) -> list[LawCell]:
    """Extrapolation of two spacings of uncorrelated sites to none, linear in the spacing."""
    fine, coarse = sorted(sweep.elastic_energies)
    # The spacing is a pixel; in units of the Larkin length it goes with e_el.
    weight = fine / (coarse - fine)
    found = []
    for first, second in zip(cells[::2], cells[1::2], strict=True):
        numbers = {
            name: getattr(first, name) + weight * (getattr(first, name) - getattr(second, name))
            for name in ("approach", "retraction", "both", "front_rms")
        }
        error = float(np.hypot((1 + weight) * first.error, weight * second.error))
        left = abs(numbers["both"] - first.both) / 3
        found.append(
            replace(
                first,
                **numbers,
                spectrum=f"{first.spectrum}-weak",
                error=error,
                numerical_error=float(np.hypot(first.numerical_error, left)),
            )
        )
    return found


def sphere_rows(configuration: Path) -> Iterator[SphereRow]:
    """What the spheres of a sweep that has been run have.

    Raises
    ------
    ValueError
        If the sweep runs full cycles or straight fronts.
    """
    sweep = load_configuration(configuration)
    schedule = sweep.schedule
    if not isinstance(schedule, SteadySchedule):
        raise ValueError(f"{configuration} does not run the steady branches of spheres")
    path = results_folder(configuration) / "hysteresis.nc"
    dataset = read_dataset(path)
    radius = (dataset.lowest_radius + dataset.highest_radius).mean("realisation") / 2
    for (place, amplitude), (energy, found) in means(read_table(path), sweep.kind).items():
        item = sweep.spectra[place]
        spectrum = item.spectrum
        yield SphereRow(
            item.name,
            sweep.kind,
            spectrum.short_cutoff,
            spectrum.roll_off,
            spectrum.hurst,
            float(radius[place, amplitude]),
            energy,
            *astuple(found),
        )


_COLUMNS = (
    "e_el",
    "w_appr",
    "w_retr",
    "lowest_radius",
    "highest_radius",
    "w_appr_numerical_error",
    "w_retr_numerical_error",
)


def _steady(start: float, reach: float = 1.0, travel: float = 1.5) -> SteadySchedule:
    """Steady branches from a penetration on."""
    return SteadySchedule(start, start + reach, travel, standard_error=0.05)


@dataclass(frozen=True, slots=True)
class Scene:
    """A sphere that has no part in any fit."""

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
    # Of Main Fig. 5, as its spectrum is in reduced lengths.
    Scene(
        "nanodiamond", "roughness", SelfAffineSpectrum(0.00104, 0.0334, 1.0), 0.173, _steady(1.0)
    ),
)


def scene_rows(realisations: int = 3) -> Iterator[SphereRow]:
    """What the scenes have, simulated."""
    for scene in SCENES:
        first = simulation_of(
            scene.kind,
            scene.spectrum,
            scene.elastic_energy,
            scene.schedule,
            Numerics(0.03),
            seed=20261122,
        )
        found = [
            sweep_row(run_simulation(replace(first, realisation=number)))
            for number in range(realisations)
        ]
        columns = [np.array([getattr(row, name) for row in found]) for name in _COLUMNS]
        energy, appr, retr, low, high, *errors = columns
        mean = 1 - energy if scene.kind == "roughness" else 1.0
        lowering, raising = (mean - appr) / energy, (retr - mean) / energy
        numbers = [
            float(value)
            for column in (lowering, raising, (lowering + raising) / 2)
            for value in (column.mean(), column.std(ddof=1) / np.sqrt(column.size))
        ]
        numerical = float(np.mean(sum(errors) / (2 * energy)))
        yield SphereRow(
            scene.name,
            scene.kind,
            scene.spectrum.short_cutoff,
            scene.spectrum.roll_off,
            scene.spectrum.hurst,
            float(np.mean(low + high)) / 2,
            float(energy.mean()),
            realisations,
            *numbers,
            numerical,
        )


def reference_rows(path: Path, schedule: SteadySchedule) -> Iterator[SphereRow]:
    """Spheres of the data of SI Fig. S-5 that are kept as a reference, at known penetrations."""
    dataset = read_dataset(path)
    middle = (schedule.start + schedule.max_penetration) / 2
    table = SweepTable(
        **{
            item.name: np.asarray(dataset[item.name])
            if item.name in dataset
            else np.full([dataset.sizes[name] for name in item.dims], np.nan)
            for item in variables(SweepTable)
        }
    )
    for (place, _), (energy, found) in means(table, "roughness").items():
        yield SphereRow(
            f"{table.spectrum[place]}, paper",
            "roughness",
            float(table.short_cutoff[place]),
            float(table.roll_off[place]),
            float(table.hurst[place]),
            jkr.equilibrium_radius(middle),
            energy,
            *astuple(found),
        )


def read_spheres(path: Path) -> list[SphereRow]:
    """Rows of a `spheres.csv`."""
    types: dict[str, type[Any]] = {"str": str, "int": int, "float": float}
    return [
        SphereRow(
            **{item.name: types[str(item.type)](row[item.name]) for item in fields(SphereRow)}
        )
        for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    ]


def text_of(rows: Sequence[Any]) -> str:
    """Text of a table of records."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow([item.name for item in fields(rows[0])])
    for row in rows:
        writer.writerow([f"{x:.5g}" if isinstance(x, float) else x for x in astuple(row)])
    return lines.getvalue()


def departures(rows: Sequence[SphereRow]) -> list[float]:
    """How far the law's k are from simulated ones where g is above 1, relative to these."""
    found = ((law_of(row), row) for row in rows)
    return [law.both.value / row.both - 1 for law, row in found if law.size > 1]


def sphere_table(rows: Sequence[SphereRow]) -> str:
    """Markdown table of simulated and predicted k, and how far they are apart for g above 1.

    The intervals of the law are held against simulations with the errors of both.
    """
    lines = [
        "| spectrum | e_el/w_int | radius | g | k, line alone | k, simulated | difference |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    apart, inside = departures(rows), 0
    for row in rows:
        law = law_of(row)
        difference = law.both.value / row.both - 1
        if law.size > 1:
            inside += is_covered(row, law)
        lines.append(
            f"| {row.spectrum} | {row.elastic_energy:.3g} | {row.contact_radius:.3g} | "
            f"{law.size:.2g} | {law.both.value:.2f} ({law.both.low:.2f} to {law.both.high:.2f}) | "
            f"{with_error(row.both, row.both_error)} | {difference:+.1%} |"
        )
    rms, worst = np.sqrt(np.mean(np.square(apart))), np.max(np.abs(apart))
    lines += [
        "",
        f"For g above 1, {len(apart)} rows: rms {rms:.1%}, worst {worst:.1%}; the 95% intervals "
        f"cover {inside}.",
    ]
    return "\n".join(lines)


def law_of(row: SphereRow) -> SphereFactors:
    """Factors k that the law gives for the sphere of a row."""
    return sphere_factors(_kind(row.kind), _spectrum(row), row.elastic_energy, row.contact_radius)


def _spectrum(row: SphereRow) -> SelfAffineSpectrum:
    """Spectrum of a sphere's surface."""
    return SelfAffineSpectrum(row.short_cutoff, row.roll_off, row.hurst)


def is_covered(row: SphereRow, law: SphereFactors) -> bool:
    """Whether a simulated k lies in the interval of the law, widened by the row's own errors."""
    difference = row.both - law.both.value
    reach = (law.both.high if difference > 0 else law.both.low) - law.both.value
    own = REACH * np.hypot(row.both_error, row.numerical_error)
    return bool(abs(difference) <= np.hypot(reach, own))


def sphere_points(rows: Sequence[SphereRow]) -> LawPoints:
    """Spheres as they are drawn."""
    return LawPoints(
        name="spheres",
        disorder=2 * np.sqrt([row.elastic_energy for row in rows]),
        size=np.array([law_of(row).size for row in rows]),
        factor=np.array([row.both for row in rows]),
        error=np.array([row.both_error for row in rows]),
        breadth=np.array([slope_breadth(_kind(row.kind), _spectrum(row)) for row in rows]),
    )


def draw_law(folder: Path, rows: Sequence[SphereRow]) -> tuple[Path]:
    """Draw the shipped law with what it was fitted to, and with spheres, as `law.png`."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "law.png"
    save_picture(law_figure(spectra_points(measured_cells()), sphere_points(rows)), path)
    return (path,)


def renew_pages(folder: Path, rows: Sequence[SphereRow]) -> tuple[Path, ...]:
    """Write the numbers of the shipped law into the pages of a checkout."""
    paths = tuple(folder / name for name in PAGES)
    apart = departures(rows)
    rms = float(np.sqrt(np.mean(np.square(apart))))
    found = finding(departure_of_spheres(rms, len(apart), len(rows)))
    for path in paths:
        text = path.read_text(encoding="utf-8")
        renewed = renewed_page(text, shipped_law(), measured_cells(), sphere_table(rows), found)
        write_text(path, renewed)
    return paths


def _kind(name: str) -> FieldKind:
    """What a spectrum describes, by its name."""
    return "roughness" if name == "roughness" else "chemical"


def main() -> None:
    """Fit the law, hold spheres against it, draw it, or write its numbers into the pages."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=("fit", "spheres", "held-out", "figure", "pages"))
    parser.add_argument("configurations", type=Path, nargs="*")
    parser.add_argument("--table", type=Path, nargs="+", default=(), help="tables to read")
    parser.add_argument("--output", type=Path, default=Path("results/benchmark"))
    chosen = parser.parse_args()
    known = [row for table in chosen.table for row in read_spheres(table)]
    if chosen.task == "spheres" and known:
        click.echo(sphere_table(known))
        return
    if chosen.task in ("figure", "pages"):
        if not known:
            parser.error("name the tables of spheres: --table docs/reference/spheres.csv")
        draw = draw_law if chosen.task == "figure" else renew_pages
        for path in draw(chosen.output, known):
            click.echo(f"{chosen.task}: {path}")
        return
    if chosen.task == "held-out":
        schedule = load_configuration(Path("config/paper.yaml")).schedule
        assert isinstance(schedule, SteadySchedule), "the paper's sweep has steady branches"
        spheres = [*scene_rows(), *reference_rows(Path("docs/reference/si-5.nc"), schedule)]
        write_text(chosen.output / "held-out.csv", text_of(spheres))
        click.echo(sphere_table(spheres))
        return
    if not chosen.configurations:
        parser.error("name the configurations of sweeps that have been run")
    if chosen.task == "spheres":
        spheres = [row for path in chosen.configurations for row in sphere_rows(path)]
        write_text(chosen.output / "spheres.csv", text_of(spheres))
        click.echo(sphere_table(spheres))
        return
    cells = [cell for path in chosen.configurations for cell in law_cells(path)]
    cells.sort(key=lambda cell: (cell.spectrum, cell.disorder, cell.size))
    text = text_of(cells)
    # What is shipped are the rows as they are written, to five digits.
    law = fitted_law(cells_of(text))
    write_text(chosen.output / "law.csv", text)
    write_text(chosen.output / "law.json", json.dumps(asdict(law), indent=1) + "\n")
    click.echo(f"{len(cells)} rows; rms {law.rms:.1%}, worst {law.worst:.1%} for g above 1")


if __name__ == "__main__":
    main()
