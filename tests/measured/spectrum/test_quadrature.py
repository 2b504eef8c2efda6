"""Weighted states of likelihoods whose integrals are known."""

import numpy as np
import pytest
from scipy.stats import qmc, truncnorm

from crackfront.analysis.estimate import quantiles
from crackfront.measured.spectrum.quadrature import Quadrature

COUNT = 2**13


class Normal:
    """Inner parameters normal about a curve of the outer ones, these as a mixture of normals."""

    inner = np.array([(0.0, 1.0), (-2.0, 2.0), (-np.inf, np.inf)])
    outer = np.array([(-5.0, 5.0), (0.0, 1.0)])
    centre = np.array([1.2, 0.3, 4.0])
    information = np.linalg.inv([[0.04, 0.01, 0.0], [0.01, 0.09, -0.02], [0.0, -0.02, 0.25]])
    slope = np.array([0.0, 0.0, 1.5])

    def __init__(self, peaks):
        self.peaks = peaks

    def start(self, outer):
        return np.tile([0.5, 0.0, 0.0], (len(outer), 1))

    def _outer(self, place):
        parts = [
            share * np.exp(-0.5 * ((place - at) / width) ** 2) / width
            for share, at, width in self.peaks
        ]
        return np.sum(parts, axis=0)

    def _difference(self, inner, outer):
        return inner - self.centre - outer[:, :1] * self.slope

    def value(self, inner, outer):
        difference = self._difference(inner, outer)
        quadratic = 0.5 * np.einsum("ni,ij,nj->n", difference, self.information, difference)
        return quadratic - np.log(self._outer(outer[:, 0]) + 1e-300)

    def expansion(self, inner, outer):
        difference = self._difference(inner, outer)
        change = np.concatenate([np.eye(3), -np.outer(self.slope, [1.0, 0.0])], axis=1)
        slopes = difference @ self.information @ change
        information = change.T @ self.information @ change
        return self.value(inner, outer), slopes, np.tile(information, (len(inner), 1, 1))


def states(likelihood, seed=0):
    """States of a likelihood, and their weights."""
    quadrature = Quadrature(likelihood)
    drawn = quadrature.states(qmc.Sobol(quadrature.n_dimension, rng=seed).random(COUNT))
    return drawn, drawn.weight


@pytest.mark.parametrize(
    "peaks",
    [
        [(1.0, 0.5, 1.0)],
        [(0.3, -3.0, 0.05), (0.7, 2.0, 0.8)],
        [(0.5, -2.0, 0.05), (0.5, 3.5, 0.05)],
    ],
    ids=["broad", "narrow and broad", "two narrow ones"],
)
def test_parts_and_moments_are_those_of_the_likelihood(peaks):
    drawn, weight = states(Normal(peaks))
    assert 1 / np.sum(weight**2) > COUNT / 20
    for share, at, width in peaks:
        near = np.abs(drawn.outer[:, 0] - at) < 4 * width
        assert np.sum(weight[near]) == pytest.approx(share, abs=0.02)
        part = weight * near
        mean = np.sum(part * drawn.outer[:, 0]) / np.sum(part)
        assert mean == pytest.approx(at, abs=0.05 * width)
    # Along the parameter without limits it is centred on its curve, shifted by the limits.
    difference = drawn.inner[:, 2] - 1.5 * drawn.outer[:, 0]
    shift = np.sum(weight * (drawn.inner[:, 1] - 0.3))
    expected = 4.0 - np.array([-0.02 / 0.09 * shift]).item()
    assert np.sum(weight * difference) == pytest.approx(expected, abs=0.1)


def test_an_inner_parameter_beyond_its_limit_is_a_truncated_normal_one():
    likelihood = Normal([(1.0, 0.5, 1.0)])
    likelihood.information = np.diag([1 / 0.01, 1.0, 1.0])
    likelihood.centre = np.array([1.5, 0.0, 0.0])
    drawn, weight = states(likelihood)
    parts = np.array([0.025, 0.5, 0.975])
    expected = truncnorm.ppf(parts, (0 - 1.5) / 0.1, (1 - 1.5) / 0.1, 1.5, 0.1)
    assert quantiles(drawn.inner[:, 0], weight, parts) == pytest.approx(expected, abs=2e-3)
