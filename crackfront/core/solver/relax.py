"""The quasi-static solver: the first metastable front in the direction of motion.

A front that advances (direction +1) stops at the smallest front that is nowhere behind its start
and that nowhere wants to advance; a receding one (direction -1) at the mirror image of that.
Where the edge would be in compression (a^2 < b) no front can rest, in either direction.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from crackfront.core.field.kinds import Field, first_radius, last_radius, n_angle
from crackfront.core.field.samples import SampleMemory, make_memory, sample_product, sample_radius
from crackfront.core.solver import forces
from crackfront.core.solver.monotone import monotone_newton
from crackfront.core.solver.reference import rosso_krauth

Array = NDArray[np.float64]
Direction = Literal[1, -1]


class Status(enum.Enum):
    """How a relaxation or a cycle ended; the value is the sentence that says it."""

    CONVERGED = "the front is in equilibrium to the tolerance"
    LOST_CONTACT = "contact was lost: no equilibrium is left at this penetration"
    STEADY = "the steady parts of both branches have been measured"
    LEFT_FIELD_OUTWARD = (
        "the front left the sampled field outward; enlarge the field or lower the penetration"
    )
    LEFT_FIELD_INWARD = (
        "the front left the sampled field inward; add samples at smaller radii to the field"
    )
    STEP_LIMIT = (
        "the solver reached its limit of sweeps before the tolerance; raise max_sweeps or the "
        "tolerance"
    )
    ROUND_OFF = (
        "the front stands still above the tolerance, because the field rises too steeply for the "
        "digits of a radius; raise the tolerance"
    )


_CODES = {
    forces.CONVERGED: Status.CONVERGED,
    forces.INWARD: Status.LEFT_FIELD_INWARD,
    forces.OUTWARD: Status.LEFT_FIELD_OUTWARD,
    forces.LIMIT: Status.STEP_LIMIT,
    forces.STILL: Status.ROUND_OFF,
}

SOLVERS = {"reference": rosso_krauth, "newton": monotone_newton}
"""Solvers by name; each changes a front in place.

They return a code, the sweeps, the updates of single sites and the residual.
"""


@dataclass(frozen=True, slots=True)
class Relaxation:
    """Outcome of one relaxation.

    Attributes
    ----------
    radius : (n_angle,) array
        Front at the end. (Units: reduced lateral length)
    status : Status
        What ended it.
    sweeps : int
        Sweeps over the front, counted in pairs of FFTs.
    updates : int
        Updates of single sites.
    residual : float
        Largest force along the motion that is left, relative to w_int per front length.
    """

    radius: Array
    status: Status
    sweeps: int
    updates: int
    residual: float


def relax(
    radius: Array,
    penetration: float,
    direction: Direction,
    field: Field,
    *,
    tolerance: float = 1e-8,
    max_sweeps: int = 10_000_000,
    solver: str = "newton",
    memory: SampleMemory | None = None,
) -> Relaxation:
    r"""First metastable front in the direction of motion at fixed penetration.

    Equilibrium is, per angle,

    .. math:: a w_{loc}(a, \theta) = a G_{JKR}(b, a) + w_{int} (-\Delta_\theta)^{1/2} a .

    Parameters
    ----------
    radius : (n_angle,) array
        Front to start from; forces against the motion are left as they are.
        (Units: reduced lateral length)
    penetration : float
        Rigid body penetration b. (Units: reduced vertical length)
    direction : {1, -1}
        +1 lets the contact grow, -1 lets it shrink.
    field : Field
        Work of adhesion along the rays.
    tolerance : float, optional
        Largest force along the motion that may be left, relative to w_int per front length.
    max_sweeps : int, optional
        Limit on the sweeps.
    solver : str, optional
        A name in :data:`SOLVERS`; ``"reference"`` is the paper's algorithm, ``"newton"`` the fast
        one that finds the same states.
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
    ValueError
        If the front does not fit the field or is not finite, the solver or the direction is
        unknown, the tolerance is below round-off, or the limit on the sweeps is not positive.
    RuntimeError
        If the fast solver finds that it has passed an equilibrium, which is a defect.

    References
    ----------
    .. [1] Rosso, Krauth, Phys. Rev. E 65, 025101 (2002).
    .. [2] Sanner et al., Sci. Adv. (2024), supplement, Sec. II.
    """
    _refuse_unusable(radius, penetration, direction, field, tolerance, max_sweeps, solver)
    front = np.array(radius, dtype=float)
    lowest = np.sqrt(max(penetration, 0.0))
    if direction > 0:
        np.maximum(front, lowest, out=front)
    if direction > 0 and np.max(front) >= last_radius(field):
        return Relaxation(front, Status.LEFT_FIELD_OUTWARD, 0, 0, np.inf)
    if memory is None:
        memory = make_memory(field)
    code, sweeps, updates, residual = SOLVERS[solver](
        front, float(penetration), int(direction), field, memory, float(tolerance), int(max_sweeps)
    )
    if code == forces.TURNED:
        raise RuntimeError(
            f"the {solver} solver moved a site past its equilibrium at penetration {penetration}; "
            "this is a defect, please report it and use the solver 'reference' meanwhile"
        )
    status = _CODES[code]
    if status is Status.LEFT_FIELD_INWARD and not _can_rest_inside(field, penetration):
        status = Status.LOST_CONTACT
    return Relaxation(front, status, int(sweeps), int(updates), float(residual))


def front_force(radius: Array, penetration: float, field: Field) -> Array:
    """Force that drives each site outward, a w_loc - a G - w_int (-Delta)^(1/2) a.

    Parameters
    ----------
    radius : (n_angle,) array
        Front. (Units: reduced lateral length)
    penetration : float
        Rigid body penetration b. (Units: reduced vertical length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    (n_angle,) array
        Force per angle; zero in equilibrium. (Units: reduced energy / length)
    """
    return np.asarray(forces.front_force(radius, float(penetration), field))


def _refuse_unusable(
    radius: Array,
    penetration: float,
    direction: int,
    field: Field,
    tolerance: float,
    max_sweeps: int,
    solver: str,
) -> None:
    """Raise if a relaxation cannot start."""
    if solver not in SOLVERS:
        raise ValueError(f"solver is {solver!r}; choose one of {', '.join(sorted(SOLVERS))}")
    if direction not in (1, -1):
        raise ValueError(f"direction is {direction}; it must be 1 (approach) or -1 (retraction)")
    if radius.shape != (n_angle(field),):
        raise ValueError(f"front has shape {radius.shape}; the field has {n_angle(field)} rays")
    if not (np.all(np.isfinite(radius)) and math.isfinite(penetration)):
        raise ValueError(f"front or penetration ({penetration}) is not finite; check both")
    inner, outer = first_radius(field), last_radius(field)
    if np.min(radius) < inner or np.max(radius) > outer:
        raise ValueError(
            f"front spans radii {np.min(radius):.6g} to {np.max(radius):.6g}; the field is sampled "
            f"from {inner:.6g} to {outer:.6g}, so start inside it"
        )
    round_off = float(np.finfo(float).eps) * radius.size
    if not tolerance >= round_off:
        raise ValueError(
            f"tolerance {tolerance} is below the round-off of a front of {radius.size} sites "
            f"({round_off:.1e}); raise it"
        )
    if max_sweeps < 1:
        raise ValueError(f"max_sweeps is {max_sweeps}; it must be at least 1")


def _can_rest_inside(field: Field, penetration: float) -> bool:
    """Whether a smooth contact within the innermost samples has an equilibrium."""
    inner = float(sample_radius(field, 0))
    adhesion = np.mean([sample_product(field, ray, 0) for ray in range(n_angle(field))]) / inner
    radius = np.linspace(0, inner, 201)[1:]
    ring = forces.RING * np.maximum(radius**2 - penetration, 0.0) ** 2
    return bool(np.any(radius * adhesion >= ring))
