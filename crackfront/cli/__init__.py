"""The command `crackfront`: one cycle on any field, and the steps of a sweep."""

from __future__ import annotations

from typing import Any

import click

from crackfront import __version__
from crackfront.cli.accuracy import accuracy, accuracy_report
from crackfront.cli.completion import completion
from crackfront.cli.cycle import cycle
from crackfront.cli.figure import check_figures, compare_figures, draw_figure, figure, gallery
from crackfront.cli.outlook import plan, status
from crackfront.cli.surface import predict, surface
from crackfront.cli.sweep import aggregate, archive, figures, fit, simulate, summary
from crackfront.cli.validate import validate


class _RefusalError(click.ClickException):
    """Input that cannot be used."""

    exit_code = 2


class _Commands(click.Group):
    """Commands whose errors are sentences, listed by what they are for."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands section by section."""
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                formatter.write_dl(
                    [(str(command.name), command.get_short_help_str(90)) for command in commands]
                )

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


SECTIONS: dict[str, tuple[click.Command, ...]] = {
    "Measured surfaces": (predict, surface),
    "One contact": (cycle,),
    "Sweeps, in this order": (
        plan,
        simulate,
        status,
        aggregate,
        fit,
        figures,
        summary,
        archive,
    ),
    "Figures of the paper": (figure, draw_figure, check_figures, compare_figures, gallery),
    "Numerical errors, validation": (accuracy, accuracy_report, validate),
    "The shell": (completion,),
}
"""All commands, by what they are for."""

_EPILOG = """\b
Exit codes:
  0   done
  1   computed, but not what was asked for: too many simulations without a value,
      a cycle that ended early, ranks that failed
  2   the input cannot be used; one sentence says why, and nothing was computed
  75  told to end (SIGTERM) before it was done; the same command goes on

\b
Examples:
  crackfront cycle --field field.nc --max-penetration 1 --output cycle.nc --watch
  crackfront plan config/default.yaml
  crackfront simulate config/default.yaml --ranks 2
  crackfront status results/default --json
"""


@click.group(
    cls=_Commands, epilog=_EPILOG, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(__version__)
def main() -> None:
    """Adhesion hysteresis of rough spheres by crack-front pinning."""


for section in SECTIONS.values():
    for command in section:
        main.add_command(command)
