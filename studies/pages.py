"""What studies write into pages: tables, numbers, and where both were measured."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import click

from crackfront.analysis.estimate import with_error
from crackfront.cli.option_types import FILE
from studies.numbers import STORED, Number, Origin, Stored, store

_BLOCK = re.compile(
    r"<!-- (?P<study>[\w-]+): (?P<name>.*?) -->(?P<text>.*?)<!-- end -->", re.DOTALL
)

_ORIGINS = re.compile(r"\n*<!-- measured -->.*?<!-- end -->\n", re.DOTALL)
"""Last line of a page, which says where its numbers come from."""

keep_option = click.option("--keep", is_flag=True, help=f"Store numbers and tables in {STORED}.")

output_option = functools.partial(click.option, "--output", type=FILE, show_default=True)
"""Option for the folder that a command writes into."""


def markdown_table(header: str, rows: Iterable[str | Sequence[str]]) -> str:
    """Table in Markdown; the header has a bar between columns, and so has a row that is one text.

    Examples
    --------
    >>> print(markdown_table("scene | time / s", [["flat", "3"], "h08 | 4"]))
    | scene | time / s |
    | --- | --- |
    | flat | 3 |
    | h08 | 4 |
    """
    lines = [header, ["---"] * len(header.split(" | ")), *rows]
    texts = (line if isinstance(line, str) else " | ".join(line) for line in lines)
    return "\n".join(f"| {text} |" for text in texts)


def tell(
    study: str,
    tables: Mapping[str, str],
    *,
    keep: bool,
    numbers: Mapping[str, Number] | None = None,
    data: Mapping[str, Any] | None = None,
) -> None:
    """Print the tables of a study, and store them with its numbers if that is asked for."""
    click.echo("\n\n".join(tables.values()))
    if keep:
        store(study, tables=tables, numbers=numbers, data=data)
        click.echo(f"stored: {STORED / study}.json; python -m studies pages writes the pages")


def renewed(page: str, studies: Mapping[str, Stored]) -> str:
    r"""Page with all of its blocks and its last line written again from what is stored.

    A block is a table between `<!-- STUDY: TABLE -->` and `<!-- end -->`, or a number within a line
    between `<!-- STUDY: NUMBER -->` and `<!-- end -->`. `<!-- STUDY: TABLE / ROW / COLUMN -->` is a
    cell of a table, in the row that begins with ROW; columns count from 1. A ValueError names a
    block that was not measured.

    Examples
    --------
    >>> known = {"speed": Stored(numbers={"ratio": Number(8.1, 0.5, commit="1a2b", command="x")})}
    >>> renewed("<!-- speed: ratio -->7<!-- end --> times\n", known).splitlines()[0]
    '<!-- speed: ratio -->8.10 ± 0.50<!-- end --> times'
    """
    used: list[Origin] = []

    def block(match: re.Match[str]) -> str:
        study, (name, *place) = match["study"], match["name"].split(" / ")
        record = studies.get(study, Stored())
        if table := record.tables.get(name):
            used.append(table)
            text = _cell(table.text, *place) if place else table.text
        elif number := record.numbers.get(name):
            used.append(number)
            text = _number_text(number)
        else:
            raise ValueError(f"the study {study} has not measured {name!r}; run it with --keep")
        if "\n" in match["text"]:
            text = f"\n\n{text}\n\n"
        return f"<!-- {study}: {match['name']} -->{text}<!-- end -->"

    text = _BLOCK.sub(block, _ORIGINS.sub("\n", page))
    return f"{text}\n{_measured_line(used)}" if used else page


def _number_text(number: Number) -> str:
    """Number with its error, if it is known."""
    return f"{number.value:g}" if number.error is None else with_error(number.value, number.error)


def _cell(table: str, row: str, column: str) -> str:
    """Text of a cell, in the row that begins with some cells; bold or not is the same."""
    for line in table.replace("**", "").splitlines():
        if line.startswith(f"| {row} |"):
            return line.split("|")[int(column)].strip()
    raise ValueError(f"no row of the table begins with {row!r}")


def _measured_line(origins: Iterable[Origin]) -> str:
    """Commands, commits and machines that the numbers of a page come from, as its last line."""
    commands: dict[tuple[str, str], dict[str, None]] = {}
    for origin in origins:
        machine = "" if origin.machine == "unknown" else f", {origin.machine}"
        place = f"commit {origin.commit[:7]}{machine}", origin.date[:10]
        commands.setdefault(place, {})[f"`{origin.command}`"] = None
    parts = (f"{', '.join(names)} ({commit}, {date})" for (commit, date), names in commands.items())
    return f"<!-- measured -->\n*Numbers of this page: {'; '.join(parts)}.*\n<!-- end -->\n"
