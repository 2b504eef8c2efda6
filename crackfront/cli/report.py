"""What commands share: their help, running what is missing, and telling how far they are."""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.store import Store
    from crackfront.sweep.tasks import Finished

FILE = click.Path(path_type=Path)
"""Type of a parameter that names a file or folder."""

as_json = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON value instead, for machines."
)
"""Option of a command whose answer machines may want."""

TRY_AGAIN = 75
"""Exit code of a command that was told to end before it was done (EX_TEMPFAIL of sysexits.h)."""


def examples(*lines: str) -> str:
    """End of the help of a command: command lines that show its use."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def echo_json(content: object) -> None:
    """Print one JSON value; a number that is none would be a defect."""
    click.echo(json.dumps(content, indent=2, allow_nan=False, default=_plain))


def _plain(value: Any) -> object:
    """What JSON has for a path, or for a scalar of numpy."""
    return str(value) if isinstance(value, Path) else value.item()


def block(context: click.Context, parameter: click.Parameter, value: str | None) -> range | None:
    """Range that an option like 0-49 means, both ends included."""
    if value is None:
        return None
    first, dash, last = value.partition("-")
    if not (dash and first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
        raise click.BadParameter(
            f"{value!r} is no range of numbers; write the first and the last, as in 0-49"
        )
    return range(int(first), int(last) + 1)


def announce_compilation(*, err: bool = False) -> None:
    """Tell why nothing seems to happen, beside the output where that is for machines."""
    from crackfront.core.compiled import kernels_are_cached

    if not kernels_are_cached():
        click.echo("compiling the solver (once)", err=err)


def refuse_unwritable(folder: Path) -> None:
    """Raise where no file can be written in a folder, before anything is computed for it.

    Raises
    ------
    OSError
        If the folder cannot be made, or takes no file.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def launch(arguments: list[str], ranks: int, launcher: str | None, folder: Path) -> None:
    """Run a command on ranks, and end where they failed."""
    from crackfront.sweep import parallel

    folder.mkdir(parents=True, exist_ok=True)
    code = parallel.launch_ranks(arguments, ranks, launcher, folder)
    if code != 0:
        click.echo(
            f"Error: the ranks ended with exit code {code}; finished simulations are stored, and "
            "the same command continues with the others",
            err=True,
        )
        sys.exit(code if 0 < code < 126 else 1)


def fill_store(
    store: Store,
    missing: tuple[Simulation, ...],
    configuration: Path,
    checkpoint_seconds: float,
) -> None:
    """Run what is missing and report every simulation as it ends."""
    from crackfront.data.provenance import provenance
    from crackfront.sweep import notice
    from crackfront.sweep.tasks import NOT_STORED, STOPPED

    if missing:
        announce_compilation()
    started = time.monotonic()
    origin = provenance(configuration.read_text(encoding="utf-8"))
    count = 0
    with notice.heeded():
        outcomes = store.fill(missing, origin, checkpoint_seconds)
        for line, finished in _reported(outcomes, len(missing)):
            if finished.status == NOT_STORED:
                raise click.ClickException(
                    f"{line}; {count} of {len(missing)} simulations were stored, and the same "
                    "command continues with the others"
                )
            if finished.status == STOPPED:
                click.echo(
                    f"Stopped as told: {count} of {len(missing)} simulations were stored and the "
                    "running ones kept; the same command continues with the others",
                    err=True,
                )
                sys.exit(TRY_AGAIN)
            count += 1
    if missing:
        click.echo(f"{len(missing)} simulations in {time.monotonic() - started:.1f} s")


def _reported(
    outcomes: Iterator[tuple[Simulation, Finished]], total: int
) -> Iterator[tuple[str, Finished]]:
    """Outcomes with their lines: a bar on a terminal, else a line each."""
    from tqdm import tqdm

    from crackfront.sweep.table import COMPLETE

    terminal = sys.stderr.isatty()
    with tqdm(total=total, unit="simulation", disable=not terminal, file=sys.stderr) as bar:
        for count, (simulation, finished) in enumerate(outcomes, start=1):
            line = f"{simulation.label}: {finished.status}"
            line += f", {finished.sentence or f'{finished.seconds:.2f} s'}"
            if not terminal:
                click.echo(f"[{count}/{total}] {line}")
            elif finished.status not in COMPLETE:
                bar.write(line)
            bar.update()
            yield line, finished
