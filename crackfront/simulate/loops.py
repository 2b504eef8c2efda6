"""One approach and retraction on a surface, and the single instabilities of a branch."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import get_args

import numpy as np
from xarray import DataArray, Dataset

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import resolved_motion
from crackfront.core.cycle.record import CycleState
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.kinds import first_radius, n_angle
from crackfront.core.fingerprint import solver_fingerprint
from crackfront.core.solver.relax import SOLVERS, Direction, Status, relax
from crackfront.data.version import __version__
from crackfront.simulate.files import cycle_dataset
from crackfront.simulate.laws import stated_error
from crackfront.simulate.loop_arrays import jump_dataset, loop_measures
from crackfront.simulate.run import compile_solver
from crackfront.simulate.surface_arrays import surface_kind
from crackfront.simulate.surface_contact import surface_contact


def run_loop(
    surface: DataArray,
    *,
    max_penetration: float = 1.0,
    step: float = 0.02,
    error: float = 0.03,
    solver: str = "newton",
    fronts: bool = True,
    energy: bool = False,
    progress: Callable[[CycleState], None] | None = None,
) -> Dataset:
    """Approach from first contact, and retraction to pull-off, of a sphere on a surface.

    Parameters
    ----------
    surface : xarray.DataArray
        `height(x, y)` or `work_of_adhesion(x, y)` on a periodic tile in reduced units, the apex
        of the sphere at the centre of the tile.
    max_penetration : float, optional
        Largest penetration. (Units: reduced vertical length)
    step : float, optional
        Difference of penetrations. The fronts at a penetration do not depend on it.
        (Units: reduced vertical length)
    error : float, optional
        Standard error of the factor k of either branch that the numerics may leave; measured
        laws choose sites, samples and tolerance. They need the attributes `short_cutoff`,
        `roll_off` and `hurst` of the surface, as :func:`random_surface` sets them. Without these
        the front has a site a pixel or more, and two samples a pixel along a ray.
    solver : {"newton", "reference"}, optional
        Solver; both find the same fronts.
    fronts, energy : bool, optional
        Whether to keep the fronts, and to compute the energy that each load step dissipates.
    progress : callable, optional
        Called with every state as it is found.

    Returns
    -------
    xarray.Dataset
        The curves over `step`, the fronts `radius(step, angle)`, and measures of the whole:
        `e_el`, `w_rms`, `correlation_length`, `w_appr`, `w_retr`, their errors and `hysteresis`.
        The last four are NaN where the loop has no steady part; `steady_sentence` says why.

    Raises
    ------
    ValueError
        If the surface, a length or the solver cannot be used, or the pixels are too coarse for
        the asked error.

    Examples
    --------
    >>> from crackfront import random_surface
    >>> surface = random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
    >>> loop = run_loop(surface, step=0.25)
    >>> loop.attrs["status"], loop.radius.dims
    ('lost_contact', ('step', 'angle'))
    """
    if solver not in SOLVERS:
        raise ValueError(f"solver is {solver!r}; choose one of {', '.join(sorted(SOLVERS))}")
    contact = surface_contact(surface, LoadSchedule(max_penetration, step), error)
    compile_solver(solver)
    record = run_cycle(
        contact.field,
        LoadSchedule(max_penetration, step),
        tolerance=contact.tolerance,
        solver=solver,
        record_fronts=fronts,
        record_energy=energy,
        progress=progress,
    )
    steady = steady_adhesion(record, contact.correlation_length)
    numerical = (math.nan, math.nan)
    if contact.simulation is not None and not steady.sentence:
        numerical = stated_error(contact.simulation, steady, contact.correlation_length)
    loop = cycle_dataset(record).assign(
        loop_measures(
            steady, contact.elastic_energy, contact.rms, contact.correlation_length, numerical
        )
    )
    return loop.assign_attrs(
        kind=surface_kind(surface),
        solver=solver,
        tolerance=contact.tolerance,
        steady_sentence=steady.sentence,
        crackfront_version=__version__,
        solver_fingerprint=solver_fingerprint(),
    )


def find_instabilities(
    surface: DataArray,
    *,
    direction: Direction = -1,
    max_penetration: float = 1.0,
    step: float = 0.02,
    travel: float = 0.05,
    precision: float = 2e-5,
    error: float = 0.05,
) -> Dataset:
    """The single instabilities of a branch, from first contact or to pull-off.

    Load steps are halved until the front moves smoothly, or until the step is too small to
    matter, which is an instability.

    Parameters
    ----------
    surface : xarray.DataArray
        As in :func:`run_loop`.
    direction : {1, -1}, optional
        Approach or retraction.
    max_penetration, step : float, optional
        As in :func:`run_loop`.
    travel : float, optional
        Largest motion of a site in a smooth step, in correlation lengths of w_loc.
    precision : float, optional
        Penetration to which an instability is located. (Units: reduced vertical length)
    error : float, optional
        As in :func:`run_loop`.

    Returns
    -------
    xarray.Dataset
        Over `instability` the penetration, the dissipated energy, the area, and the extent of the
        largest patch; the fronts `before` and `after` over `angle` as well.

    Raises
    ------
    ValueError
        If an argument cannot be used, or a front is not found.
    """
    if direction not in get_args(Direction):
        raise ValueError(f"direction is {direction}; give 1 for approach or -1 for retraction")
    schedule = LoadSchedule(max_penetration, step)
    contact = surface_contact(surface, schedule, error)
    compile_solver("newton")
    field, tolerance = contact.field, min(contact.tolerance, precision / 10)
    reach = travel * contact.correlation_length
    start = 0.0 if direction > 0 else max_penetration
    touched = np.full(n_angle(field), first_radius(field))
    found = relax(touched, start, 1, field, tolerance=tolerance)
    if found.status is not Status.CONVERGED:
        raise ValueError(f"at penetration {start:.6g}: {found.status.value}")
    loads = schedule.approach() if direction > 0 else schedule.retraction()
    steps = resolved_motion(
        field,
        found.radius,
        start,
        loads,
        direction,
        travel=reach,
        precision=precision,
        tolerance=tolerance,
    )
    jumps = [motion for motion in steps if motion.unstable]
    energies = [dissipated_energy(jump.before, jump.after, jump.end, field) for jump in jumps]
    return jump_dataset(jumps, energies, reach, n_angle(field))
