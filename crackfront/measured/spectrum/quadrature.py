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
"""Cells along the first outer parameters."""

_ROUNDS, _TEMPER, _EVEN = 4, 0.25, 0.15
"""How often the cells are divided anew, the power of the likelihood of which all of them then have
an equal part, and the part of all cells that are divided evenly."""

_PILOTS, SEED = 16, 20240229
"""States in each cell that say how likely it is, and their seed."""

_STEPS, _SETTLED, _LONGEST = 40, 1e-3, 3.0
"""Scoring steps to the likeliest inner parameters, the gain that ends them, and the longest."""

_WIDER, _BROAD, _SHARE = 1.25, 12.0, 0.1
"""Variance of the approximation over that of the likelihood, that of a second one in its place, and
the share of states that are drawn from this, so that no state weighs much."""

_NEIGHBOUR = 0.1
"""Part of a cell's likelihood that its neighbours are given at least."""

_RIDGE = 1e-6
"""Information about a parameter that the data do not determine, within its limits."""


class Likelihood(Protocol):
    """Half of a deviance, as a function of inner and outer parameters."""

    @property
    def inner(self) -> Array:
        """Limits of the inner parameters, the last of which has none, (n_inner, 2)."""

    @property
    def outer(self) -> Array:
        """Limits of the outer parameters, three at most, (n_outer, 2)."""

    def start(self, outer: Array) -> Array:
        """Inner parameters to begin with, (n, n_inner), at (n, n_outer) outer ones."""

    def value(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance, (n,), of (n, n_inner) and (n, n_outer) parameters."""

    def expansion(self, inner: Array, outer: Array) -> tuple[Array, Array, Array]:
        """The same, its slopes, (n, n_inner + n_outer), and its information, a matrix of those."""


@dataclass(frozen=True, slots=True)
class States:
    """Weighted states."""

    inner: Array
    outer: Array
    """Parameters. Shapes (n, n_inner) and (n, n_outer)."""
    logarithm: Array
    """Logarithms of their weights, comparable with those of other states. Shape (n,)."""

    @property
    def weight(self) -> Array:
        """Weights whose sum is 1, (n,)."""
        relative = np.exp(self.logarithm - np.max(self.logarithm))
        return relative / np.sum(relative)


class _Cells(NamedTuple):
    """Cells of the outer parameters, with the approximation in each."""

    edges: tuple[Array, ...]  # of the cells along each
    likeliest: Array  # (n, n_inner) inner parameters at the centres
    centre: Array  # (n, n_inner) mean of the normal approximation
    change: Array  # (n, n_inner, n_outer) of the mean with the outer parameters
    order: NDArray[np.int64]  # (n, n_inner) of the inner parameters, the most limited first
    root: (
        Array  # (n, n_inner, n_inner) lower triangle, whose square is the covariance in this order
    )
    logarithm: Array  # (n,) of the likelihood in the cell

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of cells along the outer parameters."""
        return tuple(len(one) - 1 for one in self.edges)

    @property
    def places(self) -> Array:
        """Outer parameters at the centres, (n, n_outer)."""
        return _centres(self.edges)

    @property
    def widths(self) -> Array:
        """Widths of the cells along each outer parameter, (n, n_outer)."""
        widths = np.meshgrid(*map(np.diff, self.edges), indexing="ij")
        return np.stack(widths, axis=-1).reshape(-1, len(self.edges))


def _centres(edges: Sequence[Array]) -> Array:
    """Outer parameters at the centres of cells, (n, n_outer)."""
    middles = [(one[1:] + one[:-1]) / 2 for one in edges]
    return np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, len(edges))


class Quadrature:
    """States of one likelihood."""

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
        return self._cells.likeliest[best], self._cells.places[best]

    @property
    def n_dimension(self) -> int:
        """Numbers that a state is made of."""
        return 2 + sum(self._cells.change.shape[1:])

    def states(self, uniform: Array) -> States:
        """States of numbers between 0 and 1, (n, n_dimension)."""
        table = np.cumsum(self._share)
        cell = np.searchsorted(table, uniform[:, 0] * table[-1])
        cell = np.minimum(cell, len(table) - 1)
        inner, outer, logarithm = self._drawn(cell, uniform)
        return States(inner, outer, logarithm - np.log(self._density[cell]))

    def _drawn(self, cell: NDArray[np.int64], uniform: Array) -> tuple[Array, Array, Array]:
        """Inner and outer parameters in cells, and logarithms of likelihood over their density."""
        cells, n_outer = self._cells, len(self._cells.edges)
        apart = (uniform[:, 2 : 2 + n_outer] - 0.5) * cells.widths[cell]
        centre = cells.centre[cell] + np.einsum("nij,nj->ni", cells.change[cell], apart)
        near, order = cells.root[cell], cells.order[cell]
        centre, limits = np.take_along_axis(centre, order, 1), self._likelihood.inner[order]
        broad = near * math.sqrt(_BROAD / _WIDER)
        is_broad = uniform[:, 1] < _SHARE
        chosen = np.where(is_broad[:, None, None], broad, near)
        found = _truncated(centre, chosen, limits, uniform[:, 2 + n_outer :])
        logarithm = np.logaddexp(
            math.log(1 - _SHARE) + _logarithm(found, centre, near, limits),
            math.log(_SHARE) + _logarithm(found, centre, broad, limits),
        )
        outer, inner = cells.places[cell] + apart, np.empty_like(found)
        np.put_along_axis(inner, order, found, axis=1)
        return inner, outer, -self._likelihood.value(inner, outer) - logarithm


def _fine_cells(likelihood: Likelihood) -> _Cells:
    """Cells that are fine where the likelihood lies."""
    pairs = zip(likelihood.outer.tolist(), _CELLS, strict=False)
    edges = [np.linspace(low, high, count + 1) for (low, high), count in pairs]
    cells = _expanded(likelihood, edges, None)
    for _ in range(_ROUNDS):
        tempered = np.exp(_TEMPER * (cells.logarithm - cells.logarithm.max()))
        # The edge of a cell may be likely where its centre is not.
        around = maximum_filter(tempered.reshape(cells.shape), size=3, mode="nearest")
        mass = around * np.prod(cells.widths, axis=1).reshape(cells.shape)
        edges = []
        for axis, one in enumerate(cells.edges):
            part = np.sum(mass, axis=tuple(other for other in range(mass.ndim) if other != axis))
            even = np.diff(one) / (one[-1] - one[0])
            total = np.cumsum((1 - _EVEN) * part / np.sum(part) + _EVEN * even)
            parts = np.linspace(0.0, 1.0, len(one))
            edges.append(np.interp(parts, np.append(0.0, total / total[-1]), one))
        cells = _expanded(likelihood, edges, cells)
    return cells


def _expanded(likelihood: Likelihood, edges: Sequence[Array], before: _Cells | None) -> _Cells:
    """Cells with the approximation about the likeliest inner parameters of each."""
    places = _centres(edges)
    if before is None:
        inner = likelihood.start(places)
    else:
        # From the former cell that the centre lies in.
        index = [
            np.searchsorted(one[1:-1], place)
            for one, place in zip(before.edges, places.T, strict=True)
        ]
        near = np.ravel_multi_index(tuple(index), before.shape)
        moved = np.einsum("nij,nj->ni", before.change[near], places - before.places[near])
        inner = np.clip(before.likeliest[near] + moved, *likelihood.inner.T)
    inner = _likeliest(likelihood, inner, places)
    _, slopes, information = likelihood.expansion(inner, places)
    n_inner = inner.shape[1]
    own = information[:, :n_inner, :n_inner] + _RIDGE * np.eye(n_inner)
    covariance = np.linalg.inv(own)
    step = -np.einsum("nij,nj->ni", covariance, slopes[:, :n_inner])
    centre = inner + step
    change = -np.einsum("nij,njk->nik", covariance, information[:, :n_inner, n_inner:])
    # By deviations from the centre to the limits, the furthest outside first.
    low, high = likelihood.inner.T
    spread = np.sqrt(np.einsum("nii->ni", covariance))
    order = np.argsort(-np.maximum(low - centre, centre - high) / spread, axis=1, kind="stable")
    rows = np.arange(len(places))[:, None, None]
    root = np.linalg.cholesky(_WIDER * covariance[rows, order[:, :, None], order[:, None, :]])
    half, limits = np.full((len(places), n_inner), 0.5), likelihood.inner[order]
    # Of one state in the middle; what the approximation says may be far off.
    ordered, middle = np.take_along_axis(centre, order, 1), np.empty_like(centre)
    found = _truncated(ordered, root, limits, half)
    np.put_along_axis(middle, order, found, axis=1)
    logarithm = -likelihood.value(middle, places) - _logarithm(found, ordered, root, limits)
    return _Cells(tuple(edges), inner, centre, change, order, root, logarithm)


def _likeliest(likelihood: Likelihood, inner: Array, outer: Array) -> Array:
    """Inner parameters of the least deviance at some outer ones, by scoring with damping."""
    low, high = likelihood.inner.T
    damping = np.full(len(inner), 1e-3)
    value, slopes, information = likelihood.expansion(inner, outer)
    n_inner = inner.shape[1]
    active = np.arange(len(inner))
    for _ in range(_STEPS):
        slope, matrix = slopes[active, :n_inner], information[active][:, :n_inner, :n_inner]
        here = inner[active]
        # What is at a limit and would leave it stays.
        held = ((here <= low) & (slope > 0)) | ((here >= high) & (slope < 0))
        free = ~held
        matrix = matrix * (free[:, :, None] & free[:, None, :])
        diagonal = np.einsum("nii->ni", matrix)
        diagonal += np.where(free, damping[active, None] * diagonal + _RIDGE, 1.0)
        step = -np.linalg.solve(matrix, np.where(free, slope, 0.0)[..., None])[..., 0]
        step *= np.minimum(
            1.0, _LONGEST / np.max(np.abs(step), axis=1, keepdims=True, initial=1e-9)
        )
        trial = np.clip(here + step, low, high)
        new, *others = likelihood.expansion(trial, outer[active])
        better = new < value[active]
        gain = value[active] - new
        chosen = active[better]
        inner[chosen], value[chosen] = trial[better], new[better]
        slopes[chosen], information[chosen] = (one[better] for one in others)
        damping[active] *= np.where(better, 0.2, 10.0)
        settled = (better & (gain < _SETTLED)) | (damping[active] > 1e6)
        active = active[~settled]
        if not active.size:
            break
    return inner


def _truncated(centre: Array, root: Array, limits: Array, uniform: Array) -> Array:
    """Numbers of normal distributions within limits, of numbers between 0 and 1, (n, n_inner).

    One coordinate after the other, each within what the former ones leave. The limits have the
    shape (n, n_inner, 2).
    """
    found, apart = np.zeros((2, *centre.shape))
    for axis in range(centre.shape[1]):
        middle, spread, low, high, turned, inside = _within(axis, limits, centre, root, apart)
        share = np.clip(uniform[:, axis], 1e-12, 1 - 1e-12)
        place = ndtri_exp(np.logaddexp(log_ndtr(low), np.log(share) + inside))
        place = np.clip(place, low, high)
        apart[:, axis] = np.where(turned, -place, place)
        found[:, axis] = np.clip(middle + spread * apart[:, axis], *limits[:, axis].T)
    return found


def _logarithm(found: Array, centre: Array, root: Array, limits: Array) -> Array:
    """Logarithm of the density of numbers that are drawn by :func:`_truncated`, (n,)."""
    logarithm, apart = np.zeros(len(found)), np.zeros(centre.shape)
    for axis in range(centre.shape[1]):
        middle, spread, *_, inside = _within(axis, limits, centre, root, apart)
        apart[:, axis] = (found[:, axis] - middle) / spread
        logarithm -= 0.5 * (apart[:, axis] ** 2 + math.log(2 * math.pi)) + np.log(spread) + inside
    return logarithm


def _within(
    axis: int, limits: Array, centre: Array, root: Array, apart: Array
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Mean and deviation of a coordinate given the former ones, and its limits in these units.

    Limits are mirrored where more lies below them, since small probabilities are exact there. The
    last entries are whether they are mirrored, and the logarithm of the probability between them.
    """
    spread = root[:, axis, axis]
    middle = centre[:, axis] + np.einsum("ni,ni->n", root[:, axis, :axis], apart[:, :axis])
    low, high = ((end - middle) / spread for end in limits[:, axis].T)
    turned = -low < high
    low, high = np.where(turned, -high, low), np.where(turned, -low, high)
    first, last = log_ndtr(low), log_ndtr(high)
    inside = last + np.log(-np.expm1(np.minimum(first - last, -1e-15)))
    return middle, spread, low, high, turned, inside
