"""The steady parts of both branches alone, without the cycle around them.

A branch begins at a circle that moves forward, not at first contact or far outside. Fronts do not
pass each other, so that this front is the same as a front from further behind as soon as the latter
has passed the circle everywhere: the start is forgotten exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crackfront.analysis.standard_error import standard_error
from crackfront.analysis.steady_adhesion import SteadyAdhesion, steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind
from crackfront.core.arguments import check_positive
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder, columns
from crackfront.core.cycle.touch import check_field_size, first_touch
from crackfront.core.field.fields import Field, first_place, last_place
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Direction, Status
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.contact import ExpectedMotion, Problem
from crackfront.simulate.sphere.full_cycle import SphereSchedule
from crackfront.simulate.tiles import RandomSurface

_FEWEST_TO_TURN = 8
"""Steady states before the approach may turn."""

_N_CIRCLE = 64
"""Number of circles that are tried as a start."""

_LEAST_DRIVE = 1.5
"""Drive of a circle that may be a start, in units of the rms of w_loc on it; see docs/model.md.

Single sites may move back: where some repel, no circle with an open edge drives all forward.
"""

_LARGEST_FACTOR = 2.6
"""Largest factor k that may pin a front."""

_FAR_BEHIND = 20.0
"""Distance behind a front pinned by the largest k at which a circle may be a start too.
(Units: correlation length)

On fine spectra the drive above needs hundreds of them, and fronts deviate from a circle by 7 at
most.
"""

_FEWEST_STATES = 9.0
"""States of an approach that turns as early as it may: one before it is steady."""

_LEAST_TRAVEL = 0.1
"""Least way from state to state that is advised, in correlation lengths: shorter ones cost time."""

_VARIANCE = 0.6
"""Variance of k from state to state, times e_el and the independent pieces of the front."""


@dataclass(frozen=True, slots=True)
class SteadySchedule(SphereSchedule):
    """Approach from a penetration until k is known well enough, and back over the same radii.

    ValueError if a number is not positive, or the start negative or not below the largest
    penetration.
    """

    load_name = "steady branches"

    start: float
    """Penetration at which the approach begins. (Units: reduced vertical length)"""
    max_penetration: float
    """Largest penetration. (Units: reduced vertical length)"""
    travel: float
    """Way of a smooth front from state to state, in correlation lengths of w_loc."""
    standard_error: float
    """Standard error of k, of (w_retr - w_appr) / (2 e_el), at which the approach turns: the
    retraction is taken to scatter as much."""

    def __post_init__(self) -> None:
        check_positive(travel=self.travel, standard_error=self.standard_error)
        if not 0 <= self.start < self.max_penetration < math.inf:
            raise ValueError(
                f"steady start is {self.start}; it must be 0 or more, and below the largest "
                f"penetration {self.max_penetration}: lower it or penetrate deeper"
            )

    def run(self, problem: Problem, solver: Solver | None, recorder: Recorder) -> CycleRecord:
        """Approach and retraction over the radii that an estimate of the hysteresis needs.

        Each branch begins at the circle of `forward_circle`. The approach goes on until k has the
        requested standard error or the largest penetration is reached; the retraction from about
        its largest radius until it has left the radii over which the approach was steady, which a
        branch is once every site has travelled a correlation length. The status is `STEADY` where
        both branches were measured. The energy that the first step of a branch dissipates is
        meaningless and NaN. ValueError if a smooth sphere would outgrow the field.
        """
        check_field_size(problem.field, self.max_penetration)
        loads = self._loads(problem, recorder)
        recorder.run(problem.field, first_touch(problem.field), loads, solver)
        return recorder.record(Status.STEADY if recorder.status is Status.CONVERGED else None)

    def _loads(self, problem: Problem, recorder: Recorder) -> Iterator[Load]:
        """Loads of both branches, each chosen by the states recorded before it."""
        step = self._step(problem.correlation_length)
        steady: list[ContactState[float]] = []
        circle_means: list[float] = []
        for load in self._approach(problem, step):
            yield load
            if recorder.status is not Status.CONVERGED:
                return
            state = recorder.states[-1]
            if state.least_travel >= problem.correlation_length:
                steady.append(state)
                circle_means.append(_circle_adhesion(problem.field, state.mean_radius))
                if self._is_known_well(problem, steady, circle_means):
                    break
        lowest = min((state.mean_radius for state in steady), default=math.inf)
        for load in self._retraction(problem, step, recorder.states[-1]):
            yield load
            is_over = recorder.states[-1].mean_radius < lowest
            if recorder.status is not Status.CONVERGED or is_over:
                return

    def _step(self, correlation_length: float) -> float:
        """Difference of penetrations from state to state (Units: reduced vertical length)."""
        return self.travel * correlation_length * jkr.penetration_slope(self.start)

    def _approach(self, problem: Problem, step: float) -> Iterator[Load]:
        """Loads of the approach up to the largest penetration."""
        length = problem.correlation_length
        near = jkr.equilibrium_radius(self.start) - length
        yield Load(self.start, 1, forward_circle(problem.field, self.start, 1, near, length))
        n_step = math.floor((self.max_penetration - self.start) / step)
        for k in range(1, n_step + 1):
            yield Load(self.start + k * step, 1)

    def _is_known_well(
        self,
        problem: Problem,
        steady: Sequence[ContactState[float]],
        circle_means: Sequence[float],
    ) -> bool:
        """Whether k has the requested standard error by the steady states of an approach.

        `circle_means` are the means of w_loc on their circles (Units: w_int).
        """
        if len(steady) < _FEWEST_TO_TURN:
            return False
        states = columns(steady, ContactState)
        front_part = branch_part(states.apparent_work_of_adhesion, np.array(circle_means))
        spread = standard_error(
            front_part, states.mean_radius, states.rms_radius, problem.correlation_length
        )
        # k is half of the difference of two branches, which scatter as much.
        return spread / math.sqrt(2) <= self.standard_error * problem.elastic_energy

    @staticmethod
    def _retraction(problem: Problem, step: float, last: ContactState[float]) -> Iterator[Load]:
        """Loads of the retraction from the last state of the approach, without end."""
        penetration = _retraction_start(problem.field, last)
        length = problem.correlation_length
        near = last.mean_radius + length
        yield Load(penetration, -1, forward_circle(problem.field, penetration, -1, near, length))
        while True:
            penetration -= step
            yield Load(penetration, -1)

    def steady_adhesion(
        self, record: CycleRecord, correlation_length: float, mean_adhesion: float
    ) -> SteadyAdhesion:
        """Means over the steady states, as of full cycles, with the keys that give more of them."""
        remedy = "lower start or travel, or raise max_penetration"
        return steady_adhesion(record, correlation_length, remedy)

    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States of both branches until k has the requested standard error."""
        length = surface.correlation_length
        step = self._step(length)
        n_most = 1 + math.floor((self.max_penetration - self.start) / step)
        alike = length * integral_breadth(surface.kind, surface.spectrum)
        n_independent = 2 * math.pi * jkr.equilibrium_radius(self.start) / alike
        variance = _VARIANCE / (surface.elastic_energy * n_independent)
        n_state = max(_FEWEST_STATES, 1 + variance / self.standard_error**2)
        return ExpectedMotion(2 * min(n_most, n_state), self.travel)

    def steady_penetration(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float:
        """Penetration that leaves the approach so many steady states."""
        low, _ = works
        end = self._begin(surface, low) + self._steady_way(surface, transient, n_state)
        return float(jkr.equilibrium_penetration(end, low))

    def steadier_start(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float | None:
        """Start from which the approach has so many steady states; None below first contact."""
        low, _ = works
        end = jkr.equilibrium_radius(self.max_penetration, low)
        begin = end - self._steady_way(surface, transient, n_state) + surface.correlation_length
        if begin < jkr.equilibrium_radius(0.0, low):
            return None
        return float(jkr.equilibrium_penetration(begin, low))

    def steadier_travel(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float | None:
        """Travel with which the approach has so many steady states; None if it is too small."""
        low, _ = works
        whole = jkr.equilibrium_radius(self.max_penetration, low) - self._begin(surface, low)
        shorter = float(whole - transient) / (n_state * surface.correlation_length)
        return shorter if shorter > _LEAST_TRAVEL else None

    def _begin(self, surface: RandomSurface, work_of_adhesion: float) -> float:
        """Radius of the circle at which the approach begins, a correlation length behind."""
        radius = jkr.equilibrium_radius(self.start, work_of_adhesion)
        return float(radius) - surface.correlation_length

    def _steady_way(self, surface: RandomSurface, transient: float, n_state: int) -> float:
        """Way of the approach until it has so many steady states (Units: length)."""
        correlation_lengths = n_state * self.travel
        return transient + correlation_lengths * surface.correlation_length


def integral_breadth(kind: FieldKind, spectrum: Spectrum) -> float:
    """Mean of q times mean of 1/q in the variance of w_loc, relative to a flat spectrum.

    The longest waves, and thus the mean of 1/q, decide how the mean of w_loc along a front varies;
    the mean of q decides the correlation length.
    """
    order = 0.5 if kind == "roughness" else 0.0
    flat = SelfAffineSpectrum(1.0, 1.0, hurst=1.0)
    means = [
        shape.mean_square(order + 0.5)
        * shape.mean_square(order - 0.5)
        / shape.mean_square(order) ** 2
        for shape in (spectrum, flat)
    ]
    return means[0] / means[1]


def _retraction_start(field: Field, last: ContactState[float]) -> float:
    """Penetration at which a retraction comes to the radius of the last state of the approach."""
    # The mean of w_loc lies about in the middle between the branches: rather begin outside.
    mean = _circle_adhesion(field, last.mean_radius)
    expected = max(mean + 0.8 * (mean - last.apparent_work_of_adhesion), 0.0)
    return min(float(jkr.equilibrium_penetration(last.mean_radius, expected)), last.penetration)


def _circle_adhesion(field: Field, radius: float) -> float:
    """Mean of w_loc on a circle (Units: w_int)."""
    circle = np.full(field.geometry.n_site, radius)
    return float(np.mean(front_adhesion(circle, field))) / WORK_OF_ADHESION


def branch_part(values: Array, shared: Array) -> Array:
    """Apparent work of adhesion without what both branches share over the same radii.

    The mean of w_loc on the circles raises and lowers both branches alike and adds noise to each,
    but not to the hysteresis. `shared` is that mean on the circles of the mean radii of the steady
    states; what follows it, by least squares, is taken away. All have the shape (n_state,). (Units:
    w_int)
    """
    deviation = shared - np.mean(shared)
    variance = np.mean(deviation**2)
    if variance == 0:
        return values
    return np.asarray(values - deviation * (np.mean(deviation * values) / variance))


def forward_circle(
    field: Field, penetration: float, direction: Direction, near: float, correlation_length: float
) -> Array:
    """Circle, (n_angle,), behind which no front can rest at a penetration.

    Circles are tried from the radius `near` on backwards: inwards in approach (direction +1),
    outwards in retraction (-1). The first is taken that :data:`_LEAST_DRIVE` allows, or that lies
    :data:`_FAR_BEHIND` the first circle that pinning by the largest k cannot stop. Without any it
    is the last: in approach that within which the edge is in compression, in retraction the end of
    the field. (Units: reduced lateral length, the penetration reduced vertical length)
    """
    furthest = last_place(field)
    if direction > 0:
        furthest = max(math.sqrt(max(penetration, 0.0)), first_place(field))
    if direction * (furthest - near) > 0:
        return np.full(field.geometry.n_site, furthest)
    beyond_pinning = None
    for radius in np.linspace(near, furthest, _N_CIRCLE):
        circle = np.full(field.geometry.n_site, radius)
        adhesion = front_adhesion(circle, field)
        drive = direction * (np.mean(adhesion) - jkr.energy_release_rate(radius, penetration))
        if drive > _LEAST_DRIVE * np.std(adhesion):
            return circle
        # The drive of a pinned front is at most k e_el, with w_rms^2 = 4 e_el w_int.
        largest_pinning = _LARGEST_FACTOR * np.var(adhesion) / (4 * WORK_OF_ADHESION)
        if beyond_pinning is None and drive > largest_pinning:
            beyond_pinning = radius
        if (
            beyond_pinning is not None
            and abs(radius - beyond_pinning) > _FAR_BEHIND * correlation_length
        ):
            return circle
    return np.full(field.geometry.n_site, furthest)
