"""A rough sphere on a half-space that attract each other: energy, gradient and curvature.

Half-space, law of attraction and sphere come from ContactMechanics, Adhesion and SurfaceTopography,
the extra `bem`; only the products with the elastic operators are those of scipy's real FFT.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from crackfront.core import jkr
from crackfront.core.extras import MissingExtraError
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class HalfSpaceContact:
    """A sphere with roughness against an elastic half-space, on a square grid.

    Displacements live on a grid of twice the side, so that the half-space is not periodic; the
    sphere covers its first quadrant, with the apex half a side from the first point.

    Attributes
    ----------
    system : Adhesion.System.BoundedSmoothContactSystem
        The contact as the libraries know it.
    surface : (n_point, n_point) array
        Paraboloid and roughness, positive towards the half-space. (Units: reduced vertical length)
    pixel : float
        Grid spacing. (Units: reduced lateral length)
    interaction_range : float
        Gap g_c at which the attraction ends. (Units: reduced vertical length)
    stiffness, compliance : (2 n_point, n_point + 1) array
        Pressure of a Fourier mode of unit displacement, and its inverse.
        (Units: reduced pressure / vertical length)
    """

    system: Any
    surface: Array
    pixel: float
    interaction_range: float
    stiffness: Array
    compliance: Array

    @property
    def n_point(self) -> int:
        """Points along a side of the sphere's grid."""
        return len(self.surface)

    @property
    def largest_tension(self) -> float:
        """Attraction of closed surfaces, 3 w_int / g_c (Units: reduced pressure)."""
        return 3 * WORK_OF_ADHESION / self.interaction_range

    def elastic_pressure(self, displacement: Array) -> Array:
        """Pressures that a displacement needs, on the doubled grid (Units: reduced pressure)."""
        return _filtered(displacement, self.stiffness)

    def elastic_displacement(self, pressure: Array) -> Array:
        """Displacement that pressures cause, on the doubled grid (Units: reduced vertical)."""
        return _filtered(pressure, self.compliance)

    def gap(self, displacement: Array, penetration: float) -> Array:
        """Gap between the surfaces, on the sphere's grid (Units: reduced vertical length)."""
        side = self.n_point
        return displacement[:side, :side] - (self.surface + penetration)

    def evaluate(self, displacement: Array, penetration: float) -> tuple[float, Array]:
        """Energy of the contact and its gradient.

        Parameters
        ----------
        displacement : (2 n_point, 2 n_point) array
            Displacement into the half-space. (Units: reduced vertical length)
        penetration : float
            Rigid body penetration b. (Units: reduced vertical length)

        Returns
        -------
        float
            Energy per area of a pixel. (Units: reduced pressure * vertical length)
        (2 n_point, 2 n_point) array
            Its derivative in the displacements. (Units: reduced pressure)
        """
        gradient = self.elastic_pressure(displacement)
        energy = 0.5 * float(np.vdot(displacement, gradient))
        attraction, slope, _ = self.system.interaction.evaluate(
            self.gap(displacement, penetration), potential=True, gradient=True
        )
        gradient[: self.n_point, : self.n_point] += slope
        return energy + float(np.sum(attraction)), gradient

    def softening(self, displacement: Array, penetration: float) -> Array:
        """Second derivative of the energy of attraction, on the sphere's grid; never positive.

        (Units: reduced pressure / vertical length)
        """
        gap = self.gap(displacement, penetration)
        return self.system.interaction.evaluate(gap, potential=False, curvature=True)[2]


def half_space_contact(
    roughness: Array, pixel: float, interaction_range: float, max_penetration: float
) -> HalfSpaceContact:
    """Contact of a rough sphere whose attraction is cubic in the gap, with a hard wall.

    Parameters
    ----------
    roughness : (n_point, n_point) array
        Heights on the sphere, zero for a smooth one. (Units: reduced vertical length)
    pixel : float
        Grid spacing. (Units: reduced lateral length)
    interaction_range : float
        Gap g_c at which the attraction ends. (Units: reduced vertical length)
    max_penetration : float
        Largest penetration that the domain must hold. (Units: reduced vertical length)

    Raises
    ------
    ValueError
        If the grid is too coarse for the attraction, the domain too small for the contact, or the
        libraries are missing.

    References
    ----------
    .. [1] Sanner, Pastewka, J. Mech. Phys. Solids (2022), "Crack-front model for adhesion of soft
       elastic spheres with chemical heterogeneity"; Sanner et al., Sci. Adv. (2024), supplement,
       Sec. III.
    """
    refuse_unresolved(pixel, len(roughness), interaction_range, max_penetration)
    libraries = _libraries()
    side = pixel * len(roughness)
    shape, sides = (len(roughness),) * 2, (side, side)
    sphere = libraries.make_sphere(1.0, shape, sides, kind="paraboloid")
    surface = np.asarray(sphere.heights()) + roughness
    topography = libraries.Topography(surface, sides)
    substrate = libraries.FreeFFTElasticHalfSpace(
        shape, CONTACT_MODULUS, sides, check_boundaries=False
    )
    law = libraries.PowerLaw(WORK_OF_ADHESION, interaction_range, 3)
    # The libraries halve the first axis; the operator is that of a square and symmetric.
    compliance = np.ascontiguousarray(np.real(substrate.greens_function).T)
    return HalfSpaceContact(
        system=libraries.BoundedSmoothContactSystem(substrate, law, topography),
        surface=surface,
        pixel=pixel,
        interaction_range=interaction_range,
        stiffness=1 / compliance,
        compliance=compliance,
    )


def refuse_unresolved(
    pixel: float, n_point: int, interaction_range: float, max_penetration: float
) -> None:
    """Raise if the grid is too coarse for the attraction, or the domain too small.

    Parameters
    ----------
    pixel, n_point, interaction_range, max_penetration
        As in :func:`half_space_contact`, the second a number of points.
    """
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
    reach = jkr.equilibrium_radius(max_penetration, _STRONGEST) + _cohesive_margin(
        max_penetration, interaction_range
    )
    if side < 2 * reach:
        raise ValueError(
            f"domain of side {side:.4g} is too small for the contact, whose attraction reaches to "
            f"radius {reach:.3g} at penetration {max_penetration:g}; take a side of "
            f"{math.ceil(20 * reach) / 10:g} or more, or lower max_penetration"
        )


_STRONGEST = 1.2
"""Work of adhesion, in units of w_int, of the largest contact that a domain must hold."""


def _cohesive_margin(penetration: float, interaction_range: float) -> float:
    """Distance from the edge of a smooth contact to where its gap is the range of attraction."""
    radius = jkr.equilibrium_radius(penetration, _STRONGEST)
    distance = radius + np.linspace(0.0, 2.0, 2001)
    gap = jkr.surface_displacement(distance, radius, penetration) - (penetration - distance**2 / 2)
    return float(distance[np.argmax(gap > interaction_range)] - radius)


@dataclass(frozen=True, slots=True)
class _Libraries:
    """What is used of the optional libraries."""

    make_sphere: Any
    Topography: Any
    FreeFFTElasticHalfSpace: Any
    PowerLaw: Any
    BoundedSmoothContactSystem: Any


def _libraries() -> _Libraries:
    """The optional libraries, or a sentence that says how to install them."""
    try:
        from Adhesion.Interactions import PowerLaw
        from Adhesion.System import BoundedSmoothContactSystem
        from ContactMechanics import FreeFFTElasticHalfSpace
        from SurfaceTopography import Topography
        from SurfaceTopography.Special import make_sphere
    except ModuleNotFoundError as error:
        raise MissingExtraError("boundary elements", error, "bem") from error
    return _Libraries(
        make_sphere, Topography, FreeFFTElasticHalfSpace, PowerLaw, BoundedSmoothContactSystem
    )


def _filtered(values: Array, response: Array) -> Array:
    """Values whose Fourier modes are multiplied by a response."""
    modes = rfft2(values)
    modes *= response
    return np.asarray(irfft2(modes, s=values.shape, overwrite_x=True))
