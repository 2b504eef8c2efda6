"""A straight front on a user's surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain

import numpy as np
from xarray import DataArray

from crackfront.analysis.steady_adhesion import SteadyAdhesion, passing_adhesion
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.arrays import Array
from crackfront.core.cycle.load_schedule import protocol
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.line import initial_front, line_field
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.costs import affordable_seconds
from crackfront.simulate.line.line_loads import LAW_LENGTH
from crackfront.surfaces.loop_setup import (
    LoopContact,
    LoopNumerics,
    LoopSetup,
    check_samples,
    remark_on_mean,
    remark_on_sites,
    state_count,
)
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.surface_array import surface_kind
from crackfront.surfaces.tile_measures import tile_measures
from crackfront.validation import Positive, checked_call

_ROUND_OFF = 1e-9
"""Relative distance by which a front may be shorter than a bound."""

_FEWEST_SAMPLES = 0.5
"""Samples a pixel: the field of a straight front begins two pixels behind its first front."""

_LINE_ROUND_OFF = 10.0
"""Round-off of forces of the line by Fourier transforms, relative to its shortest mode alone."""


@dataclass(frozen=True, slots=True)
class StraightSetup(LoopSetup):
    """Setup of a straight front."""

    load_stiffness: float
    """Stiffness of the load against a front that does not move.
    (Units: reduced energy / length**2)"""

    def steady_adhesion(self, record: CycleRecord) -> SteadyAdhesion:
        """Means over the last period of the tile, or less, in which the start is forgotten."""
        tile = self.measures
        return passing_adhesion(record, tile.correlation_length, tile.mean, tile.period)

    def comment_on_energy(self, record: CycleRecord, dissipated: Array) -> str:
        """Which part of the dissipated energies is due to the size of the load steps."""
        lost = np.nansum(dissipated)
        if lost <= 0:
            return ""
        # A load step on a front that is pinned loses this much even if the front moves smoothly.
        added = self.load_stiffness / 2 * np.sum(np.diff(record.states.spring_position) ** 2)
        return (
            f"load steps add {added / lost:.2g} of the sum: half of the stiffness of "
            "the springs times the square of each step, which smaller steps lower"
        )


@dataclass(frozen=True, slots=True)
class StraightFront(LoopContact):
    """A straight front on a surface, its contact at smaller x, pulled by springs along x."""

    surface: DataArray
    """The periodic surface, in reduced units."""
    spring: float
    """Length of the springs, w_int / kappa. (Units: reduced lateral length)"""

    def setup(
        self, loads: tuple[float, ...] | None, step: float, numerics: LoopNumerics
    ) -> StraightSetup:
        """What a run begins with, as of :meth:`crackfront.surfaces.loop_setup.LoopContact.setup`.

        By default the front has a site for every y, and a sample a pixel along a ray.
        """
        if loads is None:
            raise ValueError("a straight front needs loads; give loads, and no max_penetration")
        if numerics.error is not None:
            raise ValueError(
                f"error is {numerics.error:g}, but errors of straight fronts on a given surface "
                "were not measured; give sites and samples instead"
            )
        adhesion, way = surface_adhesion(self.surface), protocol(loads, step)
        short_front = self._remark_on_length(adhesion)
        values, n_state = adhesion.work_of_adhesion, state_count(loads, step)
        samples, measures = numerics.samples or 1.0, tile_measures(adhesion)
        check_samples(numerics, adhesion.pixel, measures, _FEWEST_SAMPLES)
        # The first front lies as far behind its load as pinning may pull the springs.
        behind = 1.25 * self.spring * float(np.ptp(values)) / WORK_OF_ADHESION
        furthest = max(abs(min(loads)), abs(max(loads))) + behind + 2 * adhesion.pixel
        self._check_round_off(adhesion, furthest, numerics.sites or values.shape[1])
        seconds = affordable_seconds(
            n_angle=numerics.sites or values.shape[1],
            n_point=values.size,
            n_state=n_state,
            n_sample=2 * samples * (float(np.ptp(loads)) + behind) / adhesion.pixel,
        )
        field = line_field(
            adhesion,
            self.spring,
            (min(loads), max(loads)),
            n_site=numerics.sites,
            spacing=adhesion.pixel / samples,
        )
        front = initial_front(field, adhesion, loads[0])
        few_sites = remark_on_sites(field.geometry.n_site, field.geometry.length, measures)
        return StraightSetup(
            field=field,
            front=front,
            # A branch begins with a front of its own: making contact releases no energy here.
            loads=chain([next(way)._replace(start=front)], way),
            expected=int(n_state),
            seconds=seconds,
            tolerance=DEFAULT_TOLERANCE,
            measures=measures,
            load_stiffness=field.geometry.length * field.geometry.stiffness,
            remark="; ".join(filter(None, (short_front, remark_on_mean(measures), few_sites))),
        )

    def _check_round_off(self, adhesion: AdhesionMap, furthest: float, n_site: int) -> None:
        """Raise if the round-off of places so far from 0 exceeds the tolerance of forces."""
        length, period = (adhesion.pixel * n for n in adhesion.work_of_adhesion.shape[::-1])
        stiffness = 1 / self.spring + _LINE_ROUND_OFF * math.pi * n_site / length
        force = float(np.finfo(float).eps) * furthest * stiffness
        if force > DEFAULT_TOLERANCE:
            raise ValueError(
                f"the front is pulled as far as {furthest:.4g} by springs of length "
                f"{self.spring:g}, where the round-off of places makes forces of {force:.1e} "
                f"w_int, above the tolerance of {DEFAULT_TOLERANCE:g}; shift the loads by periods "
                f"of the tile, {period:g}, to near 0, or use longer springs or fewer sites"
            )

    def _remark_on_length(self, adhesion: AdhesionMap) -> str:
        """What a short front means for k; ValueError if it is shorter than its springs."""
        length = adhesion.pixel * adhesion.work_of_adhesion.shape[1]
        ratio = length / self.spring
        if ratio < 1 - _ROUND_OFF:
            raise ValueError(
                f"spring is {self.spring:g}, longer than the front, {length:g}, which is pinned as "
                "a whole; shorten the spring or lengthen the tile along y"
            )
        if ratio < LAW_LENGTH * (1 - _ROUND_OFF):
            return (
                f"the front is {ratio:.2g} L_kappa long, below the {LAW_LENGTH:g} of the law of k: "
                "its hysteresis is too large"
            )
        return ""


@checked_call
def straight_front(surface: DataArray, spring: Positive) -> StraightFront:
    """A straight front for :func:`crackfront.run_loop`, whose loads are places of its springs.

    The front is as long as the side of the surface along y. Where this is below ten times the
    length of the springs, the factor k is larger than on a long front, on which the law of k was
    measured; the result of the loop says so.

    Parameters
    ----------
    surface : xarray.DataArray
        Surface, as of :func:`crackfront.surface`.
    spring : float
        Length of the springs, w_int over their stiffness per area. (Units: reduced lateral length)

    Returns
    -------
    StraightFront
        For :func:`crackfront.run_loop`.

    Raises
    ------
    ValueError
        If the spring cannot have this length, or the name of the array is not the name of a
        surface. The loop raises an error if springs are longer than the front.
    TypeError
        If an argument is of another type.
    """
    surface_kind(surface)
    return StraightFront(surface, spring)
