"""A simulated cycle as a loop: its works of adhesion by the definition of simulations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
from xarray import Dataset

from crackfront.analysis.estimate import UNKNOWN, Estimate, exact_estimate, normal_estimate
from crackfront.analysis.steady_adhesion import steady_adhesion, steady_branches
from crackfront.core.adhesion import FieldKind, correlation_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, Scales
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.loops.lost_energy import work_per_area
from crackfront.simulate.cycle_files import cycle_record
from crackfront.surfaces.si_units import in_reduced_units, stated_scales

_REDUCED = Scales(1.0, WORK_OF_ADHESION, CONTACT_MODULUS)
"""The sphere whose lengths and forces in SI are the same numbers as in reduced units."""

_ERRORS = (
    "The cycle was simulated: the works of adhesion are those along its rough front, and their "
    "intervals include the scatter of the states on this one surface."
)
_REDUCED_UNITS = (
    "All numbers are in reduced units, R = 1, w_int = 1/pi, E' = 3/4; --radius, --modulus, "
    "--poisson and --work-of-adhesion convert them to SI."
)
_OPEN = (
    "The energy lost is not known: the cycle does not lead from the first contact at penetration 0 "
    "to the loss of contact."
)


def simulated_loop(cycle: Dataset, name: str = "the cycle") -> MeasuredLoop:
    """Works of adhesion of a simulated cycle of a sphere, as the simulation has them.

    Parameters
    ----------
    cycle : xarray.Dataset
        What :func:`crackfront.run_loop` returned, `crackfront cycle` wrote or a sweep stored, in
        reduced units or, with the sphere in its attributes, in SI.
    name : str, optional
        Name of the cycle in messages.

    Returns
    -------
    MeasuredLoop
        In the units of the cycle; in a cycle in reduced units, works of adhesion are in w_int. The
        works and their standard errors are as of
        :func:`crackfront.analysis.steady_adhesion.steady_adhesion`. Radius and modulus are exact,
        so that neither is fitted, and nothing bends but the contact.

    Raises
    ------
    ValueError
        If the dataset is not a cycle of a sphere, states no correlation length, or lacks a steady
        part.

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
            f"{name} is of a straight front, which lacks a contact radius; a loop is of a "
            "sphere, and w_appr and w_retr of the front stand in its file"
        )
    scales = stated_scales(cycle)
    reduced = cycle if scales is None else in_reduced_units(cycle, scales)
    record = cycle_record(reduced, name)
    states: ContactState[Array] = record.states
    length = _correlation_length(reduced, name)
    steady = steady_adhesion(record, length)
    if steady.sentence:
        raise ValueError(f"{name} lacks works of adhesion: {steady.sentence}")
    averaged, _, _ = steady_branches(states, states.mean_radius, "radii", length)
    sphere, unit = (_REDUCED, 1.0) if scales is None else (scales, scales.work_of_adhesion)
    return MeasuredLoop(
        force=states.force * sphere.force,
        contact_radius=states.mean_radius * sphere.lateral,
        work_of_adhesion=states.apparent_work_of_adhesion * unit,
        direction=states.direction,
        in_window=np.isin(np.arange(states.direction.size), np.concatenate(averaged)),
        w_appr=_estimate(steady.w_appr, steady.w_appr_error, unit),
        w_retr=_estimate(steady.w_retr, steady.w_retr_error, unit),
        hysteresis=_estimate(steady.hysteresis, steady.hysteresis_error, unit),
        contact_modulus=exact_estimate(sphere.contact_modulus),
        fitted_modulus=UNKNOWN,
        stiffness=UNKNOWN,
        lost_energy=_lost_energy(record) * unit,
        pull_off_force=exact_estimate(-float(np.min(states.force)) * sphere.force),
        sphere_radius=sphere.radius,
        window=(steady.lowest_radius * sphere.lateral, steady.highest_radius * sphere.lateral),
        remarks=tuple(_remarks(record, is_reduced=scales is None)),
        reduced=scales is None,
    )


def _correlation_length(cycle: Dataset, name: str) -> float:
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


def _estimate(work: float, error: float, unit: float) -> Estimate[float]:
    """A work of adhesion with the interval of its standard error, in a unit instead of w_int."""
    return normal_estimate(work, error).each(lambda number: number * unit)


def _is_closed(record: CycleRecord) -> bool:
    """Whether a cycle leads from the first contact to the loss of contact."""
    return record.status is Status.LOST_CONTACT and record.states.penetration[0] == 0


def _lost_energy(record: CycleRecord) -> float:
    """Energy lost per largest contact area, in w_int; NaN if the cycle is not closed."""
    if not _is_closed(record):
        return math.nan
    states = record.states
    energy = work_per_area(states.penetration, states.force, states.mean_radius)
    return energy / WORK_OF_ADHESION


def _remarks(record: CycleRecord, *, is_reduced: bool) -> Iterator[str]:
    """Remarks on a simulated cycle."""
    yield _ERRORS
    if is_reduced:
        yield _REDUCED_UNITS
    if not _is_closed(record):
        yield _OPEN
