"""The command `crackfront`: one cycle on any field, and the steps of a sweep."""

from __future__ import annotations

from typing import Any

import click

from crackfront import __version__
from crackfront.cli.accuracy import accuracy, accuracy_report
from crackfront.cli.cycle import cycle
from crackfront.cli.figure import (
    check_figures,
    compare_figures,
    draw_figure,
    figure,
    gallery,
)
from crackfront.cli.outlook import plan, status
from crackfront.cli.sweep import aggregate, archive, figures, fit, simulate, summary
from crackfront.cli.validate import validate


class _RefusalError(click.ClickException):
    """Input that cannot be used."""

    exit_code = 2


class _Commands(click.Group):
    """Commands whose errors are sentences."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise _RefusalError(_file_sentence(error)) from error
        except ValueError as error:
            raise _RefusalError(str(error)) from error


def _file_sentence(error: OSError) -> str:
    """What is wrong with a file or folder."""
    if error.filename is None or error.strerror is None:
        return str(error)
    return f"{error.filename} cannot be used: {error.strerror}; check the path and its permissions"


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def main() -> None:
    """Adhesion hysteresis of rough spheres by crack-front pinning."""


for command in (
    cycle,
    plan,
    simulate,
    status,
    aggregate,
    fit,
    summary,
    figures,
    archive,
    figure,
    draw_figure,
    check_figures,
    compare_figures,
    gallery,
    accuracy,
    accuracy_report,
    validate,
):
    main.add_command(command)
