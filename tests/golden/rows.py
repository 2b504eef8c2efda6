"""Rows of stored states, and fits of their tables: what `ROWS_VERSION` stands for.

The states are data of the file: they were simulated once, at the default tolerance, and rounded to
seven digits. They never change, so that a change of the physics does not move the rows.
"""

from dataclasses import asdict, fields, replace

import numpy as np

from crackfront.analysis.result import fit_columns
from crackfront.analysis.run_measures import RunMeasures
from crackfront.analysis.steady_adhesion import SteadyMeasures, passing_adhesion
from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.table import SweepRow, SweepTable
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.line import LineState
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.run_simulation import SimulationResult, run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.tiles import Resolution
from crackfront.sweep.rows import sweep_row
from tests.golden.golden import Scenes, Values

ENERGIES = (0.06, 0.25)
"""Amplitudes of the tables, e_el / w_int."""

FINE, COARSE = (SelfAffineSpectrum(size, 2 * size, 0.8) for size in (0.1, 0.2))

_SPHERE = Simulation(
    spectrum_name="golden",
    kind="roughness",
    spectrum=FINE,
    elastic_energy=0.05,
    realisation=0,
    sweep_seed=71,
    resolution=Resolution(
        n_angle=160, spacing=0.025, interpolation="cubic", tile_side=4.0, n_point=100
    ),
    schedule=SteadySchedule(start=0.3, max_penetration=3.0, travel=0.6, standard_error=0.2),
    solver=Newton(),
)

_LINE = replace(
    _SPHERE,
    resolution=Resolution(
        n_angle=80, spacing=0.025, interpolation="cubic", tile_side=4.0, n_point=100
    ),
    schedule=LineSchedule(spring=1.5, length=4.0, period=3.0, lead_in=1.5, step=0.3),
)

_RUN_DEPENDENT = ("seconds", "cpu_seconds", "peak_memory", "max_sweeps")
"""Entries of a row that say what the simulation cost, and what it was allowed."""


def _sweep(
    base: Simulation, spectra: tuple[SelfAffineSpectrum, ...], count: int
) -> list[Simulation]:
    """Simulations of a sweep in the order of its table."""
    return [
        replace(base, spectrum=spectrum, elastic_energy=energy, realisation=realisation)
        for spectrum in spectra
        for energy in ENERGIES
        for realisation in range(count)
    ]


SPHERES = _sweep(_SPHERE, (FINE, COARSE), 3)
LINES = _sweep(_LINE, (FINE,), 2)
CYCLE = replace(_SPHERE, schedule=FullCycle(1.2, 0.06))

SIMULATIONS = {
    "cycle": CYCLE,
    "chemical line": replace(LINES[-1], kind="chemical"),
    **{f"sphere {number}": simulation for number, simulation in enumerate(SPHERES)},
    **{f"line {number}": simulation for number, simulation in enumerate(LINES)},
}
"""Simulations whose states are stored, by their names in the file."""


def completed(inputs: Scenes) -> Scenes:
    """Stored states, and those of simulations that have none yet, as the file is to have them."""
    return {
        name: inputs.get(name) or states_to_store(run_simulation(simulation))
        for name, simulation in SIMULATIONS.items()
    }


def states_to_store(result: SimulationResult, digits: int = 7) -> Values:
    """States of a simulation, rounded."""
    record, measures = result.record, result.measures
    values = {
        item.name: np.asarray(getattr(record.states, item.name), float)
        for item in fields(record.states)
    } | {
        "status": np.array(float([*Status].index(record.status))),
        "end load": np.array(record.end_load),
        "measures": np.array([measures.e_el, measures.w_rms, measures.negative_share]),
    }
    round_entries = np.vectorize(lambda entry: float(f"{entry:.{digits}g}"))
    return {name: round_entries(entries) for name, entries in values.items()}


def _result(simulation: Simulation, stored: Values) -> SimulationResult:
    """The result whose states are stored."""
    kind = LineState if isinstance(simulation.schedule, LineSchedule) else ContactState
    states = kind(**{item.name: stored[item.name] for item in fields(kind)})
    record = CycleRecord([*Status][int(stored["status"])], float(stored["end load"]), states)
    e_el, w_rms, negative_share = (float(value) for value in stored["measures"])
    measures = RunMeasures(e_el, w_rms, negative_share, 1.0, 1.0, 1.0)
    return SimulationResult(simulation, record, measures)


def _columns(rows: dict[str, SweepRow]) -> Values:
    """Columns of numbers that the states of rows decide."""
    entries = [asdict(row) for row in rows.values()]
    left_out = (*_RUN_DEPENDENT, "seed", "status", "status_sentence", "curve")
    return {
        name: np.array([entry[name] for entry in entries], float)
        for name in entries[0]
        if name not in left_out
    }


def _fit(
    rows: list[SweepRow], first: Simulation, spectra: tuple[SelfAffineSpectrum, ...]
) -> Values:
    """Every number of the fit of a table whose simulations have the kind and springs of one."""
    shape = len(spectra), len(ENERGIES), -1

    def column(name: str) -> Array:
        return np.array([getattr(row, name) for row in rows], float).reshape(shape)

    table = SweepTable(
        spectrum=np.array([f"spectrum {number}" for number in range(len(spectra))]),
        short_cutoff=np.array([spectrum.short_cutoff for spectrum in spectra]),
        roll_off=np.array([spectrum.roll_off for spectrum in spectra]),
        hurst=np.array([spectrum.hurst for spectrum in spectra]),
        correlation_length=np.array([spectrum.correlation_length for spectrum in spectra]),
        amplitude=np.array(ENERGIES),
        contact_radius=(column("lowest_radius") + column("highest_radius")) / 2,
        spring=np.full(shape[:2], getattr(first.schedule, "spring", np.nan)),
        **{
            name: column(name)
            for name in (
                "e_el",
                "w_rms",
                "w_appr",
                "w_retr",
                "w_appr_from_force",
                "w_retr_from_force",
                "w_appr_numerical_error",
                "w_retr_numerical_error",
            )
        },
    )
    fit = fit_sweep(
        table,
        lowest_elastic_energy=ENERGIES[0],
        highest_elastic_energy=ENERGIES[-1],
        n_bootstrap=200,
        kind=first.kind,
    )
    return {
        variable.name: np.asarray(entries, float)
        for variable, entries in fit_columns(fit)
        if np.asarray(entries).dtype.kind in "bif"
    }


def rows_and_fits(inputs: Scenes) -> Scenes:
    """Rows of all stored states and the fits of their two tables."""
    results = {name: _result(SIMULATIONS[name], stored) for name, stored in inputs.items()}
    rows = {name: sweep_row(result) for name, result in results.items()}
    line = results["line 0"]
    passing = passing_adhesion(line.record, line.simulation.correlation_length, 1.0, 2.0)
    loop = [getattr(passing, item.name) for item in fields(SteadyMeasures)]
    return {
        "rows": _columns(rows),
        "straight front under any loads": {"line 0": np.array(loop, float)},
        "fit of spheres": _fit(
            [rows[f"sphere {n}"] for n in range(len(SPHERES))], _SPHERE, (FINE, COARSE)
        ),
        "fit of straight fronts": _fit(
            [rows[f"line {n}"] for n in range(len(LINES))], _LINE, (FINE,)
        ),
    }
