"""What the commands of all studies share: their options, and what they print and store."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import click

from crackfront.cli.option_types import FILE
from studies.numbers import STORED, Number, store
from studies.tables import TABLES, Table

keep_option = click.option(
    "--keep", is_flag=True, help=f"Store numbers and tables in {STORED.parent}."
)

output_option = functools.partial(click.option, "--output", type=FILE, show_default=True)
"""Option for the folder that a command writes into."""


def tell(
    study: str,
    tables: Mapping[str, Table],
    *,
    keep: bool,
    numbers: Mapping[str, Number] | None = None,
    data: Mapping[str, Any] | None = None,
) -> None:
    """Print the tables of a study, and store them with its numbers if that is asked for."""
    click.echo("\n\n".join(table.text() for table in tables.values()))
    if keep:
        store(study, tables=tables, numbers=numbers, data=data)
        click.echo(f"stored: {STORED / study}.json and {TABLES / study}")
