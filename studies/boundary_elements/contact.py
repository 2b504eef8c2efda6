"""A rough sphere on a half-space that attract each other, and how it comes to rest.

Half-space, law of attraction and sphere come from ContactMechanics, Adhesion and SurfaceTopography,
the extra `bem`; only the products with the elastic operators use scipy's real FFT.

The nearest stable state is found as by NuMPI's `tr_newton_bounded` (a trust region, Steihaug's
conjugate gradients on the free variables, projection on the bounds), but with the elastic operator
as the measure of a step and as the preconditioner: the number of products hardly depends on the
grid. No step may jump over a barrier of the energy, and no state is one of negative curvature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

Values = TypeVar("Values", NDArray[np.float64], NDArray[np.float32])
"""In the precision of what they are made from."""

_STRONGEST = 1.2
"""Work of adhesion, in units of w_int, of the largest contact that must fit into a domain."""

_ACCEPTED = 0.1
"""Least gain of a step that is taken, relative to the gain that the model predicts."""

_POOR = 0.25
"""Gain, relative to the predicted one, below which the trust radius shrinks to this share."""

_FORCING = 0.3
"""Largest residual of the conjugate gradients, relative to their start."""

_MOST_PRODUCTS = 200
"""Largest number of products with the elastic operator in a step."""

_ROUND_OFF = 10 * float(np.finfo(float).eps)
"""Changes of the energy that are meaningless, relative to it."""

_PROBED = 1e-2
"""Residual, relative to its start, to which the curvature of a state is probed."""


@dataclass(frozen=True, slots=True)
class HalfSpaceContact:
    """A sphere with roughness against an elastic half-space, on a square grid.

    Displacements live on a grid of twice the side, so that the half-space is not periodic; the
    sphere covers its first quadrant, with the apex half a side from the first point.
    """

    system: Any  # Adhesion.System.BoundedSmoothContactSystem, the contact as the libraries know it
    surface: Array  # (n_point, n_point) paraboloid and roughness, positive towards the half-space
    pixel: float  # grid spacing (reduced lateral length)
    interaction_range: float  # gap g_c at which the attraction ends (reduced vertical length)
    stiffness: Array  # (2 n_point, n_point + 1) pressure of a mode of unit displacement
    compliance: Array  # its inverse

    @property
    def n_point(self) -> int:
        """Points along a side of the sphere's grid."""
        return len(self.surface)

    @property
    def largest_tension(self) -> float:
        """Attraction of closed surfaces, 3 w_int / g_c (Units: reduced pressure)."""
        return 3 * WORK_OF_ADHESION / self.interaction_range

    def elastic_pressure(self, displacement: Values) -> Values:
        """Pressures that a displacement needs, on the doubled grid (Units: reduced pressure)."""
        return _filtered(displacement, self.stiffness)

    def elastic_displacement(self, pressure: Values) -> Values:
        """Displacement that pressures cause, on the doubled grid (Units: reduced vertical)."""
        return _filtered(pressure, self.compliance)

    def gap(self, displacement: Array, penetration: float) -> Array:
        """Gap between the surfaces, on the sphere's grid (Units: reduced vertical length)."""
        side = self.n_point
        return displacement[:side, :side] - (self.surface + penetration)

    def evaluate(
        self, displacement: Array, penetration: float, elastic: Array | None = None
    ) -> tuple[float, Array]:
        """Energy per area of a pixel, and its derivative; `elastic` saves a product."""
        pressure = self.elastic_pressure(displacement) if elastic is None else elastic
        gradient = pressure.copy()
        energy = 0.5 * float(np.vdot(displacement, gradient))
        gap = self.gap(displacement, penetration)
        attraction, slope, _ = self.system.interaction.evaluate(gap, potential=True, gradient=True)
        gradient[: self.n_point, : self.n_point] += slope
        return energy + float(np.sum(attraction)), gradient

    def softening(self, displacement: Array, penetration: float) -> Array:
        """Second derivative of the energy of attraction, on the sphere's grid; never positive."""
        gap = self.gap(displacement, penetration)
        return self.system.interaction.evaluate(gap, potential=False, curvature=True)[2]


def half_space_contact(
    roughness: Array, pixel: float, interaction_range: float, max_penetration: float
) -> HalfSpaceContact:
    """Contact of a rough sphere whose attraction is cubic in the gap, with a hard wall.

    The roughness is (n_point, n_point) heights on the sphere, the penetration the largest whose
    contact must fit into the domain. (Units: reduced vertical length) A ValueError says if the
    grid is too coarse for the attraction, or the domain too small for the contact.

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. III.
    """
    check_resolution(pixel, len(roughness), interaction_range, max_penetration)
    from Adhesion.Interactions import PowerLaw
    from Adhesion.System import BoundedSmoothContactSystem
    from ContactMechanics import FreeFFTElasticHalfSpace
    from SurfaceTopography import Topography
    from SurfaceTopography.Special import make_sphere

    side = pixel * len(roughness)
    shape, sides = (len(roughness),) * 2, (side, side)
    sphere = make_sphere(1.0, shape, sides, kind="paraboloid")
    surface = np.asarray(sphere.heights()) + roughness
    substrate = FreeFFTElasticHalfSpace(shape, CONTACT_MODULUS, sides, check_boundaries=False)
    law = PowerLaw(WORK_OF_ADHESION, interaction_range, 3)
    # The libraries halve the first axis; the operator belongs to a square and is symmetric.
    compliance = np.ascontiguousarray(np.real(substrate.greens_function).T)
    return HalfSpaceContact(
        system=BoundedSmoothContactSystem(substrate, law, Topography(surface, sides)),
        surface=surface,
        pixel=pixel,
        interaction_range=interaction_range,
        stiffness=1 / compliance,
        compliance=compliance,
    )


def check_resolution(
    pixel: float, n_point: int, interaction_range: float, max_penetration: float
) -> None:
    """Raise if a grid is too coarse for the attraction, or its domain too small."""
    largest = 2 * (interaction_range / 3) ** 2
    side = pixel * n_point
    if not pixel <= largest * (1 + 1e-12):
        finest = math.ceil(side / largest * (1 - 1e-12))
        range_needed = 3 * math.sqrt(pixel / 2)
        raise ValueError(
            f"pixel is {pixel:.4g}; an attraction of range {interaction_range:g} needs "
            f"2 (g_c / 3)^2 = {largest:.4g} or less, so take n_point {finest} or more, or "
            f"interaction_range {math.ceil(1000 * range_needed) / 1000:g} or more"
        )
    reach = _attraction_radius(max_penetration, interaction_range)
    if side < 2 * reach:
        raise ValueError(
            f"domain of side {side:.4g} is too small for the contact, whose attraction reaches to "
            f"radius {reach:.3g} at penetration {max_penetration:g}; take a side of "
            f"{math.ceil(20 * reach) / 10:g} or more, or lower max_penetration"
        )


def _attraction_radius(penetration: float, interaction_range: float) -> float:
    """Radius at which the gap of a smooth contact is the range of attraction."""
    radius = jkr.equilibrium_radius(penetration, _STRONGEST)
    distance = radius + np.linspace(0.0, 2.0, 2001)
    gap = jkr.surface_displacement(distance, radius, penetration) - (penetration - distance**2 / 2)
    return float(distance[np.argmax(gap > interaction_range)])


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """A stable state of the contact."""

    displacement: Array  # into the half-space, (2 n_point, 2 n_point) (reduced vertical length)
    products: int  # of conjugate gradients
    residual: float  # largest pressure out of balance, relative to the largest tension
    radius: float  # trust radius for the next load step
    energy: float  # per area of a pixel (reduced pressure * vertical length)
    released: float  # how far it fell at this penetration; it never rises
    barriers: int  # steps that were shortened before a rise of the energy
    saddles: int  # unstable states without forces that were left


def equilibrium(
    contact: HalfSpaceContact,
    displacement: Array,
    penetration: float,
    *,
    tolerance: float,
    radius: float,
    max_iterations: int = 500,
) -> Equilibrium:
    """State in which a contact comes to rest from a (2 n_point, 2 n_point) displacement.

    The tolerance is the largest pressure out of balance that may be left, relative to the largest
    tension; the trust radius of the first step is the root of twice its elastic energy per area of
    a pixel. A ValueError says if the contact does not come to rest in `max_iterations` steps.

    References
    ----------
    .. [1] Nocedal, Wright, Numerical Optimization, 2nd ed., Algorithms 4.1 and 7.2 (Steihaug).
    """
    lowest = contact.surface + penetration
    state = _trial(contact, _above(displacement.copy(), lowest), penetration)
    first_energy, relative = state.energy, math.inf
    products = barriers = saddles = 0
    for _ in range(max_iterations):
        model = _linearised(contact, state, penetration)
        relative = float(np.max(np.abs(model.gradient))) / contact.largest_tension
        if relative > tolerance:
            step = _truncated_step(model, radius, forcing=min(_FORCING, math.sqrt(relative)))
            products += step.products
        else:
            step = _downward_step(model, radius)
            products += step.products
            if model.decrease(step.values) <= state.round_off:
                return Equilibrium(
                    displacement=state.displacement,
                    products=products,
                    residual=relative,
                    radius=radius,
                    energy=state.energy,
                    released=first_energy - state.energy,
                    barriers=barriers,
                    saddles=saddles,
                )
            saddles += 1
        trial = _trial(contact, _above(state.displacement + step.values, lowest), penetration)
        products += 1
        gain = _gain(state, trial, model.decrease(trial.displacement - state.displacement))
        if gain >= _ACCEPTED and _passes_barrier(contact, state, trial, penetration):
            barriers += 1
            gain = -math.inf
        radius = _trust_radius(radius, step, gain)
        if gain >= _ACCEPTED:
            state = trial
    raise ValueError(
        f"at penetration {penetration:.6g} the boundary elements did not come to rest in "
        f"{max_iterations} steps (pressure out of balance {relative:.2g} of the largest tension, "
        f"{tolerance:g} asked for); take smaller load steps"
    )


@dataclass(frozen=True, slots=True)
class _State:
    """A displacement with its elastic pressures, energy and derivative of the energy."""

    displacement: Array
    elastic: Array
    energy: float
    gradient: Array

    @property
    def round_off(self) -> float:
        """Change of the energy that is meaningless."""
        return _ROUND_OFF * (1 + abs(self.energy))


def _trial(contact: HalfSpaceContact, displacement: Array, penetration: float) -> _State:
    """State of a displacement at a penetration."""
    elastic = contact.elastic_pressure(displacement)
    return _State(displacement, elastic, *contact.evaluate(displacement, penetration, elastic))


def _trust_radius(radius: float, step: _Step, gain: float) -> float:
    """Trust radius after a step: smaller after a poor one, larger after a good one at its end."""
    if gain < _POOR:
        return _POOR * step.norm
    if gain > 1 - _POOR and step.at_boundary:
        return 2.0 * radius
    return radius


def _passes_barrier(
    contact: HalfSpaceContact, state: _State, trial: _State, penetration: float
) -> bool:
    """Whether the energy rises on the way to a trial, by itself and its gradient halfway."""
    middle = (state.displacement + trial.displacement) / 2
    elastic = (state.elastic + trial.elastic) / 2
    energy, gradient = contact.evaluate(middle, penetration, elastic)
    climbing = float(np.vdot(gradient, trial.displacement - state.displacement)) > 0
    return energy > state.energy + state.round_off or (
        climbing and trial.energy < energy - state.round_off
    )


def _above(displacement: Array, lowest: Array) -> Array:
    """A displacement moved, in place, out of the hard wall."""
    inner = displacement[: len(lowest), : len(lowest)]
    np.maximum(inner, lowest, out=inner)
    return displacement


@dataclass(frozen=True, slots=True)
class _Linearised:
    """Quadratic model of the energy; surfaces that are closed and pressed together stay so."""

    contact: HalfSpaceContact
    closed: NDArray[np.bool_]
    gradient: Array
    softening: Array

    def free(self, values: Values) -> Values:
        """Values with zeros, in place, where the surfaces are closed."""
        values[: len(self.closed), : len(self.closed)][self.closed] = 0.0
        return values

    def curved(self, step: Values) -> Values:
        """Product of the second derivatives with a step."""
        side = len(self.closed)
        product = self.contact.elastic_pressure(step)
        product[:side, :side] += self.softening * step[:side, :side]
        return product

    def decrease(self, step: NDArray[np.floating[Any]]) -> float:
        """Energy that a step releases, its second order in single precision."""
        curved = self.curved(step.astype(np.float32))
        return -float(np.vdot(self.gradient, step) + 0.5 * np.vdot(step, curved))


def _linearised(contact: HalfSpaceContact, state: _State, penetration: float) -> _Linearised:
    """Quadratic model of the energy at a state."""
    side, lowest = contact.n_point, contact.surface + penetration
    touching = state.displacement[:side, :side] <= lowest
    closed = touching & (state.gradient[:side, :side] >= 0)
    softening = contact.softening(state.displacement, penetration)
    model = _Linearised(contact, closed, state.gradient.copy(), softening)
    model.free(model.gradient)
    return model


def _gain(state: _State, trial: _State, predicted: float) -> float:
    """Decrease of the energy relative to the predicted one; one if both are round-off."""
    if predicted <= 0:
        return -math.inf
    decrease = state.energy - trial.energy
    if predicted <= state.round_off and decrease >= -state.round_off:
        return 1.0
    return decrease / predicted


@dataclass(frozen=True, slots=True)
class _Step:
    """A step within the trust region, and its elastic norm."""

    values: NDArray[np.float32]
    norm: float
    at_boundary: bool
    products: int


def _truncated_step(model: _Linearised, radius: float, forcing: float) -> _Step:
    """Steihaug's conjugate gradients in single precision, in the preconditioner's norm."""
    residual = model.gradient.astype(np.float32)
    step = np.zeros_like(residual)
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


def _downward_step(model: _Linearised, radius: float) -> _Step:
    """Step along a direction of negative curvature, or none where no curvature is negative."""
    side = len(model.closed)
    # Forces where surfaces attract each other: elsewhere only the half-space has a curvature.
    residual = np.zeros_like(model.gradient, dtype=np.float32)
    noise = np.random.default_rng(0).standard_normal((side, side))
    residual[:side, :side] = model.softening * noise
    model.free(residual)
    relaxed = model.free(model.contact.elastic_displacement(residual))
    direction = -relaxed
    power = first = float(np.vdot(residual, relaxed))
    for count in range(1, _MOST_PRODUCTS + 1):
        if power <= _PROBED**2 * first:
            break
        product = model.free(model.curved(direction))
        curvature = float(np.vdot(direction, product))
        if curvature < 0:
            down = -1.0 if float(np.vdot(model.gradient, direction)) > 0 else 1.0
            stretch = float(np.vdot(direction, model.contact.elastic_pressure(direction)))
            return _Step(down * radius / math.sqrt(stretch) * direction, radius, True, count)
        residual += power / curvature * product
        relaxed = model.free(model.contact.elastic_displacement(residual))
        following = float(np.vdot(residual, relaxed))
        ratio, power = following / power, following
        direction *= ratio
        direction -= relaxed
    return _Step(np.zeros_like(direction), 0.0, False, count)


def _filtered(values: Values, response: Array) -> Values:
    """Values whose Fourier modes are multiplied by a response."""
    modes = rfft2(values)
    modes *= response.astype(values.dtype, copy=False)
    return np.asarray(irfft2(modes, s=values.shape, overwrite_x=True))
