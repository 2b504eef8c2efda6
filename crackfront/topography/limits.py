"""Where the theory applies, and by how much a surface is inside."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from crackfront.analysis.factors import Factors
from crackfront.topography.measures import Surface
from crackfront.topography.prediction import Prediction

_MOST_MISFIT = 3.0
_MOST_ANISOTROPY = 1.25
_MOST_UNMEASURED = 0.1
"""Chi-squared per degree of freedom, ratio of slopes and part of e_el from which on it is said."""


@dataclass(frozen=True, slots=True)
class Limit:
    """A condition of the theory.

    Attributes
    ----------
    condition : str
        What must hold, in words.
    value, largest : float
        What was found and what it must stay below; SI units.
    units : str
        Their units.
    """

    condition: str
    value: float
    largest: float
    units: str

    @property
    def margin(self) -> float:
        """Largest allowed value over the value; above 1 inside."""
        return self.largest / self.value

    @property
    def holds(self) -> bool:
        """Whether the condition holds."""
        return self.value < self.largest


def theory_limits(surface: Surface, prediction: Prediction) -> tuple[Limit, ...]:
    """Conditions of the theory for a surface under a sphere.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    prediction : Prediction
        What is predicted for it.
    """
    _, half, slope = surface.measures
    return (
        Limit(
            "full conformity: e_el below w_int",
            prediction.e_el,
            prediction.work_of_adhesion,
            "J/m2",
        ),
        Limit("small slopes: rms slope below 1", slope.rms.value, 1.0, "1"),
        Limit(
            "features small against the contact: the longest wave that matters to e_el below the "
            "radius at zero load",
            half.longest,
            prediction.contact_radius,
            "m",
        ),
    )


def prediction_notes(surface: Surface, prediction: Prediction, factors: Factors) -> tuple[str, ...]:
    """What a reader of a prediction must know, one sentence each.

    Parameters
    ----------
    surface : Surface
        The measured surface.
    prediction : Prediction
        What is predicted for it.
    factors : Factors
        Factors k that the prediction uses.
    """
    return (*surface_notes(surface, prediction.contact_radius), *_factor_notes(factors, prediction))


def surface_notes(surface: Surface, contact_radius: float | None = None) -> Iterator[str]:
    """Treatments and doubts of the measurements.

    Parameters
    ----------
    surface : Surface
        The measured surface.
    contact_radius : float, optional
        Radius of the contact, which scans are held against. (Units: m)
    """
    fitted = surface.fitted
    for item, ratio in zip(surface.measurements, surface.anisotropy, strict=True):
        if item.missing > 0:
            yield f"{item.path}: {item.missing:.2%} of the points were missing and interpolated."
        if item.is_line:
            yield (
                f"{item.path} is a line scan: its density is fitted by the projection of an "
                "isotropic surface."
            )
        elif max(item.pixels) > 1.001 * min(item.pixels):
            yield f"{item.path}: the pixels are oblong; its density covers what both sides resolve."
        if max(ratio, 1 / ratio) > _MOST_ANISOTROPY:
            yield (
                f"{item.path}: the rms slope along x is {ratio:.2g} times that along y; the theory "
                "is for isotropic surfaces."
            )
        if contact_radius is not None and min(item.size) < 2 * contact_radius:
            yield (
                f"{item.path} is smaller than the contact ({1e6 * min(item.size):.3g} um against "
                f"{2e6 * contact_radius:.3g} um across): it stands for the whole surface by its "
                "spectrum."
            )
    if not fitted.has_roll_off:
        yield (
            "The density shows no plateau within the trusted wavelengths: the roll-off stands near "
            "their longest, and longer waves may add to e_el; add a larger scan."
        )
    if fitted.misfit > _MOST_MISFIT:
        yield (
            f"The self-affine spectrum misses the densities by {fitted.misfit:.1f} in chi-squared "
            "per degree of freedom, and the uncertainties are widened accordingly; look at the "
            "figure."
        )
    if surface.unmeasured_share > _MOST_UNMEASURED:
        yield (
            "Waves shorter than can be trusted are left out: two more decades of the power law "
            f"would add {surface.unmeasured_share:.0%} to e_el; add a finer scan."
        )


def _factor_notes(factors: Factors, prediction: Prediction) -> Iterator[str]:
    """Where the factors come from, and where they are weak."""
    used = ", ".join(
        f"{name} {weight:.0%}"
        for name, weight in zip(factors.spectra, factors.weights, strict=True)
        if weight >= 0.05
    )
    yield (
        f"k is interpolated from simulated spectra ({used}); its interval holds how far they miss "
        "each other."
    )
    if factors.near_onset:
        yield (
            "The disorder is near the onset of hysteresis for a contact of this size, where k "
            "falls towards zero with e_el; there may be no hysteresis at all."
        )
    if factors.amplitude_octaves < 0:
        yield (
            f"e_el is {2**-factors.amplitude_octaves:.2g} times below the weakest disorder that "
            "was simulated: k is that of the weakest, and its interval reaches down to zero."
        )
    if factors.amplitude_octaves > 0:
        yield (
            f"e_el is {2**factors.amplitude_octaves:.2g} times above the strongest disorder that "
            "was simulated: k is that of the strongest, and its interval is widened by the trend."
        )
    if factors.size_octaves:
        outside = "longer" if factors.size_octaves > 0 else "shorter"
        yield (
            "The correlation length relative to the contact is "
            f"{2 ** abs(factors.size_octaves):.2g} times {outside} than any that was simulated: k "
            "follows the trend of the spectra, and its interval is widened by as much."
        )
    if prediction.w_appr <= 0:
        yield (
            "w_appr is not positive: the sphere is not drawn into contact, it has to be pressed on."
        )
