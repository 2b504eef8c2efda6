"""What the commands of all studies share: their options, and what they print and store."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import click

from crackfront.cli.option_types import FILE
from studies.numbers import STORED, Number, store

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
