"""Shared by commands: options and their types, ends of help texts, JSON and announcements."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from crackfront.core.bounds import Range
from crackfront.core.words import in_time
from crackfront.measured.options import PER_SCAN, REPEATED, Options
from crackfront.simulate.jsonable import to_jsonable

Command = Callable[..., None]


class _File(click.Path):
    """A name of a file or folder; an empty one, as of a variable that is not set, is none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path of a name."""
        if value == "":
            self.fail("the name is empty; name a file or folder", param, ctx)
        return super().convert(value, param, ctx)


FILE = _File(path_type=Path)
"""Type of a parameter that names a file or folder."""


class Number(click.FloatRange):
    """A number within bounds; NaN, which no comparison excludes, is none."""

    def __init__(self, bounds: Range) -> None:
        super().__init__(*bounds)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number of a text."""
        try:
            float(value)
        except ValueError:
            self.fail(f"{value!r} is no number", param, ctx)
        number = super().convert(value, param, ctx)
        if math.isnan(number):
            self.fail("nan is no number", param, ctx)
        return number


def whole(bounds: Range) -> click.IntRange:
    """Type of a parameter that is a whole number within bounds."""
    return click.IntRange(int(bounds.least), int(bounds.most))


as_json = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON value instead, for machines."
)
"""Option of a command whose answer machines may want."""


class StoppedError(click.ClickException):
    """A command was interrupted; the message says what is stored and how to continue."""

    exit_code = 75
    """EX_TEMPFAIL of sysexits.h."""

    def show(self, file: Any = None) -> None:
        """Print the sentence."""
        click.echo(f"Interrupted. {self.message}", err=True)


def examples(*lines: str) -> str:
    """End of the help of a command: command lines that show its use."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def echo_answer(content: object, lines: Iterable[str], *, as_json: bool) -> None:
    """Print the answer of a command: the content as JSON, or else the lines that state it."""
    if as_json:
        echo_json(content)
    else:
        click.echo("\n".join(lines))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a table, its first column aligned to the left and all others to the right."""
    cells = [heads, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row in cells:
        others = (cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))
        yield "  ".join((row[0].ljust(widths[0]), *others))


def echo_json(content: object) -> None:
    """Print one JSON value."""
    click.echo(json.dumps(to_jsonable(content), indent=2, allow_nan=False))


def announce_compilation(*, err: bool = False) -> None:
    """Print a line when something is compiled, on request to standard error."""
    from crackfront.core.compiled import when_compiling

    sentence = "compiling the solver (once, for half a minute to a minute)"
    when_compiling(lambda: click.echo(sentence, err=err))


def announce_cost(seconds: float, *, err: bool = True) -> None:
    """Print how much processor time is expected, if it is more than a moment."""
    if seconds > _MOMENT:
        click.echo(f"about {in_time(seconds)} of processor time", err=err)


_MOMENT = 20.0
"""Time that needs no announcement. (Units: s)"""


def refuse_unwritable(folder: Path) -> None:
    """Raise an OSError where a folder cannot be made or written to, before anything is computed."""
    import tempfile

    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        # The name of the temporary file says nothing to a user.
        raise OSError(error.errno, error.strerror, str(folder)) from error


def refuse_overwriting(inputs: Iterable[Path], outputs: Mapping[str, Path | None]) -> None:
    """Raise ValueError if an output is a file that the command reads, or two outputs are one.

    The outputs are those of options by their names; a figure without suffix is a PDF and a PNG.
    """
    # Of a link to itself `Path.resolve` finds no place.
    read = {os.path.realpath(path) for path in inputs}
    written: dict[str, str] = {}
    for option, given in outputs.items():
        if given is None:
            continue
        is_stem = option == "--figure" and not given.suffix
        for path in [Path(f"{given}{end}") for end in (".pdf", ".png")] if is_stem else [given]:
            place = os.path.realpath(path)
            if place in read:
                raise ValueError(
                    f"{option} would overwrite {path}, which the command reads; name another file"
                )
            if place in written:
                raise ValueError(
                    f"{written[place]} and {option} are the same file, {path}; name two files"
                )
            written[place] = option


def refuse_foreign_table(option: str, path: Path | None, first: str) -> None:
    """Raise ValueError if a file exists and is no table that begins with such a column."""
    if path is None or not path.is_file():
        return
    with path.open("rb") as file:
        if file.read(len(first)) != first.encode():
            raise _foreign(option, path)


def refuse_foreign_netcdf(option: str, path: Path | None) -> None:
    """Raise ValueError if a file exists and is no netCDF file of crackfront."""
    from crackfront.simulate.storage import UnreadableFileError, read_attributes

    if path is None or not path.is_file():
        return
    try:
        attributes = read_attributes(path)
    except UnreadableFileError:
        attributes = {}
    if "crackfront_version" not in attributes:
        raise _foreign(option, path)


def _foreign(option: str, path: Path) -> ValueError:
    """Refusal to replace a file that crackfront has not written."""
    return ValueError(
        f"{option} is {path}, a file that exists and that crackfront has not written; name another"
    )


def refuse_without(context: click.Context, needed: str, *names: str) -> None:
    """Raise ValueError if an option is given that has an effect only beside another one."""
    if not context.params[needed]:
        for name in names:
            if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
                raise ValueError(f"{_option(name)} has an effect only with {_option(needed)}")


def refuse_together(context: click.Context, one: str, *names: str) -> None:
    """Raise ValueError if an option is given beside another one that leaves it without effect."""
    if context.params[one]:
        for name in names:
            if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
                raise ValueError(f"{_option(name)} has no effect with {_option(one)}; drop one")


def _option(name: str) -> str:
    """Name of an option, of that of its parameter."""
    return f"--{name.removeprefix('as_').removeprefix('is_').replace('_', '-')}"


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
