r"""The law behind k: of a straight front on springs, by disorder s = w_rms / w_int and size g.

The size is the length of the springs over the Larkin length, g = L_kappa / ell. With
:math:`x = g_s^{-(1-\zeta)}`, :math:`g_s = g / (1 + c\, s^d)`,

.. math:: k = \frac{k_0}{(1 + a\, s^b (\beta_0 / \beta)^e)(1 + A x + B x^2 + C x^3)} .

The Larkin length makes one curve of all surfaces at weak disorder. At strong disorder k falls with
s, the less the broader the spectrum of the slope of w_loc is (:func:`slope_breadth`, beta).
`python -m benchmarks.law` measures `law.csv`, fits the coefficients to it and writes `law.json`.
A sphere is locally such a front (:func:`sphere_factors`): nothing is adjusted to spheres.
docs/law.md derives all lengths.
"""

from __future__ import annotations

import csv
import functools
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.core import jkr
from crackfront.core.adhesion import FieldKind, larkin_length
from crackfront.core.variables import variable
from crackfront.data.bounds import LENGTH, refuse_outside

if TYPE_CHECKING:
    from crackfront.core.spectrum import Spectrum

Array = NDArray[np.float64]

FINITE_SIZE_EXPONENT = 0.612
"""1 - zeta, with zeta = 0.388 of the elastic line of long range [1]_.

.. [1] Rosso, Krauth, Phys. Rev. E 65, 025101 (2002).
"""

COEFFICIENTS = ("k_0", "A", "B", "C", "a", "b", "c", "d", "e")
"""Names of the coefficients of the law, in the order of the files and arrays that hold them."""

_START = (3.9, 0.55, 0.05, 0.1, 1.2, 1.25, 1.8, 1.3, 0.6)

TYPICAL_BREADTH = 1.18
"""Breadth beta_0 in the middle of those of spectra; that of one that is not known."""

_NEAR = 0.8
"""Cells as close in ln g tell their scatter together: few tiles say little of their own."""

_CIRCLE = 0.01
"""Relative error of k as a circle's period, 13 to 31 springs, and its curvature are neglected."""

_LEAST_ADHESION = 0.02
"""Work of adhesion, in units of w_int, of an approach that disorder all but stops."""

LEAST_SIZE = 0.3
"""Smallest g of the fit; below, a front is pulled over nearly all of its pinning."""

WEAKEST = 1e-6
"""Rms of w_loc that stands for the limit of weak disorder. (Units: w_int)"""


@dataclass(frozen=True, slots=True)
class LawCell:
    """One spectrum, amplitude and spring: a row of `law.csv`."""

    spectrum: str = variable("name of the spectrum", "1")
    breadth: float = variable("breadth of the spectrum of the slope of w_loc", "1")
    disorder: float = variable("s, rms of w_loc; 0 where sites are uncorrelated", "w_int")
    size: float = variable("g, length of the springs over the Larkin length", "1")
    realisations: int = variable("tiles", "1")
    approach: float = variable("k_appr", "1")
    retraction: float = variable("k_retr", "1")
    both: float = variable("k, the mean of the two", "1")
    error: float = variable("standard error of k over the tiles", "1")
    numerical_error: float = variable("standard error of k that the numerics leave", "1")
    front_rms: float = variable("rms of the front over the force's correlation length", "1")
    negative_share: float = variable("part of the tile where w_loc is negative", "1")


@dataclass(frozen=True, slots=True)
class Law:
    """The fitted law.

    Attributes
    ----------
    coefficients : tuple of float
        As :data:`COEFFICIENTS` names them.
    covariance : tuple of tuple of float
        Statistical, of the coefficients.
    model_factor, model_length : float
        Model error: standard deviation of ln k, and of ln g, between surfaces of the same s and g.
    numerical : float
        Standard error of ln k that the numerics leave.
    exponent : tuple of float
        The finite-size exponent when left free, and its standard error.
    rms, worst : float
        Departure of the measured k from the law, relative, for g above 1.
    disorder, size, breadth : tuple of float
        Measured ranges of s, g and the breadth.
    """

    coefficients: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    model_factor: float
    model_length: float
    numerical: float
    exponent: tuple[float, float]
    rms: float
    worst: float
    disorder: tuple[float, float]
    size: tuple[float, float]
    breadth: tuple[float, float]


@dataclass(frozen=True, slots=True)
class PinningFactor:
    """Factor k of a straight front, with a sentence where it is not measured.

    Attributes
    ----------
    factor : Estimate of a number
        k with the 95% interval of statistical, numerical and model error together.
    statistical, numerical, model : float
        The three standard errors of k.
    negative_share : float
        Part of a Gaussian w_loc that is negative: where it is large the linearisation of the
        roughness is not to be trusted.
    warning : str
        What lies outside of the measured range; empty inside.
    """

    factor: Estimate[float]
    statistical: float
    numerical: float
    model: float
    negative_share: float
    warning: str


def law_value(
    coefficients: Sequence[float] | Array,
    disorder: ArrayLike,
    size: ArrayLike,
    breadth: ArrayLike = TYPICAL_BREADTH,
    exponent: float = FINITE_SIZE_EXPONENT,
) -> Array:
    """Values of k, for arrays of s, g (infinity for the infinite contact) and the breadth."""
    k_0, *series, a, b, c, d, e = coefficients
    s = np.asarray(disorder, dtype=float)
    x = (np.asarray(size, dtype=float) / (1 + c * s**d)) ** -exponent
    fall = 1 + a * s**b * (TYPICAL_BREADTH / np.asarray(breadth, dtype=float)) ** e
    return np.asarray(k_0 / fall / (1 + x * np.polyval(series[::-1], x)))


def slope_breadth(kind: FieldKind, spectrum: Spectrum) -> float:
    r"""Breadth of the spectrum of the slope of w_loc, integrated along the front.

    .. math:: \beta = \frac{M_2 M_4}{M_3^2}, \quad M_n = \int_0^\infty dq\, q^n C_w(q, 0) ,

    1 for a single wavelength, larger for broader spectra.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : Spectrum
        Its shape.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> round(slope_breadth("roughness", SelfAffineSpectrum(1.0, 1.0, hurst=1.0)), 4)
    1.0417
    """
    order = 1.0 if kind == "roughness" else 0.5
    low, middle, high = (spectrum.mean_square(order + more) for more in (0.0, 0.5, 1.0))
    return low * high / middle**2


def fitted_law(cells: Sequence[LawCell]) -> Law:
    """Law of measured cells, by weighted least squares, from :data:`LEAST_SIZE` on.

    A cell weighs by its own error and the model error together, which is found in the same way as
    the residuals: once with the first guess, then with what they say.
    """
    from scipy.optimize import least_squares

    used = [cell for cell in cells if cell.size >= LEAST_SIZE]
    s, g, breadth, k = (
        np.array([getattr(cell, name) for cell in used])
        for name in ("disorder", "size", "breadth", "both")
    )
    places = s, g, breadth
    error = _pooled_error(g, np.array([cell.error for cell in used]))
    coefficients, model = np.array(_START), (0.03, 0.05)
    for _ in range(4):
        spread = np.hypot(error, _model_error(coefficients, s, g, breadth, model))

        def residuals(trial: Array, spread: Array = spread) -> Array:
            exponent = trial[-1] if trial.size > len(COEFFICIENTS) else FINITE_SIZE_EXPONENT
            values = law_value(trial[: len(COEFFICIENTS)], s, g, breadth, float(exponent))
            return (values - k) / spread

        found = least_squares(residuals, coefficients)
        coefficients = found.x
        model = _likeliest_model(coefficients, places, k, error)
    free = least_squares(residuals, [*coefficients, FINITE_SIZE_EXPONENT])
    relative = law_value(coefficients, s, g, breadth)[g >= 1] / k[g >= 1] - 1
    numerical = [cell.numerical_error / cell.both for cell in used if cell.size >= 1]
    ranges = [(float(values[values > 0].min()), float(values.max())) for values in places]
    return Law(
        coefficients=tuple(coefficients.tolist()),
        covariance=tuple(map(tuple, _covariance(found.jac).tolist())),
        model_factor=model[0],
        model_length=model[1],
        numerical=float(np.sqrt(np.mean(np.square(numerical)))),
        exponent=(float(free.x[-1]), float(np.sqrt(_covariance(free.jac)[-1, -1]))),
        rms=float(np.sqrt(np.mean(relative**2))),
        worst=float(np.max(np.abs(relative))),
        disorder=ranges[0],
        size=(LEAST_SIZE, ranges[1][1]),
        breadth=ranges[2],
    )


def _pooled_error(size: Array, error: Array) -> Array:
    """Standard errors of cells, each by the median square of those of cells of about its size."""
    near = np.abs(np.log(size[:, None] / size)) < _NEAR
    # The median of the squares of normal numbers is 0.455 of their mean.
    return np.array([np.sqrt(np.nanmedian(error[row] ** 2) / 0.455) for row in near])


def _covariance(jacobian: Array) -> Array:
    """Covariance of parameters whose residuals have unit variance."""
    return np.asarray(np.linalg.pinv(jacobian.T @ jacobian))


def _slope(
    coefficients: Sequence[float] | Array, disorder: ArrayLike, size: ArrayLike, breadth: ArrayLike
) -> Array:
    """Change of k with ln g."""
    g, step = np.asarray(size, dtype=float), 1e-4
    one, other = (
        law_value(coefficients, disorder, g * math.exp(sign * step), breadth) for sign in (1, -1)
    )
    return np.asarray((one - other) / (2 * step))


def _model_error(
    coefficients: Sequence[float] | Array,
    disorder: ArrayLike,
    size: ArrayLike,
    breadth: ArrayLike,
    model: tuple[float, float],
) -> Array:
    """Standard error of k by errors of ln k and of ln g."""
    factor, length = model
    value = law_value(coefficients, disorder, size, breadth)
    return np.hypot(factor * value, length * _slope(coefficients, disorder, size, breadth))


def _likeliest_model(
    coefficients: Array, places: tuple[Array, Array, Array], k: Array, error: Array
) -> tuple[float, float]:
    """Model errors that make the residuals likeliest."""
    s, g, breadth = places
    residuals = law_value(coefficients, s, g, breadth) - k
    grid = np.linspace(0.002, 0.15, 75)
    best = (math.inf, 0.0, 0.0)
    for factor in grid:
        for length in grid:
            variance = error**2 + _model_error(coefficients, s, g, breadth, (factor, length)) ** 2
            cost = float(np.sum(np.log(variance) + residuals**2 / variance))
            best = min(best, (cost, float(factor), float(length)))
    return best[1], best[2]


@functools.cache
def shipped_law() -> Law:
    """The law of `law.json`."""
    text = files("crackfront.analysis").joinpath("law.json").read_text(encoding="utf-8")
    content = json.loads(text)
    return Law(**{item.name: _as_tuples(content[item.name]) for item in fields(Law)})


def _as_tuples(value: Any) -> Any:
    """Lists, as JSON has them, as tuples."""
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


@functools.cache
def measured_cells() -> tuple[LawCell, ...]:
    """Rows of `law.csv`."""
    return cells_of(files("crackfront.analysis").joinpath("law.csv").read_text(encoding="utf-8"))


def cells_of(text: str) -> tuple[LawCell, ...]:
    """Rows of the text of a `law.csv`."""
    types: dict[str, type[Any]] = {"str": str, "int": int, "float": float}
    return tuple(
        LawCell(**{item.name: types[str(item.type)](row[item.name]) for item in fields(LawCell)})
        for row in csv.DictReader(text.splitlines())
    )


def pinning_factor(
    w_rms: float, size: float, kind: FieldKind = "roughness", breadth: float | None = None
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
        What makes w_loc vary; decides its mean, and by that the negative share alone.
    breadth : float, optional
        That of the spectrum, as :func:`crackfront.analysis.law.slope_breadth`; of one that is
        broader than any that was measured k is that of the broadest. By default k is that of a
        typical one, and the interval covers the others.

    Returns
    -------
    PinningFactor
        k with its errors.

    Raises
    ------
    ValueError
        If w_rms does not lie between 0 and 2, where e_el is w_int, or the size is not positive.

    Examples
    --------
    >>> import crackfront as cf
    >>> found = cf.pinning_factor(0.4, float("inf"))
    >>> 2.3 < found.factor.value < 3.2
    True
    """
    if not 0 < w_rms < 2:
        raise ValueError(
            f"w_rms is {w_rms:g} w_int; it must lie between 0 and 2, where e_el reaches w_int"
        )
    if not size > 0:
        raise ValueError(f"size g is {size:g}; it must be positive, or inf")
    law = shipped_law()
    place = w_rms, size, TYPICAL_BREADTH if breadth is None else _measured(breadth)
    value = float(law_value(law.coefficients, *place))
    statistical = _statistical_error(
        law, lambda coefficients: float(law_value(coefficients, *place))
    )
    errors = law.model_factor, law.model_length
    model = float(_model_error(law.coefficients, *place, errors))
    if breadth is None:
        ends = [float(law_value(law.coefficients, w_rms, size, end)) for end in law.breadth]
        model = math.hypot(model, (max(ends) - min(ends)) / math.sqrt(12))
    numerical = law.numerical * value
    outside, warning = _outside(law, w_rms, size)
    error = math.hypot(statistical, numerical, model, outside * value)
    found = normal_estimate(value, error)
    low, high = max(found.low, 0.0), found.high
    if size < law.size[0]:
        low = 0.0
    return PinningFactor(
        factor=Estimate(value, error, low, high),
        statistical=statistical,
        numerical=numerical,
        model=model,
        negative_share=float(ndtr(-_mean_adhesion(kind, w_rms**2 / 4) / w_rms)),
        warning=warning,
    )


def _measured(breadth: float) -> float:
    """A breadth, or the largest that was measured."""
    return min(breadth, shipped_law().breadth[1])


def _mean_adhesion(kind: FieldKind, elastic_energy: float) -> float:
    """Mean of w_loc (Units: w_int)."""
    return 1 - elastic_energy if kind == "roughness" else 1.0


def infinite_ratio(w_rms: float, size: float, breadth: float = TYPICAL_BREADTH) -> Estimate[float]:
    """Ratio of k in the infinite contact to k at a size, by the law; it extrapolates measured k.

    Parameters
    ----------
    w_rms : float
        Rms of the local work of adhesion. (Units: w_int)
    size : float
        g; below the smallest of the law the ratio is NaN.
    breadth : float, optional
        That of the spectrum, as :func:`crackfront.analysis.law.slope_breadth`.

    Examples
    --------
    >>> ratio = infinite_ratio(0.2, 10.0)
    >>> 1.0 < ratio.low < ratio.value < ratio.high < 1.3
    True
    """
    law, breadth = shipped_law(), _measured(breadth)
    if not size >= law.size[0]:
        return Estimate(*(math.nan,) * 4)

    def ratio(coefficients: Sequence[float] | Array) -> float:
        infinite, finite = law_value(coefficients, w_rms, np.array([math.inf, size]), breadth)
        return float(infinite / finite)

    value, finite = (
        ratio(law.coefficients),
        float(law_value(law.coefficients, w_rms, size, breadth)),
    )
    value = ratio(law.coefficients)
    finite = float(law_value(law.coefficients, w_rms, size, breadth))
    slope = float(_slope(law.coefficients, w_rms, size, breadth)) / finite
    error = math.hypot(_statistical_error(law, ratio), law.model_length * slope * value)
    return normal_estimate(value, error)


def _statistical_error(law: Law, function: Callable[[Array], float]) -> float:
    """Standard error of a function of the coefficients by their covariance."""
    coefficients = np.array(law.coefficients)
    steps = 1e-5 * np.maximum(np.abs(coefficients), 1e-3)
    value = function(coefficients)
    gradient = np.array(
        [
            (function(coefficients + shift) - value) / step
            for shift, step in zip(np.diag(steps), steps, strict=True)
        ]
    )
    return math.sqrt(float(gradient @ np.array(law.covariance) @ gradient))


def _outside(law: Law, w_rms: float, size: float) -> tuple[float, str]:
    """Additional relative error outside of the measured range, and a sentence that says so."""
    _, strongest = law.disorder
    smallest, _ = law.size
    if w_rms > strongest:
        return 0.25 * math.log2(w_rms / strongest), (
            f"w_rms {w_rms:.3g} w_int is above the strongest disorder that was measured "
            f"({strongest:.3g}): k is extrapolated and its interval widened"
        )
    if size < smallest:
        return 0.5, (
            f"size g {size:.3g} is below the smallest of the law ({smallest:.3g}): hysteresis sets "
            "in there, and the interval of k reaches down to zero"
        )
    return 0.0, ""


@dataclass(frozen=True, slots=True)
class SphereFactors:
    """Factors k that the law gives for a rough sphere.

    Attributes
    ----------
    approach, retraction : PinningFactor
        Of the two branches.
    both : Estimate of a number
        k, the mean of the two.
    spring : float
        L_kappa of the smooth contact. (Units: reduced lateral length)
    larkin_length : float
        (Units: reduced lateral length)
    size : float
        g = spring / larkin_length.
    """

    approach: PinningFactor
    retraction: PinningFactor
    both: Estimate[float]
    spring: float
    larkin_length: float
    size: float

    @property
    def warning(self) -> str:
        """What lies outside of the measured range; empty inside."""
        return self.approach.warning or self.retraction.warning


def sphere_factors(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: float, contact_radius: float
) -> SphereFactors:
    """Factors k of a sphere on a random surface, from the straight front alone.

    The edge of radius a is held as by a spring of the length :func:`crackfront.core.jkr.spring`
    at the work of adhesion of the branch, which k decides: the two are solved together.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : Spectrum
        Shape of the spectrum. (Units: reduced lateral length)
    elastic_energy : float
        e_el / w_int, in (0, 1).
    contact_radius : float
        Radius of the contact. (Units: reduced lateral length)

    Raises
    ------
    ValueError
        If e_el is not between 0 and w_int, or the contact has no radius.

    Examples
    --------
    >>> from crackfront.core.spectrum import SelfAffineSpectrum
    >>> flat = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
    >>> found = sphere_factors("roughness", flat, elastic_energy=0.05, contact_radius=1.9)
    >>> 2.0 < found.both.value < 2.3
    True
    """
    if not 0 < elastic_energy < 1:
        raise ValueError(
            f"energy of full conformity is {elastic_energy:.4g} w_int; the factors k need one "
            "between 0 and 1"
        )
    if not 0 < contact_radius < math.inf:
        raise ValueError(f"contact radius is {contact_radius:g}; it must be positive and finite")
    refuse_outside("contact radius", contact_radius, LENGTH)
    w_rms = 2 * math.sqrt(elastic_energy)
    larkin = larkin_length(kind, spectrum, w_rms)
    mean, breadth = _mean_adhesion(kind, elastic_energy), _measured(slope_breadth(kind, spectrum))
    # Contact is lost in retraction at the larger radius, which a refusal names.
    retraction, approach = (
        pinning_factor(
            w_rms, _branch_size(w_rms, larkin, mean, sign, contact_radius, breadth), kind, breadth
        )
        for sign in (1, -1)
    )
    approach, retraction = _on_a_circle(approach), _on_a_circle(retraction)
    one, other = approach.factor, retraction.factor
    # Errors of the law are the same for both branches.
    both = Estimate(
        *(
            (getattr(one, name) + getattr(other, name)) / 2
            for name in ("value", "standard_error", "low", "high")
        )
    )
    spring = jkr.spring(contact_radius, mean)
    return SphereFactors(approach, retraction, both, spring, larkin, spring / larkin)


def _on_a_circle(found: PinningFactor) -> PinningFactor:
    """Factor of a straight front with the model error of a front that is none."""
    value, low = found.factor.value, found.factor.low
    error = math.hypot(found.factor.standard_error, _CIRCLE * value)
    wider = normal_estimate(value, error)
    factor = replace(wider, low=max(wider.low, 0.0) if low > 0 else 0.0)
    return replace(found, factor=factor, model=math.hypot(found.model, _CIRCLE * value))


def _branch_size(
    w_rms: float, larkin: float, mean: float, sign: int, contact_radius: float, breadth: float
) -> float:
    """G of a branch, whose work of adhesion mean + sign k e_el depends on k itself."""
    from scipy.optimize import brentq

    coefficients = shipped_law().coefficients

    def adhesion(factor: float) -> float:
        return max(mean + sign * factor * w_rms**2 / 4, _LEAST_ADHESION)

    def excess(factor: float) -> float:
        # Towards pull-off nothing holds the edge; whether it is beyond, the root decides.
        held = contact_radius > jkr.pull_off_radius(adhesion(factor))
        size = jkr.spring(contact_radius, adhesion(factor)) / larkin if held else math.inf
        return float(law_value(coefficients, w_rms, size, breadth)) - factor

    root = float(brentq(excess, 0.0, coefficients[0], xtol=1e-6))
    return jkr.spring(contact_radius, adhesion(root)) / larkin
