"""`crackfront samples`: predictions for a series of samples, as a table and a figure."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from crackfront.cli.option_types import (
    FILE,
    check_together,
    examples,
    options_of,
)
from crackfront.cli.output_files import check_overwriting, check_replaced_table, check_writable
from crackfront.measured.options import PredictionOptions, ReadingOptions, SphereOptions

if TYPE_CHECKING:
    from crackfront.measured.samples.sample import Sample
    from crackfront.measured.samples.sample_results import SampleResult

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Signs that begin a formula in a spreadsheet."""


@click.command(
    epilog=examples(
        "crackfront samples samples.csv --modulus 0.7MPa --poisson 0.5 --radius 1.25mm \\",
        "    --work-of-adhesion 63mJ/m2",
        "crackfront samples samples.yaml --csv - --quantity pull_off_force",
    )
)
@click.argument("path", type=FILE, metavar="TABLE")
@options_of(SphereOptions)
@options_of(ReadingOptions)
@options_of(PredictionOptions)
@click.option(
    "--csv",
    "table",
    type=FILE,
    help="Table of results; - prints it.  [default: results/samples/<table>.csv]",
)
@click.option(
    "--figure",
    type=FILE,
    help="Figure of the series; without suffix PDF and PNG.  [default: results/samples/<table>]",
)
@click.option("--no-figure", is_flag=True, help="Draw no figure.")
@click.option(
    "--quantity",
    type=click.Choice(["hysteresis", "w_appr", "w_retr", "e_el", "pull_off_force"]),
    default="hysteresis",
    help="What is printed for each sample, and what the figure shows.",
)
@click.option("--strict", is_flag=True, help="Exit with 3 if there are reservations.")
@click.pass_context
def samples(
    context: click.Context,
    /,
    path: Path,
    table: Path | None,
    figure: Path | None,
    no_figure: bool,
    quantity: str,
    strict: bool,
    **options: Any,
) -> None:
    """Predict a series of samples from a table, with a figure of predicted and measured values.

    TABLE is CSV, TSV or YAML with a row for each sample: `sample`, `scans` (with | between several)
    or `psd` or `rms`, and if they are known `group`, `radius (mm)`, `modulus (MPa)`,
    `work_of_adhesion (mJ/m2)`, `measured_hysteresis (mJ/m2)` and any other option of
    `crackfront predict` for scans, sphere and theory. Options of the command apply to rows that do
    not give a value.

    If a row cannot be used, the command ends with an error that states its line, before anything is
    computed. A sample whose files fail later has the outcome `invalid` in its row. The exit code is
    the largest of all samples, each as in `crackfront predict`.
    """
    from crackfront.measured.samples.sample import read_samples

    check_together(context, "no_figure", "figure")
    check_overwriting([path], {"--csv": table, "--figure": figure})
    check_replaced_table("--csv", table, "sample")
    stem = Path("results/samples", path.stem)
    table = table or stem.with_name(f"{stem.name}.csv")
    series = read_samples(path, options)
    if not no_figure:
        check_writable((figure or stem).parent)
    unused_columns = list(dict.fromkeys(name for sample in series for name in sample.further))
    if unused_columns:
        listed = ", ".join(unused_columns)
        click.echo(f"copied to the results without being used: {listed}", err=True)
    results = write_samples(table, series, "sample", quantity)
    invalid = [result.sample.name for result in results if result.outcome == "invalid"]
    if invalid:
        click.echo(f"without a value: {', '.join(invalid)}; the table states the reasons", err=True)
    if not no_figure:
        for file in _draw_series(results, quantity, figure or stem):
            click.echo(f"figure: {file}", err=_is_standard_output(table))
    context.exit(max(exit_code(result.outcome, strict) for result in results))


def _draw_series(results: Sequence[SampleResult], quantity: str, figure: Path) -> tuple[Path, ...]:
    """Draw predicted and measured values of a series; the files of the figure."""
    from crackfront.measured.page.series import series_figure
    from crackfront.plots.style import save_figure

    points = [result.point(quantity) for result in results]
    return save_figure(series_figure(points, quantity), figure)


def write_samples(
    path: Path,
    samples: Sequence[Sample],
    first_column: Literal["sample", "scan"],
    quantity: str = "hysteresis",
) -> list[SampleResult]:
    """Write a table with a row for each sample, and print the quantity of each as it is known.

    The path - is standard output. A file is written again after every sample, because each takes
    seconds: an interrupted command leaves the rows of the samples so far.
    """
    from crackfront.measured.samples.sample_results import predicted_samples
    from crackfront.simulate.storage import check_regular_file, write_text

    is_printed = _is_standard_output(path)
    if not is_printed:
        check_regular_file(path)
        check_writable(path.parent)
    results: list[SampleResult] = []
    for result in predicted_samples(samples):
        click.echo(_line(result, quantity), err=is_printed)
        results.append(result)
        if not is_printed:
            write_text(path, _csv_text(results, first_column))
    if is_printed:
        click.echo(_csv_text(results, first_column), nl=False)
    else:
        click.echo(f"table: {path}")
    return results


def _is_standard_output(path: Path) -> bool:
    """Whether the name of a table means standard output."""
    return str(path) == "-"


def _csv_text(results: Sequence[SampleResult], first_column: Literal["sample", "scan"]) -> str:
    """Comma-separated values of all results; tables of scans lack the group of a sample."""
    rows = []
    for result in results:
        row = {first_column: result.row["sample"]} | result.row
        if first_column == "scan":
            del row["sample"], row["group"]
        rows.append({_as_text(name): _as_text(cell) for name, cell in row.items()})
    # Samples may have different columns.
    heads = dict.fromkeys(name for row in rows for name in row)
    text = io.StringIO()
    table = csv.DictWriter(text, heads)
    table.writeheader()
    table.writerows(rows)
    return text.getvalue()


def _as_text(cell: Any) -> Any:
    """A cell that spreadsheets do not take for a formula."""
    from crackfront.measured.tables.number_cells import is_number

    is_formula = isinstance(cell, str) and cell.startswith(_FORMULA) and not is_number(cell)
    return f"'{cell}" if is_formula else cell


def _line(result: SampleResult, quantity: str) -> str:
    """Quantity and outcome of a sample, with the reason if it lacks a value or is in doubt."""
    from crackfront.measured.prediction.prediction_texts import ENERGY, estimate_text

    row = result.row
    reason = row.get("failed") or row.get("undecided") or ""
    if result.outcome == "invalid":
        reason = row["remarks"]
    outcome = f"{result.outcome}: {reason}" if reason else result.outcome
    if result.prediction is None:
        return f"{result.sample.name}: {outcome}"
    estimate = getattr(result.prediction, quantity)
    if not math.isfinite(estimate.value):
        return f"{result.sample.name}: {outcome}"
    name, unit = ("pull-off force", "N") if quantity == "pull_off_force" else (quantity, ENERGY)
    least = "at least " if quantity in ("hysteresis", "e_el") and result.prediction.at_least else ""
    return f"{result.sample.name}: {name} {least}{estimate_text(unit, estimate)}; {outcome}"


def exit_code(outcome: str, strict: bool) -> int:
    """Exit code for an outcome: 4 without a prediction; if strict, 3 with reservations."""
    if outcome in ("does not apply", "invalid"):
        return 4
    return 3 if strict and outcome != "applies" else 0
