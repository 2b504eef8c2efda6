"""The nearest stable state of a contact: a trust-region method preconditioned by elasticity.

The method is that of NuMPI's `tr_newton_bounded` (Steihaug's conjugate gradients on the free
variables, projection on the bounds), but with the elastic operator as the measure of a step and as
the preconditioner, which makes the number of products nearly independent of the grid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.studies.boundary_elements.contact import HalfSpaceContact

Array = NDArray[np.float64]

_ACCEPTED = 0.1
"""Gain, relative to that of the model, of a step that is taken."""

_POOR = 0.25
"""Gain below which the trust radius shrinks; and by how much it does."""

_FORCING = 0.3
"""Largest residual of the conjugate gradients, relative to that at their start."""

_MOST_PRODUCTS = 200
"""Products of one step."""


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """A stable state of the contact.

    Attributes
    ----------
    displacement : (2 n_point, 2 n_point) array
        Displacement into the half-space. (Units: reduced vertical length)
    iterations, products : int
        Steps of the method, and conjugate-gradient products in all of them.
    residual : float
        Largest pressure that is not in balance, relative to the largest tension.
    radius : float
        Trust radius to begin the next load step with.
    """

    displacement: Array
    iterations: int
    products: int
    residual: float
    radius: float


def equilibrium(
    contact: HalfSpaceContact,
    displacement: Array,
    penetration: float,
    *,
    tolerance: float,
    radius: float,
    max_iterations: int = 500,
) -> Equilibrium:
    """State in which a contact comes to rest from a given one.

    Parameters
    ----------
    contact : HalfSpaceContact
        Sphere, half-space and their attraction.
    displacement : (2 n_point, 2 n_point) array
        Where it starts. (Units: reduced vertical length)
    penetration : float
        Rigid body penetration b. (Units: reduced vertical length)
    tolerance : float
        Largest pressure out of balance that may be left, relative to the largest tension.
    radius : float
        Trust radius of the first step: root of twice its elastic energy per area of a pixel.
    max_iterations : int, optional
        Steps after which the method gives up.

    Raises
    ------
    ValueError
        If it does not come to rest.

    References
    ----------
    .. [1] Steihaug, SIAM J. Numer. Anal. 20, 626 (1983).
    .. [2] Nocedal, Wright, Numerical Optimization, 2nd ed., Algorithms 4.1 and 7.2.
    """
    lowest = contact.surface + penetration
    state = _above(displacement.copy(), lowest)
    energy, gradient = contact.evaluate(state, penetration)
    products, relative = 0, math.inf
    for iteration in range(max_iterations):
        model = _linearised(contact, state, gradient, lowest, penetration)
        relative = float(np.max(np.abs(model.gradient))) / contact.largest_tension
        if relative <= tolerance:
            return Equilibrium(state, iteration, products, relative, radius)
        step = _truncated_step(model, radius, forcing=min(_FORCING, math.sqrt(relative)))
        trial = _above(state + step.values, lowest)
        trial_energy, trial_gradient = contact.evaluate(trial, penetration)
        gain = _gain(energy, trial_energy, model.decrease(trial - state))
        products += step.products + 1
        if gain < _POOR:
            radius = _POOR * step.norm
        elif gain > 1 - _POOR and step.at_boundary:
            radius *= 2.0
        if gain >= _ACCEPTED:
            state, energy, gradient = trial, trial_energy, trial_gradient
    raise ValueError(
        f"at penetration {penetration:.6g} the boundary elements did not come to rest in "
        f"{max_iterations} steps (pressure out of balance {relative:.2g} of the largest tension, "
        f"{tolerance:g} asked for); take smaller load steps"
    )


def _above(displacement: Array, lowest: Array) -> Array:
    """A displacement moved, in place, out of the hard wall."""
    inner = displacement[: len(lowest), : len(lowest)]
    np.maximum(inner, lowest, out=inner)
    return displacement


@dataclass(frozen=True, slots=True)
class _Linearised:
    """Quadratic model of the energy where closed surfaces stay closed."""

    contact: HalfSpaceContact
    closed: NDArray[np.bool_]
    gradient: Array
    softening: Array

    def free(self, values: Array) -> Array:
        """Values without, in place, those of closed surfaces."""
        values[: len(self.closed), : len(self.closed)][self.closed] = 0.0
        return values

    def curved(self, step: Array) -> Array:
        """Product of the second derivatives with a step."""
        side = len(self.closed)
        product = self.contact.elastic_pressure(step)
        product[:side, :side] += self.softening * step[:side, :side]
        return product

    def decrease(self, step: Array) -> float:
        """Energy that a step releases."""
        return -float(np.vdot(self.gradient, step) + 0.5 * np.vdot(step, self.curved(step)))


def _linearised(
    contact: HalfSpaceContact, state: Array, gradient: Array, lowest: Array, penetration: float
) -> _Linearised:
    """Model around a state; surfaces that are closed and pressed together stay so."""
    side = contact.n_point
    closed = (state[:side, :side] <= lowest) & (gradient[:side, :side] >= 0)
    model = _Linearised(contact, closed, gradient.copy(), contact.softening(state, penetration))
    model.free(model.gradient)
    return model


def _gain(before: float, after: float, predicted: float) -> float:
    """Decrease of the energy relative to the predicted one; one where both are round-off."""
    if predicted <= 0:
        return -math.inf
    round_off = 10 * np.finfo(float).eps * (1 + abs(before))
    if predicted <= round_off and before - after >= -round_off:
        return 1.0
    return (before - after) / predicted


@dataclass(frozen=True, slots=True)
class _Step:
    """A step within the trust region, its elastic norm, and how it was found."""

    values: Array
    norm: float
    at_boundary: bool
    products: int


def _truncated_step(model: _Linearised, radius: float, forcing: float) -> _Step:
    """Steihaug's conjugate gradients, preconditioned; the norm is that of the preconditioner."""
    step = np.zeros_like(model.gradient)
    residual = model.gradient.copy()
    relaxed = model.free(model.contact.elastic_displacement(residual))
    direction = -relaxed
    power = first = float(np.vdot(residual, relaxed))
    # Products of step and direction in the norm of the preconditioner, by recurrence.
    step_step = step_direction = 0.0
    direction_direction = power
    for count in range(1, _MOST_PRODUCTS + 1):
        product = model.free(model.curved(direction))
        curvature = float(np.vdot(direction, product))
        length = power / curvature if curvature > 0 else math.inf
        reached = step_step + 2 * length * step_direction + length**2 * direction_direction
        if not reached < radius**2:
            root = step_direction**2 + direction_direction * (radius**2 - step_step)
            length = (math.sqrt(root) - step_direction) / direction_direction
            step += length * direction
            return _Step(step, radius, True, count)
        step += length * direction
        residual += length * product
        relaxed = model.free(model.contact.elastic_displacement(residual))
        following = float(np.vdot(residual, relaxed))
        ratio, power = following / power, following
        if power <= forcing**2 * first:
            return _Step(step, math.sqrt(reached), False, count)
        step_step = reached
        step_direction = ratio * (step_direction + length * direction_direction)
        direction_direction = power + ratio**2 * direction_direction
        direction *= ratio
        direction -= relaxed
    return _Step(step, math.sqrt(step_step), False, count)
