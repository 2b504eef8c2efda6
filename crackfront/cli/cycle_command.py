"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.answers import StoppedError, announce_compilation, announce_cost, echo_answer
from crackfront.cli.option_types import (
    FILE,
    Number,
    as_json,
    examples,
    whole,
)
from crackfront.cli.output_files import check_overwriting, check_replaced_netcdf, check_writable
from crackfront.core.arguments import regular_file
from crackfront.core.bounds import (
    DENSITY,
    NUMBER,
    SITES,
    Range,
)
from crackfront.core.words import counted
from crackfront.sweep.checkpoints import CheckpointTimer
from crackfront.sweep.parallel import deferring_stops
from crackfront.sweep.watching import cycle_progress

if TYPE_CHECKING:
    from xarray import Dataset

    from crackfront.core.cycle.record import Observer, Recorder
    from crackfront.core.solver.relax import Solver
    from crackfront.simulate.cycle_files import CycleCheckpoint
    from crackfront.surfaces.loop_setup import LoopContact, LoopSetup

_SECONDS_BETWEEN_CHECKPOINTS = 60.0
"""The same as in `crackfront simulate`: a kill loses at most a minute of work. (Units: s)"""

_PLACE = Range(-NUMBER.most, NUMBER.most)
"""Loads and their steps; the contact rejects negative ones where they are not allowed."""

_MOST_BYTES = 1e8
"""Largest size of a file of loads. (Units: byte)"""


def _loads(_: click.Context, __: click.Parameter, text: str | None) -> tuple[float, ...] | None:
    """Loads of a text with commas, or of a file, in which # begins a comment."""
    from crackfront.surfaces.loop_setup import load_values

    if text is None:
        return None
    if re.fullmatch(r"[-+.\de]+", text) or ("," in text and not Path(text).exists()):
        return load_values([part.strip() for part in text.split(",")])
    try:
        content = regular_file(Path(text), _MOST_BYTES).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(
            f"--loads is {text}, which is not a text; name a file of numbers"
        ) from error
    try:
        return load_values(re.sub("#.*", "", content).replace(",", " ").split())
    except ValueError as error:
        raise ValueError(f"{text}: {error}") from error


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
    used, and 75 after Ctrl-C or SIGTERM: the states so far are then kept next to the output, and
    the same command continues from there.
    """
    from crackfront.core.cycle.load_schedule import DEFAULT_STEP
    from crackfront.core.solver.relax import named_solver
    from crackfront.simulate.cycle_files import CycleCheckpoint, checkpoint_path, cycle_key
    from crackfront.surfaces.loop_setup import LoopNumerics

    _check_outputs(field_file, output, figure)
    if step is None:
        step = DEFAULT_STEP if loads is None else math.inf
    numerics = LoopNumerics(error, sites, samples)
    contact = _contact(field_file, spring, max_penetration)
    setup = contact.setup(loads, step, numerics)
    solution = named_solver(solver, setup.tolerance)
    key = cycle_key(field_file, spring, loads, max_penetration, step, numerics, solver, record)
    checkpoint = CycleCheckpoint(checkpoint_path(output), key, setup.field.geometry)
    announce_compilation(err=as_json)
    announce_cost("cycle", setup.seconds)
    recorder = _recorded(setup, solution, checkpoint, record, every_state=watch)
    loop = _written_loop(recorder, setup, output)
    checkpoint.remove()
    figures = () if figure is None else _draw(loop, figure)
    lines = _result_lines(recorder, loop, output, figures)
    echo_answer(_content(recorder, loop, output), lines, as_json=as_json)
    _check_complete(recorder, has_loads=loads is not None)


def _contact(field_file: Path, spring: float | None, max_penetration: float | None) -> LoopContact:
    """Contact with the field of a file: a sphere, or a straight front on springs of a length."""
    from crackfront.surfaces.loops import loop_contact
    from crackfront.surfaces.straight_front import straight_front
    from crackfront.surfaces.surface_array import read_field

    surface = read_field(field_file)
    if spring is None:
        return loop_contact(surface, max_penetration)
    return loop_contact(straight_front(surface, spring), max_penetration)


def _check_outputs(field_file: Path, output: Path, figure: Path | None) -> None:
    """Raise if an output cannot be written, or would overwrite a file of something else."""
    from crackfront.simulate.cycle_files import checkpoint_path
    from crackfront.simulate.storage import check_regular_file

    check_regular_file(output)
    written = {"--output": output, "--figure": figure, "the checkpoint": checkpoint_path(output)}
    check_overwriting([field_file], written)
    check_replaced_netcdf("--output", output)
    for path in (output, figure or output):
        check_writable(path.parent)


def _recorded(
    setup: LoopSetup,
    solver: Solver,
    checkpoint: CycleCheckpoint,
    quantities: Sequence[str],
    *,
    every_state: bool,
) -> Recorder:
    """Run a cycle, from its checkpoint if there is one; StoppedError at a signal."""
    from crackfront.core.cycle.record import Recorder

    stored = checkpoint.read(lambda sentence: click.echo(sentence, err=True))
    if stored is not None:
        count = stored.record.states.direction.size
        click.echo(f"going on from {checkpoint.path}, after state {count}", err=True)
    with deferring_stops(), cycle_progress(setup.expected, every_state=every_state) as progress:
        recorder = Recorder(
            fronts="fronts" in quantities,
            energy="energy" in quantities,
            observers=[progress, _storing(checkpoint)],
            resume=stored,
        )
        recorder.run(setup.field, setup.front, setup.loads, solver)
    return recorder


def _written_loop(recorder: Recorder, setup: LoopSetup, output: Path) -> Dataset:
    """Curves and measures of a cycle, which are written into the output."""
    from crackfront.simulate.provenance import provenance
    from crackfront.simulate.storage import write_dataset
    from crackfront.surfaces.loops import loop_dataset

    loop = loop_dataset(recorder.record(), setup)
    write_dataset(output, loop, provenance())
    return loop


def _end(recorder: Recorder) -> str:
    """Load at which a cycle ended, in words."""
    return f"{recorder.load_noun} {recorder.load:.6g}"


def _result_lines(
    recorder: Recorder, loop: Dataset, output: Path, figures: Iterable[Path]
) -> Iterator[str]:
    """Files and result of a cycle, in lines for people."""
    from crackfront.core.outcome import Status

    yield f"{counted(len(recorder.states), 'state')}: {output}"
    for path in figures:
        yield f"figure: {path}"
    yield loop.attrs["result"]
    if recorder.status is Status.LOST_CONTACT:
        yield f"contact was lost at {_end(recorder)}"


def _check_complete(recorder: Recorder, *, has_loads: bool) -> None:
    """Raise if a cycle ended before contact was lost or all of the user's loads were visited."""
    from crackfront.core.outcome import Status

    complete = [Status.LOST_CONTACT]
    if has_loads:
        complete.append(Status.CONVERGED)
    if recorder.status not in complete:
        raise click.ClickException(f"at {_end(recorder)} {recorder.status.value}")


def _draw(loop: Dataset, figure: Path) -> tuple[Path, ...]:
    """Draw the figure of a loop; its files."""
    from crackfront.plots.figures import loop_figure
    from crackfront.plots.style import save_figure

    return save_figure(loop_figure(loop), figure)


def _content(recorder: Recorder, loop: Dataset, output: Path) -> dict[str, object]:
    """How a cycle ended and its measures, for JSON."""
    forces = loop["force"].values.tolist() if "force" in loop else []
    from_contact = bool(forces) and loop["penetration"].values[0] == 0
    return {
        "output": output,
        "states": len(recorder.states),
        "status": recorder.status.name.lower(),
        f"end_{recorder.load_name}": recorder.load,
        "lowest_force": min(forces, default=None),
        "jump_in_force": forces[0] if from_contact else None,
        **{name: float(loop.get(name, "nan")) for name in ("w_appr", "w_retr", "hysteresis")},
    }


def _storing(checkpoint: CycleCheckpoint) -> Observer:
    """Observer that stores the states from time to time, and ends the cycle at a signal."""
    timer = CheckpointTimer(checkpoint.path, _SECONDS_BETWEEN_CHECKPOINTS)

    def store(recorder: Recorder) -> None:
        if timer.keep(lambda _: checkpoint.write(recorder.checkpoint())):
            raise StoppedError(
                f"{len(recorder.states)} states are stored in {checkpoint.path}; run the same "
                "command to continue"
            )

    return store
