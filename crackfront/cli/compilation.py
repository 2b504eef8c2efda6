"""Compilation of the solvers ahead of the first run."""

from __future__ import annotations

import click

from crackfront.cli.report import announce_compilation, examples


@click.command("compile", epilog=examples("crackfront compile"))
def compile_solvers() -> None:
    """Compile the solver of sweeps, so that no run waits for it.

    What runs call is compiled once for these sources and this kind of processor, for spheres and
    for straight fronts in a process each; what the cache holds already is only loaded.
    """
    import multiprocessing

    from crackfront.simulate.run import compile_solver

    announce_compilation()
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        line = pool.apply_async(compile_solver, ("newton", True))
        compile_solver("newton")
        line.get()
