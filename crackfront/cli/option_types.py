"""Arguments and options of commands: their types, and which options go together."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from crackfront.core.bounds import Range
from crackfront.measured.options import PER_SCAN, REPEATED, Options

Command = Callable[..., None]


class _File(click.Path):
    """Name of a file or folder; an empty name, as of a variable that is not set, is an error."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path of a name."""
        if value == "":
            self.fail("the name is empty; name a file or folder", param, ctx)
        return super().convert(value, param, ctx)


FILE = _File(path_type=Path)
"""Type of a parameter that names a file or folder."""


class Number(click.FloatRange):
    """A number within bounds; NaN, which no comparison excludes, is an error."""

    def __init__(self, bounds: Range) -> None:
        super().__init__(*bounds)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number of a text."""
        try:
            float(value)
        except ValueError:
            self.fail(f"{value!r} is not a number", param, ctx)
        number = super().convert(value, param, ctx)
        if math.isnan(number):
            self.fail("nan is not a number", param, ctx)
        return number


def whole(bounds: Range) -> click.IntRange:
    """Type of a parameter that is a whole number within bounds."""
    return click.IntRange(int(bounds.least), int(bounds.most))


as_json = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON value instead, for machines."
)
"""Option of a command whose answer machines may want."""


def examples(*lines: str) -> str:
    """End of the help of a command: command lines that show its use."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def options_of(
    record: type[Options], *, required: bool = False, without: Iterable[str] = ()
) -> Callable[[Command], Command]:
    """Give a command an option for every field of a record, without some of them."""

    def decorated(command: Command) -> Command:
        for name, field in reversed(record.model_fields.items()):
            if name in without:
                continue
            marks = [mark for mark in (PER_SCAN, REPEATED) if mark in field.metadata]
            command = click.option(
                option_name(name),
                required=required,
                multiple=bool(marks),
                default=field.default or None,
                help=" ".join([*str(field.description).split(), *marks]),
            )(command)
        return command

    return decorated


def check_needed_option(context: click.Context, needed: str, *names: str) -> None:
    """Raise ValueError if one of some options is set, but not the option that it needs."""
    if not _first_set(context, [needed]) and (option := _first_set(context, names)):
        raise ValueError(f"{option} has an effect only with {option_name(needed)}; give both")


def check_together(context: click.Context, decider: str, *names: str) -> None:
    """Raise ValueError if one of some options is set that `decider` leaves without effect."""
    if context.params[decider] and (option := _first_set(context, names)):
        raise ValueError(f"{option} has no effect with {option_name(decider)}; drop one")


def _first_set(context: click.Context, names: Iterable[str]) -> str:
    """The first of some options that the user has set; empty if there is none."""
    for name in names:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            return option_name(name)
    return ""


def option_name(name: str) -> str:
    """Name of the option of a parameter."""
    return f"--{name.removeprefix('as_').removeprefix('is_').replace('_', '-')}"
