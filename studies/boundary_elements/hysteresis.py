"""Hysteresis of the crack front and of boundary elements on the same surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, ENERGY, LATERAL, VERTICAL, variable
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.front import FrontCycle, States, shared_states


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """Both models over the steady parts of both branches on one surface.

    Works of adhesion are means over the states of a branch, of the smooth sphere that has the same
    force at the same penetration.
    """

    seed: int = variable("seed of the surface", "1")
    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    step: float = variable("load step", VERTICAL)
    roll_off: float = variable("roll-off wavelength", LATERAL)
    hurst: float = variable("Hurst exponent", "1")
    asked_energy: float = variable("energy of full conformity that was asked for", ADHESION)
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    repelling: float = variable("part of the surface whose work of adhesion is negative", "1")
    boundary_approach: float = variable("w_appr of the boundary elements", ADHESION)
    boundary_retraction: float = variable("w_retr of the boundary elements", ADHESION)
    front_approach: float = variable("w_appr of the front", ADHESION)
    front_retraction: float = variable("w_retr of the front", ADHESION)
    barriers: int = variable("steps that were shortened before a barrier", "1")
    saddles: int = variable("unstable states without forces that were left", "1")
    least_released: float = variable("least fall of the energy at a penetration", ENERGY)
    products: float = variable("conjugate-gradient products of a load step", "1")
    boundary_seconds: float = variable("processor time of the boundary elements", "s")
    front_seconds: float = variable("processor time of the front and its field", "s")

    @property
    def boundary_difference(self) -> float:
        """w_retr - w_appr of the boundary elements (Units: w_int)."""
        return self.boundary_retraction - self.boundary_approach

    @property
    def front_difference(self) -> float:
        """w_retr - w_appr of the front (Units: w_int)."""
        return self.front_retraction - self.front_approach

    @property
    def setting(self) -> tuple[float, ...]:
        """What surfaces share that are averaged: grid, range, load step, spectrum, amplitude."""
        # An extrapolation to no range stands for all grids.
        grid = self.n_point if self.interaction_range else 0
        return grid, self.interaction_range, self.step, *self.scene

    @property
    def scene(self) -> tuple[float, ...]:
        """Spectrum and amplitude."""
        return self.roll_off, self.hurst, self.asked_energy


def hysteresis(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> Hysteresis:
    """Hysteresis of both models on one surface."""
    theirs, ours = shared_states(boundary, front.states)
    steady = case.loads.are_steady(boundary.penetration[theirs])
    adhesion = rough_adhesion(case.heights(), case.pixel)
    return Hysteresis(
        seed=case.seed,
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        step=case.loads.step,
        roll_off=case.roll_off,
        hurst=case.hurst,
        asked_energy=case.elastic_energy,
        elastic_energy=adhesion.e_el,
        repelling=float(np.mean(adhesion.work_of_adhesion < 0)),
        **_branches("boundary", boundary, theirs[steady]),
        **_branches("front", front.states, ours[steady]),
        barriers=int(np.sum(boundary.barriers)),
        saddles=int(np.sum(boundary.saddles)),
        least_released=float(np.min(boundary.released)),
        products=float(np.mean(boundary.products)),
        boundary_seconds=float(np.sum(boundary.seconds)),
        front_seconds=front.seconds,
    )


def apparent_adhesion(force: Array, penetration: Array) -> Array:
    """Work of adhesion of the smooth sphere that has a force at a penetration (Units: w_int).

    The larger one of the two radii of F = 3 a b / 2 - a^3 / 2 has an open edge.

    Examples
    --------
    >>> radius = np.array([1.2, 1.7])
    >>> penetration = jkr.equilibrium_penetration(radius, 0.8)
    >>> apparent_adhesion(jkr.equilibrium_force(radius, 0.8), penetration).round(12).tolist()
    [0.8, 0.8]
    """
    radius = [
        float(np.max(np.real(np.roots([1.0, 0.0, -3 * b, 2 * load]))))
        for load, b in zip(force.tolist(), penetration.tolist(), strict=True)
    ]
    return jkr.apparent_work_of_adhesion(radius, penetration)


def _branches(name: str, states: States, compared: NDArray[np.int64]) -> dict[str, float]:
    """Works of adhesion of a model."""
    works = []
    for sign in (1, -1):
        branch = compared[states.direction[compared] == sign]
        adhesion = apparent_adhesion(states.force[branch], states.penetration[branch])
        works.append(float(np.mean(adhesion)))
    return {f"{name}_approach": works[0], f"{name}_retraction": works[1]}
