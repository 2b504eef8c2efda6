"""The fit of k, of the exponent, of the midpoint and of the trends of k to a sweep."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtr

from crackfront.analysis.estimate import (
    Estimate,
    combination,
    finite_mean,
    finite_std,
    finite_sum,
    least_squares_slope,
    mean_estimate,
    ratio_or_nan,
    resample_counts,
    student_estimate,
)
from crackfront.analysis.law import WEAKEST, pinning_factor
from crackfront.analysis.powers import power_fit
from crackfront.analysis.result import (
    HALF_WIDTHS,
    CellEstimates,
    ForceDifference,
    LawEstimates,
    SweepFit,
)
from crackfront.analysis.sweep_law import SweepLaw, law_departure
from crackfront.analysis.table import SweepTable
from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array

FEWEST_BOOTSTRAP = 100
"""Smallest number of bootstrap samples; with fewer, standard errors are mostly noise."""

COUNTS_AT_ONCE = 2**23
"""Largest number of bootstrap counts in memory at once: 64 MB."""

_SAME_SIZE = 1e-6
"""Difference of log2 of the correlation lengths up to which two spectra have the same size."""

FIT_DEFINITION = (
    "k of one simulation is (w_retr - w_appr) / (2 e_el) with e_el measured on its tile. k of a "
    "spectrum is the mean over the amplitudes in the range, with equal weights; k of an amplitude "
    "is the mean over its realisations. k depends on disorder and size, so that an average over "
    "amplitudes depends on their weights: equal ones are the same for every spectrum, whatever the "
    "noise. The pooled k is the mean over the spectra. The ratio of sums, sum of hysteresis over "
    "sum of 2 e_el, weighs each amplitude by its e_el; where it differs from k, k is not constant. "
    "The exponent is the slope of log mean hysteresis in log w_rms (measured); the exponent of the "
    "law is the slope of 2 k e_el with the law's k at the same amplitudes. The disorder slope is "
    "the slope of mean k in log2 w_rms. Slopes are by least squares with equal weights, pooled "
    "with one intercept a spectrum. A cell with one realisation, where others have several, is "
    "left out of both slopes, because it lacks a scatter. The midpoint slope m in w_int - (w_retr "
    "+ w_appr)/2 = m e_el (by the law 1 for roughness, 0 for a chemical field) is a ratio of sums, "
    "the best estimator for noise whose variance grows with w_rms^2. The size slope is the slope "
    "of k in log2 of the correlation length among spectra of one shape, with one intercept a "
    "shape; a shape has equal roll_off / short_cutoff and Hurst exponent, and for straight fronts "
    "equal springs in correlation lengths. The law's k is k of a straight front at the measured "
    "w_rms and size g, the length of its springs over the Larkin length. A sphere has the springs "
    "of the smooth contact with the radius in the middle of the steady window; the law was not "
    "fitted to spheres. k of the infinite contact is the measured k times the ratio of the law's k "
    "at infinite g and at g. Intervals are 95%, by Student's t with the standard error of a "
    "bootstrap: realisations of a spectrum are resampled, each with all its amplitudes because "
    "these share their noise, and spectra are independent. Percentiles of the bootstrap would be "
    "far too narrow for so few realisations. The intervals cover the scatter between realisations, "
    "not the differences between spectra. The realisations that an interval of some half-width "
    "needs follow from the present interval by 1/sqrt(n), if further realisations scatter as these "
    "do; numerical bias stays. The powers of k in s and g are from least squares of log k with "
    "equal weights of the cells in the range; the law's powers are from the same cells. The "
    "probability of the midpoint's least likely deviation is the probability that any of all cells "
    "deviates as much, by Student's t, if cells are independent."
)
"""What the numbers of a fit mean; an attribute of every file with them."""


class _Samples(NamedTuple):
    """Quantities of every simulation, (..., n_amplitude, n_realisation), or means of them."""

    energy: Array
    rms: Array
    hysteresis: Array
    depression: Array
    factor: Array
    factor_from_force: Array


class _LawNumbers(NamedTuple):
    """Something of each estimate in `LawEstimates`, such as its value, error or weight."""

    factor: Any
    factor_by_sums: Any
    factor_from_force: Any
    exponent: Any
    midpoint_slope: Any
    disorder_slope: Any


class _Statistics(NamedTuple):
    """Estimates of one spectrum from every bootstrap sample."""

    values: _LawNumbers
    """Arrays (n_sample,)."""
    weights: _LawNumbers
    """Weights of the spectrum where several are pooled, arrays (n_sample,)."""


@dataclass(frozen=True, slots=True)
class _SpectrumFit:
    """Fit of one spectrum."""

    values: _LawNumbers
    standard_errors: _LawNumbers
    """NaN if there is a single realisation."""
    weights: _LawNumbers
    """Weights of the spectrum where several are pooled."""
    factor_draws: Array | None
    """k of the bootstrap samples, (n_sample, n_amplitude); None if there is one realisation."""


def fit_sweep(
    table: SweepTable,
    *,
    lowest_elastic_energy: float,
    highest_elastic_energy: float,
    n_bootstrap: int = 4000,
    seed: int = 0,
    kind: FieldKind = "roughness",
    uncorrelated: bool = False,
    watched: Callable[[list[int]], Iterable[int]] = iter,
) -> SweepFit:
    """Fit k, the exponent, the midpoint and the trends of k, with intervals.

    :data:`FIT_DEFINITION` defines the estimates. Estimates that the data do not determine are NaN,
    and :func:`crackfront.analysis.fit_text.fit_notes` says why.

    Parameters
    ----------
    table : SweepTable
        Works of adhesion of all simulations.
    lowest_elastic_energy, highest_elastic_energy : float
        Range of requested e_el, ends included. (Units: w_int)
    n_bootstrap : int, optional
        Bootstrap samples, :data:`FEWEST_BOOTSTRAP` or more.
    seed : int, optional
        Seed of the bootstrap, on which point estimates do not depend.
    kind : {"roughness", "chemical"}, optional
        The midpoint should be w_int - e_el for roughness, w_int for a chemical field.
    uncorrelated : bool, optional
        Whether the sites of straight fronts are independent: the law's limit of weak disorder.
    watched : callable, optional
        Wraps the numbers of the spectra, for example in a progress bar.

    Returns
    -------
    SweepFit
        Estimates for every spectrum and amplitude, every spectrum, and all spectra together.

    Raises
    ------
    ValueError
        If no simulation in the range has a value.
    """
    in_range = _amplitudes_in_range(table, lowest_elastic_energy, highest_elastic_energy)
    samples = _samples(table)
    chosen = _Samples(*(values[:, in_range] for values in samples))
    n_realisation = np.count_nonzero(np.any(np.isfinite(chosen.factor), axis=1), axis=-1)
    freedom = n_realisation - 1
    fits = _fit_spectra(chosen, n_bootstrap, seed, watched)
    spectra = _spectra_estimates(fits, freedom)
    shares = _pooling_shares(fits)
    pooled = _pooled_estimates(spectra, freedom, shares)
    law = SweepLaw(table, kind, uncorrelated)
    cells = _cell_estimates(samples, 1.0 if kind == "roughness" else 0.0, law)
    n_large, departure = law_departure(cells.factor, cells.law_factor, cells.size)
    largest, probability = _largest_deviation(cells, in_range)
    law_exponent = _law_exponents(cells, in_range)
    powers = power_fit(
        cells.w_rms[:, in_range],
        cells.size[:, in_range],
        cells.factor.value[:, in_range],
        cells.law_factor.value[:, in_range],
        [fit.factor_draws for fit in fits],
        freedom,
    )
    return SweepFit(
        table=table,
        kind=kind,
        lowest_elastic_energy=lowest_elastic_energy,
        highest_elastic_energy=highest_elastic_energy,
        n_bootstrap=n_bootstrap,
        seed=seed,
        uncorrelated=uncorrelated,
        in_range=in_range,
        n_realisation=n_realisation,
        n_failed=np.count_nonzero(~np.isfinite(chosen.factor), axis=(1, 2)),
        cells=cells,
        spectra=spectra,
        pooled=pooled,
        size_slope=_size_slopes(table, cells),
        pooled_size_slope=_size_slope(table, spectra.factor, freedom),
        n_needed=_needed_realisations(spectra.factor, n_realisation),
        pooled_n_needed=_needed_realisations(pooled.factor, np.max(n_realisation)),
        law_exponent=law_exponent,
        pooled_law_exponent=_weighted_mean(law_exponent, shares.exponent),
        powers=powers,
        midpoint_largest=largest,
        midpoint_probability=probability,
        from_force=_force_difference(table, in_range),
        k_0=pinning_factor(WEAKEST, np.inf).factor.each(np.asarray),
        n_large=np.asarray(n_large),
        law_departure=np.asarray(departure),
    )


def _amplitudes_in_range(table: SweepTable, lowest: float, highest: float) -> NDArray[np.bool_]:
    """Amplitudes in a range of requested e_el; ValueError if no simulation there has a value."""
    requested = table.amplitude
    in_range = (requested >= lowest * (1 - 1e-9)) & (requested <= highest * (1 + 1e-9))
    if not np.any(table.finite[:, in_range]):
        raise ValueError(
            f"all {table.finite[:, in_range].size} simulations with e_el from {lowest} to "
            f"{highest} w_int failed; see their status in the dataset"
        )
    return in_range


def _samples(table: SweepTable) -> _Samples:
    """Quantities of every simulation, NaN if it failed."""
    finite = table.finite
    energy = np.where(finite, table.e_el, np.nan)
    w_appr, w_retr = np.where(finite, (table.w_appr, table.w_retr), np.nan)
    return _Samples(
        energy=energy,
        rms=np.where(finite, table.w_rms, np.nan),
        hysteresis=w_retr - w_appr,
        depression=1 - (w_retr + w_appr) / 2,
        factor=(w_retr - w_appr) / (2 * energy),
        factor_from_force=(table.w_retr_from_force - table.w_appr_from_force) / (2 * energy),
    )


def _cell_estimates(samples: _Samples, midpoint_slope: float, law: SweepLaw) -> CellEstimates:
    """Means over the realisations; by the law the midpoint is w_int - midpoint_slope e_el."""
    factor, count = mean_estimate(samples.factor)
    law_factor, size = law.cells()
    return CellEstimates(
        count=count,
        e_el=mean_estimate(samples.energy)[0].value,
        w_rms=mean_estimate(samples.rms)[0].value,
        hysteresis=mean_estimate(samples.hysteresis)[0],
        factor=factor,
        midpoint_deviation=mean_estimate(midpoint_slope * samples.energy - samples.depression)[0],
        size=size,
        law_factor=law_factor,
        infinite_factor=law.infinite(factor, size),
    )


def _fit_spectra(
    samples: _Samples,
    n_bootstrap: int,
    seed: int,
    watched: Callable[[list[int]], Iterable[int]],
) -> list[_SpectrumFit]:
    """Fit of every spectrum, each with an independent stream of random numbers."""
    n_spectrum = samples.factor.shape[0]
    streams = np.random.SeedSequence(seed).spawn(n_spectrum)
    fits = []
    for index in watched([*range(n_spectrum)]):
        spectrum = _Samples(*(quantity[index] for quantity in samples))
        fits.append(_fit_spectrum(spectrum, n_bootstrap, np.random.default_rng(streams[index])))
    return fits


def _fit_spectrum(samples: _Samples, n_bootstrap: int, rng: np.random.Generator) -> _SpectrumFit:
    """Fit of one spectrum from the realisations with a value at any amplitude."""
    present = np.any(np.isfinite(samples.factor), axis=0)
    samples = _Samples(*(quantity[:, present] for quantity in samples))
    n_present = np.count_nonzero(present)
    count = np.count_nonzero(np.isfinite(samples.factor), axis=1)
    # A cell of one realisation lacks a scatter, and so would the intervals of the slopes.
    sloped = count >= min(2, np.max(count, initial=0))
    whole = _statistics(_means(samples, np.ones((1, n_present))), sloped)
    values = _LawNumbers(*(numbers[0] for numbers in whole.values))
    weights = _LawNumbers(
        *(
            weight[0] if np.isfinite(value) else 0.0
            for value, weight in zip(values, whole.weights, strict=True)
        )
    )
    if n_present < 2:
        unknown = _LawNumbers(*(math.nan for _ in values))
        return _SpectrumFit(values, unknown, weights, None)
    resampled = _resampled(samples, n_bootstrap, rng)
    drawn = _statistics(resampled, sloped)
    errors = _LawNumbers(*(float(finite_std(numbers)) for numbers in drawn.values))
    return _SpectrumFit(values, errors, weights, resampled.factor)


def _spectra_estimates(fits: list[_SpectrumFit], freedom: NDArray[np.int64]) -> LawEstimates:
    """Estimates of the spectra, (n_spectrum,), with intervals."""
    values = _by_estimate([fit.values for fit in fits])
    errors = _by_estimate([fit.standard_errors for fit in fits])
    estimates = _LawNumbers(
        *(
            student_estimate(value, error, freedom)
            for value, error in zip(values, errors, strict=True)
        )
    )
    return LawEstimates(**estimates._asdict())


def _by_estimate(spectra: Sequence[_LawNumbers]) -> _LawNumbers:
    """Numbers of all spectra, as a list for each estimate."""
    return _LawNumbers(*map(list, zip(*spectra, strict=True)))


def _pooling_shares(fits: list[_SpectrumFit]) -> _LawNumbers:
    """Shares of the spectra in each pooled estimate, arrays (n_spectrum,)."""
    weights = _by_estimate([fit.weights for fit in fits])
    return _LawNumbers(*(ratio_or_nan(weight, np.sum(weight)) for weight in weights))


def _pooled_estimates(
    spectra: LawEstimates, freedom: NDArray[np.int64], shares: _LawNumbers
) -> LawEstimates:
    """Estimates of all spectra together."""
    return LawEstimates(
        **{
            name: combination(getattr(spectra, name), freedom, share)
            for name, share in shares._asdict().items()
        }
    )


def _resampled(samples: _Samples, n_bootstrap: int, rng: np.random.Generator) -> _Samples:
    """Means of bootstrap samples, in parts that fit into memory."""
    n_realisation = samples.factor.shape[1]
    at_once = max(1, COUNTS_AT_ONCE // n_realisation)
    sizes = [min(at_once, n_bootstrap - first) for first in range(0, n_bootstrap, at_once)]
    parts = [_means(samples, resample_counts(size, n_realisation, rng)) for size in sizes]
    return _Samples(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _means(samples: _Samples, counts: Array) -> _Samples:
    """Means over the realisations of every bootstrap sample, (n_sample, n_amplitude)."""
    means = []
    for quantity in samples:
        finite = np.isfinite(quantity)
        values = np.where(finite, quantity, 0.0)
        means.append(ratio_or_nan(counts @ values.T, counts @ finite.T))
    return _Samples(*means)


def _statistics(means: _Samples, sloped: NDArray[np.bool_]) -> _Statistics:
    """Estimates from the means of every bootstrap sample.

    Slopes use only the amplitudes that are `sloped`.
    """
    doublings = np.where(sloped, np.log2(means.rms), np.nan)
    positive = means.hysteresis > 0
    logarithm = np.log2(means.hysteresis, where=positive, out=np.full(positive.shape, np.nan))
    exponent, exponent_weight = least_squares_slope(doublings, logarithm)
    disorder_slope, slope_weight = least_squares_slope(doublings, means.factor)
    energy, equal = finite_sum(means.energy), np.ones(positive.shape[0])
    values = _LawNumbers(
        factor=finite_mean(means.factor),
        factor_by_sums=ratio_or_nan(finite_sum(means.hysteresis), 2 * energy),
        factor_from_force=finite_mean(means.factor_from_force),
        exponent=exponent,
        midpoint_slope=ratio_or_nan(finite_sum(means.depression), energy),
        disorder_slope=disorder_slope,
    )
    weights = _LawNumbers(
        factor=equal,
        factor_by_sums=energy,
        factor_from_force=equal,
        exponent=exponent_weight,
        midpoint_slope=energy,
        disorder_slope=slope_weight,
    )
    return _Statistics(values, weights)


def _largest_deviation(cells: CellEstimates, in_range: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Largest deviation of a midpoint in standard errors, and its probability by chance."""
    deviation, freedom = cells.midpoint_deviation, cells.count - 1
    tested = (deviation.standard_error > 0) & in_range
    if not np.any(tested):
        return np.array(np.nan), np.array(np.nan)
    scores = np.abs(deviation.value[tested] / deviation.standard_error[tested])
    chances = 2 * stdtr(freedom[tested], -scores)
    least = np.argmin(chances)
    # That any of so many independent cells is as unlikely: 1 - (1 - chance)^n.
    probability = -np.expm1(scores.size * np.log1p(-chances[least]))
    return np.asarray(scores[least]), np.asarray(probability)


def _needed_realisations(factor: Estimate, n_realisation: ArrayLike) -> Array:
    """Realisations for intervals of k of :data:`HALF_WIDTHS`, along the last axis.

    Intervals narrow as 1 / sqrt(n); the present number where they are narrow enough already.
    """
    half_width = np.asarray(factor.high - factor.low)[..., None] / 2
    times = np.maximum((half_width / np.array(HALF_WIDTHS)) ** 2, 1.0)
    return np.asarray(np.ceil(np.asarray(n_realisation)[..., None] * times))


def _law_exponents(cells: CellEstimates, in_range: NDArray[np.bool_]) -> Array:
    """Exponents of the hysteresis in w_rms by the law, (n_spectrum,).

    The amplitudes are the same as for measured exponents: a positive mean hysteresis, and several
    realisations if other amplitudes have them.
    """
    most = np.max(cells.count[:, in_range], axis=1, keepdims=True)
    sloped = in_range & (cells.count >= np.minimum(2, most)) & (cells.hysteresis.value > 0)
    hysteresis = cells.law_factor.value * cells.e_el
    sloped &= hysteresis > 0
    logarithm = np.log2(hysteresis, where=sloped, out=np.full(sloped.shape, np.nan))
    return least_squares_slope(np.log2(cells.w_rms), logarithm)[0]


def _weighted_mean(values: Array, weights: Array) -> Array:
    """Mean of the values that are not NaN."""
    weights = np.where(np.isfinite(values), weights, 0.0)
    return ratio_or_nan(finite_sum(weights * values), np.sum(weights))


def _size_slopes(table: SweepTable, cells: CellEstimates) -> Estimate:
    """Change of k per doubling of the correlation length at every amplitude."""
    slopes = [
        _size_slope(table, cells.factor.at((slice(None), index)), cells.count[:, index] - 1)
        for index in range(table.amplitude.size)
    ]
    return Estimate(*np.transpose([astuple(estimate) for estimate in slopes]))


def _size_slope(table: SweepTable, factor: Estimate, freedom: NDArray[np.int64]) -> Estimate:
    """Change of k per doubling of the correlation length among spectra of one shape."""
    doublings = np.log2(table.correlation_length)
    deviation = np.zeros(doublings.size)
    for index in np.unique(table.family):
        family = (table.family == index) & np.isfinite(factor.value)
        # Equal lengths may differ by round-off.
        if np.any(family) and np.ptp(doublings[family]) > _SAME_SIZE:
            deviation[family] = doublings[family] - np.mean(doublings[family])
    spread = np.sum(deviation**2)
    return combination(factor, freedom, deviation / spread if spread > 0 else np.zeros(1))


def _force_difference(table: SweepTable, in_range: NDArray[np.bool_]) -> ForceDifference:
    """Differences of the experimenter's estimates over the simulations in the range."""
    shape = table.spectrum.size, -1
    approach = (table.w_appr_from_force - table.w_appr)[:, in_range].reshape(shape)
    retraction = (table.w_retr_from_force - table.w_retr)[:, in_range].reshape(shape)
    return ForceDifference(
        approach=finite_mean(approach),
        approach_largest=np.fmax.reduce(np.abs(approach), axis=-1),  # ignores NaN
        retraction=finite_mean(retraction),
        retraction_largest=np.fmax.reduce(np.abs(retraction), axis=-1),
    )
