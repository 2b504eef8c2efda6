"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import MISSING, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.report import (
    FILE,
    announce_compilation,
    as_json,
    echo_json,
    examples,
    refuse_unwritable,
)
from crackfront.cli.watch import Watch, state_line
from crackfront.simulate.cases import CASES, Resolution

if TYPE_CHECKING:
    from crackfront.core.cycle.record import Recorder
    from crackfront.core.field.fields import Interpolation


def _case_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of all cases."""
    known: dict[str, list[str]] = {}
    texts: dict[str, str] = {}
    for name, case in CASES.items():
        for item in fields(case):
            flag = _flag(item)
            known.setdefault(flag, []).append(name)
            texts.setdefault(flag, item.metadata["text"])
    for flag, names in reversed(known.items()):
        owner = "" if len(names) == len(CASES) else f"({', '.join(names)}) "
        command = click.option(flag, _parameter(flag), type=float, help=owner + texts[flag])(
            command
        )
    return command


def _flag(item: Any) -> str:
    """How the option of a field of a case is written."""
    return item.metadata["flag"] or f"--{item.name.replace('_', '-')}"


def _parameter(flag: str) -> str:
    """Name of the parameter of an option; some flags are words of Python."""
    return f"case_{flag.strip('-').replace('-', '_')}"


@click.command(
    epilog=examples(
        "crackfront cycle --field tile.nc --max-penetration 1 --output cycle.nc --watch",
        "crackfront cycle --field tile.nc --max-penetration 1 --step 0.05 --record fronts \\",
        "  --record energy --output cycle.nc",
        "crackfront cycle --geometry line --spring 32 --field tile.nc --from 300 --to 1100 \\",
        "  --step 10 --record fronts --output line.nc",
    )
)
@click.option("--field", "field_file", type=FILE, required=True, help="netCDF file of the field.")
@click.option(
    "--geometry",
    type=click.Choice(list(CASES)),
    default="sphere",
    show_default=True,
    help="What touches the surface.",
)
@_case_options
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0, min_open=True),
    default=1e-8,
    show_default=True,
    help="Force that may be left, relative to w_int per front length.",
)
@click.option(
    "--solver",
    default="newton",
    show_default=True,
    help="newton, or reference (the paper's algorithm); both find the same states.",
)
@click.option(
    "--max-sweeps",
    type=click.IntRange(min=1),
    default=10_000_000,
    show_default=True,
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
    type=click.IntRange(min=4),
    help="Sites of the front on a tile.  [default: one or more a pixel on the largest circle]",
)
@click.option(
    "--samples-per-pixel",
    type=click.FloatRange(min=0, min_open=True),
    help="Samples along a ray on a tile, per pixel.  [default: 2, or 4 where linear]",
)
@click.option(
    "--interpolation",
    type=click.Choice(["cubic", "linear"]),
    help="Pieces between samples of a ray.  [default: cubic on a tile, linear on polar samples]",
)
@click.option("--output", type=FILE, required=True, help="netCDF file of the cycle.")
@click.option(
    "--watch",
    is_flag=True,
    help="Show front and loop on the terminal as they grow; elsewhere print a line a state.",
)
@as_json
def cycle(
    field_file: Path,
    geometry: str,
    tolerance: float,
    solver: str,
    max_sweeps: int,
    record: tuple[str, ...],
    angles: int | None,
    samples_per_pixel: float | None,
    interpolation: Interpolation | None,
    output: Path,
    watch: bool,
    as_json: bool,
    **given: float | None,
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
    it ended early; the output is written in both cases. It is 2 where the input cannot be used.
    """
    from crackfront.core.cycle.record import Recorder
    from crackfront.core.outcome import Status
    from crackfront.core.solver.relax import named_solver
    from crackfront.data.files import refuse_no_file
    from crackfront.data.provenance import provenance
    from crackfront.simulate.fields import read_field
    from crackfront.simulate.files import write_cycle

    case = _case(geometry, given)
    refuse_no_file(output)
    refuse_unwritable(output.parent)
    solution = named_solver(solver, tolerance, max_sweeps)
    problem = case.problem(
        lambda: read_field(field_file, interpolation or "linear"),
        Resolution(angles, samples_per_pixel, interpolation),
    )
    if "fronts" in record and problem.front.size == 1:
        raise ValueError(
            "--record fronts: on rings the front is a circle, whose radius every record holds as "
            "mean_radius; leave it out"
        )
    announce_compilation(err=as_json)
    shown = Watch(getattr(case, "max_penetration", None)) if watch else None
    recorder = Recorder(
        fronts="fronts" in record,
        energy="energy" in record,
        observers=[_report if shown is None else shown],
    )
    recorder.run(problem.field, problem.front, problem.loads, solution)
    if shown is not None:
        shown.finish()
    outcome = recorder.record()
    write_cycle(output, outcome, provenance(), problem.field.geometry, problem.sites)
    count, load = len(recorder.states), recorder.load_name
    if as_json:
        forces = [state.force for state in recorder.states if hasattr(state, "force")]
        echo_json(
            {
                "output": output,
                "states": count,
                "status": outcome.status.name.lower(),
                f"end_{load}": outcome.end_load,
                "lowest_force": min(forces, default=None),
            }
        )
    else:
        click.echo(f"{count} states: {output}")
    if outcome.status is not Status[case.ends_by]:
        raise click.ClickException(f"at {load} {outcome.end_load:.6g} {outcome.status.value}")
    if not as_json and outcome.status is Status.LOST_CONTACT:
        click.echo(f"contact was lost at {load} {outcome.end_load:.6g}")


def _case(geometry: str, given: dict[str, float | None]) -> Any:
    """The case that the options name."""
    own = {_parameter(_flag(item)): item for item in fields(CASES[geometry])}
    values = {}
    for name, value in given.items():
        flag = f"--{name.removeprefix('case_').replace('_', '-')}"
        if name not in own and value is not None:
            raise ValueError(f"{flag} is no option of --geometry {geometry}; leave it out")
        if name in own and value is None and own[name].default is MISSING:
            raise ValueError(f"{flag} is missing; --geometry {geometry} needs it")
        if name in own and value is not None:
            values[own[name].name] = value
    return CASES[geometry](**values)


def _report(recorder: Recorder) -> None:
    """Tell on a terminal which state was found last."""
    if sys.stderr.isatty():
        click.echo(f"\r{state_line(recorder.states)}", nl=False, err=True)
