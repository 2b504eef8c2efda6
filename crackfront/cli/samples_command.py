"""`crackfront samples`: predictions for a series of samples, as a table and a figure."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
    if further := list(dict.fromkeys(name for sample in series for name in sample.further)):
        click.echo(f"copied to the results without being used: {', '.join(further)}", err=True)
    results = write_samples(table, series, "sample", quantity)
    invalid = [result.sample.name for result in results if result.outcome == "invalid"]
    if invalid:
        click.echo(f"without a value: {', '.join(invalid)}; the table states the reasons", err=True)
    if not no_figure:
        from crackfront.measured.page.series import series_figure
        from crackfront.plots.style import save_figure

        drawn = series_figure([result.point(quantity) for result in results], quantity)
        for file in save_figure(drawn, figure or stem):
            click.echo(f"figure: {file}", err=str(table) == "-")
    context.exit(max(exit_code(result.outcome, strict) for result in results))


def write_samples(
    path: Path, samples: Sequence[Sample], first: str, quantity: str = "hysteresis"
) -> list[SampleResult]:
    """Write a table with a row for each sample, as soon as it is known; - is standard output.

    The quantity of every sample is printed.
    """
    from crackfront.measured.samples.sample_results import predicted_samples
    from crackfront.simulate.storage import check_regular_file, write_text

    is_printed = str(path) == "-"
    results, rows = [], []
    if not is_printed:
        check_regular_file(path)
        check_writable(path.parent)
    text = ""
    for result in predicted_samples(samples):
        click.echo(_line(result, quantity), err=is_printed)
        results.append(result)
        row = {first: result.row["sample"]} | result.row
        if first != "sample":
            del row["sample"], row["group"]
        rows.append({_as_text(name): _as_text(cell) for name, cell in row.items()})
        # After every sample, as each takes seconds: an interruption keeps what was read.
        stream = io.StringIO()
        table = csv.DictWriter(stream, dict.fromkeys(name for row in rows for name in row))
        table.writeheader()
        table.writerows(rows)
        text = stream.getvalue()
        if not is_printed:
            write_text(path, text)
    click.echo(text if is_printed else f"table: {path}", nl=not is_printed)
    return results


def _as_text(cell: Any) -> Any:
    """A cell that spreadsheets do not take for a formula."""
    from crackfront.measured.tables.number_cells import is_number

    is_formula = isinstance(cell, str) and cell.startswith(_FORMULA) and not is_number(cell)
    return f"'{cell}" if is_formula else cell


def _line(result: SampleResult, quantity: str) -> str:
    """What came of a sample: the quantity, and why there is none or it is in doubt."""
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
    """Exit code of what came of a surface: 3 of reservations if strict, 4 without a prediction."""
    if outcome in ("does not apply", "invalid"):
        return 4
    return 3 if strict and outcome != "applies" else 0
