"""Factors k of a rough sphere, by the law of straight fronts without any adjustment to spheres."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import Estimate, FloatOrArray, normal_estimate
from crackfront.analysis.law import (
    PinningFactor,
    law_value,
    pinning_factor,
    pinning_factors,
    shipped_law,
    spectral_breadth,
)
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, adhesion_rms, larkin_length, mean_adhesion
from crackfront.core.arrays import Array
from crackfront.core.bounds import LENGTH, check_within

if TYPE_CHECKING:
    from crackfront.core.spectrum import Spectrum

_CIRCLE_ERROR = 0.02
"""Relative error of k because the front is a circle with a period of 13 to 31 springs.

Simulated spheres depart from the law by this much more than straight fronts do (docs/law.md).
"""

_LEAST_ADHESION = 0.02
"""Lower bound of a branch's work of adhesion at strong disorder. (Units: w_int)"""


@dataclass(frozen=True, slots=True)
class SphereFactors:
    """Factors k that the law gives for a rough sphere."""

    approach: PinningFactor
    retraction: PinningFactor
    both: Estimate[float]
    """Mean k of the two branches."""
    spring: float
    """L_kappa of the smooth contact. (Units: reduced lateral length)"""
    larkin_length: float
    """Larkin length. (Units: reduced lateral length)"""
    size: float
    """g, the ratio of these two lengths."""

    @property
    def warning(self) -> str:
        """Sentences on numbers outside the measured ranges; empty inside."""
        return self.approach.warning or self.retraction.warning


def sphere_factors(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    contact_radius: float,
    breadth: float | None = None,
) -> SphereFactors:
    """Factors k of a sphere on a random surface, by the law of the straight front.

    The contact acts on its edge like springs of the length :func:`crackfront.core.jkr.spring`.
    This length depends on the work of adhesion of the branch and therefore on k, so that both are
    solved together.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : Spectrum
        Shape of the spectrum. (Units: reduced lateral length)
    elastic_energy : float
        e_el, between 0 and 1. (Units: w_int)
    contact_radius : float
        Mean radius of the contact. (Units: reduced lateral length)
    breadth : float, optional
        Breadth of the spectrum, if it is known already: computing it takes most of the time.

    Returns
    -------
    SphereFactors
        k of both branches with their errors.

    Raises
    ------
    ValueError
        If e_el or the radius is out of bounds, or the radius is at or below pull-off.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> flat = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
    >>> factors = sphere_factors("roughness", flat, elastic_energy=0.05, contact_radius=1.9)
    >>> 2.0 < factors.both.value < 2.3
    True
    """
    if not 0 < elastic_energy < 1:
        raise ValueError(
            f"energy of full conformity is {elastic_energy:.4g} w_int; the factors k need one "
            "between 0 and 1"
        )
    check_within("contact radius", contact_radius, LENGTH)
    spring_at = functools.partial(jkr.spring, contact_radius)
    sizes = sizes_on_springs(kind, spectrum, elastic_energy, spring_at, breadth)
    if not sizes.is_stable:
        lost = jkr.pull_off_radius(sizes.retraction.work_of_adhesion)
        raise ValueError(
            f"contact radius {contact_radius:g} is at or below pull-off ({lost:.4g}), where the "
            "edge is unstable; enlarge it"
        )
    straight = straight_factors(kind, elastic_energy, sizes)
    approach, retraction = _on_a_circle(straight.approach), _on_a_circle(straight.retraction)
    both = _mean(approach.factor, retraction.factor)
    return replace(straight, approach=approach, retraction=retraction, both=both)


def sphere_estimates(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: Array, contact_radius: Array
) -> tuple[Estimate, Array]:
    """Mean factors k of both branches and sizes g, for several spheres and one spectrum.

    Arguments are as for :func:`sphere_factors`, with e_el, radii and results of the shape (n,).
    Results are NaN where e_el or a radius is out of bounds, and close to pull-off.
    """
    breadth = spectral_breadth(kind, spectrum)
    sizes = np.full((3, elastic_energy.size), np.nan)
    in_bounds = (elastic_energy > 0) & (elastic_energy < 1)
    in_bounds &= (contact_radius >= LENGTH.least) & (contact_radius <= LENGTH.most)
    for place in np.flatnonzero(in_bounds):
        spring_at = functools.partial(jkr.spring, float(contact_radius[place]))
        sphere = sizes_on_springs(kind, spectrum, float(elastic_energy[place]), spring_at, breadth)
        if sphere.is_stable:
            sizes[:, place] = sphere.approach.size, sphere.retraction.size, sphere.smooth
    w_rms = adhesion_rms(np.where(np.isfinite(sizes[0]), elastic_energy, np.nan))
    approach, retraction = (
        _widened_on_a_circle(pinning_factors(w_rms, size, breadth).factor) for size in sizes[:2]
    )
    return _mean(approach, retraction), sizes[2]


class BranchSize(NamedTuple):
    """Size of the front on a branch, at the work of adhesion that follows from its k."""

    work_of_adhesion: float
    """Apparent work of adhesion. (Units: w_int)"""
    size: float
    """Size g; infinite at and below pull-off."""


class SpringSizes(NamedTuple):
    """Sizes g of a front on springs, and the lengths that they are ratios of."""

    approach: BranchSize
    retraction: BranchSize
    smooth: float
    """Size g without hysteresis, at the mean of w_loc."""
    spring: float
    """L_kappa of the smooth contact. (Units: as the spectrum)"""
    larkin_length: float
    """Larkin length. (Units: as the spectrum)"""
    breadth: float
    """Breadth of the spectrum."""

    @property
    def is_stable(self) -> bool:
        """Whether the edge is stable; it is lost first in retraction, where it adheres most."""
        return math.isfinite(self.retraction.size)


def sizes_on_springs(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    spring_at: Callable[[float], float],
    breadth: float | None = None,
) -> SpringSizes:
    """Sizes g of both branches of a front on springs that depend on the work of adhesion.

    `spring_at` returns the length L_kappa of the springs (Units: as the spectrum) at a work of
    adhesion (Units: w_int), infinity where the edge is unstable. A caller with many energies
    states the breadth of the spectrum, which takes time. ValueError if the spectrum is anisotropic.
    """
    if not spectrum.is_isotropic:
        raise ValueError(
            "the spectrum is anisotropic, and the law of k was measured for isotropic ones; "
            "simulate the surface instead"
        )
    if breadth is None:
        breadth = spectral_breadth(kind, spectrum)
    w_rms = adhesion_rms(elastic_energy)
    larkin = larkin_length(kind, spectrum, w_rms)
    mean = mean_adhesion(kind, elastic_energy)
    spring = spring_at(mean)
    return SpringSizes(
        approach=_branch_size(w_rms, larkin, mean, -1, spring_at, breadth),
        retraction=_branch_size(w_rms, larkin, mean, 1, spring_at, breadth),
        smooth=spring / larkin,
        spring=spring,
        larkin_length=larkin,
        breadth=breadth,
    )


def straight_factors(kind: FieldKind, elastic_energy: float, sizes: SpringSizes) -> SphereFactors:
    """Factors k of a straight front of these sizes, which must be stable."""
    w_rms = adhesion_rms(elastic_energy)
    approach, retraction = (
        pinning_factor(w_rms, branch.size, kind, sizes.breadth)
        for branch in (sizes.approach, sizes.retraction)
    )
    return SphereFactors(
        approach,
        retraction,
        both=_mean(approach.factor, retraction.factor),
        spring=sizes.spring,
        larkin_length=sizes.larkin_length,
        size=sizes.smooth,
    )


def _mean(
    approach: Estimate[FloatOrArray], retraction: Estimate[FloatOrArray]
) -> Estimate[FloatOrArray]:
    """Mean factor of both branches; their errors are fully correlated."""
    return Estimate(
        (approach.value + retraction.value) / 2,
        (approach.standard_error + retraction.standard_error) / 2,
        (approach.low + retraction.low) / 2,
        (approach.high + retraction.high) / 2,
    )


def _on_a_circle(straight: PinningFactor) -> PinningFactor:
    """Add the model error of circular fronts to the factor of a straight one."""
    factor = _widened_on_a_circle(straight.factor.each(np.asarray)).each(float)
    model = math.hypot(straight.model, _CIRCLE_ERROR * factor.value)
    return replace(straight, factor=factor, model=model)


def _widened_on_a_circle(factor: Estimate) -> Estimate:
    """Add the model error of circular fronts to factors of straight ones."""
    error = np.hypot(factor.standard_error, _CIRCLE_ERROR * factor.value)
    wider = normal_estimate(factor.value, error)
    # An interval that ends at zero still does.
    low = np.where(factor.low == 0, 0.0, np.maximum(wider.low, 0.0))
    return replace(wider, low=low)


def _branch_size(
    w_rms: float,
    larkin: float,
    mean: float,
    sign: int,
    spring_at: Callable[[float], float],
    breadth: float,
) -> BranchSize:
    """Size of the front on a branch, whose work of adhesion mean + sign k e_el depends on k."""
    coefficients = shipped_law().coefficients

    def adhesion(factor: float) -> float:
        return max(mean + sign * factor * w_rms**2 / 4, _LEAST_ADHESION)

    def excess(factor: float) -> float:
        size = spring_at(adhesion(factor)) / larkin
        return float(law_value(coefficients, w_rms, size, breadth)) - factor

    root = float(scipy.optimize.brentq(excess, 0.0, coefficients[0], xtol=1e-6))
    return BranchSize(adhesion(root), spring_at(adhesion(root)) / larkin)
