"""What a reader of a fit must know, one sentence each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.result import SweepFit

ONSET = 0.5
"""A k below this part of the spectrum's largest counts as below the onset of hysteresis."""


def fit_notes(fit: SweepFit) -> tuple[str, ...]:
    """How k depends on disorder and size and how far spectra differ, then gaps and failures.

    Parameters
    ----------
    fit : SweepFit
        A fit.

    Returns
    -------
    tuple of str
        Sentences, that on the trends of k first.
    """
    return (
        trend_sentence(fit),
        *_spread_sentences(fit),
        *_onset_sentences(fit),
        *_gap_sentences(fit),
        *_exponent_sentences(fit),
        *_numerical_sentences(fit),
    )


def trend_sentence(fit: SweepFit) -> str:
    """Say that k is no constant, and which trends the sweep resolves.

    Parameters
    ----------
    fit : SweepFit
        A fit.

    Returns
    -------
    str
        One sentence.
    """
    disorder = _change(fit.pooled.disorder_slope, "per doubling of w_rms within a spectrum")
    size = _change(
        fit.pooled_size_slope, "per doubling of the correlation length among spectra of one shape"
    )
    return (
        "k is a function of disorder and of size, not a constant, so that each k here is an "
        "average over the stated range: "
        + (disorder or "its trend with w_rms needs two amplitudes")
        + "; "
        + (size or "its trend with size needs two spectra of one shape and different lengths")
        + "."
    )


def _change(trend: Estimate, unit: str) -> str:
    """Words for a trend; empty if there is none to speak of."""
    value, low, high = float(trend.value), float(trend.low), float(trend.high)
    if not np.isfinite(value):
        return ""
    if not np.isfinite(low):
        return f"it changes by {value:+.3g} {unit} (no interval)"
    resolved = "" if low > 0 or high < 0 else ", which does not differ from zero"
    return f"it changes by {value:+.3g} ({low:+.3g} to {high:+.3g}) {unit}{resolved}"


def _spread_sentences(fit: SweepFit) -> Iterator[str]:
    """How far the k of the spectra differ."""
    factor = fit.spectra.factor.value
    known = np.flatnonzero(np.isfinite(factor))
    if known.size > 1:
        lowest, highest = known[np.argmin(factor[known])], known[np.argmax(factor[known])]
        yield (
            f"The spectra's k lie between {factor[lowest]:.2f} ({fit.table.spectrum[lowest]}) and "
            f"{factor[highest]:.2f} ({fit.table.spectrum[highest]}); the interval of the pooled k "
            "covers the scatter between realisations, not this difference."
        )


def _onset_sentences(fit: SweepFit) -> Iterator[str]:
    """Spectra whose k falls towards zero within the range because the contact is finite."""
    factor = np.where(fit.in_range, fit.cells.factor.value, np.nan)
    for index, name in enumerate(fit.table.spectrum):
        known = np.flatnonzero(np.isfinite(factor[index]))
        if known.size == 0:
            continue
        energy = fit.table.e_el_requested
        weakest = known[np.argmin(energy[known])]
        first, largest = factor[index, weakest], np.max(factor[index, known])
        if first < ONSET * largest:
            yield (
                f"{name}: k is {first:.2f} at e_el = {energy[weakest]:.4g} w_int "
                f"and up to {largest:.2f} in the range, which thus reaches below the onset "
                "of hysteresis of a finite contact; there k and the exponent say more about size "
                "than about the law, so raise the lower end of the range."
            )


def _gap_sentences(fit: SweepFit) -> Iterator[str]:
    """Failed simulations, missing amplitudes and single realisations."""
    for index, name in enumerate(fit.table.spectrum):
        missing = fit.in_range & (fit.cells.count[index] == 0)
        if fit.n_realisation[index] == 0:
            yield f"{name}: no simulation in the range has a value; it is in no pooled result."
            continue
        if fit.n_failed[index]:
            yield (
                f"{name}: simulations in the range without a value: {fit.n_failed[index]}, left "
                "out; if they failed because of what they are, the means are biased."
            )
        if np.any(missing):
            gaps = ", ".join(f"{value:.4g}" for value in fit.table.e_el_requested[missing])
            yield (
                f"{name}: no value at e_el = {gaps} w_int; its k averages the other amplitudes "
                "and does not compare with the k of other spectra."
            )
        if fit.n_realisation[index] == 1:
            yield f"{name}: one realisation gives no interval, nor do pooled results with it."


def _exponent_sentences(fit: SweepFit) -> Iterator[str]:
    """Amplitudes without a logarithm of their hysteresis."""
    hysteresis = fit.cells.hysteresis.value
    for index, name in enumerate(fit.table.spectrum):
        known = fit.in_range & np.isfinite(hysteresis[index])
        negative = known & (np.where(known, hysteresis[index], 1.0) <= 0)
        if np.any(negative):
            gaps = ", ".join(f"{value:.4g}" for value in fit.table.e_el_requested[negative])
            yield (
                f"{name}: the mean hysteresis at e_el = {gaps} w_int is not positive and is left "
                "out of the exponent (not of k); raise the lower end of the range."
            )


def _numerical_sentences(fit: SweepFit) -> Iterator[str]:
    """What the discretisation may do to k."""
    error = np.where(fit.table.finite, fit.table.numerical_error, np.nan)[:, fit.in_range]
    if np.any(np.isfinite(error)):
        spectrum, amplitude, _ = np.unravel_index(np.nanargmax(error), error.shape)
        energy = fit.table.e_el_requested[fit.in_range][amplitude]
        yield (
            f"Numerical errors: up to {np.nanmax(error):.2g} of k "
            f"({fit.table.spectrum[spectrum]} at e_el = {energy:.4g} w_int), by the measured laws; "
            "they are mostly a bias, which realisations do not average out, and no interval here "
            "holds them."
        )
