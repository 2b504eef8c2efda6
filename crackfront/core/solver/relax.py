"""The quasi-static solver: the first metastable front in the direction of motion.

A front that advances (direction +1) stops at the smallest front that is nowhere behind its start
and that nowhere wants to advance. A receding front (direction -1) stops at the largest front that
is nowhere ahead of its start and that nowhere wants to recede.
Where the edge of a sphere would be in compression (a^2 < b) no front can rest, in either direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.field.fields import Field, first_place, last_place
from crackfront.core.field.samples import SampleMemory, evaluate, make_memory
from crackfront.core.geometry.base import lowest_place
from crackfront.core.outcome import DefectError, Direction, Relaxation, Status
from crackfront.core.solver import DEFAULT_MAX_SWEEPS, DEFAULT_TOLERANCE, forces
from crackfront.core.solver.codes import Code
from crackfront.core.solver.monotone import monotone_newton
from crackfront.core.solver.reference import rosso_krauth

_STATUSES = {
    Code.CONVERGED: Status.CONVERGED,
    Code.LEFT_FIELD_INWARD: Status.LEFT_FIELD_INWARD,
    Code.LEFT_FIELD_OUTWARD: Status.LEFT_FIELD_OUTWARD,
    Code.SWEEP_LIMIT: Status.STEP_LIMIT,
    Code.STANDS_STILL: Status.ROUND_OFF,
}


@dataclass(frozen=True, slots=True)
class Solver:
    """A way to the first metastable front.

    Parameters
    ----------
    tolerance : float
        Largest force along the motion that may be left, relative to w_int per front length.
    max_sweeps : int
        Limit on the sweeps of one relaxation, at least 1.
    """

    tolerance: float = DEFAULT_TOLERANCE
    max_sweeps: int = DEFAULT_MAX_SWEEPS

    name: ClassVar[str]
    kernel: ClassVar[Callable[..., Any]]
    """Moves the sites of an array; returns code, sweeps, updates of single sites, residual."""


class Newton(Solver):
    """The fast solver: safe Newton steps on windows and on the whole front."""

    __slots__ = ()
    name, kernel = "newton", staticmethod(monotone_newton)


class Reference(Solver):
    """The paper's algorithm (Rosso and Krauth), the reference for every other solver."""

    __slots__ = ()
    name, kernel = "reference", staticmethod(rosso_krauth)


SOLVERS: dict[str, type[Solver]] = {kind.name: kind for kind in (Reference, Newton)}
"""Solvers by name."""


def force_round_off(n_site: int) -> float:
    """Round-off of the forces on a front, relative to w_int per front length."""
    return float(np.finfo(float).eps) * n_site


def named_solver(name: str, tolerance: float, max_sweeps: int = DEFAULT_MAX_SWEEPS) -> Solver:
    """Solver of a name in :data:`SOLVERS`.

    Raises
    ------
    ValueError
        If no solver has this name.
    """
    if name not in SOLVERS:
        raise ValueError(f"solver is {name!r}; choose one of {', '.join(sorted(SOLVERS))}")
    return SOLVERS[name](tolerance, max_sweeps)


def relax(
    front: Array,
    load: float,
    direction: Direction,
    field: Field,
    solver: Solver | None = None,
    memory: SampleMemory | None = None,
) -> Relaxation:
    r"""First metastable front in the direction of motion at a fixed load.

    :func:`crackfront.core.cycle.follow.follow` checks the arguments and calls it for every load.

    On a sphere, at the penetration b, equilibrium is, per angle,

    .. math:: a w_{loc}(a, \theta) = a G_{JKR}(b, a) + w_{int} (-\Delta_\theta)^{1/2} a .

    Parameters
    ----------
    front : (n_site,) array
        Front to start from, inside the field; forces against the motion are left as they are.
        (Units: reduced lateral length)
    load : float
        Penetration of a sphere, or place of the springs of a straight front.
        (Units: reduced vertical length, or reduced lateral length)
    direction : {1, -1}
        +1 lets the contact grow, -1 lets it shrink.
    field : Field
        Work of adhesion along the rays.
    solver : Solver, optional
        :class:`Newton` by default; all find the same fronts.
    memory : SampleMemory, optional
        Samples remembered from earlier relaxations on the same field (see
        :func:`crackfront.core.field.samples.make_memory`); changed in place, without effect on the
        result.

    Returns
    -------
    Relaxation
        The front, and how it was reached. Losing contact is an outcome, not an error.

    Raises
    ------
    DefectError
        If the fast solver finds that it has passed an equilibrium, which is a defect.

    References
    ----------
    .. [1] Rosso, Krauth, Phys. Rev. E 65, 025101 (2002).
    .. [2] Sanner et al., Sci. Adv. (2024), supplement, Sec. II.
    """
    solver = solver or Newton()
    moved = np.array(front, dtype=float)
    if direction > 0:
        np.maximum(moved, lowest_place(field.geometry, load), out=moved)
    if direction > 0 and np.max(moved) >= last_place(field):
        return Relaxation(moved, Status.LEFT_FIELD_OUTWARD, 0, 0, np.inf)
    if memory is None:
        memory = make_memory(field)
    task = forces.make_task(
        moved, float(load), int(direction), field, memory, float(solver.tolerance)
    )
    code, sweeps, updates, residual = solver.kernel(moved, task, int(solver.max_sweeps))
    if code == Code.PASSED_EQUILIBRIUM:
        noun = field.geometry.state_type.load_noun
        raise DefectError(
            f"the {solver.name} solver moved a site past its equilibrium at {noun} {load}; "
            "this is a defect, please report it and use the solver 'reference' meanwhile"
        )
    status = _STATUSES[code]
    if status is Status.LEFT_FIELD_INWARD and not _can_rest_inside(field, load):
        status = Status.LOST_CONTACT
    return Relaxation(moved, status, int(sweeps), int(updates), float(residual))


def front_force(front: Array, load: float, field: Field) -> Array:
    """Force that drives each site outward; on a sphere a w_loc - a G - w_int (-Delta)^(1/2) a.

    Parameters
    ----------
    front : (n_site,) array
        Front. (Units: reduced lateral length)
    load : float
        Penetration of a sphere, or place of the springs of a straight front.
        (Units: reduced vertical length, or reduced lateral length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    (n_site,) array
        Force per angle; zero in equilibrium. (Units: reduced energy / length)
    """
    return np.asarray(forces.front_force(front, float(load), field))


def _can_rest_inside(field: Field, load: float) -> bool:
    """Whether a front may have an equilibrium within the innermost samples."""
    products = [evaluate(field, ray, 0)[0] for ray in range(field.geometry.n_site)]
    return bool(field.geometry.can_rest_inside(first_place(field), float(np.mean(products)), load))
