"""Options of commands, made from the fields of records."""

from __future__ import annotations

from collections.abc import Callable

import click

from crackfront.topography.options import PER_SCAN, REPEATED, Options

Command = Callable[..., None]


def options_of(record: type[Options], *, required: bool = False) -> Callable[[Command], Command]:
    """Give a command an option for every field of a record."""

    def decorated(command: Command) -> Command:
        for name, field in reversed(record.model_fields.items()):
            often = [mark for mark in (PER_SCAN, REPEATED) if mark in field.metadata]
            command = click.option(
                f"--{name.replace('_', '-')}",
                required=required,
                multiple=bool(often),
                default=field.default or None,
                help=" ".join([*str(field.description).split(), *often]),
            )(command)
        return command

    return decorated
