r"""A sphere: the front is a closed line around its apex, and its rays are radii.

Per angle, with the penetration b as the load (supplement, Sec. I D),

.. math:: a\, w_{loc}(a, \theta) = a\, G_{JKR}(b, a) + w_{int} (-\Delta_\theta)^{1/2} a .
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
import scipy
from scipy.fft import irfft, rfft

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.arrays import Array
from crackfront.core.compiled import implements
from crackfront.core.field.fields import (
    Interpolation,
    RayField,
    TileField,
    check_field_values,
    tile_field,
)
from crackfront.core.geometry import base
from crackfront.core.geometry.base import fast_site_count
from crackfront.core.outcome import Direction, Relaxation, Status
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, AREA, FORCE, LATERAL, VERTICAL, Variable, variable

Value = TypeVar("Value", float, Array)

RING = CONTACT_MODULUS / (2 * np.pi)
"""Factor of (a^2 - b)^2 in a G_JKR."""


@dataclass(frozen=True)
class ContactState(Generic[Value]):
    """A metastable contact, or all of a cycle, one entry a state."""

    load_noun: ClassVar[str] = "penetration"
    branch_names: ClassVar[Mapping[int, str]] = {1: "approach", -1: "retraction"}
    front_name: ClassVar[str] = "radius"

    penetration: Value = variable("rigid body penetration", VERTICAL)
    direction: Value = variable("+1 in approach, -1 in retraction", "1")
    mean_radius: Value = variable("mean radius of the front", LATERAL)
    min_radius: Value = variable("smallest radius of the front", LATERAL)
    max_radius: Value = variable("largest radius of the front", LATERAL)
    rms_radius: Value = variable("rms deviation of the radius from its mean", LATERAL)
    force: Value = variable("normal force, positive where it pushes", FORCE)
    contact_area: Value = variable("area within the front", AREA)
    apparent_work_of_adhesion: Value = variable("mean of a G over mean of a", ADHESION)
    least_travel: Value = variable("smallest way of a site since its branch began", LATERAL)
    iterations: Value = variable("sweeps of the solver", "1")
    updates: Value = variable("updates of single sites by the solver", "1")
    residual: Value = variable("largest force along the motion, per front length", ADHESION)

    @property
    def summary(self) -> str:
        """One state in words."""
        return (
            f"penetration {self.penetration:+.4f}, force {self.force:+.4f}, "
            f"radius {self.mean_radius:.4f}, rms {self.rms_radius:.4f}"
        )

    def forces_summary(self, status: Status) -> str:
        """First force and pull-off force, in words.

        At penetration 0 the first force is the jump-in force. The pull-off force is known if
        contact was lost.
        """
        began = "jump-in" if np.ravel(self.penetration)[0] == 0 else "first"
        forces = f"{began} force {np.ravel(self.force)[0]:.4g}"
        if status is Status.LOST_CONTACT:
            forces += f", pull-off force {np.min(self.force):.4g}"
        return f"{forces} (pi w_int R)"


class Sphere(NamedTuple):
    """The contact of a sphere.

    Attributes
    ----------
    cosine, sine : (n_site,) array
        Directions of the rays.
    """

    cosine: Array
    sine: Array

    @property
    def n_site(self) -> int:
        """Number of rays; a single one is a circle, without line elasticity."""
        return self.cosine.size

    @property
    def perimeter(self) -> float:
        """The whole angle, since forces are per angle (Units: rad)."""
        return 2 * np.pi

    @property
    def state_type(self) -> type[ContactState[Array]]:
        """Record of a contact."""
        return ContactState

    @property
    def sites(self) -> Array:
        """Angles of the rays (Units: rad)."""
        return _angles(self.n_site)

    @property
    def variables(self) -> tuple[Variable, Variable]:
        """Radii of a front, and the angles of its sites."""
        angle = Variable("angle", ("angle",), "rad", "angle of a site of the front")
        return Variable(ContactState.front_name, ("angle",), LATERAL, "front"), angle

    def state(
        self, relaxation: Relaxation, load: float, direction: Direction, turn: Array
    ) -> ContactState[float]:
        """Quantities that are recorded of a front in equilibrium."""
        front = relaxation.front
        release = front * jkr.energy_release_rate(front, load)
        return ContactState(
            penetration=load,
            direction=direction,
            mean_radius=float(np.mean(front)),
            min_radius=float(np.min(front)),
            max_radius=float(np.max(front)),
            rms_radius=float(np.std(front)),
            force=float(np.mean(jkr.force(front, load))),
            contact_area=float(np.pi * np.mean(front**2)),
            apparent_work_of_adhesion=float(np.mean(release) / np.mean(front) / WORK_OF_ADHESION),
            least_travel=float(np.min(np.abs(front - turn))),
            iterations=relaxation.sweeps,
            updates=relaxation.updates,
            residual=relaxation.residual,
        )

    def stored_energy(self, front: Array, load: float) -> float:
        """Energy of the rings of a smooth sphere and of the line (Units: reduced energy)."""
        # No energy is released or stored where an edge in compression advances.
        open_edge = np.maximum(front, math.sqrt(max(load, 0.0)))
        return float(np.mean(jkr.stored_energy(open_edge, load))) + line_energy(front)

    def can_rest_inside(self, place: float, product: float, load: float) -> bool:
        """Whether a smooth contact of that work of adhesion has an equilibrium within a radius."""
        radius = np.linspace(0, place, 201)[1:]
        ring = RING * np.maximum(radius**2 - load, 0.0) ** 2
        return bool(np.any(radius * (product / place) >= ring))


def sphere(n_site: int) -> Sphere:
    """Sphere whose front has sites at equally spaced angles."""
    angle = _angles(n_site)
    return Sphere(np.cos(angle), np.sin(angle))


def _angles(n_site: int) -> Array:
    """Equally spaced angles, the first 0."""
    return 2 * np.pi * np.arange(n_site) / n_site


def polar_field(
    radii: Array, work_of_adhesion: Array, interpolation: Interpolation = "linear"
) -> RayField:
    """Field from samples on rays at equally spaced angles.

    Parameters
    ----------
    radii : (n_sample,) array
        Increasing radii. A leading zero is dropped: the product vanishes there.
        (Units: reduced lateral length)
    work_of_adhesion : (n_sample, n_site) or (n_sample,) array
        Local work of adhesion; on rings, where it depends on the radius alone, one ray is enough.
        (Units: reduced energy / area, w_int = 1/pi)
    interpolation : {"linear", "cubic"}, optional
        Radius times work of adhesion between the samples of a ray: straight, or a cubic spline
        through all of them.

    Returns
    -------
    RayField
        Field whose front has `n_site` sites; a single one is a circle, without line elasticity.

    Raises
    ------
    ValueError
        If shapes disagree, radii do not increase or are negative, fewer than two samples, or two
        or three angles are given, or a value is not finite.
    """
    radii = np.asarray(radii, dtype=float)
    values = np.asarray(work_of_adhesion, dtype=float)
    if radii.ndim != 1 or values.ndim not in (1, 2) or values.shape[0] != radii.size:
        raise ValueError(
            f"work of adhesion has shape {values.shape} for {radii.size} radii; it must be "
            "(radius, angle), or (radius) for rings"
        )
    if not np.all(np.isfinite(radii)) or np.any(np.diff(radii) <= 0) or np.any(radii < 0):
        raise ValueError("radii must be finite, not negative and strictly increasing; sort them")
    check_field_values(values, names=("radius", "angle")[: values.ndim])
    rays = np.atleast_2d(values.T)
    if radii[0] == 0:
        radii, rays = radii[1:], rays[:, 1:]
    if radii.size < 2 or len(rays) in (0, 2, 3):
        raise ValueError(
            f"field has {radii.size} positive radii and {len(rays)} angles; at least 2 radii and "
            "4 angles are needed, or 1 angle for rings"
        )
    products = np.ascontiguousarray(radii * rays)
    slopes = _spline_slopes(radii, products) if interpolation == "cubic" else np.empty((0, 0))
    return RayField(sphere(len(rays)), radii.copy(), products, slopes)


def _spline_slopes(radii: Array, products: Array) -> Array:
    """Slopes of the splines of all rays, (n_site, n_sample), at their samples."""
    # Ray by ray: the coefficients of all rays at once need seven times the memory.
    slopes = np.empty_like(products)
    for slope, product in zip(slopes, products, strict=True):
        slope[:] = scipy.interpolate.CubicSpline(radii, product)(radii, 1)
    return slopes


def contact_field(
    adhesion: AdhesionMap,
    max_penetration: float,
    n_site: int | None = None,
    spacing: float | None = None,
    interpolation: Interpolation = "cubic",
    *,
    band_limited: bool = False,
) -> TileField:
    """Field of a sphere on a tile, which no front can leave up to a penetration.

    Fronts do not pass each other, so that a front stays inside the circle in equilibrium with the
    tile's largest work of adhesion; a tenth more allows for the overshoot of the splines between
    the points.

    Parameters
    ----------
    adhesion : AdhesionMap
        Work of adhesion on the tile, which may be smaller than the contact.
    max_penetration : float
        Largest penetration. (Units: reduced vertical length)
    n_site : int, optional
        Sites of the front; by default at least one a pixel on the smooth contact's largest circle.
    spacing : float, optional
        Distance of samples along a ray; by default half a pixel, or a quarter where straight
        pieces join the samples. (Units: reduced lateral length)
    interpolation, band_limited
        As of :func:`crackfront.core.field.fields.tile_field`.

    Raises
    ------
    ValueError
        If the penetration is below pull-off, or as :func:`crackfront.core.field.fields.tile_field`.
    """
    if n_site is None:
        circle = 2 * math.pi * jkr.equilibrium_radius(max_penetration)
        n_site = fast_site_count(circle / adhesion.pixel)
    if spacing is None:
        spacing = adhesion.pixel / (2 if interpolation == "cubic" else 4)
    values = adhesion.work_of_adhesion
    # tile_field raises an error, with the place, if values are not finite.
    strongest = float(np.max(values, where=np.isfinite(values), initial=WORK_OF_ADHESION))
    largest = 1.1 * jkr.equilibrium_radius(max_penetration, strongest / WORK_OF_ADHESION)
    return tile_field(
        adhesion, sphere(n_site), spacing, largest, interpolation, band_limited=band_limited
    )


def half_laplacian(radius: Array) -> Array:
    r"""Half-Laplacian of a front in its angle.

    .. math:: (-\Delta_\theta)^{1/2} a = \sum_n |n| \tilde a_n e^{i n \theta}

    Parameters
    ----------
    radius : (n_site,) array
        Radius at equally spaced angles. (Units: length)

    Returns
    -------
    (n_site,) array
        Generalised curvature; it has zero mean. (Units: length)

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. I D.

    Examples
    --------
    >>> angle = 2 * np.pi * np.arange(8) / 8
    >>> bool(np.allclose(half_laplacian(np.cos(3 * angle)), 3 * np.cos(3 * angle)))
    True
    """
    modes = rfft(radius)
    return np.asarray(irfft(np.arange(modes.size) * modes, n=radius.size))


def line_energy(radius: Array) -> float:
    r"""Energy that distorts the front out of its circle, pi w_int sum_n |n| |a_n|^2.

    Parameters
    ----------
    radius : (n_site,) array
        Radius at equally spaced angles. (Units: reduced lateral length)

    Returns
    -------
    float
        Energy; its gradient is w_int times the half-Laplacian. (Units: reduced energy)
    """
    product = radius * half_laplacian(radius)
    return float(np.pi * WORK_OF_ADHESION * np.mean(product))


@implements(base.restoring_force, Sphere)
def _ring_force(geometry: Any, place: float, load: float) -> float:
    """A G_JKR of an open edge, zero where the edge is in compression."""
    opening = place * place - load
    return RING * opening * opening if opening > 0.0 else 0.0


@implements(base.restoring_slope, Sphere)
def _ring_slope(geometry: Any, place: float, load: float) -> float:
    """Derivative of the convex a G_JKR by the radius."""
    opening = place * place - load
    return 4 * RING * place * opening if opening > 0.0 else 0.0


@implements(base.lowest_place, Sphere)
def _lowest(geometry: Any, load: float) -> float:
    """Radius within which the edge is in compression, a^2 < b, so that no front rests."""
    return np.sqrt(max(load, 0.0))


@implements(base.mode_stiffness, Sphere)
def _stiffness(geometry: Any, mode: float) -> float:
    """w_int times the number of the mode, as of the half-Laplacian in the angle."""
    return WORK_OF_ADHESION * mode


@implements(base.weight, Sphere)
def _radius(geometry: Any, place: float) -> float:
    """Weight of the work of adhesion, the radius: forces are per angle."""
    return place


@implements(base.weight_slope, Sphere)
def _unit_slope(geometry: Any) -> float:
    """Derivative of the weight by the radius."""
    return 1.0


@implements(base.ray_start, Sphere)
def _apex(geometry: Any, ray: int, n_x: int, n_y: int, inverse_pixel: float) -> Any:
    """Centre of the tile, above which the apex is."""
    return 0.5 * n_x, 0.5 * n_y


@implements(base.ray_direction, Sphere)
def _direction(geometry: Any, ray: int) -> Any:
    """Unit vector at the angle of the ray."""
    return geometry.cosine[ray], geometry.sine[ray]
