"""A simulated cycle as a loop: its works of adhesion by the definition of simulations."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, get_args

import numpy as np
from xarray import Dataset

from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.analysis.steady_adhesion import SteadyAdhesion, steady_adhesion, steady_branches
from crackfront.core.adhesion import FieldKind, correlation_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, Scales
from crackfront.measured.loops.loop import MeasuredLoop, work_per_area
from crackfront.simulate.cycle_files import cycle_record
from crackfront.surfaces.si_units import in_reduced_units, stated_scales

_NETCDF = (b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF")
"""First bytes of the files of netCDF."""

_REDUCED = Scales(1.0, WORK_OF_ADHESION, CONTACT_MODULUS)
"""The sphere whose lengths and forces in SI are those in reduced units."""

_ERRORS = (
    "The cycle was simulated: the works of adhesion are those along its rough front, and their "
    "intervals include the scatter of the states on this one surface."
)
_UNITS = (
    "All numbers are in reduced units, R = 1, w_int = 1/pi, E' = 3/4; --radius, --modulus and "
    "--work-of-adhesion convert them to SI."
)
_OPEN = (
    "The energy lost is not known: the cycle does not lead from the first contact at penetration 0 "
    "to the loss of contact."
)


def is_netcdf(path: Path) -> bool:
    """Whether a file is one of netCDF, as simulated cycles are; OSError if it cannot be opened."""
    with path.open("rb") as file:
        return file.read(4).startswith(_NETCDF)


def simulated_loop(cycle: Dataset, name: str = "the cycle") -> MeasuredLoop:
    """Works of adhesion of a simulated cycle of a sphere, as the simulation has them.

    Parameters
    ----------
    cycle : xarray.Dataset
        What :func:`crackfront.run_loop` returned, `crackfront cycle` wrote or a sweep stored, in
        reduced units or, with the sphere in its attributes, in SI.
    name : str, optional
        What a refusal calls it.

    Returns
    -------
    MeasuredLoop
        In the units of the cycle, those of works of adhesion w_int where it is in reduced ones. The
        works and their standard errors are as of
        :func:`crackfront.analysis.steady_adhesion.steady_adhesion`. Radius and modulus are exact,
        so that neither is fitted, and nothing bends but the contact.

    Raises
    ------
    ValueError
        If the dataset is no cycle of a sphere, states no correlation length, or has no steady part.

    Examples
    --------
    >>> from crackfront import random_surface, run_loop
    >>> surface = random_surface(short_cutoff=0.1, elastic_energy=0.02, side=4, seed=1)
    >>> cycle = run_loop(surface, step=0.05)
    >>> simulated_loop(cycle).w_retr.value == float(cycle.w_retr)
    True
    """
    if "pinning_force" in cycle:
        raise ValueError(
            f"{name} is of a straight front, which has no contact radius; a loop is that of a "
            "sphere, and w_appr and w_retr of the front stand in its file"
        )
    scales = stated_scales(cycle)
    reduced = cycle if scales is None else in_reduced_units(cycle, scales)
    record = cycle_record(reduced, name)
    states: ContactState[Array] = record.states
    length = _stated_length(reduced, name)
    steady = steady_adhesion(record, length)
    if steady.sentence:
        raise ValueError(f"{name} has no works of adhesion: {steady.sentence}")
    averaged, _, _ = steady_branches(states, states.mean_radius, "radii", length)
    inside = np.zeros(states.direction.size, bool)
    inside[np.concatenate(averaged)] = True
    sphere, adhesion = (_REDUCED, 1.0) if scales is None else (scales, scales.work_of_adhesion)
    w_appr, w_retr, hysteresis = (
        _estimate(steady, work, adhesion) for work in ("w_appr", "w_retr", "hysteresis")
    )
    nothing, modulus = Estimate(*[math.nan] * 4), sphere.contact_modulus
    lost, pull = _lost_energy(record), -float(np.min(states.force)) * sphere.force
    remarks = _ERRORS, *([_UNITS] if scales is None else []), *([_OPEN] if lost is None else [])
    return MeasuredLoop(
        force=states.force * sphere.force,
        contact_radius=states.mean_radius * sphere.lateral,
        work_of_adhesion=states.apparent_work_of_adhesion * adhesion,
        direction=states.direction,
        in_window=inside,
        w_appr=w_appr,
        w_retr=w_retr,
        hysteresis=hysteresis,
        contact_modulus=Estimate(modulus, 0.0, modulus, modulus),
        fitted_modulus=nothing,
        stiffness=nothing,
        lost_energy=math.nan if lost is None else lost * adhesion,
        pull_off_force=Estimate(pull, 0.0, pull, pull),
        sphere_radius=sphere.radius,
        window=(steady.lowest_radius * sphere.lateral, steady.highest_radius * sphere.lateral),
        remarks=remarks,
        reduced=scales is None,
    )


def _stated_length(cycle: Dataset, name: str) -> float:
    """Correlation length of w_loc that a cycle in reduced units states, or its spectrum has."""
    if "correlation_length" in cycle:
        return float(cycle.correlation_length)
    spectrum = Spectrum.stated(cycle.attrs)
    kind: Any = cycle.attrs.get("kind")
    if spectrum is None or kind not in get_args(FieldKind):
        raise ValueError(
            f"{name} states neither a correlation length nor the spectrum of its surface, so that "
            "its steady part is unknown; write it by crackfront.run_loop or crackfront cycle"
        )
    return correlation_length(kind, spectrum)


def _estimate(steady: SteadyAdhesion, name: str, unit: float) -> Estimate[float]:
    """A work of adhesion with the interval of its standard error, in a unit of w_int."""
    return normal_estimate(getattr(steady, name), getattr(steady, f"{name}_error")).each(
        lambda work: work * unit
    )


def _lost_energy(record: CycleRecord) -> float | None:
    """Energy lost per largest contact area, in w_int; None where the cycle is not closed."""
    states = record.states
    if record.status is not Status.LOST_CONTACT or states.penetration[0] != 0:
        return None
    columns = states.penetration, states.force, states.mean_radius
    return work_per_area(*columns) / WORK_OF_ADHESION
