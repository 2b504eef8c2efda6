"""The fit as a page of Markdown: tables, and notes of one sentence each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import MISSING, Estimate, finite_mean, with_error, with_interval
from crackfront.analysis.finding import (
    PAPER_FACTOR,
    PERTURBATION_FACTOR,
    departure_of_spheres,
    finding,
)
from crackfront.analysis.law import LEAST_SIZE
from crackfront.analysis.result import HALF_WIDTHS, LawEstimates, SweepFit
from crackfront.core.arrays import Array
from crackfront.core.words import counted, wrapped

ONSET = 0.5
"""Ratio of k to the largest k of its spectrum below which hysteresis has not set in."""

_REACH_OF_TWO = 13
"""Standard errors on each side of a 95% interval by Student's t with one degree of freedom."""

MEASURED_ON = "it was measured on Gaussian surfaces of isotropic spectra"
"""What the law of k covers."""

_FACTORS = "factor", "factor_by_sums"
"""Estimates of k in the table of the law."""

_SLOPES = "midpoint_slope", "disorder_slope"
"""Estimates after the exponents in the table of the law."""


def fit_table(fit: SweepFit) -> str:
    """The whole page: the result, tables of the fit with the theory, and notes."""
    in_range = int(np.count_nonzero(fit.in_range))
    blocks = [
        fit_result(fit),
        finding(_law_agreement(fit)),
        "## The fit",
        f"Range: e_el/w_int from {fit.lowest_elastic_energy:g} to "
        f"{fit.highest_elastic_energy:g} ({in_range} of {fit.in_range.size} amplitudes); "
        f"{_n_simulation(fit)} simulations, {int(np.sum(fit.n_failed))} without a value. "
        "Values with 95% intervals (Student's t with the bootstrap's standard error, "
        f"{fit.n_bootstrap} samples of realisations). k is the mean over the amplitudes with "
        "equal weights. A pooled k is followed by the range of the spectra and by the largest "
        "numerical bias, which its interval does not include.",
        _law_table(fit),
        _midpoint_sentence(fit),
        "## k at every amplitude",
        "Mean and standard error over the realisations (their number); amplitudes outside the "
        "range of the fit in parentheses.",
        _cell_table(fit),
        "## k by the law of docs/law.md",
        "k of the straight front at the same disorder and size g, without any adjustment to this "
        "sweep; and the measured k, extrapolated by the law to the infinite contact if g is "
        f"{LEAST_SIZE:g} or more. In the limit of weak disorder the infinite contact has "
        f"k_0 = {with_interval(fit.k_0)} on every surface.",
        _sizes_table(fit),
        _powers_sentence(fit),
        "## What an experimenter would find",
        "Work of adhesion from a JKR fit of force against mean radius, minus the front's work of "
        "adhesion (in w_int): mean, and largest magnitude in one simulation.",
        _force_table(fit),
        "## Notes",
        "\n".join(f"- {sentence}" for sentence in fit_notes(fit)),
    ]
    return "\n\n".join(blocks) + "\n"


def fit_result(fit: SweepFit) -> str:
    """The result in a few lines of Markdown: k, k by the law, and the exponent."""
    compared = fit.in_range & np.isfinite(fit.cells.factor.value)
    law = finite_mean(np.where(compared, fit.cells.law_factor.value, np.nan))
    mean = float(finite_mean(law))
    pooled = f"{mean:.2f}" if np.isfinite(mean) else MISSING
    by_law = "; ".join([pooled + _covered_words(fit), *_range_of(law)])
    return wrapped(
        f"# Hysteresis: w_retr, w_appr = {_mean_adhesion(fit)} ± k e_el\n\n"
        f"- k of this sweep ({_used_simulations(fit)}): {_pooled_entry(fit, 'factor')}\n"
        f"{_needed_line(fit)}"
        f"- k by the law: {by_law}; k of the paper: {PAPER_FACTOR:g}\n"
        f"- exponent of w_rms: {_exponent_entry(fit)}\n"
        f"- exponent by the law: {_law_exponent_entry(fit)}; of the paper: 2\n"
        "- by the law, k falls with disorder and rises with the size of the contact; k = 3 and the "
        "exponent 2 are special cases (docs/law.md)"
    )


def _needed_line(fit: SweepFit) -> str:
    """Line on the realisations that narrower intervals of k need; empty without an interval."""
    half_width = float(fit.pooled.factor.high - fit.pooled.factor.low) / 2
    if not np.isfinite(half_width):
        return ""
    present = int(np.max(fit.n_realisation))
    needed = [
        f"±{width:g} needs about {number:.0f}"
        for width, number in zip(HALF_WIDTHS, fit.pooled_n_needed, strict=True)
        if width < float(f"{half_width:.1g}")  # narrower also as it is printed
    ]
    further = f"; {', '.join(needed)}" if needed else ""
    spectra = f"{counted(present, 'realisation')} of each spectrum"
    return f"- 95% interval of this k: ±{half_width:.2g} with {spectra}{further}\n"


def _exponent_entry(fit: SweepFit) -> str:
    """Pooled exponent with its interval, and the range of the spectra."""
    spectra = _range_of(fit.spectra.exponent.value)
    return "; ".join([with_interval(fit.pooled.exponent), *spectra])


def _law_exponent_entry(fit: SweepFit) -> str:
    """Pooled exponent by the law, and the range of the spectra."""
    pooled = float(fit.pooled_law_exponent)
    if not np.isfinite(pooled):
        return MISSING + _covered_words(fit)
    return "; ".join([f"{pooled:.2f}{_covered_words(fit)}", *_range_of(fit.law_exponent)])


def _names(fit: SweepFit, *, covered: bool) -> list[str]:
    """Names of the spectra that the law of k covers, or of the others."""
    table = fit.table
    return [
        str(name) for index, name in enumerate(table.spectrum) if table.is_covered(index) == covered
    ]


def _covered_words(fit: SweepFit) -> str:
    """Which spectra a number by the law is for; empty if the law covers all."""
    if not _names(fit, covered=False):
        return ""
    if names := _names(fit, covered=True):
        return f" (of {', '.join(names)} alone)"
    return " (the law covers no spectrum of this sweep)"


def _used_simulations(fit: SweepFit) -> str:
    """How many simulations are in the range of the fit, and the range if that is not all."""
    used, total = _n_simulation(fit), fit.table.e_el.size
    if used == total:
        return counted(total, "simulation")
    low, high = fit.lowest_elastic_energy, fit.highest_elastic_energy
    return f"{used} of {total} simulations, e_el/w_int from {low:g} to {high:g}"


def _n_simulation(fit: SweepFit) -> int:
    """Number of simulations in the range of a fit."""
    return int(np.count_nonzero(fit.in_range)) * fit.table.e_el[:, 0].size


def _law_table(fit: SweepFit) -> str:
    """Table of the law: every spectrum, pooled, and theory."""
    header = (
        "spectrum | correlation length | realisations | k | k, ratio of sums | exponent of w_rms "
        "| exponent by the law | midpoint slope m | change of k per doubling of w_rms"
    )
    lengths, counts = fit.table.correlation_length, fit.n_realisation
    rows = []
    for index, spectrum in enumerate(fit.table.spectrum):
        by_law = float(fit.law_exponent[index])
        rows.append(
            [
                str(spectrum),
                f"{lengths[index]:.3g}",
                str(counts[index]),
                *_estimate_entries(fit.spectra, (*_FACTORS, "exponent"), index),
                f"{by_law:.2f}" if np.isfinite(by_law) else MISSING,
                *_estimate_entries(fit.spectra, _SLOPES, index),
            ]
        )
    pooled = [_pooled_entry(fit, name) for name in _FACTORS]
    pooled += [_exponent_entry(fit), _law_exponent_entry(fit)]
    pooled += _estimate_entries(fit.pooled, _SLOPES, ())
    law = "2", "2", "1" if fit.kind == "roughness" else "0", "0"
    rows += [
        ["**pooled**", "", str(np.sum(counts)), *pooled],
        ["paper", "", "", *[f"{PAPER_FACTOR:g}"] * 2, *law],
        ["2nd-order perturbation theory", "", "", *[f"{PERTURBATION_FACTOR:g}"] * 2, *law],
    ]
    return _markdown(header.split(" | "), rows)


def _estimate_entries(law: LawEstimates, names: Sequence[str], index: Any) -> list[str]:
    """Estimates of one spectrum, or pooled ones with the index (), as entries of a table."""
    return [with_interval(getattr(law, name).at(index)) for name in names]


def _pooled_entry(fit: SweepFit, name: str) -> str:
    """Pooled k with its interval, the range of the spectra and the numerical bias."""
    pooled = with_interval(getattr(fit.pooled, name))
    return "; ".join([pooled, *pooled_limits(fit, getattr(fit.spectra, name))])


def pooled_limits(fit: SweepFit, spectra: Estimate) -> tuple[str, ...]:
    """Range of the spectra and numerical bias of a pooled k, which its interval leaves out."""
    bias = _largest_numerical_error(fit)
    limits = _range_of(spectra.value)
    if bias is None:
        return limits
    return (*limits, f"numerical bias up to {bias.error:.2f}{_covered_words(fit)}")


def _range_of(values: Array) -> tuple[str, ...]:
    """Range of a quantity of the spectra, if there are at least two."""
    finite = values[np.isfinite(values)]
    return (f"spectra {finite.min():.2f} to {finite.max():.2f}",) if finite.size > 1 else ()


def _cell_table(fit: SweepFit) -> str:
    """Table of k at every amplitude, and of its trend with size if there is one."""
    header, rows = ["e_el/w_int", *map(str, fit.table.spectrum)], []
    for index, energy in enumerate(fit.table.amplitude):
        cells = (_cell(fit, spectrum, index) for spectrum in range(fit.table.spectrum.size))
        rows.append([f"{energy:.4g}" if fit.in_range[index] else f"({energy:.4g})", *cells])
    if np.any(np.isfinite(fit.size_slope.value)):
        header.append("change of k per doubling of the correlation length")
        for index, row in enumerate(rows):
            row.append(with_interval(fit.size_slope.at(index)))
        blank = [""] * fit.table.spectrum.size
        rows.append(["mean over the range", *blank, with_interval(fit.pooled_size_slope)])
    return _markdown(header, rows)


def _sizes_table(fit: SweepFit) -> str:
    """Table of measured k and k by the law at every spectrum and amplitude."""
    header = ("spectrum", "e_el/w_int", "g", "k, measured", "k, law", "k, infinite contact")
    cells, rows = fit.cells, []
    for cell in np.ndindex(cells.size.shape):
        size = cells.size[cell]
        name, energy = fit.table.spectrum[cell[0]], fit.table.amplitude[cell[1]]
        estimates = cells.factor, cells.law_factor, cells.infinite_factor
        factors = (with_interval(estimate.at(cell)) for estimate in estimates)
        size_text = f"{size:.2g}" if np.isfinite(size) else MISSING
        rows.append((str(name), f"{energy:.4g}", size_text, *factors))
    return _markdown(header, rows)


def _powers_sentence(fit: SweepFit) -> str:
    """The fit of k in disorder and size."""
    powers = fit.powers
    if not np.isfinite(powers.factor.value):
        return (
            "The cells in the range do not span disorder and size, so that k cannot be fitted in "
            "both."
        )
    return (
        f"k of the cells in the range follows k_m (s / {powers.disorder:.3g})^a "
        f"(g / {powers.size:.3g})^b with k_m = {with_interval(powers.factor)}, "
        f"a = {with_interval(powers.disorder_power)} and b = {with_interval(powers.size_power)}; "
        f"the law has a = {powers.law_disorder_power:.2f} and b = {powers.law_size_power:.2f} at "
        "the same cells."
    )


def _cell(fit: SweepFit, spectrum: int, amplitude: int) -> str:
    """Mean k, standard error and number of realisations of one cell."""
    place = spectrum, amplitude
    count, factor = fit.cells.count[place], fit.cells.factor.at(place).each(float)
    if count < 2:
        return f"{factor.value:.2f} (1)" if count else MISSING
    return f"{with_error(factor.value, factor.standard_error)} ({count})"


def _midpoint_sentence(fit: SweepFit) -> str:
    """How well the midpoints agree with the mean of w_loc."""
    chance = float(fit.midpoint_probability)
    if not np.isfinite(fit.midpoint_largest):
        return "Without standard errors, midpoints cannot be compared with the mean of w_loc."
    probability = f"{chance:.2g}" if chance >= 0.001 else "below 0.001"
    return (
        f"The least likely deviation of a midpoint (w_retr + w_appr)/2 from {_mean_adhesion(fit)}, "
        f"among all spectra and amplitudes in the range, is {fit.midpoint_largest:.2g} standard "
        f"errors; if the law is exact, the probability of one as unlikely is {probability}."
    )


def _mean_adhesion(fit: SweepFit) -> str:
    """Mean of w_loc in words."""
    return "w_int - e_el" if fit.kind == "roughness" else "w_int"


def _force_table(fit: SweepFit) -> str:
    """Table of the differences of the experimenter's estimates."""
    header = "spectrum; w_appr, mean; w_appr, largest; w_retr, mean; w_retr, largest; k from force"
    differences = np.transpose(astuple(fit.from_force))
    rows = []
    for index, name in enumerate(fit.table.spectrum):
        row = differences[index]
        numbers = [f"{value:.4f}" if np.isfinite(value) else MISSING for value in row]
        rows.append((str(name), *numbers, with_interval(fit.spectra.factor_from_force.at(index))))
    pooled = _pooled_entry(fit, "factor_from_force")
    return _markdown(header.split("; "), [*rows, ("**pooled**", "", "", "", "", pooled)])


def _markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = (header, ["---"] * len(header), *rows)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def fit_notes(fit: SweepFit) -> tuple[str, ...]:
    """Sentences on trends of k, differences between spectra, gaps and failures."""
    return (
        trend_sentence(fit),
        *_uncovered_sentences(fit),
        *_spread_sentences(fit),
        *_onset_sentences(fit),
        *_gap_sentences(fit),
        *_exponent_sentences(fit),
        *_realisation_sentences(fit),
        *_numerical_sentences(fit),
    )


def trend_sentence(fit: SweepFit) -> str:
    """Sentence on the dependence of k on disorder and size, as far as the sweep resolves it."""
    disorder = _trend_text(fit.pooled.disorder_slope, "per doubling of w_rms within a spectrum")
    size = _trend_text(
        fit.pooled_size_slope, "per doubling of the correlation length among spectra of one shape"
    )
    disorder = disorder or "its trend with w_rms needs two amplitudes"
    size = size or "its trend with size needs two spectra of one shape and different lengths"
    return (
        "k depends on disorder and size and is not a constant, so each k of a spectrum is an "
        f"average over the stated range: {disorder}; {size}."
    )


def _law_agreement(fit: SweepFit) -> str:
    """Agreement of this sweep with the law, as the end of the finding."""
    if not np.any(np.isfinite(fit.cells.law_factor.value)):
        return "; this sweep cannot test it, because it does not cover the spectra"
    if not fit.n_large:
        return "; this sweep cannot test it, because g is below 1 everywhere"
    counts = int(fit.n_large), fit.cells.size.size
    if not fit.table.on_springs:
        return departure_of_spheres(float(fit.law_departure), *counts, "the spheres of this sweep")
    return (
        f". For the {counts[0]} of {counts[1]} spectrum-amplitude pairs of this sweep with g > 1, "
        f"k agrees with it to {fit.law_departure:.1%} rms"
    )


def _trend_text(trend: Estimate, unit: str) -> str:
    """A trend in words; empty if it is NaN."""
    value, _, low, high = map(float, astuple(trend))
    if not np.isfinite(value):
        return ""
    if not np.isfinite(low):
        return f"it changes by {value:+.3g} {unit} (no interval)"
    resolved = "" if low > 0 or high < 0 else ", which does not differ from zero"
    return f"it changes by {value:+.3g} ({low:+.3g} to {high:+.3g}) {unit}{resolved}"


def _uncovered_sentences(fit: SweepFit) -> Iterator[str]:
    """Spectra that the law of k does not cover."""
    if names := _names(fit, covered=False):
        yield (
            f"The law of k does not cover {', '.join(names)}: {MEASURED_ON}. They have neither a k "
            "by the law nor a numerical error."
        )


def _spread_sentences(fit: SweepFit) -> Iterator[str]:
    """Difference of the k of the spectra."""
    factor = fit.spectra.factor.value
    finite = np.flatnonzero(np.isfinite(factor))
    if finite.size > 1:
        lowest, highest = finite[np.argmin(factor[finite])], finite[np.argmax(factor[finite])]
        yield (
            f"The spectra's k lie between {factor[lowest]:.2f} ({fit.table.spectrum[lowest]}) and "
            f"{factor[highest]:.2f} ({fit.table.spectrum[highest]}); the interval of the pooled k "
            "covers the scatter between realisations, not this difference."
        )


def _onset_sentences(fit: SweepFit) -> Iterator[str]:
    """Spectra whose k falls towards zero at weak disorder, because the contact is finite."""
    factor = np.where(fit.in_range, fit.cells.factor.value, np.nan)
    for index, name in enumerate(fit.table.spectrum):
        finite = np.flatnonzero(np.isfinite(factor[index]))
        if finite.size == 0:
            continue
        energy = fit.table.amplitude
        weakest = finite[np.argmin(energy[finite])]
        first, largest = factor[index, weakest], np.max(factor[index, finite])
        if first < ONSET * largest:
            yield (
                f"{name}: k is {first:.2f} at e_el = {energy[weakest]:.4g} w_int "
                f"and up to {largest:.2f} in the range: the range begins below the onset of "
                "hysteresis of a finite contact. There k and the exponent depend on the size of "
                "the contact; raise the lower end of the range."
            )


def _gap_sentences(fit: SweepFit) -> Iterator[str]:
    """Failed simulations, missing amplitudes and single realisations."""
    for index in range(fit.table.spectrum.size):
        yield from _spectrum_gap_sentences(fit, index)
    if pairs := [str(name) for name in fit.table.spectrum[fit.n_realisation == 2]]:
        yield (
            f"{', '.join(pairs)}: two realisations give no interval, because by Student's t with "
            f"one degree of freedom it would reach {_REACH_OF_TWO} standard errors to both sides; "
            "set realisations to 3 or more. The pooled k may have one, from all spectra together."
        )


def _spectrum_gap_sentences(fit: SweepFit, index: int) -> Iterator[str]:
    """Failed simulations, missing amplitudes and single realisations of one spectrum."""
    name, n_realisation = fit.table.spectrum[index], fit.n_realisation[index]
    if n_realisation == 0:
        yield f"{name}: no simulation in the range has a value; pooled results leave it out."
        return
    if fit.n_failed[index]:
        yield (
            f"{name}: {fit.n_failed[index]} simulations in the range have no value and are "
            "left out; if failure depends on the surface, the means are biased."
        )
    missing = fit.in_range & (fit.cells.count[index] == 0)
    if np.any(missing):
        yield (
            f"{name}: no value at e_el = {_amplitudes(fit, missing)} w_int; its k is a mean over "
            "the other amplitudes and cannot be compared with the k of other spectra."
        )
    single = fit.in_range & (fit.cells.count[index] == 1)
    if np.any(single) and n_realisation > 1:
        yield (
            f"{name}: only one realisation has a value at e_el = {_amplitudes(fit, single)} w_int; "
            "the exponent and the trend with w_rms leave it out, k does not."
        )
    if n_realisation == 1:
        yield f"{name}: one realisation gives no interval, neither here nor in pooled results."


def _amplitudes(fit: SweepFit, chosen: NDArray[np.bool_]) -> str:
    """Chosen e_el of a sweep, with commas."""
    return ", ".join(f"{value:.4g}" for value in fit.table.amplitude[chosen])


def _exponent_sentences(fit: SweepFit) -> Iterator[str]:
    """Amplitudes whose mean hysteresis is not positive, so that it lacks a logarithm."""
    hysteresis = fit.cells.hysteresis.value
    for index, name in enumerate(fit.table.spectrum):
        negative = fit.in_range & (hysteresis[index] <= 0)
        if np.any(negative):
            yield (
                f"{name}: the mean hysteresis at e_el = {_amplitudes(fit, negative)} w_int is not "
                "positive; the exponent leaves it out, k does not; raise the lower end of the "
                "range."
            )


def _realisation_sentences(fit: SweepFit) -> Iterator[str]:
    """What the numbers of realisations for narrower intervals assume."""
    if np.any(np.isfinite(fit.pooled_n_needed)):
        yield (
            "The realisations that a narrower interval of k needs, each at every amplitude, follow "
            "from the present interval by 1/sqrt(n), if k scatters between further surfaces as "
            "between these. Realisations do not reduce the numerical bias or the differences "
            "between spectra."
        )


def _numerical_sentences(fit: SweepFit) -> Iterator[str]:
    """Largest error of k by the discretisation."""
    if largest := _largest_numerical_error(fit):
        yield (
            f"Numerical errors: up to {largest.error:.2g} of k "
            f"({largest.spectrum} at e_el = {largest.energy:.4g} w_int), by the measured laws; "
            "they are mostly a bias, which realisations do not average out, and the intervals do "
            "not include them."
        )


class _NumericalError(NamedTuple):
    """Expected numerical error of k, with its spectrum and its e_el (Units: w_int)."""

    error: float
    spectrum: str
    energy: float


def _largest_numerical_error(fit: SweepFit) -> _NumericalError | None:
    """Largest expected error of k in the range; None without a simulation with a value."""
    error = np.where(fit.table.finite, fit.table.numerical_error, np.nan)[:, fit.in_range]
    if not np.any(np.isfinite(error)):
        return None
    spectrum, amplitude, _ = np.unravel_index(np.nanargmax(error), error.shape)
    energy = fit.table.amplitude[fit.in_range][amplitude]
    name = str(fit.table.spectrum[spectrum])
    return _NumericalError(float(np.nanmax(error)), name, float(energy))
