"""Figures of the paper: compute their data, draw them, and compare them with the paper."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

import click

from crackfront.cli.answers import announce_compilation, announce_cost
from crackfront.cli.option_types import FILE, examples
from crackfront.cli.output_files import check_writable
from crackfront.cli.result_commands import fit_of_sweep
from crackfront.plots.style import save_figure, save_picture
from crackfront.simulate.checksums import forget_sums
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import read_attributes, write_text
from studies.numbers import StoredFigure, store
from studies.pages import keep_option, output_option, tell
from studies.paper.checks import Check, checks_table, counted
from studies.paper.drawing import save_animation
from studies.paper.experiment import (
    hystereses,
    hystereses_figure,
    hystereses_numbers,
    hystereses_table,
    instability_numbers,
)
from studies.paper.figure import FIGURES, SCALES, Figure, figure, load_figure
from studies.records import read_record, write_record

commands = click.Group()

_output = output_option(default=Path("results/figures"), help="Folder of all figures.")

_PICTURES = Path("docs/experiments/figures")
"""Pictures of the gallery."""

_REFERENCE = Path("docs/reference")
"""Data that other pages use."""


@commands.command(
    "figure",
    epilog=examples("python -m studies paper figure config/figures/main-2.yaml --scale paper"),
)
@click.argument("configuration", type=FILE)
@click.option(
    "--scale",
    type=click.Choice(SCALES),
    default="quick",
    show_default=True,
    help="Coarser lengths, which take minutes on two cores, or the lengths of the paper.",
)
@_output
def compute_figure(configuration: Path, scale: str, output: Path) -> None:
    """Compute the data of one figure, named as its file in config/figures."""
    started, started_cpu = time.perf_counter(), time.process_time()
    parameters = load_figure(configuration, scale)
    shown = figure(configuration.stem)
    path = output / scale / f"{configuration.stem}.nc"
    forget_sums(output)
    check_writable(path.parent)
    announce_cost(configuration.stem, shown.seconds(parameters))
    if (sweep := getattr(parameters, "sweep", None)) is not None:
        record = shown.compute(parameters, click.echo, fit_of_sweep(Path(sweep)))
    else:
        announce_compilation()
        record = shown.compute(parameters, click.echo)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    costs = {
        "seconds": time.perf_counter() - started,
        "cpu_seconds": time.process_time() - started_cpu,
    }
    write_record(path, record, origin, title=shown.title, scale=scale, **costs)
    click.echo(f"data: {path}")


@commands.command(
    "draw", epilog=examples("python -m studies paper draw results/figures/quick/main-3ab.nc")
)
@click.argument("data", type=FILE)
def draw_figure(data: Path) -> None:
    """Draw a figure, and its animation if it has one, into the folder of its data."""
    shown, record = _figure_and_record(data)
    folder = data.absolute().parents[1]
    forget_sums(folder)
    for path in save_figure(shown.draw(record), data.with_suffix("")):
        click.echo(f"figure: {path}")
    if shown.animate is not None:
        animation = shown.animate(record)
        click.echo(f"animation: {save_animation(animation, data.with_suffix(''))}")


@commands.command("check", epilog=examples("python -m studies paper check"))
@_output
def check_figures(output: Path) -> None:
    """Compare the data of all figures with the statements of the paper, in checks.md."""
    sections: list[str] = []
    failed: list[str] = []
    all_checks: list[Check] = []
    for scale in SCALES:
        for path in _data_of_figures(output / scale):
            shown, record = _figure_and_record(path)
            checks = shown.checks(record)
            title = f"{shown.title} ({scale})"
            all_checks += checks
            sections += ["", f"## {title}", "", checks_table(checks).text()]
            failed += [_failure(title, check) for check in checks if check.result == "FAIL"]
    if not all_checks:
        raise _no_data(output)
    counts = [f"- {text}" for text in (*counted([checks_table(all_checks)]), *failed)]
    forget_sums(output)
    lines = ["# Checks of the figures", "", *counts, *sections, ""]
    write_text(output / "checks.md", "\n".join(lines))
    click.echo(f"checks: {output / 'checks.md'}")
    for line in counts:
        click.echo(line)


def _failure(title: str, check: Check) -> str:
    """Line about a check that fails, under the title of its figure."""
    return f"FAIL: {title}: {check.claim}: {check.expected} expected, {check.computed} found"


@commands.command(epilog=examples("python -m studies paper gallery"))
@_output
@click.option(
    "--pictures", type=FILE, default=_PICTURES, show_default=True, help="Folder of the pictures."
)
def gallery(output: Path, pictures: Path) -> None:
    """Store all figures and their checks for the pages.

    Each figure is stored at the paper's scale if it was computed, with its animation.
    """
    paths = {path.stem: path for scale in SCALES for path in _data_of_figures(output / scale)}
    if not paths:
        raise _no_data(output)
    pictures.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        if name in paths:
            _store_figure(name, paths[name], pictures)


def _store_figure(name: str, path: Path, pictures: Path) -> None:
    """Store a figure with its picture, or its animation, and its checks."""
    shown, record = _figure_and_record(path)
    if shown.animate:
        picture = pictures / f"{name}.gif"
        shutil.copyfile(path.with_suffix(".gif"), picture)
    else:
        picture = pictures / f"{name}.png"
        save_picture(shown.draw(record), picture)
    data = read_attributes(path)
    stored_figure = StoredFigure(
        title=shown.title,
        picture=picture.name,
        scale=data["scale"],
        cpu_seconds=round(float(data["cpu_seconds"])),
        checks=checks_table(shown.checks(record)),
    )
    data["command"] = f"make figures SCALE={data['scale']}"
    store("paper", figures={name: stored_figure}, data=data)
    click.echo(f"figure: {picture}")


@commands.command(epilog=examples("python -m studies paper experiment --keep"))
@output_option(default=Path("docs/figures"))
@keep_option
def experiment(output: Path, keep: bool) -> None:
    """Compare the measured hysteresis on nanodiamond with the predicted ones."""
    check_writable(output)
    path = _REFERENCE / "main-5bc.nc"
    contact = _figure_and_record(path)[1]
    shown = hystereses(contact)
    save_picture(hystereses_figure(shown), output / "experiment.png")
    parts = {"experiment": hystereses_table(shown)}
    numbers = hystereses_numbers(shown) | instability_numbers(contact)
    tell("paper", parts, numbers=numbers, keep=keep)


def _data_of_figures(folder: Path) -> list[Path]:
    """Files of a folder with data of figures."""
    paths = [folder / f"{name}.nc" for name in FIGURES]
    return [path for path in paths if path.exists()]


def _no_data(output: Path) -> ValueError:
    """Error about a folder without data of figures."""
    return ValueError(
        f"{output} does not contain data of figures; run python -m studies paper figure"
    )


def _figure_and_record(path: Path) -> tuple[Figure, Any]:
    """Figure that data are of, and the data."""
    if path.stem not in FIGURES:
        raise ValueError(
            f"{path} does not contain data of a figure; their files are named {', '.join(FIGURES)}"
        )
    shown = figure(path.stem)
    return shown, read_record(path, shown.record)
