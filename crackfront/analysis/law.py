r"""The law of k for a straight front on springs, by disorder s = w_rms / w_int and size g.

The size is the length of the springs over the Larkin length, g = L_kappa / ell. With
:math:`\gamma = g_{eff}^{-(1-\zeta)}`,
:math:`g_{eff} = g\, (\beta_0 / \beta)^{m_9} / (1 + m_6\, s^{m_7})`,

.. math:: k = \frac{k_0}{(1 + m_4\, s^{m_5} (\beta_0 / \beta)^{m_8})
              (1 + m_1 \gamma + m_2 \gamma^2 + m_3 \gamma^3)} .

In units of the Larkin length, all surfaces have almost the same k at weak disorder. At strong
disorder k falls with s. It falls less for a broader spectrum of w_loc (:func:`spectral_breadth`,
beta).
`python -m studies law fit` fits the coefficients to straight fronts and writes `law.json`.
A sphere is locally such a front (:mod:`crackfront.analysis.law_spheres`).
docs/law.md derives all lengths.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field
from scipy.special import ndtr

from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.core.adhesion import FieldKind, adhesion_order, mean_adhesion
from crackfront.core.arrays import Array
from crackfront.validation import checked_call

if TYPE_CHECKING:
    from crackfront.core.spectrum import Spectrum

FINITE_SIZE_EXPONENT = 0.612
"""1 - zeta, with the roughness exponent zeta = 0.388 of the long-range elastic line [1]_.

.. [1] Rosso, Krauth, Phys. Rev. E 65, 025101 (2002).
"""


class _Coefficients(NamedTuple):
    """Coefficients of the law, numbers or arrays."""

    k_0: Any
    m_1: Any
    m_2: Any
    m_3: Any
    m_4: Any
    m_5: Any
    m_6: Any
    m_7: Any
    m_8: Any
    m_9: Any


COEFFICIENTS = _Coefficients._fields
"""Names of the coefficients of the law, in the order of files and arrays."""

TYPICAL_BREADTH = 1.75
"""Breadth beta_0 of a typical spectrum, assumed if the breadth is unknown."""

LEAST_SIZE = 0.3
"""Smallest g of the fit; the springs pull a smaller front over nearly all of its pinning."""

WEAKEST = 1e-6
"""Rms of w_loc at which the limit of weak disorder is evaluated. (Units: w_int)"""

_NARROWEST = 0.25
"""Breadth of a single wavelength, the smallest possible one. (Units: e-folds of wavevector)"""

_BREADTH_TOLERANCE = 1.25
"""Ratio of breadths outside the measured range up to which the law needs no extra error."""


@dataclass(frozen=True, slots=True)
class Law:
    """The fitted law."""

    coefficients: tuple[float, ...]
    """In the order of :data:`COEFFICIENTS`."""
    covariance: tuple[tuple[float, ...], ...]
    """Statistical covariance of the coefficients and the finite-size exponent, all fitted."""
    model_factor: float
    """Model error of ln k: its standard deviation between surfaces of equal s and g."""
    model_length: float
    """Model error of ln g: its standard deviation between such surfaces."""
    numerical: float
    """Standard error of ln k by the numerics."""
    exponent: tuple[float, float]
    """The finite-size exponent if it is fitted, and its standard error."""
    rms: float
    """Rms relative departure of the measured k from the law, for g above 1."""
    worst: float
    """Largest relative departure of the measured k from the law, for g above 1."""
    disorder: tuple[float, float]
    """Measured range of s."""
    size: tuple[float, float]
    """Measured range of g."""
    breadth: tuple[float, float]
    """Measured range of the breadth."""
    departures: tuple[tuple[float, ...], ...]
    """Departures of the measured k from the law, as rows of :class:`Departure`."""

    def departures_at(self, size: float, breadth: float | None = None) -> list[Departure]:
        """Departures of the fronts with about a size g, and a breadth if it is known."""
        rows = [Departure._make(row) for row in self.departures]
        return [
            row
            for row in rows
            if row.least_size <= size < row.largest_size
            and (breadth is None or row.narrowest <= breadth < row.broadest)
        ]


class Departure(NamedTuple):
    """Relative departure of the measured k from the law, for a group of straight fronts."""

    narrowest: float
    """Least breadth of the spectra."""
    broadest: float
    """Breadth below which the spectra lie."""
    least_size: float
    """Least size g."""
    largest_size: float
    """Size g below which the fronts lie."""
    mean: float
    """Mean of k over the law, less 1."""
    rms: float
    """Rms of k over the law, less 1."""
    fronts: int
    """Number of spectra, amplitudes and springs."""

    @property
    def sentence(self) -> str:
        """Mean and rms departure, and the fronts that they are for, in words."""
        return (
            f"{self.mean:+.1%} in the mean, {self.rms:.1%} rms ({self.fronts} fronts of g "
            f"{self.least_size:.3g} to {self.largest_size:.3g}, breadth {self.narrowest:.3g} to "
            f"{self.broadest:.3g})"
        )


@dataclass(frozen=True, slots=True)
class PinningFactors:
    """Factors k of straight fronts, arrays of one shape."""

    factor: Estimate
    """k with 95% intervals of the statistical, numerical and model errors together."""
    statistical: Array
    """Standard error of k from the measured fronts."""
    numerical: Array
    """Standard error of k from their numerics."""
    model: Array
    """Standard error of k between surfaces of equal disorder and size."""


@dataclass(frozen=True, slots=True)
class PinningFactor:
    """Factor k of a straight front, with a warning if it is extrapolated."""

    factor: Estimate[float]
    """k with the 95% interval of the statistical, numerical and model errors together."""
    statistical: float
    """Standard error of k from the measured fronts."""
    numerical: float
    """Standard error of k from their numerics."""
    model: float
    """Standard error of k between surfaces of equal disorder and size."""
    negative_share: float
    """Part of a Gaussian w_loc that is negative. If it is large, do not trust the linearisation of
    the roughness."""
    warning: str
    """Sentences on numbers outside the measured ranges; empty inside."""


def law_value(
    coefficients: Sequence[float] | Array,
    disorder: ArrayLike,
    size: ArrayLike,
    breadth: ArrayLike = TYPICAL_BREADTH,
    exponent: ArrayLike = FINITE_SIZE_EXPONENT,
) -> Array:
    """Values of k, for arrays of s, g (infinity for the infinite contact) and the breadth.

    The coefficients and the exponent may be arrays too; all arguments broadcast.
    """
    law = _Coefficients(*coefficients)
    s = np.asarray(disorder, dtype=float)
    gamma = effective_size(coefficients, s, size, breadth) ** -np.asarray(exponent)
    narrower = TYPICAL_BREADTH / np.asarray(breadth, dtype=float)
    disorder_term = 1 + law.m_4 * s**law.m_5 * narrower**law.m_8
    with np.errstate(over="ignore"):  # k of a front that is hardly pinned is zero
        size_term = 1 + gamma * np.polyval([law.m_3, law.m_2, law.m_1], gamma)
        return np.asarray(law.k_0 / disorder_term / size_term)


def effective_size(
    coefficients: Sequence[float] | Array,
    disorder: ArrayLike,
    size: ArrayLike,
    breadth: ArrayLike = TYPICAL_BREADTH,
) -> Array:
    """Sizes g_eff of the law, for arrays of s, g and the breadth."""
    law = _Coefficients(*coefficients)
    narrower = TYPICAL_BREADTH / np.asarray(breadth, dtype=float)
    reduction = 1 + law.m_6 * np.asarray(disorder) ** law.m_7
    return np.asarray(size, dtype=float) * narrower**law.m_9 / reduction


def spectral_breadth(kind: FieldKind, spectrum: Spectrum) -> float:
    r"""Breadth of the spectrum of w_loc, in e-folds of the wavevector that share its variance.

    .. math:: \beta = \frac{1}{4} + \frac{1}{\int p^2\, d\ln q}, \quad
              p = \frac{q^2 C_w(q)}{\int q^2 C_w\, d\ln q}

    Waves within a quarter of an e-fold of the wavevector pin a front together. Waves further apart
    pin it separately, each with its part of the variance, as at weaker disorder. `kind` says what
    the spectrum describes.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> round(spectral_breadth("roughness", SelfAffineSpectrum(1.0, 1.0, hurst=1.0)), 3)
    0.917
    """
    shortest, longest = spectrum.short_cutoff, 20 * spectrum.longest_feature
    wavevector = 2 * np.pi / np.geomspace(longest, shortest, 4001)
    # C_w is proportional to q^(2 order) C.
    variance = wavevector ** (2 + 2 * adhesion_order(kind)) * spectrum.density(wavevector)
    step = math.log(longest / shortest) / 4000
    return _NARROWEST + float(step * np.sum(variance) ** 2 / np.sum(variance**2))


def law_slope(
    coefficients: Sequence[float] | Array, disorder: ArrayLike, size: ArrayLike, breadth: ArrayLike
) -> Array:
    """Changes of k with ln g, for arrays of s, g and the breadth."""
    g, step = np.asarray(size, dtype=float), 1e-4
    above = law_value(coefficients, disorder, g * math.exp(step), breadth)
    below = law_value(coefficients, disorder, g * math.exp(-step), breadth)
    return np.asarray((above - below) / (2 * step))


def model_error(
    coefficients: Sequence[float] | Array,
    disorder: ArrayLike,
    size: ArrayLike,
    breadth: ArrayLike,
    model: tuple[float, float],
) -> Array:
    """Standard error of k due to the model errors of ln k and ln g."""
    factor, length = model
    value = law_value(coefficients, disorder, size, breadth)
    return np.hypot(factor * value, length * law_slope(coefficients, disorder, size, breadth))


@functools.cache
def shipped_law() -> Law:
    """The law of `law.json`."""
    text = files("crackfront.analysis").joinpath("law.json").read_text(encoding="utf-8")
    content = json.loads(text)
    return Law(**{item.name: _as_tuples(content[item.name]) for item in fields(Law)})


def _as_tuples(value: Any) -> Any:
    """Copy of a value from JSON with tuples in place of lists."""
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


@checked_call
def pinning_factor(
    w_rms: Annotated[float, Field(gt=0, lt=2)],
    size: Annotated[float, Field(gt=0)],
    kind: FieldKind = "roughness",
    breadth: Annotated[float, Field(ge=_NARROWEST, allow_inf_nan=False)] | None = None,
) -> PinningFactor:
    r"""Factor k of a straight front, by the measured law.

    The pinning force of either branch is k e_el with e_el = w_rms^2 / 4 w_int; by symmetry both
    branches of a straight front have the same k.

    Parameters
    ----------
    w_rms : float
        Rms of the local work of adhesion. (Units: w_int)
    size : float
        g, length of the spring over the Larkin length; infinity for the infinite contact.
    kind : {"roughness", "chemical"}, optional
        Cause of the variations of w_loc. It decides the mean of w_loc, and so `negative_share`.
    breadth : float, optional
        Breadth of the spectrum, by :func:`crackfront.analysis.law.spectral_breadth`. Without it k
        is for a typical spectrum, and the interval covers all breadths.

    Returns
    -------
    PinningFactor
        k with its errors.

    Raises
    ------
    TypeError
        If `w_rms`, `size` or `breadth` is not a number.
    ValueError
        If `w_rms` is not between 0 and 2, `size` is not positive, `breadth` is below 0.25, or
        `kind` is unknown.

    Examples
    --------
    >>> import crackfront as cf
    >>> infinite = cf.pinning_factor(0.4, float("inf"))
    >>> 2.3 < infinite.factor.value < 3.2
    True
    """
    factors = pinning_factors(w_rms, size, breadth)
    sentences = _sentences_outside(
        shipped_law(), w_rms, size, TYPICAL_BREADTH if breadth is None else breadth
    )
    return PinningFactor(
        factor=factors.factor.each(float),
        statistical=float(factors.statistical),
        numerical=float(factors.numerical),
        model=float(factors.model),
        negative_share=float(ndtr(-mean_adhesion(kind, w_rms**2 / 4) / w_rms)),
        warning="; ".join(sentences),
    )


def pinning_factors(
    w_rms: ArrayLike, size: ArrayLike, breadth: ArrayLike | None = None
) -> PinningFactors:
    """Factors k of straight fronts, by the measured law; arrays broadcast.

    Parameters
    ----------
    w_rms : array
        Rms of the local work of adhesion, between 0 and 2. (Units: w_int)
    size : array
        g, as for :func:`pinning_factor`.
    breadth : array, optional
        Breadth of the spectrum. Without it k is for a typical spectrum, and the intervals cover
        all breadths.

    Returns
    -------
    PinningFactors
        k with its errors; NaN if an argument is NaN.

    Examples
    --------
    >>> import numpy as np
    >>> pinning_factors(np.array([0.2, 0.4]), float("inf")).factor.value.round(1).tolist()
    [3.3, 2.9]
    """
    law = shipped_law()
    s, g = np.asarray(w_rms, dtype=float), np.asarray(size, dtype=float)
    beta = np.asarray(TYPICAL_BREADTH if breadth is None else breadth, dtype=float)
    value = law_value(law.coefficients, s, g, beta)
    model = model_error(law.coefficients, s, g, beta, (law.model_factor, law.model_length))
    if breadth is None:
        narrow, broad = (law_value(law.coefficients, s, g, end) for end in law.breadth)
        # Uniform distribution between k of the narrowest and of the broadest spectrum.
        model = np.hypot(model, (broad - narrow) / math.sqrt(12))
    statistical = _statistical_error(
        law,
        lambda coefficients, exponent: law_value(
            coefficients, s[..., None], g[..., None], beta[..., None], exponent
        ),
    )
    numerical = law.numerical * value
    outside = _error_outside(_octaves_outside(law, s, g, beta)) * value
    error = np.sqrt(statistical**2 + numerical**2 + model**2 + outside**2)
    factor = normal_estimate(value, error)
    # Hysteresis begins at the smallest size of the law.
    low = np.where(g < law.size[0], 0.0, np.maximum(factor.low, 0.0))
    return PinningFactors(replace(factor, low=low), statistical, numerical, model)


def infinite_ratio(
    w_rms: ArrayLike, size: ArrayLike, breadth: ArrayLike = TYPICAL_BREADTH
) -> Estimate:
    """Ratios of k in the infinite contact to k at a size, by the law, to extrapolate measured k.

    Arguments are as for :func:`pinning_factors`. NaN below the smallest size of the law.

    Examples
    --------
    >>> ratio = infinite_ratio(0.2, 10.0)
    >>> bool(1.0 < ratio.low < ratio.value < ratio.high < 1.3)
    True
    """
    law = shipped_law()
    s, g, beta = (np.asarray(number, dtype=float) for number in (w_rms, size, breadth))
    finite = law_value(law.coefficients, s, g, beta)
    value = law_value(law.coefficients, s, math.inf, beta) / finite

    def ratio(coefficients: Array, exponent: Array) -> Array:
        disorder, broadness = s[..., None], beta[..., None]
        infinite = law_value(coefficients, disorder, math.inf, broadness, exponent)
        return infinite / law_value(coefficients, disorder, g[..., None], broadness, exponent)

    slope = law_slope(law.coefficients, s, g, beta) / finite
    error = np.hypot(_statistical_error(law, ratio), law.model_length * slope * value)
    return normal_estimate(value, error).where(g >= law.size[0])


def _statistical_error(law: Law, function: Callable[[Array, Array], Array]) -> Array:
    """Standard errors of a function of the coefficients and the exponent, by their covariance.

    The function gets an array of trials for each number; its values have the trials as last axis.
    """
    fitted = np.array([*law.coefficients, FINITE_SIZE_EXPONENT])
    steps = 1e-5 * np.maximum(np.abs(fitted), 1e-3)
    # The first trial is the fit; each of the others shifts one number.
    trials = fitted[:, None] + np.diag(steps, k=1)[:-1]
    values = function(trials[:-1], trials[-1])
    gradient = (values[..., 1:] - values[..., :1]) / steps
    variance = np.sum((gradient @ np.array(law.covariance)) * gradient, axis=-1)
    return np.asarray(np.sqrt(variance))


class _Octaves(NamedTuple):
    """Distances from the measured ranges in octaves, zero inside.

    Weak disorder and large sizes do not count, because the law has the right limits there.
    """

    strong: Array
    """Disorder above the strongest."""
    small: Array
    """Size below the smallest."""
    broad: Array
    """Breadth above the broadest spectrum; zero within a tolerance."""
    narrow: Array
    """Breadth below the narrowest spectrum; zero within a tolerance."""


def _octaves_outside(law: Law, w_rms: ArrayLike, size: ArrayLike, breadth: ArrayLike) -> _Octaves:
    """Distances of arguments from the measured ranges."""
    narrowest, broadest = law.breadth

    def octaves(ratio: ArrayLike, allowed: float = 1.0) -> Array:
        return np.log2(np.where(np.asarray(ratio) > allowed, ratio, 1.0))

    return _Octaves(
        strong=octaves(np.asarray(w_rms) / law.disorder[1]),
        small=octaves(law.size[0] / np.asarray(size)),
        broad=octaves(np.asarray(breadth) / broadest, _BREADTH_TOLERANCE),
        narrow=octaves(narrowest / np.asarray(breadth), _BREADTH_TOLERANCE),
    )


def _error_outside(octaves: _Octaves) -> Array:
    """Additional relative errors outside the measured ranges."""
    strong, broad, narrow = 0.25 * octaves.strong, 0.1 * octaves.broad, 0.1 * octaves.narrow
    small = np.where(octaves.small > 0, 0.5, 0.0)
    return np.asarray(np.sqrt(strong**2 + small**2 + broad**2 + narrow**2))


def _sentences_outside(law: Law, w_rms: float, size: float, breadth: float) -> Iterator[str]:
    """A sentence for each argument outside the measured ranges."""
    octaves = _octaves_outside(law, w_rms, size, breadth)
    extrapolated = ": k is extrapolated and its interval widened"
    if octaves.strong > 0:
        yield (
            f"w_rms {w_rms:.3g} w_int is above the strongest disorder that was measured "
            f"({law.disorder[1]:.3g}){extrapolated}"
        )
    if octaves.small > 0:
        yield (
            f"size g {size:.3g} is below the smallest of the law ({law.size[0]:.3g}), where "
            "hysteresis begins: the interval of k reaches down to zero"
        )
    if octaves.broad > 0:
        yield (
            f"breadth {breadth:.3g} of the spectrum is above the largest that was measured "
            f"({law.breadth[1]:.3g}){extrapolated}"
        )
    if octaves.narrow > 0:
        yield (
            f"breadth {breadth:.3g} of the spectrum is below the smallest that was measured "
            f"({law.breadth[0]:.3g}){extrapolated}"
        )
