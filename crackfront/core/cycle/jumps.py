"""Jumps in the steady part of a cycle, recorded while it runs.

A load step merges many jumps. Each steady one is therefore taken once more, by
:func:`crackfront.core.cycle.instabilities.resolved_motion`, on a front of its own: it is nearer to
equilibrium than the recorded states, which stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load, Step, front_at
from crackfront.core.cycle.instabilities import Motion, jump_size, resolved_motion, swept_areas
from crackfront.core.field.fields import Field
from crackfront.core.geometry.base import State, restoring_force, weight
from crackfront.core.solver.relax import Solver, force_round_off
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import (
    AREA,
    ENERGY,
    LATERAL,
    STEP,
    VERTICAL,
    Variable,
    variable,
    variables,
)

JUMP = "jump"
"""Dimension of the jumps of a cycle."""

SMOOTH_TRAVEL = 0.05
"""Largest motion of a site in a smooth step. (Units: correlation lengths of w_loc)

The smallest jumps that are recorded move a site by more. Smaller ones dissipate about 1%.
"""

_PRECISION = 0.02
"""Load within which jumps count as one, relative to the load that lets the front sweep the square
of a correlation length.

Up to about one jump starts in that load, so that 1% of the jumps coincide with another.
"""

_TOLERANCE = 0.1
"""Tolerance of the solver, relative to the force that the precision of the load changes."""

_ROUND_OFF = 10.0
"""Least tolerance, relative to the round-off of the forces."""


@dataclass(frozen=True, slots=True)
class Jumps:
    """Jumps of the steady load steps, one entry each, in their order.

    A load step is steady if every site had travelled a correlation length of w_loc before it.
    """

    jump_state: Array = variable("number of the state that ends its load step", "1", JUMP)
    jump_load: Array = variable("load of the jump", VERTICAL, JUMP)
    jump_area: Array = variable("area that the jump sweeps", AREA, JUMP)
    jump_extent: Array = variable("width of its largest patch along the front", LATERAL, JUMP)
    jump_energy: Array = variable("energy that the jump dissipates", ENERGY, JUMP)
    swept_area: Array = variable("area that a steady load step sweeps; else NaN", AREA, STEP)


def jump_variables(states: type[State]) -> tuple[Variable, ...]:
    """Variables of the jumps between states of a type; their loads have the unit of its loads."""
    load = variables(states)[0]
    return tuple(
        replace(item, units=load.units) if item.name == "jump_load" else item
        for item in variables(Jumps)
    )


class JumpRecorder:
    """Recorder of the jumps of one cycle.

    Parameters
    ----------
    correlation_length : float
        Correlation length of w_loc. (Units: reduced lateral length)
    jumps : Jumps, optional
        Jumps of an earlier run of the same cycle.
    front : (n_site,) array, optional
        Its last front. (Units: reduced lateral length)
    """

    correlation_length: float
    """Travel of every site after which load steps are steady. (Units: reduced lateral length)"""
    front: Array | None
    """Last front; None before the first steady load step of a branch."""

    def __init__(
        self, correlation_length: float, jumps: Jumps | None = None, front: Array | None = None
    ) -> None:
        self.correlation_length, self.front = correlation_length, front
        self._columns: dict[str, list[float]] = {item.name: [] for item in fields(Jumps)}
        if jumps is not None:
            self._columns = {name: getattr(jumps, name).tolist() for name in self._columns}

    def add(self, field: Field, step: Step, before: Load | None, solver: Solver) -> None:
        """Record the jumps of a load step from a steady state at the load `before`, if it is one.

        The solver has found the states of the cycle.
        """
        number, area = len(self._columns["swept_area"]), np.nan
        if before is None:
            self.front = None
        else:
            area = 0.0
            for motion in self._motions(field, step, before, solver):
                area += float(np.sum(swept_areas(motion.before, motion.after, field.geometry)))
                self.front = motion.after
                if motion.unstable:
                    self._add_jump(motion, field, number)
        self._columns["swept_area"].append(area)

    def _add_jump(self, jump: Motion, field: Field, number: int) -> None:
        """Record a jump of the load step that ends with the state of a number."""
        size = jump_size(jump, field, SMOOTH_TRAVEL * self.correlation_length)
        self._columns["jump_state"].append(number)
        self._columns["jump_load"].append(jump.end)
        self._columns["jump_area"].append(size.area)
        self._columns["jump_extent"].append(size.extent)
        self._columns["jump_energy"].append(size.dissipated_energy)

    def _motions(self, field: Field, step: Step, before: Load, solver: Solver) -> Iterator[Motion]:
        """Motions of the front in a load step, each smooth or a single jump."""
        load, length = step.load, self.correlation_length
        swept = float(np.sum(swept_areas(step.before, step.front, field.geometry)))
        share = _PRECISION / max(1.0, swept / length**2)
        force = share * _force_change(field, step, before)
        least = _ROUND_OFF * force_round_off(field.geometry.n_site)
        finer = replace(solver, tolerance=min(solver.tolerance, max(_TOLERANCE * force, least)))
        if self.front is None:
            self.front = front_at(field, step.before, before, finer)
        return resolved_motion(
            field,
            self.front,
            before.value,
            [load.value],
            load.direction,
            travel=SMOOTH_TRAVEL * length,
            precision=share * abs(load.value - before.value),
            solver=finer,
        )

    def jumps(self) -> Jumps:
        """All jumps so far."""
        columns = {name: np.array(values, float) for name, values in self._columns.items()}
        return Jumps(**columns | {"jump_state": columns["jump_state"].astype(np.int64)})


def _force_change(field: Field, step: Step, before: Load) -> float:
    """Change of the force on a front by a load step, relative to w_int per front length."""
    place = float(np.mean(step.before))
    forces = [restoring_force(field.geometry, place, load.value) for load in (before, step.load)]
    return abs(forces[1] - forces[0]) / (weight(field.geometry, place) * WORK_OF_ADHESION)
