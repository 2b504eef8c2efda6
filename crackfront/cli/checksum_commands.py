"""Whether results are as they were written, and the list that says so."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from crackfront.cli.answers import echo_answer
from crackfront.cli.option_types import FILE, as_json, examples
from crackfront.core.words import counted

_REMEDY = (
    "remove damaged files, of curves also their file in shards, and run make, which makes them "
    "again; remove what does not belong to the list, or run crackfront checksums"
)


@click.command(
    epilog=examples("crackfront verify results/default", "crackfront verify default.zip --json")
)
@click.argument("place", metavar="PLACE", type=FILE)
@as_json
def verify(place: Path, as_json: bool) -> None:
    """Check a folder of results, or its archive (ZIP), against its checksums, SHA256SUMS.

    `sha256sum --check SHA256SUMS` in the folder does the same, but for files that the list does not
    name. The exit code is 1 if a file is damaged, missing or not in the list, and 2 if the
    list is missing or incomplete. Nothing is changed.
    """
    from crackfront.sweep.integrity import verification

    report = verification(place)
    lines = [f"{counted(report.verified, 'file')} verified"]
    for kind, names in (
        ("damaged", report.damaged),
        ("missing", report.missing),
        ("not in the list", report.unlisted),
    ):
        lines += [f"{kind}: {name}" for name in names]
    echo_answer(asdict(report), lines, as_json=as_json)
    if not report.is_whole:
        raise click.ClickException(
            f"{place} is not as it was written: {len(report.damaged)} damaged, "
            f"{len(report.missing)} missing, {len(report.unlisted)} not in the list; {_REMEDY}"
        )


@click.command(epilog=examples("crackfront checksums results/default"))
@click.argument("folders", metavar="FOLDER...", type=FILE, nargs=-1, required=True)
def checksums(folders: tuple[Path, ...]) -> None:
    """Write SHA256SUMS, the checksums of a folder of results that is finished.

    The workflow writes it at its end; commands that write results later remove it. A file that
    does not agree with the checksum in its name or next to it is an error.
    """
    from crackfront.sweep.integrity import write_sums

    for folder in folders:
        click.echo(f"checksums: {write_sums(folder)}")
