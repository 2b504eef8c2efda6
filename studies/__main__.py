"""The studies from the command line: `python -m studies NAME`, each with commands of its own."""

from __future__ import annotations

import importlib

import click

from crackfront.cli import Commands

STUDIES = {
    "paper": "Figures of the paper: compute their data, draw them, compare them with the paper.",
    "law": "The law of k: measure it on straight fronts, fit it, hold spheres against it.",
    "accuracy": "Errors of the numerics, the fit of their laws, and what the errors rest on.",
    "boundary-elements": "The model against boundary elements of the same rough sphere.",
    "speed": "Solvers against the reference, what requests cost, how sweeps scale.",
}
"""What each study measures, by the name of its folder."""


class _Studies(Commands):
    """Studies that are imported when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all studies."""
        return list(STUDIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Commands of a study."""
        if cmd_name not in STUDIES:
            return None
        study: click.Group = importlib.import_module(
            f"studies.{cmd_name.replace('-', '_')}.commands"
        ).commands
        return study

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the names of the studies without importing them."""
        with formatter.section("Studies"):
            formatter.write_dl(list(STUDIES.items()))


@click.group(cls=_Studies, context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """What was measured with crackfront; its numbers and figures stand in the pages."""


if __name__ == "__main__":
    main(prog_name="python -m studies")
