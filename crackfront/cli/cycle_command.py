"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import hashlib
import math
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.common import (
    FILE,
    Number,
    StoppedError,
    announce_compilation,
    announce_cost,
    as_json,
    echo_answer,
    examples,
    refuse_foreign_netcdf,
    refuse_overwriting,
    refuse_unwritable,
    whole,
)
from crackfront.core.arguments import regular_file
from crackfront.core.bounds import (
    DENSITY,
    NUMBER,
    SITES,
    Range,
)
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.words import counted
from crackfront.sweep.checkpoints import CheckpointTimer
from crackfront.sweep.parallel import deferring_stops

if TYPE_CHECKING:
    from xarray import Dataset

    from crackfront.core.cycle.record import Checkpoint, Observer, Recorder
    from crackfront.core.geometry.base import Geometry

_SECONDS_BETWEEN_CHECKPOINTS = 60.0

_SECONDS_IN_LOG = 10.0
"""Time between two lines of a log."""

_PLACE = Range(-NUMBER.most, NUMBER.most)
"""Loads and their steps; what is negative is refused where it cannot be."""

_MOST_BYTES = 1e8
"""Size of a file of loads."""


def _loads(_: click.Context, __: click.Parameter, given: str | None) -> tuple[float, ...] | None:
    """Loads of a text with commas, or of a file, in which what stands behind # is none."""
    from crackfront.surfaces.loop_setup import load_values

    if given is None:
        return None
    if re.fullmatch(r"[-+.\de]+", given) or ("," in given and not Path(given).exists()):
        return load_values([one.strip() for one in given.split(",")])
    try:
        text = regular_file(Path(given), _MOST_BYTES).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"--loads is {given}, which is no text; name one of numbers") from error
    try:
        return load_values(re.sub("#.*", "", text).replace(",", " ").split())
    except ValueError as error:
        raise ValueError(f"{given}: {error}") from error


@click.command(
    epilog=examples(
        "crackfront cycle --field field.nc --max-penetration 1 --output cycle.nc --watch",
        "crackfront cycle --field field.nc --max-penetration 1 --step 0.02 --output cycle.nc \\",
        "  --figure cycle",
        "crackfront cycle --field field.nc --max-penetration 1 --step 0.05 --record fronts \\",
        "  --record energy --output cycle.nc",
        "crackfront cycle --field field.nc --loads 0,1,0.2,1,0 --step 0.02 --output minor.nc",
        "crackfront cycle --spring 2 --field field.nc --loads 0,4,0 --step 0.1 --output line.nc",
    )
)
@click.option("--field", "field_file", type=FILE, required=True, help="netCDF file of the field.")
@click.option(
    "--max-penetration",
    type=Number(_PLACE),
    help="Largest penetration of a sphere, if no loads are given.",
)
@click.option(
    "--loads",
    callback=_loads,
    help="Loads, up and down in any order: a list as in 0,1,0.2,1, or a file of numbers.",
)
@click.option(
    "--step",
    type=Number(_PLACE),
    help="Largest load step.  [default without loads: 0.004, for dissipated energies within 1%]",
)
@click.option(
    "--spring",
    type=Number(NUMBER),
    help="A straight front instead of a sphere, on springs of this length, w_int / kappa.",
)
@click.option(
    "--error",
    type=Number(Range(0, 1)),
    help="Error of k that the numerics may leave, if the field states its spectrum.  "
    "[default: 0.03]",
)
@click.option(
    "--sites",
    type=whole(SITES),
    help="Sites of the front, instead of an error.  [default: one or more per pixel]",
)
@click.option(
    "--samples",
    type=Number(DENSITY),
    help="Samples per pixel along a ray, instead of an error.  [default: 2; straight fronts: 1]",
)
@click.option(
    "--solver",
    default="newton",
    help="newton, or reference (the paper's algorithm); both find the same states.",
)
@click.option(
    "--record",
    type=click.Choice(["fronts", "energy"]),
    multiple=True,
    help="Also record the fronts, or the dissipated energy; may be repeated.",
)
@click.option("--output", type=FILE, required=True, help="netCDF file of the cycle.")
@click.option("--figure", type=FILE, help="Figure: talk.svg, or without suffix PDF and PNG.")
@click.option("--watch", is_flag=True, help="Print a line for every state.")
@as_json
def cycle(
    field_file: Path,
    max_penetration: float | None,
    loads: tuple[float, ...] | None,
    step: float | None,
    spring: float | None,
    error: float | None,
    sites: int | None,
    samples: float | None,
    solver: str,
    record: tuple[str, ...],
    output: Path,
    figure: Path | None,
    watch: bool,
    as_json: bool,
) -> None:
    """Run one approach and retraction on a field from a file.

    The field is a surface on a periodic tile, work_of_adhesion(x, y) or height(x, y); the apex of
    the sphere is at its centre. `crackfront surface --field` makes a field from a scan, and
    crackfront.surface of the Python library from an array. All quantities are in reduced units:
    R = 1, w_int = 1/pi, E' = 3/4. Works of adhesion are in units of w_int if their attribute
    units is w_int.

    With --spring the front is straight along y, with one site for every y of the tile. Springs
    pull it along x; the loads, which a straight front needs, are the positions of their other
    ends, in the unit of length of the tile. On a tile without roughness the front rests at the
    load.

    The exit code is 0 if the cycle is complete (on a sphere without --loads, if contact is lost)
    and 1 if it ended early; the output is written in both cases. It is 2 if the input cannot be
    used, and 75 after Ctrl-C or SIGTERM: the states so far are then kept beside the output, and
    the same command continues from there.
    """
    from crackfront.core.cycle.load_schedule import DEFAULT_STEP
    from crackfront.core.cycle.record import Recorder
    from crackfront.core.outcome import Status
    from crackfront.core.solver.relax import named_solver
    from crackfront.simulate.provenance import provenance
    from crackfront.simulate.storage import refuse_no_file, write_dataset
    from crackfront.surfaces.loop_setup import LoopContact, LoopNumerics
    from crackfront.surfaces.loops import loop_dataset
    from crackfront.surfaces.pressed_sphere import PressedSphere
    from crackfront.surfaces.straight_front import straight_front
    from crackfront.surfaces.surface_array import read_field

    refuse_no_file(output)
    written = {"--output": output, "--figure": figure, "the checkpoint": _checkpoint(output)}
    refuse_overwriting([field_file], written)
    refuse_foreign_netcdf("--output", output)
    for path in (output, figure or output):
        refuse_unwritable(path.parent)
    solution = named_solver(solver, DEFAULT_TOLERANCE)
    surface = read_field(field_file)
    contact: LoopContact = PressedSphere(surface)
    if spring is not None:
        contact = straight_front(surface, spring)
    step = (DEFAULT_STEP if loads is None else math.inf) if step is None else step
    numerics = LoopNumerics(error, sites, samples)
    setup = contact.setup(loads, max_penetration, step, numerics)
    solution = replace(solution, tolerance=setup.tolerance)
    key = _key(field_file, spring, loads, max_penetration, step, numerics, solver, record)
    keeper = _States(output, key, setup.field.geometry)
    announce_compilation(err=as_json)
    announce_cost(setup.seconds)
    with deferring_stops(), _progress(setup.expected, every_state=watch) as shown:
        recorder = Recorder(
            fronts="fronts" in record,
            energy="energy" in record,
            observers=[shown, keeper],
            resume=keeper.found(),
        )
        recorder.run(setup.field, setup.front, setup.loads, solution)
    found = loop_dataset(recorder.record(), setup)
    write_dataset(output, found, provenance())
    keeper.remove()
    drawn = () if figure is None else _draw(found, figure)
    end = f"{recorder.load_noun} {recorder.load:.6g}"
    lines = [
        f"{counted(len(recorder.states), 'state')}: {output}",
        *(f"figure: {path}" for path in drawn),
    ]
    lines.append(found.attrs["result"])
    if recorder.status is Status.LOST_CONTACT:
        lines.append(f"contact was lost at {end}")
    echo_answer(_content(recorder, found, output), lines, as_json=as_json)
    if recorder.status not in (Status.LOST_CONTACT, None if loads is None else Status.CONVERGED):
        raise click.ClickException(f"at {end} {recorder.status.value}")


def _content(recorder: Recorder, found: Dataset, output: Path) -> dict[str, object]:
    """How a cycle ended and what it found, for JSON."""
    forces = found["force"].values.tolist() if "force" in found else []
    from_contact = bool(forces) and found["penetration"].values[0] == 0
    return {
        "output": output,
        "states": len(recorder.states),
        "status": recorder.status.name.lower(),
        f"end_{recorder.load_name}": recorder.load,
        "lowest_force": min(forces, default=None),
        "jump_in_force": forces[0] if from_contact else None,
        **{name: float(found.get(name, "nan")) for name in ("w_appr", "w_retr", "hysteresis")},
    }


@contextmanager
def _progress(expected: int, *, every_state: bool) -> Iterator[Observer]:
    """What shows new states: a bar on a terminal, now and then a line in a log, or one for each."""
    from tqdm import tqdm

    with tqdm(total=expected, unit="state", disable=not sys.stderr.isatty()) as bar:
        following = time.monotonic() + _SECONDS_IN_LOG

        def shown(recorder: Recorder) -> None:
            nonlocal following
            count, last = len(recorder.states), recorder.states[-1]
            bar.set_postfix_str(last.summary, refresh=False)
            bar.update(count - bar.n)
            if every_state or (bar.disable and time.monotonic() >= following):
                following = time.monotonic() + _SECONDS_IN_LOG
                branch = last.branch_names[last.direction]
                bar.write(f"state {count}, {branch}: {last.summary}", file=sys.stderr)

        yield shown


class _States:
    """The states of a cycle in a file beside its output, from which the same command goes on."""

    def __init__(self, output: Path, key: str, geometry: Geometry) -> None:
        self.path = _checkpoint(output)
        self._key, self._geometry = key, geometry
        self._file = CheckpointTimer(self.path, _SECONDS_BETWEEN_CHECKPOINTS)

    def found(self) -> Checkpoint | None:
        """Checkpoint of an earlier run of the same cycle, if there is one."""
        from crackfront.simulate.cycle_files import known_checkpoint
        from crackfront.simulate.storage import read_dataset, set_aside_if_damaged

        if not self.path.exists():
            return None
        if sentence := set_aside_if_damaged(self.path):
            click.echo(f"{sentence}; the cycle begins anew", err=True)
            return None
        found = known_checkpoint(read_dataset(self.path), self._key, self.path)
        if found is None:
            raise ValueError(
                f"{self.path} holds the states of another cycle, of another field, other options "
                "or of another version; remove it, or name another --output"
            )
        count = found.record.states.direction.size
        click.echo(f"going on from {self.path}, after state {count}", err=True)
        return found

    def remove(self) -> None:
        """Remove the file and its checksum, when the cycle has ended."""
        from crackfront.simulate.checksums import digest_path

        for path in (self.path, digest_path(self.path)):
            path.unlink(missing_ok=True)

    def __call__(self, recorder: Recorder) -> None:
        """Store the states when it is time for that; end the cycle when a stop is requested."""
        from crackfront.simulate.cycle_files import checkpoint_dataset
        from crackfront.simulate.provenance import provenance
        from crackfront.simulate.storage import write_derived

        def write(path: Path) -> None:
            kept = checkpoint_dataset(recorder.checkpoint(), self._key, self._geometry)
            write_derived(path, kept, provenance())

        if self._file.keep(write):
            count = len(recorder.states)
            raise StoppedError(
                f"{count} states are stored in {self.path}; run the same command to continue"
            )


def _checkpoint(output: Path) -> Path:
    """File beside an output that keeps the states of an interrupted cycle."""
    return output.with_name(f"{output.stem}.checkpoint.nc")


def _key(field_file: Path, *options: object) -> str:
    """Digits that change with the field, the options of a cycle and the version of the physics."""
    from crackfront.core.versions import PHYSICS_VERSION

    with field_file.open("rb") as file:
        content = hashlib.file_digest(file, "sha256").hexdigest()
    return hashlib.sha256(repr((content, *options, PHYSICS_VERSION)).encode()).hexdigest()


def _draw(found: Dataset, stem: Path) -> tuple[Path, ...]:
    """Draw the figure of a loop."""
    from crackfront.plots.figures import plot_loop
    from crackfront.plots.style import COLUMN, blank_figure, house_style, save_figure

    with house_style():
        figure = blank_figure(COLUMN, 0.82 * COLUMN)
        plot_loop(found, figure.add_subplot())
        return save_figure(figure, stem)
