"""Factors k of a rough sphere by the law of straight fronts: nothing is adjusted to spheres."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import Estimate, FloatOrArray, normal_estimate
from crackfront.analysis.law import (
    PinningFactor,
    law_value,
    mean_w_loc,
    pinning_factor,
    pinning_factors,
    shipped_law,
    spectral_breadth,
)
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, larkin_length
from crackfront.core.arrays import Array
from crackfront.core.bounds import LENGTH, refuse_outside

if TYPE_CHECKING:
    from crackfront.core.spectrum import Spectrum

_CIRCLE = 0.02
"""Relative error of k by neglecting the curvature of a circle and its period of 13 to 31 springs.

Simulated spheres depart from the law by so much more than straight fronts do (docs/law.md).
"""

_LEAST_ADHESION = 0.02
"""Least work of adhesion of a branch, in units of w_int, where strong disorder leaves none."""


@dataclass(frozen=True, slots=True)
class SphereFactors:
    """Factors k that the law gives for a rough sphere."""

    approach: PinningFactor
    retraction: PinningFactor
    both: Estimate[float]
    """Mean k of the two branches."""
    spring: float
    larkin_length: float
    """L_kappa of the smooth contact, and the Larkin length. (Units: reduced lateral length)"""
    size: float
    """Their ratio g."""

    @property
    def warning(self) -> str:
        """What lies outside of the measured range; empty inside."""
        return self.approach.warning or self.retraction.warning


def sphere_factors(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: float, contact_radius: float
) -> SphereFactors:
    """Factors k of a sphere on a random surface, from the straight front alone.

    The edge of radius a is held as by a spring of the length :func:`crackfront.core.jkr.spring` at
    the work of adhesion of the branch, which k decides: the two are solved together. The kind is
    what the spectrum describes; lengths are reduced lateral ones, e_el is in w_int. ValueError if
    e_el is not between 0 and w_int, or the contact has no radius.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> flat = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
    >>> found = sphere_factors("roughness", flat, elastic_energy=0.05, contact_radius=1.9)
    >>> 2.0 < found.both.value < 2.3
    True
    """
    spring = _spring_of_a_sphere(elastic_energy, contact_radius)
    held = held_factors(kind, spectrum, elastic_energy, spring)
    approach, retraction = _on_a_circle(held.approach), _on_a_circle(held.retraction)
    both = _mean(approach.factor, retraction.factor)
    return replace(held, approach=approach, retraction=retraction, both=both)


def sphere_estimates(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: Array, contact_radius: Array
) -> tuple[Estimate, Array]:
    """Mean factors k of both branches and sizes g, of spheres on surfaces of one shape.

    Arguments are as of :func:`sphere_factors`, e_el and radius of shape (n,), as are the results.
    They are NaN where it raises a ValueError, as of a contact so close to pull-off that nothing
    holds its edge.
    """
    breadth = spectral_breadth(kind, spectrum)
    sizes = np.full((3, elastic_energy.size), np.nan)
    for place, (energy, radius) in enumerate(zip(elastic_energy, contact_radius, strict=True)):
        with contextlib.suppress(ValueError):
            spring = _spring_of_a_sphere(float(energy), float(radius))
            held = _held_sizes(kind, spectrum, float(energy), spring, breadth)
            sizes[:, place] = held.approach, held.retraction, held.smooth
    w_rms = 2 * np.sqrt(np.where(np.isfinite(sizes[0]), elastic_energy, np.nan))
    approach, retraction = (
        _widened_on_a_circle(pinning_factors(w_rms, size, breadth).factor) for size in sizes[:2]
    )
    return _mean(approach, retraction), sizes[2]


def _spring_of_a_sphere(elastic_energy: float, contact_radius: float) -> Callable[[float], float]:
    """Length of the spring that holds the edge of a sphere, by the work of adhesion."""
    if not 0 < elastic_energy < 1:
        raise ValueError(
            f"energy of full conformity is {elastic_energy:.4g} w_int; the factors k need one "
            "between 0 and 1"
        )
    if not 0 < contact_radius < math.inf:
        raise ValueError(f"contact radius is {contact_radius:g}; it must be positive and finite")
    refuse_outside("contact radius", contact_radius, LENGTH)

    def spring(work_of_adhesion: float) -> float:
        return jkr.spring(contact_radius, work_of_adhesion)

    return spring


def held_factors(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    spring: Callable[[float], float],
) -> SphereFactors:
    """Factors k of a front that springs hold, whose length a work of adhesion (w_int) decides.

    The function `spring` returns this length L_kappa (Units: that of the spectrum), and raises a
    ValueError where nothing holds the front. The errors are those of a straight front.
    """
    breadth = spectral_breadth(kind, spectrum)
    held = _held_sizes(kind, spectrum, elastic_energy, spring, breadth)
    w_rms = 2 * math.sqrt(elastic_energy)
    approach, retraction = (
        pinning_factor(w_rms, size, kind, breadth) for size in (held.approach, held.retraction)
    )
    both = _mean(approach.factor, retraction.factor)
    return SphereFactors(approach, retraction, both, held.spring, held.larkin_length, held.smooth)


def _mean(
    approach: Estimate[FloatOrArray], retraction: Estimate[FloatOrArray]
) -> Estimate[FloatOrArray]:
    """Mean of the factors of both branches, whose errors are the same."""
    branches = zip(astuple(approach), astuple(retraction), strict=True)
    return Estimate(*((below + above) / 2 for below, above in branches))


def _on_a_circle(straight: PinningFactor) -> PinningFactor:
    """Factor of a straight front with the additional model error of a circular one."""
    factor = _widened_on_a_circle(straight.factor.each(np.asarray)).each(float)
    model = math.hypot(straight.model, _CIRCLE * factor.value)
    return replace(straight, factor=factor, model=model)


def _widened_on_a_circle(factor: Estimate) -> Estimate:
    """Factors of straight fronts with the additional model error of circular ones."""
    error = np.hypot(factor.standard_error, _CIRCLE * factor.value)
    wider = normal_estimate(factor.value, error)
    # An interval that reaches down to zero still does.
    low = np.where(factor.low == 0, 0.0, np.maximum(wider.low, 0.0))
    return replace(wider, low=low)


class _HeldSizes(NamedTuple):
    """Sizes g of a front that springs hold, and the lengths of which they are the ratio."""

    approach: float
    retraction: float
    smooth: float
    """That without disorder."""
    spring: float
    larkin_length: float
    """L_kappa of the smooth contact, and the Larkin length."""


def _held_sizes(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    spring: Callable[[float], float],
    breadth: float,
) -> _HeldSizes:
    """Sizes g of both branches, as of :func:`held_factors`; ValueError where nothing holds one."""
    w_rms = 2 * math.sqrt(elastic_energy)
    larkin = larkin_length(kind, spectrum, w_rms)
    mean = mean_w_loc(kind, elastic_energy)
    # Contact is lost in retraction at the larger radius, which a refusal names.
    retraction, approach = (
        _branch_size(w_rms, larkin, mean, sign, spring, breadth) for sign in (1, -1)
    )
    smooth = spring(mean)
    return _HeldSizes(approach, retraction, smooth / larkin, smooth, larkin)


def _branch_size(
    w_rms: float,
    larkin: float,
    mean: float,
    sign: int,
    spring: Callable[[float], float],
    breadth: float,
) -> float:
    """G of a branch, whose work of adhesion mean + sign k e_el depends on k itself."""
    coefficients = shipped_law().coefficients

    def adhesion(factor: float) -> float:
        return max(mean + sign * factor * w_rms**2 / 4, _LEAST_ADHESION)

    def excess(factor: float) -> float:
        try:
            size = spring(adhesion(factor)) / larkin
        except ValueError:
            # Towards pull-off nothing holds the edge; whether it is beyond, the root decides.
            size = math.inf
        return float(law_value(coefficients, w_rms, size, breadth)) - factor

    root = float(scipy.optimize.brentq(excess, 0.0, coefficients[0], xtol=1e-6))
    return spring(adhesion(root)) / larkin
