"""Whether results are as they were written, their repair, and whether two of them agree."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

import click

from crackfront.cli.report import FILE, Number, as_json, echo_answer, examples
from crackfront.data.bounds import Range, counted


@click.command(
    epilog=examples("crackfront verify results/default", "crackfront verify default.zip --json")
)
@click.argument("place", metavar="PLACE", type=FILE)
@as_json
def verify(place: Path, as_json: bool) -> None:
    """Check a folder of results, or its archive (ZIP), against its checksums, SHA256SUMS.

    `sha256sum --check SHA256SUMS` in the folder does the same. Files that the list does not name
    are checked where they have checksums of their own: netCDF files, and curves in packs. The exit
    code is 1 where a file is damaged, or missing although a row or the list names it, or where the
    configuration, the table, its rows and its curves are of different sweeps.
    """
    from crackfront.sweep.store import mixture_sentence
    from crackfront.sweep.verification import verification

    found = verification(place)
    lines = [
        f"{counted(found.listed, 'file')} in SHA256SUMS, {counted(found.unlisted, 'other')}",
        *(f"damaged: {name}" for name in found.damaged),
        *(f"missing: {name}" for name in found.missing),
        *found.mixture,
        *filter(None, [mixture_sentence(found.arithmetic)]),
    ]
    if is_whole := not (found.damaged or found.missing or found.mixture):
        lines.append(f"{place}: nothing is damaged or missing")
    content = {**asdict(found), "arithmetic": sorted(found.arithmetic)}
    echo_answer(content, lines, as_json=as_json)
    if not is_whole:
        if found.mixture and not (found.damaged or found.missing):
            raise click.ClickException(
                f"{place} holds files that do not belong together; run crackfront simulate, "
                "aggregate and fit with one configuration, or the workflow"
            )
        raise click.ClickException(
            f"{place}: {counted(len(found.damaged), 'damaged file')}, {len(found.missing)} "
            "missing; the workflow computes them anew, an archive is to be packed again"
        )


@click.command(epilog=examples("crackfront checksums results/default"))
@click.argument("folders", metavar="FOLDER...", type=FILE, nargs=-1, required=True)
def checksums(folders: tuple[Path, ...]) -> None:
    """Write SHA256SUMS, the checksums of a folder of results that is finished.

    Commands that change the folder later remove the list. The workflow writes it at its end. A
    folder whose files are not those of a list that is there is refused.
    """
    from crackfront.data.digests import SUMS
    from crackfront.data.files import damaged_files, write_sums

    for folder in folders:
        # Without a list there is nothing to compare with; what is damaged then is found below.
        if (folder / SUMS).is_file() and (damaged := damaged_files(folder)):
            raise ValueError(
                f"{damaged[0]} is not as it was written; run crackfront repair {folder} and make "
                "it again, or remove SHA256SUMS if the file is right"
            )
        click.echo(f"checksums: {write_sums(folder)}")


@click.command(
    epilog=examples("crackfront repair config/default.yaml", "crackfront repair results/figures")
)
@click.argument("places", metavar="PLACE...", type=FILE, nargs=-1, required=True)
@click.option(
    "--output", type=FILE, help="Folder of the results of configurations.  [default: their own]"
)
def repair(places: tuple[Path, ...], output: Path | None) -> None:
    """Set damaged files aside, so that the workflow makes them and dependent files again.

    A PLACE is a configuration of a sweep, or a folder of results. Shards of a sweep whose curves
    are missing are removed, and files that are dated in the future get the present date. `make`
    begins with this command; no other part of the workflow changes results before its jobs run.
    """
    from crackfront.data.files import reset_future_dates

    for place in places:
        folder, sentences = _repaired(place, output)
        reset_future_dates(folder)
        for sentence in sentences:
            click.echo(sentence)


def _repaired(place: Path, output: Path | None) -> tuple[Path, Iterable[str]]:
    """Folder of a place, and the sentences of its repair, which runs as they are read."""
    from crackfront.data.files import set_aside_damaged
    from crackfront.sweep.library import opened

    if not place.is_dir():
        _, store, _ = opened(place, output)
        return store.folder, store.repair(place)
    kept = place / "configuration.yaml"
    try:
        _, store, _ = opened(kept, place)
    except ValueError:  # the folder is of no sweep, or its configuration is damaged
        return place, set_aside_damaged(place)
    return place, store.repair(kept)


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
    type=Number(Range(0, math.inf)),
    default=0.0,
    help="Largest difference at which results agree.",
)
@as_json
def compare(one: Path, other: Path, tolerance: float, as_json: bool) -> None:
    """Compare two files of results, or two folders of them, in values and in bits.

    The output lists the largest difference of each variable, relative to its largest magnitude.
    Costs and origin of a run are left out. The exit code is 1 if the results do not agree.
    """
    from crackfront.data.comparison import comparison

    found = comparison(one, other)
    variables, agree = found.by_variable(), found.largest <= tolerance
    content = {
        "agree": agree,
        "in_bits": found.in_bits,
        "files": found.n_file,
        "largest": found.largest,
        "variables": {name: item.largest for name, item in variables.items()},
        "alone": found.alone,
    }
    lines = [
        f"{name:36} {item.largest:.1e}  {item.file if item.largest else ''}".rstrip()
        for name, item in variables.items()
    ]
    lines += [f"without a counterpart: {path}" for path in found.alone]
    if agree:
        within = "" if found.largest == 0 else f", within {found.largest:.1e}"
        bits = "in bits" if found.in_bits else "in values, not in bits"
        lines.append(f"agreement of {counted(found.n_file, 'file')} {bits}{within}")
    echo_answer(content, lines, as_json=as_json)
    if not agree:
        difference = f"the largest difference is {found.largest:.1e}"
        if found.largest == math.inf:
            names = ", ".join(name for name, item in variables.items() if item.largest == math.inf)
            difference = f"not in both, of another shape, or not a number in one: {names}"
        if found.alone:
            difference = f"{counted(len(found.alone), 'file')} without a counterpart"
        raise click.ClickException(f"{one} and {other} do not agree: {difference}")
