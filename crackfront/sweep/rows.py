"""The row of one simulation in the file of a sweep, and rows as columns of a file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.jump_measures import JumpMeasures, jump_measures
from crackfront.analysis.steady_adhesion import SteadyAdhesion, SteadyMeasures
from crackfront.analysis.table import PLACE, JumpRow, SweepRow, row_type
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.outcome import Status
from crackfront.core.variables import ADHESION, variables
from crackfront.simulate.contact import Pressed
from crackfront.simulate.labels import label
from crackfront.simulate.numerical_errors import stated_error
from crackfront.simulate.run_simulation import SimulationResult
from crackfront.simulate.simulation import Simulation


def _status_word(status: Status) -> str:
    """Word of a file for how a cycle ended."""
    return status.name.lower()


_FULL_CYCLE = _status_word(Status.LOST_CONTACT)

COMPLETE = _FULL_CYCLE, _status_word(Status.STEADY)
"""Statuses of a simulation that has values: a full cycle, or the steady parts of both branches."""

AT_LIMIT = _status_word(Status.STEP_LIMIT)
"""Status of a simulation that reached its limit of sweeps, and may go on with a higher one."""

NO_STEADY_PART = "no_steady_part"
"""Status of a complete cycle without enough steady states."""

INVALID, DEFECT = "invalid", "defect"
"""Statuses of a simulation whose surface or load cannot be simulated, and of one whose result the
solver found to be wrong."""

CYCLE_STATUSES = tuple(map(_status_word, Status))
"""How a cycle may end; files of curves have their places."""

STATUSES = (*CYCLE_STATUSES, NO_STEADY_PART, INVALID, DEFECT)
"""What `status` may be; the file of a sweep has their places."""


def sweep_row(result: SimulationResult) -> SweepRow:
    """What the file of a sweep says about one simulation."""
    record, simulation = result.record, result.simulation
    length = simulation.correlation_length
    steady = result.steady_adhesion
    status, sentence = _status(record, steady)
    complete = status in COMPLETE
    is_cycle = status == _FULL_CYCLE
    numerical = stated_error(simulation, steady, length) if complete else (np.nan, np.nan)
    measures: dict[str, Any] = {
        item.name: getattr(steady, item.name) if complete or item.units != ADHESION else np.nan
        for item in variables(SteadyMeasures)
    }
    if record.jumps is not None:
        measures |= _without_jumps()
        if complete and steady.averaged is not None:
            measures |= asdict(jump_measures(record.jumps, steady.averaged))
    return row_type(record.jumps is not None)(
        **measures | asdict(result.measures),
        w_appr_numerical_error=numerical[0],
        w_retr_numerical_error=numerical[1],
        iterations=int(np.sum(record.states.iterations)),
        n_step=record.states.direction.size,
        pull_off_force=float(np.min(record.states.force, initial=np.inf)) if is_cycle else np.nan,
        end_penetration=record.end_load if isinstance(simulation.schedule, Pressed) else math.nan,
        status=status,
        status_sentence=sentence,
        seed=simulation.seed,
        max_sweeps=simulation.solver.max_sweeps,
    )


def failed_row(simulation: Simulation, status: str, sentence: str) -> SweepRow:
    """Row of a simulation that failed, with its status and the reason as a sentence."""
    kind = row_type(simulation.record_jumps)
    values: dict[str, Any] = {item.name: math.nan for item in fields(kind)}
    if simulation.record_jumps:
        values |= _without_jumps()
    values |= dict.fromkeys(("iterations", "n_step", "n_approach", "n_retraction"), 0)
    values |= {"status": status, "status_sentence": sentence}
    values |= {"seed": simulation.seed, "max_sweeps": simulation.solver.max_sweeps}
    return kind(**values)


def _without_jumps() -> dict[str, float]:
    """Measures of the jumps of a simulation without a value."""
    values = {item.name: math.nan for item in fields(JumpMeasures)}
    return values | {"n_jump_appr": 0, "n_jump_retr": 0}


def _status(record: CycleRecord, steady: SteadyAdhesion) -> tuple[str, str]:
    """How a simulation ended, in a word and in a sentence."""
    status = _status_word(record.status)
    if status in COMPLETE and steady.sentence:
        return NO_STEADY_PART, steady.sentence
    return status, record.status.value


def row_columns(rows: Sequence[SweepRow], shape: tuple[int, ...]) -> dict[str, NDArray[np.generic]]:
    """Values of rows of one type, as a file has them: over spectra, amplitudes and realisations."""
    columns = {
        item.name: np.array([getattr(row, item.name) for row in rows]).reshape(shape)
        for item in variables(type(rows[0]))
    }
    places = [STATUSES.index(row.status) for row in rows]
    return columns | {"status": np.array(places, np.int8).reshape(shape)}


def labelled_columns(columns: Mapping[str, NDArray[np.generic]]) -> dict[str, xr.Variable]:
    """Variables of a file for columns as of :func:`row_columns`."""
    labelled = {}
    for item in variables(JumpRow, *PLACE):
        if item.name not in columns:
            continue
        values = columns[item.name]
        about = label(item, STATUSES if item.name == "status" else ())
        labelled[item.name] = xr.Variable(item.dims, values, about)
    return labelled
