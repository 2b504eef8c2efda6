"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import hashlib
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
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
from crackfront.core.solver import DEFAULT_MAX_SWEEPS, DEFAULT_TOLERANCE
from crackfront.data.bounds import COUNT, DENSITY, NUMBER, TOLERANCE, Range, regular_file
from crackfront.simulate.cases import PLACE, LineCase, Resolution, SphereCase, load_values
from crackfront.sweep.parallel import deferring_stops, stop_is_requested

if TYPE_CHECKING:
    from xarray import Dataset

    from crackfront.core.cycle.record import Checkpoint, Observer, Recorder
    from crackfront.core.geometry.base import Geometry

_SECONDS_BETWEEN_CHECKPOINTS = 60.0

_MOST_BYTES = 1e8
"""Size of a file of loads."""


def _loads(_: click.Context, __: click.Parameter, given: str | None) -> tuple[float, ...] | None:
    """Loads of a text with commas, or of a file, in which what stands behind # is none."""
    if given is None:
        return None
    if re.fullmatch(r"[-+.\de]+(,[-+.\de]+)*", given):
        return load_values(given.split(","))
    text = regular_file(Path(given), _MOST_BYTES).read_text(encoding="utf-8")
    try:
        return load_values(re.sub("#.*", "", text).replace(",", " ").split())
    except ValueError as error:
        raise ValueError(f"{given}: {error}") from error


def _case(
    geometry: str, max_penetration: float | None, spring: float | None, **way: Any
) -> SphereCase | LineCase:
    """The contact and the loads that the options name."""
    if geometry == "sphere":
        if spring is not None:
            raise ValueError("--spring is no option of --geometry sphere; leave it out")
        return SphereCase(max_penetration, **way)
    if max_penetration is not None:
        raise ValueError("--max-penetration is no option of --geometry line; give --loads")
    if spring is None or way["loads"] is None:
        missing = "--spring" if spring is None else "--loads"
        raise ValueError(f"{missing} is missing; --geometry line needs it")
    return LineCase(spring, **way)


@click.command(
    epilog=examples(
        "crackfront cycle --field tile.nc --max-penetration 1 --output cycle.nc --watch",
        "crackfront cycle --field surface.nc --max-penetration 1 --step 0.02 --output cycle.nc \\",
        "  --figure cycle",
        "crackfront cycle --field tile.nc --max-penetration 1 --step 0.05 --record fronts \\",
        "  --record energy --output cycle.nc",
        "crackfront cycle --geometry line --spring 32 --field tile.nc --loads 300,1100,300 \\",
        "  --step 10 --record fronts --output line.nc",
        "crackfront cycle --field tile.nc --loads loads.txt --step 0.02 --output minor.nc",
    )
)
@click.option("--field", "field_file", type=FILE, required=True, help="netCDF file of the field.")
@click.option(
    "--geometry",
    type=click.Choice(["sphere", "line"]),
    default="sphere",
    help="What touches the surface.",
)
@click.option(
    "--max-penetration", type=Number(PLACE), help="Largest penetration of a sphere, without loads."
)
@click.option(
    "--loads",
    callback=_loads,
    help="Loads to visit, up and down in any order: a text as 0,1,0.2,1, or a file of numbers.",
)
@click.option(
    "--step",
    type=Number(PLACE),
    help="Largest difference of loads.  [default: 0.004 without loads, dissipated energies to 1%]",
)
@click.option(
    "--spring",
    type=Number(NUMBER),
    help="Length of the springs of a line, w_int / kappa, in the unit of the tile.",
)
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
    help="Pieces between samples of a ray.  [default: cubic]",
)
@click.option("--output", type=FILE, required=True, help="netCDF file of the cycle.")
@click.option("--figure", type=FILE, help="Figure: talk.svg, or without suffix PDF and PNG.")
@click.option("--watch", is_flag=True, help="Print a line for every state.")
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

    The field is a surface on a periodic tile, work_of_adhesion(x, y) or height(x, y), whose centre
    is the apex of the sphere, as crackfront.surface of the Python library makes one of an array.
    All quantities are in reduced units: R = 1, w_int = 1/pi, E' = 3/4; works of adhesion whose
    attribute units is w_int are relative to it.

    With --geometry line the front is straight, along y, one site for every y of the tile. Springs
    of the length --spring pull it along x, their other end at the loads; lengths are those of the
    tile, and the springs do not pull where the front feels the mean of the tile.

    The exit code is 0 where the cycle came to its end (on a sphere without --loads, by losing
    contact) and 1 where it ended early; the output is written in both cases. It is 2 where the
    input cannot be used, and 75 after Ctrl-C or SIGTERM: the states so far are then kept beside the
    output, and the same command goes on from there.
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
    resolution, case = Resolution(*sizes), _case(geometry, **given)
    refuse_no_file(output)
    for path in (output, figure or output):
        refuse_unwritable(path.parent)
    solution = named_solver(*solver)
    problem = case.problem(lambda: read_field(field_file), resolution)
    key = _key(field_file, geometry, given, solver, record, resolution)
    keeper = _Keeper(output, key, problem.field.geometry)
    announce_compilation(err=as_json)
    announce_cost(problem.seconds)
    with deferring_stops(), _progress(problem.expected, every_state=watch) as shown:
        recorder = Recorder(
            fronts="fronts" in record,
            energy="energy" in record,
            observers=[shown, keeper],
            resume=keeper.found(),
        )
        recorder.run(problem.field, problem.front, problem.loads, solution)
    found = loop_dataset(recorder.record(), problem.measures, problem.field.geometry)
    write_dataset(output, found, provenance())
    keeper.path.unlink(missing_ok=True)
    drawn = () if figure is None else _draw(found, figure)
    end = f"{recorder.load_name} {recorder.load:.6g}"
    lines = [f"{len(recorder.states)} states: {output}", *(f"figure: {path}" for path in drawn)]
    lines.append(found.attrs["result"])
    if recorder.status is Status.LOST_CONTACT:
        lines.append(f"contact was lost at {end}")
    echo_answer(_content(recorder, found, output), lines, as_json=as_json)
    if recorder.status.name not in case.ends_by:
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


@contextmanager
def _progress(expected: int, *, every_state: bool) -> Iterator[Observer]:
    """What shows every new state: on a terminal a bar, and on request a line for each."""
    from tqdm import tqdm

    with tqdm(total=expected, unit="state", disable=not sys.stderr.isatty()) as bar:

        def shown(recorder: Recorder) -> None:
            count, last = len(recorder.states), recorder.states[-1]
            bar.set_postfix_str(last.told, refresh=False)
            bar.update(count - bar.n)
            if every_state:
                branch = "approach" if last.direction > 0 else "retraction"
                bar.write(f"state {count}, {branch}: {last.told}", file=sys.stderr)

        yield shown


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
