"""The command `crackfront`: one cycle on any field, and the steps of a sweep."""

from __future__ import annotations

from typing import Any

import click

from crackfront import __version__
from crackfront.cli.cycle import cycle
from crackfront.cli.sweep import aggregate, figures, fit, plan, simulate


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
        except (ValueError, OSError) as error:
            raise _RefusalError(str(error)) from error


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def main() -> None:
    """Adhesion hysteresis of rough spheres by crack-front pinning."""


for command in (cycle, plan, simulate, aggregate, fit, figures):
    main.add_command(command)
