"""Whether results are as they were written, and whether two of them agree."""

from __future__ import annotations

import math
from pathlib import Path

import click

from crackfront.cli.report import FILE, as_json, echo_json, examples


@click.command(
    epilog=examples(
        "crackfront verify results/default",
        "crackfront verify default.zip --json",
    )
)
@click.argument("place", metavar="FOLDER", type=FILE)
@as_json
def verify(place: Path, as_json: bool) -> None:
    """Check every file of a folder of results, or of its archive, against its digest.

    The exit code is 1 where a file is damaged, or missing although a journal or a list names it.
    """
    from crackfront.data.digests import Integrity
    from crackfront.sweep.verification import verification

    found = verification(place)
    if as_json:
        counts = {
            name: {state.value: count[state] for state in Integrity}
            for name, count in found.counts.items()
        }
        echo_json({"counts": counts, "damaged": found.damaged, "missing": found.missing})
    else:
        heads = "".join(f"{state.value:>18}" for state in Integrity)
        click.echo(f"{'files in':20}{heads}")
        for name, count in found.counts.items():
            numbers = "".join(f"{count[state]:18}" for state in Integrity)
            click.echo(f"{name:20}{numbers}")
        for what, names in (("damaged", found.damaged), ("missing", found.missing)):
            for name in names:
                click.echo(f"{what}: {name}")
    if found.damaged or found.missing:
        raise click.ClickException(
            f"{place}: {len(found.damaged)} files are damaged and {len(found.missing)} missing; "
            "make computes them anew, an archive is to be packed again"
        )
    if not as_json:
        click.echo(f"{place}: nothing is damaged or missing")


@click.command(
    epilog=examples(
        "crackfront compare results/default elsewhere/default",
        "crackfront compare results/figures/paper/main-3cd.nc docs/reference/main-3cd.nc",
    )
)
@click.argument("one", type=FILE)
@click.argument("other", type=FILE)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0),
    default=0.0,
    show_default=True,
    help="Largest difference at which results agree.",
)
@as_json
def compare(one: Path, other: Path, tolerance: float, as_json: bool) -> None:
    """Compare two files of results, or two folders of them, in values and in bits.

    The numbers are largest differences relative to the largest magnitude, a variable each. What a
    run cost and where it comes from is left out. The exit code is 1 where the results do not agree.
    """
    from crackfront.data.comparison import comparison

    found = comparison(one, other)
    agree = found.largest <= tolerance
    if as_json:
        # Shapes that disagree are infinitely different, for which JSON has no number.
        echo_json(
            {
                "agree": agree,
                "in_bits": found.in_bits,
                "files": found.n_file,
                "largest": _finite(found.largest),
                "variables": {
                    name: _finite(item.largest) for name, item in found.by_variable().items()
                },
                "alone": found.alone,
            }
        )
    else:
        for name, item in found.by_variable().items():
            click.echo(
                f"{name:36} {item.largest:.1e}  {item.file if item.largest else ''}".rstrip()
            )
        for path in found.alone:
            click.echo(f"without a counterpart: {path}")
        if agree:
            within = "" if found.largest == 0 else f" within {found.largest:.1e}"
            bits = "in bits" if found.in_bits else "in values, not in bits"
            click.echo(f"{found.n_file} files agree {bits}{within}")
    if not agree:
        raise click.ClickException(
            f"{one} and {other} do not agree: "
            + (
                f"{len(found.alone)} files have no counterpart"
                if found.alone
                else f"the largest difference is {found.largest:.1e}"
            )
        )


def _finite(value: float) -> float | None:
    """A number that JSON has."""
    return value if math.isfinite(value) else None
