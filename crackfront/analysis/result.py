"""Result of a fit: estimates on plain arrays, with their names and units in files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.powers import PowerFit
from crackfront.analysis.table import AMPLITUDE, REALISATION, SPECTRUM, SweepTable
from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, Variable, variable, variables

Counts = NDArray[np.int64]

_LAW_EXPONENT = "exponent of hysteresis in w_rms by the law, at the same amplitudes"

_NEEDED = "realisations of each spectrum that an interval of k of a half-width needs"

_SIZE_SLOPE = "change of k per doubling of the correlation length among spectra of one shape"

HALF_WIDTHS = 0.1, 0.05, 0.02
"""Half-widths of intervals of k for which a fit states the number of realisations."""

_HALF_WIDTH = Variable("half_width", ("half_width",), "1", "half of a 95% interval of k")

_BOUND = Variable("bound", ("bound",), "1", "value, its standard error, ends of its 95% interval")


@dataclass(frozen=True, slots=True)
class CellEstimates:
    """Means over the realisations at every spectrum and amplitude, in the range or not."""

    count: Counts = variable("number of simulations with a value", "1")
    e_el: Array = variable("mean measured e_el", ADHESION)
    w_rms: Array = variable("mean measured w_rms", ADHESION)
    hysteresis: Estimate = variable("mean hysteresis w_retr - w_appr", ADHESION)
    factor: Estimate = variable("mean k = hysteresis / (2 e_el)", "1")
    midpoint_deviation: Estimate = variable("mean of midpoint - mean of w_loc", ADHESION)
    size: Array = variable("g, length of the springs over the Larkin length", "1")
    law_factor: Estimate = variable("k of the straight front at this disorder and size", "1")
    infinite_factor: Estimate = variable("mean k, extrapolated to the infinite contact", "1")


@dataclass(frozen=True, slots=True)
class LawEstimates:
    """Estimates from the amplitudes in the range, for every spectrum or pooled.

    If k is constant, the exponent is 2 and the disorder slope 0. The midpoint slope of
    the law is 1 for roughness and 0 for a chemical field.
    """

    factor: Estimate = variable("k, mean over the amplitudes", "1")
    factor_by_sums: Estimate = variable("k, sum of hysteresis / sum of 2 e_el", "1")
    factor_from_force: Estimate = variable("k from JKR fits of force against radius", "1")
    exponent: Estimate = variable("exponent of hysteresis in w_rms", "1")
    midpoint_slope: Estimate = variable("slope of w_int - midpoint in e_el", "1")
    disorder_slope: Estimate = variable("change of k per doubling of w_rms", "1")


@dataclass(frozen=True, slots=True)
class ForceDifference:
    """Differences of the experimenter's estimates from w_appr and w_retr, in the range."""

    approach: Array = variable("mean of w_appr from force - w_appr", ADHESION)
    approach_largest: Array = variable("largest |w_appr from force - w_appr|", ADHESION)
    retraction: Array = variable("mean of w_retr from force - w_retr", ADHESION)
    retraction_largest: Array = variable("largest |w_retr from force - w_retr|", ADHESION)


@dataclass(frozen=True, slots=True)
class SweepFit:
    r"""Fit of :math:`w_{retr,appr} = w_{int} - e_{el} \pm k e_{el}` to a sweep.

    :data:`crackfront.analysis.sweep_fit.FIT_DEFINITION` defines the numbers, and
    :func:`fit_columns` gives all arrays with dimensions, units and long names.
    """

    table: SweepTable
    kind: FieldKind
    """Whether the mean of w_loc is w_int - e_el or w_int."""
    lowest_elastic_energy: float
    """Least requested e_el of the fit, included. (Units: w_int)"""
    highest_elastic_energy: float
    """Largest requested e_el of the fit, included. (Units: w_int)"""
    n_bootstrap: int
    """Number of bootstrap samples."""
    seed: int
    """Seed of the random numbers of the bootstrap."""
    uncorrelated: bool
    """Whether the sites of straight fronts are statistically independent."""
    cells: CellEstimates
    """Means at every spectrum and amplitude, (n_spectrum, n_amplitude)."""
    spectra: LawEstimates
    """The fit of every spectrum, (n_spectrum,)."""
    pooled: LawEstimates
    """The fit of all spectra together, ()."""
    from_force: ForceDifference
    """Differences of the experimenter's estimates, (n_spectrum,)."""
    powers: PowerFit
    """The fit of k in disorder and size, ()."""
    in_range: NDArray[np.bool_] = variable("amplitude is in the fit", "1", AMPLITUDE)
    n_realisation: Counts = variable("realisations with a value in the range", "1", SPECTRUM)
    n_failed: Counts = variable("simulations without a value in the range", "1", SPECTRUM)
    n_needed: Array = variable(_NEEDED, "1", SPECTRUM, _HALF_WIDTH.name)
    pooled_n_needed: Array = variable(_NEEDED, "1", _HALF_WIDTH.name)
    """Extrapolated by 1/sqrt(n) from the present intervals, for each of :data:`HALF_WIDTHS`."""
    law_exponent: Array = variable(_LAW_EXPONENT, "1", SPECTRUM)
    pooled_law_exponent: Array = variable(_LAW_EXPONENT, "1")
    midpoint_largest: Array = variable("least likely deviation of a midpoint, in errors", "1")
    midpoint_probability: Array = variable("probability of that deviation among all cells", "1")
    """It follows from Student's t, if the cells in the range are independent."""
    size_slope: Estimate = variable(_SIZE_SLOPE, "1", AMPLITUDE)
    pooled_size_slope: Estimate = variable(_SIZE_SLOPE, "1")
    k_0: Estimate = variable("k of weak disorder in the infinite contact, by the law", "1")
    n_large: Counts = variable("spectra and amplitudes with g above 1", "1")
    law_departure: Array = variable("rms departure of their k from the law, relative", "1")


def fit_columns(fit: SweepFit) -> Iterator[tuple[Variable, NDArray[Any]]]:
    """Variables and arrays of a fit for a file.

    An estimate has its four numbers along the dimension `bound`. The prefix `pooled_` marks pooled
    results, `cell_` means over realisations, `from_force_` the experimenter's estimates and
    `powers_` the fit in disorder and size.
    """
    yield _BOUND, np.array([item.name for item in fields(Estimate)])
    yield _HALF_WIDTH, np.array(HALF_WIDTHS)
    for item, values in _columns(fit.table):
        if REALISATION not in item.dims and values is not None:
            yield item, values
    yield from _columns(fit)
    yield from _columns(fit.cells, "cell_", SPECTRUM, AMPLITUDE)
    yield from _columns(fit.spectra, "", SPECTRUM)
    yield from _columns(fit.pooled, "pooled_")
    yield from _columns(fit.from_force, "from_force_", SPECTRUM)
    yield from _columns(fit.powers, "powers_")


def _columns(record: Any, prefix: str = "", *dims: str) -> Iterator[tuple[Variable, NDArray[Any]]]:
    """Variables and arrays of one record; `dims` are dimensions that all its fields share."""
    for item in variables(type(record), *dims):
        entry, column = getattr(record, item.name), replace(item, name=prefix + item.name)
        if isinstance(entry, Estimate):
            column = replace(column, dims=(*column.dims, *_BOUND.dims))
            entry = np.stack(astuple(entry), axis=-1)
        yield column, entry
