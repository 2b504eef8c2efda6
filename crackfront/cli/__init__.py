"""The command `crackfront`: its sections, and how it refuses input."""

from __future__ import annotations

import atexit
import errno
import gc
from collections.abc import Sequence
from typing import Any

import click
from click.shell_completion import get_completion_class

from crackfront.cli.compilation import compile_solvers
from crackfront.cli.cycle import cycle
from crackfront.cli.integrity import compare, verify
from crackfront.cli.law import law
from crackfront.cli.report import StoppedError, examples
from crackfront.cli.results import aggregate, archive, figures, fit, summary
from crackfront.cli.surface import predict, surface
from crackfront.cli.sweep import plan, simulate, status
from crackfront.sweep.parallel import stopping_as_ctrl_c

_OBJECTS = 100_000
"""New objects after which the process of a command looks for garbage."""


class _RefusalError(click.ClickException):
    """Input that cannot be used."""

    exit_code = 2


class Commands(click.Group):
    """Commands whose errors are sentences."""

    def main(self, args: Sequence[str] | None = None, *others: Any, **options: Any) -> Any:
        """Run a command line; that of the process, its only purpose, where none is given."""
        if args is None:
            # Imports leave no garbage; to look for it in them takes as long as a short command.
            gc.set_threshold(_OBJECTS)
            atexit.register(gc.freeze)
        return super().main(args, *others, **options)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            with stopping_as_ctrl_c():
                return super().invoke(ctx)
        except KeyboardInterrupt as error:
            raise StoppedError(
                "Nothing is half-written; run the same command to continue from its last "
                "checkpoint, or to begin anew where it has none"
            ) from error
        except BrokenPipeError:
            raise
        except MemoryError as error:
            sentence = "the memory does not suffice; compute less, or on a machine with more"
            raise click.ClickException(sentence) from error
        except OSError as error:
            raise _RefusalError(_file_sentence(error)) from error
        except ValueError as error:
            raise _RefusalError(str(error)) from error


class _Sections(Commands):
    """The commands of the library, listed by what they are for."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands section by section."""
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                formatter.write_dl(
                    [(str(command.name), command.get_short_help_str(90)) for command in commands]
                )


def _file_sentence(error: OSError) -> str:
    """What is wrong with a file or folder."""
    if error.filename is None or error.strerror is None:
        return str(error)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return f"{error.filename} cannot be written: {error.strerror}; make room and repeat"
    return f"{error.filename} cannot be used: {error.strerror}; check the path and its permissions"


@click.command(
    epilog=examples(
        'eval "$(crackfront completion bash)"          # in ~/.bashrc',
        'eval "$(crackfront completion zsh)"           # in ~/.zshrc',
        "crackfront completion fish > ~/.config/fish/completions/crackfront.fish",
    )
)
@click.argument("shell", type=click.Choice(("bash", "zsh", "fish")))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print the script by which a shell completes commands and options."""
    kind = get_completion_class(shell)
    assert kind is not None, "click knows these shells"
    root = context.find_root().command
    click.echo(kind(root, {}, "crackfront", "_CRACKFRONT_COMPLETE").source())


SECTIONS: dict[str, tuple[click.Command, ...]] = {
    "Predictions": (predict, surface, law),
    "One contact": (cycle,),
    "Sweeps, in this order": (plan, simulate, status, aggregate, fit, figures, summary, archive),
    "Stored results": (verify, compare),
    "The machine": (compile_solvers, completion),
}
"""All commands, by what they are for."""

_EPILOG = """\b
Exit codes:
  0   done
  1   computed, but not what was asked for: too many simulations without a value,
      a cycle that ended early, ranks that failed, results that are damaged or do not
      agree
  2   the input cannot be used; one sentence says why, and nothing was computed
  3   predict: the theory applies with reservations, each of which is named
  4   predict: the theory does not apply, and what modulus, radius or roughness would do
  75  interrupted (Ctrl-C or SIGTERM); run the same command to continue

\b
Examples:
  crackfront cycle --field field.nc --max-penetration 1 --output cycle.nc --watch
  crackfront plan config/default.yaml
  crackfront simulate config/default.yaml --ranks 2
  crackfront status results/default --json
"""


def _tell_version(context: click.Context, parameter: click.Parameter, asked: bool) -> None:
    """Print the version, which is imported here so that --help does not wait for it, and end."""
    if asked and not context.resilient_parsing:
        from crackfront import __version__

        click.echo(f"{context.find_root().info_name}, version {__version__}")
        context.exit()


@click.group(
    cls=_Sections, epilog=_EPILOG, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_tell_version,
    help="Show the version and exit.",
)
def main() -> None:
    """Adhesion hysteresis of rough spheres by crack-front pinning."""


for section in SECTIONS.values():
    for command in section:
        main.add_command(command)
