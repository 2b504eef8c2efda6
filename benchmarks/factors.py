"""Make the table of the factors k that `crackfront predict` rests on, from results of sweeps.

make; make SWEEP=config/strong.yaml
python -m benchmarks.factors config/default.yaml config/strong.yaml --output results/benchmark

Every row of `factors.csv` is a spectrum and an amplitude of a sweep. Copied to
`crackfront/analysis/factors.csv`, it is what the command predicts from.
"""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Iterator
from dataclasses import astuple, fields
from pathlib import Path

import click
import numpy as np

from crackfront.analysis.estimate import mean_estimate
from crackfront.analysis.factors import MeasuredFactors
from crackfront.analysis.table import SweepTable
from crackfront.core import jkr
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.data.files import write_text
from crackfront.sweep.configuration import load_configuration, results_folder
from crackfront.sweep.table import read_table


def rows(table: SweepTable, contact_radius: float) -> Iterator[MeasuredFactors]:
    """Factors of every spectrum and amplitude of a sweep.

    Parameters
    ----------
    table : SweepTable
        Apparent works of adhesion of a sweep.
    contact_radius : float
        Radius of the contact. (Units: reduced lateral length)
    """
    energy = np.where(table.finite, table.e_el, np.nan)
    lowering = (1 - energy - table.w_appr) / energy
    raising = (table.w_retr - 1 + energy) / energy
    branches = [mean_estimate(item) for item in (lowering, raising, (lowering + raising) / 2)]
    energies, numerical = mean_estimate(energy)[0], mean_estimate(table.numerical_error)[0]
    for spectrum, amplitude in np.ndindex(energies.value.shape):
        cell = spectrum, amplitude
        yield MeasuredFactors(
            str(table.spectrum[spectrum]),
            *(
                float(getattr(table, name)[spectrum])
                for name in ("short_cutoff", "roll_off", "hurst", "correlation_length")
            ),
            contact_radius,
            float(energies.value[cell]),
            int(branches[0][1][cell]),
            *(
                float(number[cell])
                for estimate, _ in branches
                for number in (estimate.value, estimate.standard_error)
            ),
            float(numerical.value[cell]),
        )


def factors_text(measured: list[MeasuredFactors]) -> str:
    """Text of `factors.csv`."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow([item.name for item in fields(MeasuredFactors)])
    for row in measured:
        writer.writerow([f"{x:.5g}" if isinstance(x, float) else x for x in astuple(row)])
    return lines.getvalue()


def sweep_rows(configuration: Path) -> list[MeasuredFactors]:
    """Factors of a sweep that has been run.

    Raises
    ------
    ValueError
        If it has not been run, or runs full cycles.
    """
    schedule = load_configuration(configuration).schedule
    if not isinstance(schedule, SteadySchedule):
        raise ValueError(f"{configuration} runs full cycles; the table is made of steady branches")
    middle = (schedule.start + schedule.max_penetration) / 2
    table = read_table(results_folder(configuration) / "hysteresis.nc")
    return list(rows(table, jkr.equilibrium_radius(middle)))


def main() -> None:
    """Make the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("configurations", type=Path, nargs="+")
    parser.add_argument("--output", type=Path, default=Path("results/benchmark"))
    chosen = parser.parse_args()
    measured = [row for path in chosen.configurations for row in sweep_rows(path)]
    measured.sort(key=lambda row: (row.spectrum, row.elastic_energy))
    write_text(chosen.output / "factors.csv", factors_text(measured))
    click.echo(f"{len(measured)} rows: {chosen.output / 'factors.csv'}")


if __name__ == "__main__":
    main()
