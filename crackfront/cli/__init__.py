"""The command `crackfront`: its sections, and how it reports wrong input."""

from __future__ import annotations

import errno
import os
from typing import Any

import click

from crackfront.cli.answers import StoppedError, announce_compilation
from crackfront.cli.checksum_commands import checksums, verify
from crackfront.cli.cycle_command import cycle
from crackfront.cli.law_command import law
from crackfront.cli.loop_command import loop
from crackfront.cli.option_types import examples
from crackfront.cli.output import output_that_may_close
from crackfront.cli.result_commands import (
    aggregate,
    archive,
    fit,
)
from crackfront.cli.samples_command import samples
from crackfront.cli.surface_commands import predict, surface
from crackfront.cli.sweep_commands import plan, simulate, status, surfaces
from crackfront.sweep.parallel import stopping_as_ctrl_c


class _InputError(click.ClickException):
    """Input that cannot be used."""

    exit_code = 2


class Commands(click.Group):
    """Commands whose errors are sentences."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        # Results are renamed when they are whole; file systems may lack the locks that HDF5 sets.
        os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
        try:
            with output_that_may_close(), stopping_as_ctrl_c():
                return super().invoke(ctx)
        except KeyboardInterrupt as error:
            raise StoppedError(
                str(error)
                or "No file is incomplete; run the same command to continue from its last "
                "checkpoint, or from the beginning if it has none"
            ) from error
        except MemoryError as error:
            sentence = "the memory does not suffice; compute less, or use a machine with more"
            raise click.ClickException(sentence) from error
        except RuntimeError as error:
            from crackfront.core.outcome import DefectError

            if isinstance(error, DefectError):
                raise click.ClickException(str(error)) from error
            raise
        except (OSError, ValueError) as error:
            raise _InputError(_sentence(error)) from error


class _Sections(Commands):
    """The commands of the library, listed by what they are for."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands section by section."""
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                formatter.write_dl(
                    [(str(command.name), command.get_short_help_str(90)) for command in commands]
                )


def _sentence(error: OSError | ValueError) -> str:
    """What is wrong with an input, a file or a folder."""
    if isinstance(error, ValueError) or error.filename is None or error.strerror is None:
        return str(error)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return f"{error.filename} cannot be written: {error.strerror}; make room and repeat"
    return f"{error.filename} cannot be used: {error.strerror}; check the path and its permissions"


@click.command("compile", epilog=examples("crackfront compile"))
def compile_solvers() -> None:
    """Compile the solver, so that no run has to wait for it.

    Compiled code is kept for these sources and this kind of processor; what is kept already is
    only loaded. Spheres and straight fronts are compiled in a process each.
    """
    import multiprocessing

    from crackfront.simulate.line.line_loads import LineSchedule
    from crackfront.simulate.run_simulation import compile_solver
    from crackfront.simulate.sphere.full_cycle import FullCycle

    announce_compilation()
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        line = pool.apply_async(compile_solver, ("newton", LineSchedule))
        compile_solver("newton", FullCycle)
        line.get()


SECTIONS: dict[str, tuple[click.Command, ...]] = {
    "Predictions": (predict, samples, surface, law),
    "One contact": (cycle, loop),
    "Sweeps, in this order": (
        *(plan, simulate, status, aggregate, fit, archive),
        surfaces,
    ),
    "Stored results": (verify, checksums),
    "The machine": (compile_solvers,),
}
"""All commands, by what they are for."""

_EPILOG = """\b
Exit codes:
  0   done
  1   computed, but not as requested: too many simulations without a value, a cycle
      that ended early, ranks that failed, a disk or memory that was full, results
      that verify finds damaged or missing
  2   the input cannot be used; one sentence says why, and nothing was computed
  3   predict, samples with --strict: the theory applies with reservations, or it
      cannot be decided whether it applies
  4   predict, samples: the theory does not apply, or a sample cannot be used; the
      output says which modulus, radius, roughness or w_int would meet the condition
  75  interrupted (Ctrl-C, SIGTERM, a closed terminal); run the same command again

\b
Examples:
  crackfront cycle --field field.nc --max-penetration 1 --output cycle.nc --watch
  crackfront plan config/default.yaml
  mpiexec -n 5 crackfront simulate config/default.yaml   # one hands out, four simulate
  crackfront status results/default --json
"""


@click.group(
    cls=_Sections,
    epilog=_EPILOG,
    context_settings={"help_option_names": ["-h", "--help"], "show_default": True},
)
@click.version_option(package_name="crackfront")
def main() -> None:
    """Adhesion hysteresis of rough spheres by crack-front pinning."""


for section in SECTIONS.values():
    for command in section:
        main.add_command(command)
