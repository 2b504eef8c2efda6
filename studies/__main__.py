"""The studies from the command line: `python -m studies NAME`, each with commands of its own."""

from __future__ import annotations

import contextlib
import importlib
from pathlib import Path

import click

from crackfront.cli import Commands
from crackfront.cli.report import FILE, examples
from crackfront.data.files import write_text
from studies.pages import keep_option, tell

STUDIES = {
    "paper": "Figures of the paper: compute their data, draw them, compare them with the paper.",
    "law": "The law of k: measure it on straight fronts, fit it, compare spheres with it.",
    "accuracy": "Errors of the numerics and their laws, of predictions and of measured loops.",
    "boundary-elements": "The model against boundary elements of the same rough sphere.",
    "speed": "Times of the solvers, costs of requests, scaling of sweeps.",
}
"""What each study measures, by the name of its folder."""


class _Studies(Commands):
    """Studies that are imported when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all studies, and the commands of all."""
        return [*STUDIES, *super().list_commands(ctx)]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Commands of a study."""
        if cmd_name not in STUDIES:
            return super().get_command(ctx, cmd_name)
        study: click.Group = importlib.import_module(
            f"studies.{cmd_name.replace('-', '_')}.commands"
        ).commands
        study.help = STUDIES[cmd_name]
        return study

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the names of the studies without importing them."""
        with formatter.section("Studies"):
            about = {name: one.get_short_help_str(120) for name, one in self.commands.items()}
            formatter.write_dl([*STUDIES.items(), *about.items()])


@click.group(cls=_Studies, context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """Measure the numbers and figures of the pages anew."""


@main.command(epilog=examples("python -m studies pages", "python -m studies pages --check"))
@click.option("--check", is_flag=True, help="Write nothing; list numbers of older sources.")
def pages(check: bool) -> None:
    """Write the stored tables and numbers of studies into README.md, paper.md and docs.

    With --check a page whose numbers are not the stored ones is refused.
    """
    from studies.pages import kept_parts, renewed, stale

    parts = kept_parts()
    for path in (Path("README.md"), Path("paper.md"), *sorted(Path("docs").rglob("*.md"))):
        text = path.read_text(encoding="utf-8")
        if (new := renewed(text, parts)) == text:
            continue
        if check:
            raise ValueError(f"{path} has not what was measured; run python -m studies pages")
        write_text(path, new)
        click.echo(f"page: {path}")
    for told in stale(parts):
        click.echo(told)


@main.command(epilog=examples("python -m studies differences ../other-clone"))
@click.argument("clone", type=FILE)
@click.option("--machine", help="What computed there, if it is the machine that computed here.")
@keep_option
def differences(clone: Path, machine: str | None, keep: bool) -> None:
    """Compare the numbers of the pages with those that the same studies gave in another CLONE.

    A number differs if it has moved by more than its own error.
    """
    from studies.differences import differences_text
    from studies.pages import KEPT, kept_parts

    here = kept_parts()
    with contextlib.chdir(clone):
        there = kept_parts()
    if not there:
        raise ValueError(f"{clone} has no numbers in {KEPT}; give the folder of a clone")
    text = differences_text(here, there, machine)
    tell("differences", {"processors": text}, "studies.differences", keep=keep)


if __name__ == "__main__":
    main(prog_name="python -m studies")
