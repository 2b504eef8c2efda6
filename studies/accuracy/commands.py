"""Commands that measure errors: of the numerics scene by scene, of predictions, of steady runs."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import click

from crackfront.cli.answers import announce_compilation, announce_cost
from crackfront.cli.option_types import FILE, examples, whole
from crackfront.cli.output_files import check_writable
from crackfront.core.arguments import nearest_name
from crackfront.core.bounds import Range
from crackfront.measured.scan.reading import read_measurements
from crackfront.plots.style import save_figure
from crackfront.simulate.checksums import forget_sums
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.storage import read_attributes, write_dataset, write_text
from crackfront.sweep.integrity import write_sums
from crackfront.sweep.watching import with_progress
from studies.accuracy import energies as synthetic
from studies.accuracy import energy_balance as balance
from studies.accuracy import individual_pinning as pinning
from studies.accuracy import measured_loops as rigs
from studies.accuracy import movement as settled
from studies.accuracy import predictions as films
from studies.accuracy import scans as instrument
from studies.accuracy.drawing import figures
from studies.accuracy.files import STUDIES
from studies.accuracy.fitting import fit_laws, laws_text
from studies.accuracy.report import DETAILED_SCENES, compared_numbers, error_tables, measured
from studies.accuracy.scenes import SCENES
from studies.numbers import store
from studies.pages import keep_option, output_option, tell

commands = click.Group()

_output = output_option(default=Path("results/accuracy"), help="Folder of the results.")


@commands.command(
    epilog=examples(
        "python -m studies accuracy scene flat-0.04",
        "python -m studies accuracy scene flat-0.04 --study requested --realisations 4",
    )
)
@click.argument("scene")
@_output
@click.option(
    "--study",
    type=click.Choice(list(STUDIES)),
    default="settings",
    show_default=True,
    help="Errors of single settings; of numerics that the laws choose; of these on surfaces that "
    "have no part in the laws, and again where rare avalanches are counted; of schedules and "
    "tiles; true and stated errors.",
)
@click.option(
    "--realisations", type=whole(Range(2, 1e6)), default=8, show_default=True, help="Surfaces."
)
def scene(scene: str, output: Path, study: str, realisations: int) -> None:
    """Measure the errors of one scene."""
    if scene not in SCENES:
        raise click.BadParameter(f"{scene!r} is not a scene; {nearest_name(scene, SCENES)}")
    check_writable(output)
    announce_cost(f"{study} of {scene}", realisations * STUDIES[study].seconds(SCENES[scene]))
    announce_compilation()
    compile_solver("newton", FullCycle)
    errors = STUDIES[study].measured(SCENES[scene], realisations, click.echo)
    path = output / f"{study}-{scene}.nc"
    forget_sums(output)
    write_dataset(path, errors, provenance())
    click.echo(f"errors: {path}")


@commands.command(epilog=examples("python -m studies accuracy report"))
@_output
@keep_option
def report(output: Path, keep: bool) -> None:
    """Fit the laws, write the tables, and draw the figures of what was measured."""
    forget_sums(output)
    study_errors = measured(output)
    tables = error_tables(study_errors)
    parts = [f"## {name}\n\n{table.text()}\n" for name, table in tables.items()]
    write_text(output / "accuracy.md", "\n".join(["# Measured errors\n", *parts]))
    click.echo(f"tables: {output / 'accuracy.md'}")
    if laws := list(fit_laws(study_errors.fitted)):
        write_text(output / "laws.csv", laws_text(laws))
        click.echo(f"laws: {output / 'laws.csv'}")
    for name, figure in figures(study_errors, laws).items():
        for path in save_figure(figure, output / name):
            click.echo(f"figure: {path}")
    write_sums(output)
    if keep:
        hidden = {f"Settings, {name}" for name in SCENES if name not in DETAILED_SCENES}
        shown = {name: table for name, table in tables.items() if name not in hidden}
        data = read_attributes(min(output.glob("*.nc"))) | {"command": "make accuracy"}
        store("accuracy", tables=shown, numbers=compared_numbers(study_errors), data=data)


@commands.command(epilog=examples("python -m studies accuracy predictions"))
@keep_option
def predictions(keep: bool) -> None:
    """Compare predictions from scans with simulations of the surfaces; print a table."""
    shown = with_progress(films.comparisons(), len(films.FILMS), "films")
    parts = {"Predictions": films.comparison_table(shown)}
    tell("accuracy", parts, keep=keep)


@commands.command(epilog=examples("python -m studies accuracy energies --scans 12"))
@click.option(
    "--scans", type=whole(Range(1, 1e6)), default=14, show_default=True, help="Scans of each kind."
)
@keep_option
def energies(scans: int, keep: bool) -> None:
    """Compare e_el of synthetic scans with their spectra; print a table."""
    tables = {
        "Scans": synthetic.KINDS,
        "Roll-offs": synthetic.ROLL_OFFS,
        "Held-out scans": synthetic.HELD_OUT,
    }
    all_scans = [
        (kind, number) for kinds in tables.values() for kind in kinds for number in range(scans)
    ]
    scans_by_kind = defaultdict(list)
    for kind, number in with_progress(all_scans, len(all_scans), "scans"):
        scans_by_kind[kind].append(synthetic.scan_energy(synthetic.synthetic_surface(kind, number)))
    parts = {
        name: synthetic.energy_table({kind: scans_by_kind[kind] for kind in kinds})
        for name, kinds in tables.items()
    }
    numbers = {"coverage of the hardest scans": synthetic.hardest_coverage(scans_by_kind)}
    tell("accuracy", parts, numbers=numbers, keep=keep)


@commands.command(epilog=examples("python -m studies accuracy movement examples/scans/*.al3d"))
@click.argument("scans", type=FILE, nargs=-1)
@keep_option
def movement(scans: tuple[Path, ...], keep: bool) -> None:
    """Measure how far intervals of e_el move with seeds, digits of heights and more draws.

    SCANS are read one by one; without any, one synthetic scan of each kind is taken.
    """
    surfaces = {str(scan): list(read_measurements([scan])) for scan in scans} or {
        kind.name: [scan.measurement for scan in synthetic.synthetic_surface(kind, 0).scans]
        for kind in synthetic.KINDS
    }
    shown = with_progress(surfaces.items(), len(surfaces), "scans")
    movements = [(name, settled.movement(measurements)) for name, measurements in shown]
    parts = {"Movement": settled.movement_table(movements)}
    tell("accuracy", parts, keep=keep)


@commands.command(epilog=examples("python -m studies accuracy scans"))
@output_option(default=Path("examples/scans"))
def scans(output: Path) -> None:
    """Write the synthetic scans of nanodiamond that the examples read."""
    check_writable(output)
    instrument.write_scans(output)
    click.echo(f"scans: {output}")


@commands.command("energy-balance", epilog=examples("python -m studies accuracy energy-balance"))
@keep_option
def energy_balance(keep: bool) -> None:
    """Compare the dissipated energy of cycles with the work of their steps; print a table."""
    announce_compilation()
    parts = {"Energy balance": balance.energy_table()}
    tell("accuracy", parts, keep=keep)


@commands.command(
    "individual-pinning", epilog=examples("python -m studies accuracy individual-pinning")
)
@keep_option
def individual_pinning(keep: bool) -> None:
    """Measure the hysteresis of straight fronts far beyond w_rms = w_int; print a table."""
    announce_compilation()
    table, numbers = pinning.measured_pinning()
    tell("accuracy", {"Individual pinning": table}, numbers=numbers, keep=keep)


@commands.command(epilog=examples("python -m studies accuracy loops --loops 40"))
@click.option(
    "--loops", type=whole(Range(1, 1e6)), default=20, show_default=True, help="Simulated spheres."
)
@keep_option
def loops(loops: int, keep: bool) -> None:
    """Record simulated cycles as rigs would, and count truths within intervals; print a table."""
    announce_compilation()
    coverages: dict[str, rigs.Coverage] = {}
    for press, instruments in rigs.RECORDED:
        shown = with_progress(rigs.cycles(loops, press), loops, "loops")
        coverages |= rigs.coverage(shown, instruments)
    parts = {"Measured loops": rigs.coverage_table(coverages)}
    tell("accuracy", parts, keep=keep)
