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
from crackfront.core.field.fields import TileField
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
from crackfront.surfaces.tile_measures import TileMeasures, tile_measures
from crackfront.validation import Positive, checked_call

_ROUND_OFF = 1e-9
"""Relative distance by which a front may be shorter than a bound."""

_FEWEST_SAMPLES = 0.5
"""Samples a pixel: the field of a straight front begins two pixels behind its first front."""

_USUAL_SAMPLES = 1.0
"""Samples a pixel along a ray, if the user states no number."""

_SPLINE_OVERSHOOT = 1.25
"""Largest range of the splines over the range of the points that they go through."""

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
        """Field, first front and loads of a run along some loads.

        The front has a site for every y, and a sample a pixel along a ray, unless the numerics
        state other numbers.
        """
        if loads is None:
            raise ValueError("a straight front needs loads; give loads, and no max_penetration")
        if numerics.error is not None:
            raise ValueError(
                f"error is {numerics.error:g}, but errors of straight fronts on a given surface "
                "were not measured; give sites and samples instead"
            )
        visited = protocol(loads, step)
        n_state = state_count(loads, step)
        adhesion = surface_adhesion(self.surface)
        self._check_length(adhesion)
        measures = tile_measures(adhesion)
        check_samples(numerics, adhesion.pixel, measures, _FEWEST_SAMPLES)
        seconds = self._affordable_seconds(adhesion, loads, n_state, numerics)
        field = self._field(adhesion, loads, numerics)
        front = initial_front(field, adhesion, loads[0])
        # A branch begins with a front of its own: making contact releases no energy here.
        first = next(visited)._replace(start=front)
        return StraightSetup(
            field=field,
            front=front,
            loads=chain([first], visited),
            expected=int(n_state),
            seconds=seconds,
            tolerance=DEFAULT_TOLERANCE,
            measures=measures,
            load_stiffness=field.geometry.length * field.geometry.stiffness,
            remark=self._remark(adhesion, field, measures),
        )

    def _pinned_distance(self, adhesion: AdhesionMap) -> float:
        """Largest distance to the load at which pinning may stop a front (Units: length)."""
        span = float(np.ptp(adhesion.work_of_adhesion))
        return _SPLINE_OVERSHOOT * self.spring * span / WORK_OF_ADHESION

    def _affordable_seconds(
        self,
        adhesion: AdhesionMap,
        loads: tuple[float, ...],
        n_state: float,
        numerics: LoopNumerics,
    ) -> float:
        """Expected processor time (Units: s); raises if round-off, memory or time are too large."""
        values, pixel = adhesion.work_of_adhesion, adhesion.pixel
        n_site = numerics.sites or values.shape[1]
        behind = self._pinned_distance(adhesion)
        furthest = max(abs(min(loads)), abs(max(loads))) + behind + 2 * pixel
        self._check_round_off(adhesion, furthest, n_site)
        samples = numerics.samples or _USUAL_SAMPLES
        return affordable_seconds(
            n_angle=n_site,
            n_point=values.size,
            n_state=n_state,
            n_sample=2 * samples * (float(np.ptp(loads)) + behind) / pixel,
        )

    def _field(
        self, adhesion: AdhesionMap, loads: tuple[float, ...], numerics: LoopNumerics
    ) -> TileField:
        """Field that no front leaves between the lowest and the highest load."""
        samples = numerics.samples or _USUAL_SAMPLES
        return line_field(
            adhesion,
            self.spring,
            (min(loads), max(loads)),
            n_site=numerics.sites,
            spacing=adhesion.pixel / samples,
        )

    def _remark(self, adhesion: AdhesionMap, field: TileField, measures: TileMeasures) -> str:
        """Reservations about the result, in one line; empty if there are none."""
        remarks = (
            self._remark_on_length(adhesion),
            remark_on_mean(measures),
            remark_on_sites(field.geometry.n_site, field.geometry.length, measures),
        )
        return "; ".join(filter(None, remarks))

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

    def _check_length(self, adhesion: AdhesionMap) -> None:
        """Raise ValueError if the front is shorter than its springs."""
        length = _front_length(adhesion)
        if length / self.spring < 1 - _ROUND_OFF:
            raise ValueError(
                f"spring is {self.spring:g}, longer than the front, {length:g}, which is pinned as "
                "a whole; shorten the spring or lengthen the tile along y"
            )

    def _remark_on_length(self, adhesion: AdhesionMap) -> str:
        """Sentence on a front that is too short for the law of k; else empty."""
        ratio = _front_length(adhesion) / self.spring
        if ratio >= LAW_LENGTH * (1 - _ROUND_OFF):
            return ""
        return (
            f"the front is {ratio:.2g} L_kappa long, below the {LAW_LENGTH:g} of the law of k: "
            "its hysteresis is too large"
        )


def _front_length(adhesion: AdhesionMap) -> float:
    """Side of the tile along y (Units: length)."""
    return adhesion.pixel * adhesion.work_of_adhesion.shape[1]


@checked_call
def straight_front(surface: DataArray, spring: Positive) -> StraightFront:
    """A straight front for :func:`crackfront.run_loop`, whose loads are places of its springs.

    The front is as long as the side of the surface along y. If this is less than ten times the
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
