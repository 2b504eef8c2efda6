"""The studies from the command line: `python -m studies NAME`, each with commands of its own."""

from __future__ import annotations

import importlib

import click

from crackfront.cli import Commands
from crackfront.cli.answers import announce_compilation
from crackfront.cli.option_types import examples
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.storage import write_text
from studies.pages import keep_option

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
            about = {
                name: command.get_short_help_str(120) for name, command in self.commands.items()
            }
            formatter.write_dl([*STUDIES.items(), *about.items()])


@click.group(cls=_Studies, context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """Measure the numbers and figures of the pages."""


@main.command(epilog=examples("python -m studies pages"))
def pages() -> None:
    """Write the gallery; name the pages that quote other numbers than are stored."""
    from studies.numbers import stored
    from studies.paper.gallery import GALLERY, gallery_page
    from studies.quotes import read_quotes

    studies = {name: stored(name) for name in STUDIES}
    if figures := studies["paper"].figures:
        text = gallery_page(figures)
        if not GALLERY.exists() or GALLERY.read_text(encoding="utf-8") != text:
            write_text(GALLERY, text)
            click.echo(f"page: {GALLERY}")
    for quote in read_quotes():
        if not quote.is_shown(studies):
            click.echo(f"edit {quote.page}, which should say: {quote.text(studies)}")


@main.command(
    epilog=examples(
        "python -m studies canaries",
        "python -m studies canaries law paper",
        "python -m studies canaries --keep",
    )
)
@click.argument("studies", nargs=-1)
@keep_option
def canaries(studies: tuple[str, ...], keep: bool) -> None:
    """Measure some numbers of all STUDIES again, and compare them with the stored ones.

    Ends with 1 if a number has moved by more than a tenth of its error. With --keep the numbers are
    stored.
    """
    from studies.canaries import chosen_canaries, measured
    from studies.numbers import store

    chosen = chosen_canaries(studies)
    announce_compilation()
    compile_solver("newton", FullCycle)
    moved, seconds, count = [], 0.0, 0
    for result in measured(chosen):
        seconds, count = seconds + result.seconds, count + len(result.numbers)
        click.echo(f"{result.study}, {result.name}: {result.seconds:.1f} s")
        if keep:
            store(result.study, canaries=result.numbers)
        for comparison in result.comparisons():
            click.echo(f"  {comparison}")
            if comparison.has_moved:
                moved.append(comparison)
    summary = f"{len(moved)} moved by more than a tenth of their error"
    click.echo(f"{count} numbers in {seconds:.0f} s of one core: {summary}")
    for comparison in moved:
        click.echo(f"MOVED: {comparison}")
    if moved:
        raise SystemExit(1)


if __name__ == "__main__":
    main(prog_name="python -m studies")
