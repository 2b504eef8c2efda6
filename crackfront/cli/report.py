"""What commands share: types of options, ends of help texts, JSON and announcements."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from crackfront.data.bounds import Range, in_time
from crackfront.data.jsonable import to_jsonable

T = TypeVar("T")

FILE = click.Path(path_type=Path)
"""Type of a parameter that names a file or folder."""


class Number(click.FloatRange):
    """A number within bounds; NaN, which no comparison excludes, is none."""

    def __init__(self, bounds: Range) -> None:
        super().__init__(*bounds)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number of a text."""
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


def with_progress(things: Iterable[T], total: int, unit: str) -> Iterator[T]:
    """The things one by one, with a bar on a terminal once they take more than a few seconds.

    Elsewhere lines on standard error count them, each after twice the time of the one before. The
    unit is the plural of a thing.
    """
    from tqdm import tqdm

    began, due, terminal = time.monotonic(), _PATIENCE, sys.stderr.isatty()
    with tqdm(
        total=total, unit=unit, delay=_PATIENCE, disable=not terminal, file=sys.stderr
    ) as bar:
        for number, thing in enumerate(things, start=1):
            yield thing
            bar.update()
            passed = time.monotonic() - began
            if not terminal and passed > due and number < total:
                click.echo(f"{number} of {total} {unit}", err=True)
                due = 2 * passed


_PATIENCE = 5.0
"""Time after which a command shows how far it is. (Units: s)"""


def refuse_unwritable(folder: Path) -> None:
    """Raise an OSError where a folder cannot be made or written to, before anything is computed."""
    import tempfile

    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass
