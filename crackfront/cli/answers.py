"""What commands print: answers, tables, JSON, and announcements of waiting times."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import click

from crackfront.core.words import in_time
from crackfront.simulate.jsonable import to_jsonable

_MOMENT = 20.0
"""Time that needs no announcement. (Units: s)"""


class StoppedError(click.ClickException):
    """A command was interrupted; the message says what is stored and how to continue."""

    exit_code = 75
    """EX_TEMPFAIL of sysexits.h."""

    def show(self, file: Any = None) -> None:
        """Print the sentence."""
        click.echo(f"Interrupted. {self.message}", err=True)


def echo_answer(content: object, lines: Iterable[str], *, as_json: bool) -> None:
    """Print the answer of a command: the content as JSON, or else the lines that state it."""
    if as_json:
        echo_json(content)
    else:
        click.echo("\n".join(lines))


def echo_json(content: object) -> None:
    """Print one JSON value."""
    click.echo(json.dumps(to_jsonable(content), indent=2, allow_nan=False))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a table, its first column aligned to the left and all others to the right."""
    cells = [heads, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row in cells:
        further = (cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))
        yield "  ".join((row[0].ljust(widths[0]), *further))


def warn(sentence: str) -> None:
    """Print a warning."""
    click.echo(f"Warning: {sentence}", err=True)


def announce_compilation(*, err: bool = False) -> None:
    """Print a line when something is compiled, on request to standard error."""
    from crackfront.core.compiled import when_compiling

    sentence = "compiling the solver (once, for half a minute to a minute)"
    when_compiling(lambda: click.echo(sentence, err=err))


def announce_cost(task: str, seconds: float, *, err: bool = True) -> None:
    """Print how much processor time a task is expected to take, if it is more than a moment."""
    if seconds > _MOMENT:
        click.echo(f"{task}: about {in_time(seconds)} of processor time", err=err)
