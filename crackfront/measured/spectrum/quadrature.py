"""Weighted states of a likelihood that is broad, or has several maxima, in few parameters.

These few parameters, the outer ones, are cut into cells. In each cell the inner parameters have a
normal approximation about their likeliest values, within their limits (Genz, J. Comput. Graph.
Stat. 1, 141, 1992). States are drawn from the approximations by a low-discrepancy sequence. The
weight of a state is the likelihood over the approximation: a poor approximation needs more states,
but does not bias them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from scipy.special import log_ndtr, ndtri_exp

from crackfront.core.arrays import Array

_CELLS = 24, 8, 6
"""Numbers of cells along the outer parameters."""

_ROUNDS = 4
"""Number of times that the cells are adapted to the likelihood."""

_TEMPER = 0.25
"""Power of the likelihood of which all cells have an equal part after the adaptation."""

_EVEN = 0.15
"""Part of the cells that are spread evenly."""

_PILOTS = 16
"""States in each cell that estimate its likelihood."""

SEED = 20240229
"""Seed of these states."""

_STEPS = 40
"""Largest number of scoring steps to the likeliest inner parameters."""

_SETTLED = 1e-3
"""Decrease of half of the deviance in a step that ends the scoring."""

_LONGEST_STEP = 3.0
"""Largest change of a parameter in a step."""

_WIDER = 1.25
"""Variance of the approximation over the variance of the likelihood."""

_BROAD = 12.0
"""Variance of a second, broad approximation over the variance of the likelihood."""

_BROAD_SHARE = 0.1
"""Share of states from the broad approximation, so that no state has a large weight."""

_NEIGHBOUR = 0.1
"""Least likelihood of a cell over the likelihood of its neighbours, for the choice of states."""

_RIDGE = 1e-6
"""Information added to each parameter, in case that the data do not determine it."""


class Likelihood(Protocol):
    """Half of a deviance, as a function of inner and outer parameters."""

    @property
    def inner(self) -> Array:
        """Limits of the inner parameters, (n_inner, 2); the last parameter is unlimited."""

    @property
    def outer(self) -> Array:
        """Limits of the outer parameters, at most three, (n_outer, 2)."""

    def start(self, outer: Array) -> Array:
        """First inner parameters, (n, n_inner), for outer ones, (n, n_outer)."""

    def value(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance, (n,), for parameters (n, n_inner) and (n, n_outer)."""

    def expansion(self, inner: Array, outer: Array) -> tuple[Array, Array, Array]:
        """As `value`, with its slopes, (n, n_inner + n_outer), and information matrices."""


@dataclass(frozen=True, slots=True)
class States:
    """Weighted states."""

    inner: Array
    outer: Array
    """Parameters. Shapes (n, n_inner) and (n, n_outer)."""
    logarithm: Array
    """Logarithms of their weights, comparable with other states. Shape (n,)."""

    @property
    def weight(self) -> Array:
        """Weights whose sum is 1, (n,)."""
        relative = np.exp(self.logarithm - np.max(self.logarithm))
        return relative / np.sum(relative)


class _Cells(NamedTuple):
    """Cells of the outer parameters, with the approximation in each."""

    edges: tuple[Array, ...]
    """Edges of the cells along each outer parameter."""
    likeliest: Array
    """Likeliest inner parameters at the centres of the cells. Shape (n, n_inner)."""
    mean: Array
    """Means of the normal approximation. Shape (n, n_inner)."""
    slope: Array
    """Derivatives of the means by the outer parameters. Shape (n, n_inner, n_outer)."""
    order: NDArray[np.int64]
    """Order of the inner parameters, the most limited first. Shape (n, n_inner)."""
    root: Array
    """Cholesky factors of the covariance in this order. Shape (n, n_inner, n_inner)."""
    logarithm: Array
    """Logarithms of the likelihood. Shape (n,)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of cells along the outer parameters."""
        return tuple(len(edges) - 1 for edges in self.edges)

    @property
    def centres(self) -> Array:
        """Outer parameters at the centres, (n, n_outer)."""
        return _centres(self.edges)

    @property
    def widths(self) -> Array:
        """Widths of the cells along each outer parameter, (n, n_outer)."""
        widths = np.meshgrid(*map(np.diff, self.edges), indexing="ij")
        return np.stack(widths, axis=-1).reshape(-1, len(self.edges))


def _centres(edges: Sequence[Array]) -> Array:
    """Outer parameters at the centres of cells, (n, n_outer)."""
    middles = [(along[1:] + along[:-1]) / 2 for along in edges]
    return np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, len(edges))


class Quadrature:
    """Weighted states of one likelihood, from the approximation in its cells."""

    def __init__(self, likelihood: Likelihood) -> None:
        self._likelihood = likelihood
        self._cells = _fine_cells(likelihood)
        count = len(self._cells.logarithm)
        points = scipy.stats.qmc.Sobol(self.n_dimension, rng=SEED).random(_PILOTS)
        uniform = np.tile(points, (count, 1))
        *_, weight = self._drawn(np.repeat(np.arange(count), _PILOTS), uniform)
        pilot = weight.reshape(count, _PILOTS)
        likely = np.logaddexp.reduce(pilot, axis=1).reshape(self._cells.shape)
        likely = np.exp(likely - likely.max())
        share = np.maximum(likely, _NEIGHBOUR * maximum_filter(likely, size=3, mode="nearest"))
        self._density = share.ravel()
        self._share = self._density * np.prod(self._cells.widths, axis=1)

    @property
    def likeliest(self) -> tuple[Array, Array]:
        """Inner and outer parameters of the likeliest cell."""
        best = int(np.argmax(self._cells.logarithm))
        return self._cells.likeliest[best], self._cells.centres[best]

    @property
    def n_dimension(self) -> int:
        """Random numbers for each state."""
        return 2 + sum(self._cells.slope.shape[1:])

    def states(self, uniform: Array) -> States:
        """States from random numbers between 0 and 1, (n, n_dimension)."""
        cumulated = np.cumsum(self._share)
        cell = np.searchsorted(cumulated, uniform[:, 0] * cumulated[-1])
        cell = np.minimum(cell, len(cumulated) - 1)
        inner, outer, logarithm = self._drawn(cell, uniform)
        return States(inner, outer, logarithm - np.log(self._density[cell]))

    def _drawn(self, cell: NDArray[np.int64], uniform: Array) -> tuple[Array, Array, Array]:
        """Inner and outer parameters in cells, and logarithms of likelihood over their density."""
        cells, n_outer = self._cells, len(self._cells.edges)
        offset = (uniform[:, 2 : 2 + n_outer] - 0.5) * cells.widths[cell]
        mean = cells.mean[cell] + np.einsum("nij,nj->ni", cells.slope[cell], offset)
        narrow, order = cells.root[cell], cells.order[cell]
        mean, limits = np.take_along_axis(mean, order, 1), self._likelihood.inner[order]
        broad = narrow * math.sqrt(_BROAD / _WIDER)
        is_broad = uniform[:, 1] < _BROAD_SHARE
        root = np.where(is_broad[:, None, None], broad, narrow)
        ordered = _truncated(mean, root, limits, uniform[:, 2 + n_outer :])
        logarithm = np.logaddexp(
            math.log(1 - _BROAD_SHARE) + _log_probability(ordered, mean, narrow, limits),
            math.log(_BROAD_SHARE) + _log_probability(ordered, mean, broad, limits),
        )
        outer, inner = cells.centres[cell] + offset, np.empty_like(ordered)
        np.put_along_axis(inner, order, ordered, axis=1)
        return inner, outer, -self._likelihood.value(inner, outer) - logarithm


def _fine_cells(likelihood: Likelihood) -> _Cells:
    """Cells that are finer where the likelihood is larger."""
    pairs = zip(likelihood.outer.tolist(), _CELLS, strict=False)
    edges = [np.linspace(low, high, count + 1) for (low, high), count in pairs]
    cells = _expanded(likelihood, edges, None)
    for _ in range(_ROUNDS):
        tempered = np.exp(_TEMPER * (cells.logarithm - cells.logarithm.max()))
        # The edge of a cell may be likely where its centre is not.
        around = maximum_filter(tempered.reshape(cells.shape), size=3, mode="nearest")
        mass = around * np.prod(cells.widths, axis=1).reshape(cells.shape)
        edges = []
        for axis, before in enumerate(cells.edges):
            other_axes = tuple(number for number in range(mass.ndim) if number != axis)
            part = np.sum(mass, axis=other_axes)
            even = np.diff(before) / (before[-1] - before[0])
            total = np.cumsum((1 - _EVEN) * part / np.sum(part) + _EVEN * even)
            parts = np.linspace(0.0, 1.0, len(before))
            edges.append(np.interp(parts, np.append(0.0, total / total[-1]), before))
        cells = _expanded(likelihood, edges, cells)
    return cells


def _expanded(likelihood: Likelihood, edges: Sequence[Array], before: _Cells | None) -> _Cells:
    """Cells with the approximation about their likeliest inner parameters."""
    centres = _centres(edges)
    start = (
        likelihood.start(centres)
        if before is None
        else _interpolated_inner(before, likelihood, centres)
    )
    inner = _likeliest(likelihood, start, centres)
    _, slopes, information = likelihood.expansion(inner, centres)
    n_inner = inner.shape[1]
    inner_information = information[:, :n_inner, :n_inner] + _RIDGE * np.eye(n_inner)
    covariance = np.linalg.inv(inner_information)
    step = -np.einsum("nij,nj->ni", covariance, slopes[:, :n_inner])
    mean = inner + step
    slope = -np.einsum("nij,njk->nik", covariance, information[:, :n_inner, n_inner:])
    # The parameter furthest outside its limits comes first, in standard deviations.
    low, high = likelihood.inner.T
    spread = np.sqrt(np.einsum("nii->ni", covariance))
    order = np.argsort(-np.maximum(low - mean, mean - high) / spread, axis=1, kind="stable")
    rows = np.arange(len(centres))[:, None, None]
    root = np.linalg.cholesky(_WIDER * covariance[rows, order[:, :, None], order[:, None, :]])
    half, limits = np.full((len(centres), n_inner), 0.5), likelihood.inner[order]
    # A single state in the middle; the approximation alone may be far off.
    ordered_mean, middle = np.take_along_axis(mean, order, 1), np.empty_like(mean)
    ordered = _truncated(ordered_mean, root, limits, half)
    np.put_along_axis(middle, order, ordered, axis=1)
    probability = _log_probability(ordered, ordered_mean, root, limits)
    logarithm = -likelihood.value(middle, centres) - probability
    return _Cells(tuple(edges), inner, mean, slope, order, root, logarithm)


def _interpolated_inner(before: _Cells, likelihood: Likelihood, centres: Array) -> Array:
    """First inner parameters at new centres, from the earlier cells around them."""
    index = [
        np.searchsorted(edges[1:-1], centre)
        for edges, centre in zip(before.edges, centres.T, strict=True)
    ]
    cell = np.ravel_multi_index(tuple(index), before.shape)
    change = np.einsum("nij,nj->ni", before.slope[cell], centres - before.centres[cell])
    return np.clip(before.likeliest[cell] + change, *likelihood.inner.T)


def _likeliest(likelihood: Likelihood, inner: Array, outer: Array) -> Array:
    """Inner parameters of the least deviance at some outer ones, by damped Fisher scoring."""
    low, high = likelihood.inner.T
    damping = np.full(len(inner), 1e-3)
    value, slopes, information = likelihood.expansion(inner, outer)
    n_inner = inner.shape[1]
    active = np.arange(len(inner))
    for _ in range(_STEPS):
        slope, matrix = slopes[active, :n_inner], information[active][:, :n_inner, :n_inner]
        current = inner[active]
        # A parameter at a limit that would step outside is fixed.
        fixed = ((current <= low) & (slope > 0)) | ((current >= high) & (slope < 0))
        free = ~fixed
        matrix = matrix * (free[:, :, None] & free[:, None, :])
        diagonal = np.einsum("nii->ni", matrix)
        diagonal += np.where(free, damping[active, None] * diagonal + _RIDGE, 1.0)
        step = -np.linalg.solve(matrix, np.where(free, slope, 0.0)[..., None])[..., 0]
        longest = np.max(np.abs(step), axis=1, keepdims=True, initial=1e-9)
        step *= np.minimum(1.0, _LONGEST_STEP / longest)
        trial = np.clip(current + step, low, high)
        new, new_slopes, new_information = likelihood.expansion(trial, outer[active])
        better = new < value[active]
        gain = value[active] - new
        improved = active[better]
        inner[improved], value[improved] = trial[better], new[better]
        slopes[improved], information[improved] = new_slopes[better], new_information[better]
        damping[active] *= np.where(better, 0.2, 10.0)
        settled = (better & (gain < _SETTLED)) | (damping[active] > 1e6)
        active = active[~settled]
        if not active.size:
            break
    return inner


def _truncated(mean: Array, root: Array, limits: Array, uniform: Array) -> Array:
    """Samples of normal distributions within limits, (n, n_inner), from uniform random numbers.

    Coordinates follow one after the other, each conditional on the earlier ones. The limits have
    the shape (n, n_inner, 2).
    """
    samples, deviates = np.zeros((2, *mean.shape))
    for axis in range(mean.shape[1]):
        part = _conditional(axis, limits, mean, root, deviates)
        share = np.clip(uniform[:, axis], 1e-12, 1 - 1e-12)
        deviate = ndtri_exp(np.logaddexp(log_ndtr(part.low), np.log(share) + part.probability))
        deviate = np.clip(deviate, part.low, part.high)
        deviates[:, axis] = np.where(part.mirrored, -deviate, deviate)
        coordinate = part.mean + part.spread * deviates[:, axis]
        samples[:, axis] = np.clip(coordinate, *limits[:, axis].T)
    return samples


def _log_probability(samples: Array, mean: Array, root: Array, limits: Array) -> Array:
    """Logarithm of the probability density of samples of :func:`_truncated`, (n,)."""
    logarithm, deviates = np.zeros(len(samples)), np.zeros(mean.shape)
    for axis in range(mean.shape[1]):
        part = _conditional(axis, limits, mean, root, deviates)
        deviates[:, axis] = (samples[:, axis] - part.mean) / part.spread
        exponent = 0.5 * (deviates[:, axis] ** 2 + math.log(2 * math.pi))
        logarithm -= exponent + np.log(part.spread) + part.probability
    return logarithm


class _Conditional(NamedTuple):
    """Distributions of one coordinate, conditional on the earlier ones. Shapes (n,)."""

    mean: Array
    spread: Array
    low: Array
    high: Array
    """Limits, in standard deviations from the mean."""
    mirrored: NDArray[np.bool_]
    """Whether the limits are mirrored, because small probabilities are exact in the lower tail."""
    probability: Array
    """Logarithm of the probability between the limits."""


def _conditional(
    axis: int, limits: Array, mean: Array, root: Array, deviates: Array
) -> _Conditional:
    """Distribution of a coordinate, from the deviates of the earlier ones."""
    spread = root[:, axis, axis]
    middle = mean[:, axis] + np.einsum("ni,ni->n", root[:, axis, :axis], deviates[:, :axis])
    low, high = ((end - middle) / spread for end in limits[:, axis].T)
    mirrored = -low < high
    low, high = np.where(mirrored, -high, low), np.where(mirrored, -low, high)
    first, last = log_ndtr(low), log_ndtr(high)
    probability = last + np.log(-np.expm1(np.minimum(first - last, -1e-15)))
    return _Conditional(middle, spread, low, high, mirrored, probability)
