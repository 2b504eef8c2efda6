"""Whether results are as they were written, and the list that says so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, as_json, echo_answer, examples
from crackfront.data.bounds import counted

if TYPE_CHECKING:
    from crackfront.sweep.integrity import Verification


@click.command(
    epilog=examples("crackfront verify results/default", "crackfront verify default.zip --json")
)
@click.argument("place", metavar="PLACE", type=FILE)
@as_json
def verify(place: Path, as_json: bool) -> None:
    """Check a folder of results, or its archive (ZIP), against its checksums, SHA256SUMS.

    `sha256sum --check SHA256SUMS` in the folder does nearly the same. The checksums in the names of
    finished simulations and next to tables are checked too, also before the list is written. An
    archive is read without unpacking it. The exit code is 1 if a file is damaged, missing or not in
    the list, or if there is no list.
    """
    from crackfront.sweep.integrity import verification

    found = verification(place)
    content = {"whole": found.is_whole, **asdict(found)}
    echo_answer(content, _lines(place, found), as_json=as_json)
    if not found.is_whole:
        raise click.ClickException(_problem(place, found))


def _lines(place: Path, found: Verification) -> Iterator[str]:
    """What a verification found, a line for each file that needs attention."""
    from crackfront.data.digests import SUMS, shown

    yield f"{counted(found.listed, 'file')} in {SUMS}, {found.verified} verified"
    kinds = {
        "damaged": found.damaged,
        "missing": found.missing,
        f"not in {SUMS}": found.unlisted,
        "not a regular file": found.irregular,
    }
    for kind, names in kinds.items():
        for name in names:
            yield f"{kind}: {shown(name)}"
    if found.is_whole:
        yield f"{place}: nothing is damaged or missing"


def _problem(place: Path, found: Verification) -> str:
    """What is wrong with results, and what to do."""
    sentences = []
    if found.damaged or found.missing or found.unlisted:
        remedy = "pack the archive again"
        if place.is_dir():
            remedy = "remove damaged files and run make, which makes them again"
            if not found.damaged and not found.missing:
                remedy = "remove what does not belong to the results, or run crackfront checksums"
        sentences.append(
            f"{place} has {counted(len(found.damaged), 'damaged file')}, {len(found.missing)} "
            f"missing, {len(found.unlisted)} not in the list; {remedy}"
        )
    if found.fault:
        sentences.append(found.fault)
    if not found.verified:
        sentences.append("Nothing was verified")
    return ". ".join(sentences)


@click.command(epilog=examples("crackfront checksums results/default"))
@click.argument("folders", metavar="FOLDER...", type=FILE, nargs=-1, required=True)
def checksums(folders: tuple[Path, ...]) -> None:
    """Write SHA256SUMS, the checksums of a folder of results that is finished.

    Commands that change the folder later remove the list. The workflow writes it at its end. A file
    that does not agree with its own checksum, or with the list that is there, is an error.
    """
    from crackfront.sweep.integrity import write_sums

    for folder in folders:
        click.echo(f"checksums: {write_sums(folder)}")
