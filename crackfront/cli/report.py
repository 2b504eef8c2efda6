"""What commands share: running the missing simulations, and telling how far they are."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from crackfront.scene import Simulation
    from crackfront.store import Finished, Store

FILE = click.Path(path_type=Path)
"""Type of a parameter that names a file or folder."""


def announce_compilation() -> None:
    """Tell why nothing seems to happen."""
    from crackfront.compiled import kernels_are_cached

    if not kernels_are_cached():
        click.echo("compiling the solver (once)")


def launch(arguments: list[str], ranks: int, launcher: str | None) -> None:
    """Run a command on ranks, and end where they failed."""
    from crackfront import parallel

    code = parallel.launch_ranks(arguments, ranks, launcher)
    if code != 0:
        click.echo(
            f"Error: the ranks ended with exit code {code}; finished simulations are stored, and "
            "the same command continues with the others",
            err=True,
        )
        sys.exit(code if 0 < code < 126 else 1)


def fill_store(store: Store, missing: tuple[Simulation, ...], configuration: Path) -> None:
    """Run what is missing and report every simulation as it ends."""
    from crackfront.provenance import provenance

    if missing:
        announce_compilation()
    started = time.monotonic()
    origin = provenance(configuration.read_text(encoding="utf-8"))
    errors = []
    for line, finished in _reported(store.fill(missing, origin), len(missing)):
        if finished.error:
            errors.append(line)
    if errors:
        raise click.ClickException(
            f"{len(errors)} of {len(missing)} simulations could not be run or stored, the first "
            f"is {errors[0]}"
        )
    if missing:
        click.echo(f"{len(missing)} simulations in {time.monotonic() - started:.1f} s")


def _reported(
    outcomes: Iterator[tuple[Simulation, Finished]], total: int
) -> Iterator[tuple[str, Finished]]:
    """Outcomes with their lines: a bar on a terminal, else a line each."""
    from tqdm import tqdm

    from crackfront.dataset import COMPLETE

    terminal = sys.stderr.isatty()
    with tqdm(total=total, unit="simulation", disable=not terminal, file=sys.stderr) as bar:
        for count, (simulation, finished) in enumerate(outcomes, start=1):
            line = f"{simulation.label}: {finished.error or finished.status}"
            if not finished.error:
                line += f", {finished.seconds:.2f} s"
            if not terminal:
                click.echo(f"[{count}/{total}] {line}")
            elif finished.status not in COMPLETE:
                bar.write(line)
            bar.update()
            yield line, finished
