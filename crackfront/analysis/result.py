"""What a fit returns: estimates on plain arrays with named dimensions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.table import SweepTable
from crackfront.core.adhesion import FieldKind

Array = NDArray[np.float64]

SPECTRUM, AMPLITUDE = "spectrum", "amplitude"
"""Names of the dimensions."""


@dataclass(frozen=True, slots=True)
class Column:
    """One array of a fit with what a file needs to know about it.

    Attributes
    ----------
    name : str
        Name of the variable.
    dims : tuple of str
        Names of the dimensions of `values`.
    values : array
        The numbers.
    long_name, units : str
        What it is.
    """

    name: str
    dims: tuple[str, ...]
    values: NDArray[Any]
    long_name: str
    units: str


def _about(long_name: str, units: str = "1") -> dict[str, str]:
    """What a file says about an entry."""
    return {"long_name": long_name, "units": units}


@dataclass(frozen=True, slots=True)
class CellEstimates:
    """Means over the realisations of one spectrum and amplitude, in the range or not.

    Attributes
    ----------
    count : (n_spectrum, n_amplitude) int array
        Simulations with a value.
    e_el, w_rms : (n_spectrum, n_amplitude) array
        Means of what the tiles measure. (Units: w_int)
    hysteresis : (n_spectrum, n_amplitude) Estimate
        w_retr - w_appr. (Units: w_int)
    factor : (n_spectrum, n_amplitude) Estimate
        k = hysteresis / (2 e_el).
    midpoint_deviation : (n_spectrum, n_amplitude) Estimate
        (w_retr + w_appr)/2 less the mean of w_loc. (Units: w_int)
    """

    count: NDArray[np.int64] = field(metadata=_about("number of simulations with a value"))
    e_el: Array = field(metadata=_about("mean measured e_el", "w_int"))
    w_rms: Array = field(metadata=_about("mean measured w_rms", "w_int"))
    hysteresis: Estimate = field(metadata=_about("mean hysteresis w_retr - w_appr", "w_int"))
    factor: Estimate = field(metadata=_about("mean k = hysteresis / (2 e_el)"))
    midpoint_deviation: Estimate = field(
        metadata=_about("mean of midpoint - mean of w_loc", "w_int")
    )


@dataclass(frozen=True, slots=True)
class LawEstimates:
    """What is fitted to the amplitudes in the range, for every spectrum or pooled.

    Attributes
    ----------
    factor : Estimate
        k, mean over the amplitudes.
    factor_by_sums : Estimate
        k as ratio of sums, hysteresis over 2 e_el.
    factor_from_force : Estimate
        k from the experimenter's estimates, mean over the amplitudes.
    exponent : Estimate
        Exponent of hysteresis in w_rms; 2 if k is constant.
    midpoint_slope : Estimate
        m of w_int - midpoint = m e_el; by the law 1 for roughness, 0 for a chemical field.
    disorder_slope : Estimate
        Change of k per doubling of w_rms; 0 if k is constant.
    """

    factor: Estimate = field(metadata=_about("k, mean over the amplitudes"))
    factor_by_sums: Estimate = field(metadata=_about("k, sum of hysteresis / sum of 2 e_el"))
    factor_from_force: Estimate = field(metadata=_about("k from JKR fits of force against radius"))
    exponent: Estimate = field(metadata=_about("exponent of hysteresis in w_rms"))
    midpoint_slope: Estimate = field(metadata=_about("slope of w_int - midpoint in e_el"))
    disorder_slope: Estimate = field(metadata=_about("change of k per doubling of w_rms"))


@dataclass(frozen=True, slots=True)
class ForceDifference:
    """How far the experimenter's estimates lie from w_appr and w_retr, in the range.

    Attributes
    ----------
    approach, retraction : (n_spectrum,) array
        Mean difference. (Units: w_int)
    approach_largest, retraction_largest : (n_spectrum,) array
        Largest magnitude in a single simulation. (Units: w_int)
    """

    approach: Array = field(metadata=_about("mean of w_appr from force - w_appr", "w_int"))
    approach_largest: Array = field(
        metadata=_about("largest |w_appr from force - w_appr|", "w_int")
    )
    retraction: Array = field(metadata=_about("mean of w_retr from force - w_retr", "w_int"))
    retraction_largest: Array = field(
        metadata=_about("largest |w_retr from force - w_retr|", "w_int")
    )


@dataclass(frozen=True, slots=True)
class SweepFit:
    r"""Fit of :math:`w_{retr,appr} = w_{int} - e_{el} \pm k e_{el}` to a sweep.

    What each number means stands in :data:`crackfront.analysis.sweep.FIT_DEFINITION`;
    :func:`fit_columns` gives all arrays with dimensions, units and long names.

    Attributes
    ----------
    table : SweepTable
        What was fitted.
    kind : {"roughness", "chemical"}
        Whether the mean of w_loc is w_int - e_el or w_int.
    lowest_elastic_energy, highest_elastic_energy : float
        Range of requested e_el, ends included. (Units: w_int)
    n_bootstrap, seed : int
        Bootstrap samples and the seed of their draws.
    in_range : (n_amplitude,) bool array
        Amplitudes that the fit uses.
    n_realisation : (n_spectrum,) int array
        Realisations with any value in the range.
    n_failed : (n_spectrum,) int array
        Simulations in the range without a value.
    cells : CellEstimates
        Means at every spectrum and amplitude.
    spectra : LawEstimates of (n_spectrum,) arrays
        The fit of every spectrum.
    pooled : LawEstimates of () arrays
        The fit of all spectra together.
    size_slope : (n_amplitude,) Estimate
        Change of k per doubling of the correlation length among spectra of one shape.
    pooled_size_slope : () Estimate
        The same for k averaged over the range.
    midpoint_largest, midpoint_probability : () array
        Largest deviation of a cell's midpoint in the range, in standard errors, and the
        probability of one as large or larger among all cells (Student's t, Bonferroni).
    from_force : ForceDifference
        How far the experimenter's estimates differ.
    """

    table: SweepTable
    kind: FieldKind
    lowest_elastic_energy: float
    highest_elastic_energy: float
    n_bootstrap: int
    seed: int
    in_range: NDArray[np.bool_]
    n_realisation: NDArray[np.int64]
    n_failed: NDArray[np.int64]
    cells: CellEstimates
    spectra: LawEstimates
    pooled: LawEstimates
    size_slope: Estimate
    pooled_size_slope: Estimate
    midpoint_largest: Array
    midpoint_probability: Array
    from_force: ForceDifference


def fit_columns(fit: SweepFit) -> Iterator[Column]:
    """Arrays of a fit, an estimate as four: value, standard error and the ends of its interval.

    Parameters
    ----------
    fit : SweepFit
        A fit.

    Yields
    ------
    Column
        `exponent`, `exponent_standard_error`, `exponent_low`, `exponent_high`, the same with the
        prefix `pooled_`, means over realisations with the prefix `cell_`, and so on.
    """
    table = fit.table
    yield Column("spectrum", (SPECTRUM,), table.spectrum, "name of the spectrum", "")
    for name, text in (
        ("short_cutoff", "shortest wavelength"),
        ("roll_off", "roll-off wavelength"),
        ("correlation_length", "correlation length of w_loc"),
    ):
        yield Column(name, (SPECTRUM,), getattr(table, name), text, "reduced lateral length")
    yield Column("hurst", (SPECTRUM,), table.hurst, "Hurst exponent", "1")
    yield Column("e_el_requested", (AMPLITUDE,), table.e_el_requested, "requested e_el", "w_int")
    yield Column("in_range", (AMPLITUDE,), fit.in_range, "amplitude is in the fit", "1")
    for name, text in (
        ("n_realisation", "realisations with a value in the range"),
        ("n_failed", "simulations without a value in the range"),
    ):
        yield Column(name, (SPECTRUM,), getattr(fit, name), text, "1")
    for name, text in (
        ("midpoint_largest", "largest deviation of a midpoint in standard errors"),
        ("midpoint_probability", "probability of that deviation among all cells"),
    ):
        yield Column(name, (), getattr(fit, name), text, "1")
    text = "change of k per doubling of the correlation length among spectra of one shape"
    yield from _estimate_columns("size_slope", (AMPLITUDE,), fit.size_slope, text, "1")
    yield from _estimate_columns("pooled_size_slope", (), fit.pooled_size_slope, text, "1")
    yield from _group_columns("cell_", (SPECTRUM, AMPLITUDE), fit.cells)
    yield from _group_columns("", (SPECTRUM,), fit.spectra)
    yield from _group_columns("pooled_", (), fit.pooled)
    yield from _group_columns("from_force_", (SPECTRUM,), fit.from_force)


def _group_columns(
    prefix: str, dims: tuple[str, ...], group: CellEstimates | LawEstimates | ForceDifference
) -> Iterator[Column]:
    """Columns of the entries of a group."""
    for item in fields(group):
        entry, name = getattr(group, item.name), prefix + item.name
        text, units = item.metadata["long_name"], item.metadata["units"]
        if isinstance(entry, Estimate):
            yield from _estimate_columns(name, dims, entry, text, units)
        else:
            yield Column(name, dims, entry, text, units)


def _estimate_columns(
    name: str, dims: tuple[str, ...], entry: Estimate, text: str, units: str
) -> Iterator[Column]:
    """Columns of one estimate."""
    yield Column(name, dims, entry.value, text, units)
    for suffix, words in (
        ("standard_error", "standard error"),
        ("low", "lower end of the 95% interval"),
        ("high", "upper end of the 95% interval"),
    ):
        yield Column(f"{name}_{suffix}", dims, getattr(entry, suffix), f"{text}: {words}", units)
