"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.report import (
    FILE,
    Number,
    StoppedError,
    announce_compilation,
    announce_cost,
    as_json,
    echo_answer,
    examples,
    finite,
    refuse_unwritable,
    whole,
)
from crackfront.cli.watch import Progress
from crackfront.core.solver import DEFAULT_MAX_SWEEPS, DEFAULT_TOLERANCE
from crackfront.data.bounds import COUNT, DENSITY, TOLERANCE, Range
from crackfront.simulate.cases import CASES, Resolution
from crackfront.sweep.parallel import deferring_stops, stop_is_requested

if TYPE_CHECKING:
    from xarray import Dataset

    from crackfront.core.cycle.record import Checkpoint, Recorder
    from crackfront.core.geometry.base import Geometry

_SECONDS_BETWEEN_CHECKPOINTS = 60.0


def _flag(item: Field[Any]) -> str:
    """Option of the command line that fills a field of a case."""
    return item.metadata["flag"] or f"--{item.name.replace('_', '-')}"


def _case_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of all cases."""
    known: dict[str, tuple[Field[Any], list[str]]] = {}
    for name, case in CASES.items():
        for item in fields(case):
            known.setdefault(_flag(item), (item, []))[1].append(name)
    for flag, (item, names) in reversed(known.items()):
        owner = "" if len(names) == len(CASES) else f"({', '.join(names)}) "
        bounds, text = Number(item.metadata["bounds"]), owner + item.metadata["text"]
        command = click.option(flag, type=bounds, help=text)(command)
    return command


def _case(geometry: str, given: dict[str, float | None]) -> Any:
    """The case that the options name."""
    own, known = {_flag(item): item for item in fields(CASES[geometry])}, {}
    for name, value in given.items():
        flag = f"--{name.replace('_', '-')}"
        if value is None and flag in own and own[flag].default is MISSING:
            raise ValueError(f"{flag} is missing; --geometry {geometry} needs it")
        if value is not None:
            if flag not in own:
                raise ValueError(f"{flag} is no option of --geometry {geometry}; leave it out")
            known[own[flag].name] = value
    return CASES[geometry](**known)


@click.command(
    epilog=examples(
        "crackfront cycle --field tile.nc --max-penetration 1 --output cycle.nc --watch",
        "crackfront cycle --field surface.nc --max-penetration 1 --step 0.02 --output cycle.nc \\",
        "  --figure cycle",
        "crackfront cycle --field tile.nc --max-penetration 1 --step 0.05 --record fronts \\",
        "  --record energy --output cycle.nc",
        "crackfront cycle --geometry line --spring 32 --field tile.nc --from 300 --to 1100 \\",
        "  --step 10 --record fronts --output line.nc",
    )
)
@click.option("--field", "field_file", type=FILE, required=True, help="netCDF file of the field.")
@click.option(
    "--geometry", type=click.Choice(list(CASES)), default="sphere", help="What touches the surface."
)
@_case_options
@click.option(
    "--tolerance",
    type=Number(TOLERANCE),
    default=DEFAULT_TOLERANCE,
    help="Force that may be left, relative to w_int per front length.",
)
@click.option(
    "--solver",
    default="newton",
    help="newton, or reference (the paper's algorithm); both find the same states.",
)
@click.option(
    "--max-sweeps",
    type=whole(COUNT),
    default=DEFAULT_MAX_SWEEPS,
    help="Limit on the sweeps of one load step.",
)
@click.option(
    "--record",
    type=click.Choice(["fronts", "energy"]),
    multiple=True,
    help="Record the fronts, the dissipated energy too; may be repeated.",
)
@click.option(
    "--angles",
    type=whole(Range(4, COUNT.most)),
    help="Sites of the front on a tile.  [default: one or more a pixel on the largest circle]",
)
@click.option(
    "--samples-per-pixel",
    type=Number(DENSITY),
    help="Samples along a ray on a tile, per pixel.  [default: 2, or 4 where linear]",
)
@click.option(
    "--interpolation",
    type=click.Choice(["cubic", "linear"]),
    help="Pieces between samples of a ray.  [default: cubic on a tile, linear on polar samples]",
)
@click.option("--output", type=FILE, required=True, help="netCDF file of the cycle.")
@click.option("--figure", type=FILE, help="Figure of the loop, without suffix; PDF and PNG.")
@click.option(
    "--watch", is_flag=True, help="Print a line for every state; a terminal shows the last one."
)
@as_json
def cycle(
    field_file: Path,
    geometry: str,
    record: tuple[str, ...],
    output: Path,
    figure: Path | None,
    watch: bool,
    as_json: bool,
    **given: Any,
) -> None:
    """Run one approach and retraction on a field from a file.

    The field is a periodic tile work_of_adhesion(x, y), whose centre is the apex of the sphere,
    or samples work_of_adhesion(radius, angle), whose angles are the sites of the front. On rings,
    work_of_adhesion(radius), the front is a circle and the problem scalar. All quantities are in
    reduced units: R = 1, w_int = 1/pi, E' = 3/4. Surfaces of the Python library, saved by
    surface.to_netcdf, are fields as well.

    With --geometry line the front is straight, along y, one site for every y of the tile. Springs
    of the length --spring pull it along x, from --from to --to and back; lengths are those of the
    tile, and the springs do not pull where the front feels the mean of the tile.

    The exit code is 0 where the cycle came to its end (on a sphere, by losing contact) and 1 where
    it ended early; the output is written in both cases. It is 2 where the input cannot be used, and
    75 after Ctrl-C or SIGTERM: the states so far are then kept beside the output, and the same
    command goes on from there.
    """
    from crackfront.core.cycle.record import Recorder
    from crackfront.core.outcome import Status
    from crackfront.core.solver.relax import named_solver
    from crackfront.data.files import refuse_no_file, write_dataset
    from crackfront.data.provenance import provenance
    from crackfront.simulate.fields import read_field
    from crackfront.simulate.loops import loop_dataset

    solver = [given.pop(name) for name in ("solver", "tolerance", "max_sweeps")]
    sizes = (given.pop(name) for name in ("angles", "samples_per_pixel", "interpolation"))
    resolution, case = Resolution(*sizes), _case(geometry, given)
    refuse_no_file(output)
    for path in (output, figure or output):
        refuse_unwritable(path.parent)
    solution, pieces = named_solver(*solver), resolution.interpolation or "linear"
    problem = case.problem(lambda: read_field(field_file, pieces), resolution)
    if "fronts" in record and problem.front.size == 1:
        raise ValueError(
            "--record fronts: on rings the front is a circle, whose radius every record holds as "
            "mean_radius; leave it out"
        )
    key = _key(field_file, geometry, given, solver, record, resolution)
    keeper = _Keeper(output, key, problem.field.geometry)
    shown = Progress(problem.expected, every_state=watch)
    recorder = Recorder(
        fronts="fronts" in record,
        energy="energy" in record,
        observers=[shown, keeper],
        resume=keeper.found(),
    )
    announce_compilation(err=as_json)
    announce_cost(problem.seconds)
    with deferring_stops():
        recorder.run(problem.field, problem.front, problem.loads, solution)
    shown.finish()
    found = loop_dataset(recorder.record(), problem.measures, problem.field.geometry, problem.sites)
    write_dataset(output, found, provenance())
    keeper.path.unlink(missing_ok=True)
    drawn = () if figure is None else _draw(found, figure)
    end = f"{recorder.load_name} {recorder.load:.6g}"
    lines = [f"{len(recorder.states)} states: {output}", *(f"figure: {path}" for path in drawn)]
    lines.append(found.attrs["result"])
    if recorder.status is Status.LOST_CONTACT:
        lines.append(f"contact was lost at {end}")
    echo_answer(_content(recorder, found, output), lines, as_json=as_json)
    if recorder.status.name != case.ends_by:
        raise click.ClickException(f"at {end} {recorder.status.value}")


def _content(recorder: Recorder, found: Dataset, output: Path) -> dict[str, object]:
    """How a cycle ended and what it found, for JSON."""
    forces = [state.force for state in recorder.states if hasattr(state, "force")]
    return {
        "output": output,
        "states": len(recorder.states),
        "status": recorder.status.name.lower(),
        f"end_{recorder.load_name}": recorder.load,
        "lowest_force": min(forces, default=None),
        "jump_in_force": next(iter(forces), None),
        **{
            name: finite(float(found.get(name, "nan")))
            for name in ("w_appr", "w_retr", "hysteresis")
        },
    }


class _Keeper:
    """Stores the states of a cycle beside its output, and ends it when a stop is requested."""

    def __init__(self, output: Path, key: str, geometry: Geometry) -> None:
        self.path = output.with_name(f"{output.stem}.checkpoint.nc")
        self._key, self._geometry = key, geometry
        self._next = time.monotonic() + _SECONDS_BETWEEN_CHECKPOINTS

    def found(self) -> Checkpoint | None:
        """Checkpoint of an earlier run of the same cycle, if there is one."""
        from crackfront.data.files import UnreadableFileError, read_dataset, set_aside
        from crackfront.simulate.files import known_checkpoint

        if not self.path.exists():
            return None
        try:
            found = known_checkpoint(read_dataset(self.path), self._key, self.path)
        except UnreadableFileError:
            aside = f"it is set aside as {set_aside(self.path).name}, and the cycle begins anew"
            click.echo(f"{self.path} is damaged; {aside}", err=True)
            return None
        if found is None:
            click.echo(f"{self.path} is of another cycle; this one begins anew", err=True)
        else:
            count = found.record.states.direction.size
            click.echo(f"going on from {self.path}, after state {count}", err=True)
        return found

    def __call__(self, recorder: Recorder) -> None:
        """Store the states when it is time for that; end the cycle when a stop is requested."""
        from crackfront.data.files import write_dataset
        from crackfront.data.provenance import provenance
        from crackfront.simulate.files import checkpoint_dataset

        stop = stop_is_requested()
        if not stop and time.monotonic() < self._next:
            return
        kept = checkpoint_dataset(recorder.checkpoint(), self._key, self._geometry)
        write_dataset(self.path, kept, provenance())
        self._next = time.monotonic() + _SECONDS_BETWEEN_CHECKPOINTS
        if stop:
            count = len(recorder.states)
            raise StoppedError(
                f"{count} states are stored in {self.path}; run the same command to continue"
            )


def _key(field_file: Path, *options: object) -> str:
    """Digits that change with the field, the options of a cycle and the sources of its solver."""
    from crackfront.data.fingerprint import solver_fingerprint

    with field_file.open("rb") as file:
        content = hashlib.file_digest(file, "sha256").hexdigest()
    return hashlib.sha256(repr((content, *options, solver_fingerprint())).encode()).hexdigest()


def _draw(found: Dataset, stem: Path) -> tuple[Path, ...]:
    """Draw the figure of a loop."""
    from crackfront.plots.library import plot_loop
    from crackfront.plots.style import COLUMN, blank_figure, house_style, save_figure

    with house_style():
        figure = blank_figure(COLUMN, 0.82 * COLUMN)
        plot_loop(found, figure.add_subplot())
        return save_figure(figure, stem)
