"""Roughness of fronts: the fit recovers what was put in, and a small contact is measured."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure
from studies.paper.front_spectra import RoughnessRecord, fitted_roughness, stiffness_wavevector
from studies.paper.rough import STRONG, WEAK
from tests.studies.paper.made import computed, failed, parameters

SCENE = figure("beyond-roughness")


def synthetic(exponents, rng, n_surface=8):
    """Spectra that are powers of the stiffness, with the scatter of 20 fronts."""
    mode = np.arange(1, 400)
    empty = RoughnessRecord(
        short_cutoff=0.02,
        elastic_energy=np.tile([0.05, 0.001], 2),
        rms=np.tile([0.45, 0.06], 2),
        larkin_length=np.tile([0.01, 0.6], 2),
        radius=np.full(4, 1.6),
        ring_stiffness=np.full(4, 4.0),
        longest=np.full(4, 0.8),
        shortest=np.full(4, 0.08),
        mode=mode,
        power=np.ones((4, n_surface, mode.size)),
        lag=np.geomspace(0.01, 3, 20),
        difference=np.ones((4, 20)),
    )
    scatter = rng.gamma(20, 1 / 20, empty.power.shape)
    laws = [
        stiffness_wavevector(empty, index) ** -(1 + 2 * exponent)
        for index, exponent in enumerate((*exponents, *exponents))
    ]
    return replace(empty, power=np.array(laws)[:, None] * scatter)


@pytest.fixture(scope="module")
def record():
    small = parameters(
        "beyond-roughness",
        short_cutoff=0.06,
        max_penetration=0.6,
        first_penetration=0.4,
        last_penetration=0.1,
        n_surface=2,
        n_front=4,
    )
    lines = {
        "strong_line": small.strong_line.model_copy(update={"spring": 12.0}),
        "weak_line": small.weak_line.model_copy(update={"elastic_energy": 0.09, "spring": 1.2}),
    }
    small = small.model_copy(update=lines)
    return computed("beyond-roughness", small)


def test_the_fit_recovers_exponents_within_its_intervals(rng):
    data = synthetic((0.388, 0.5), rng)
    for index, exponent in ((STRONG, 0.388), (WEAK, 0.5)):
        fit = fitted_roughness(data, index)
        assert abs(fit.exponent - exponent) < 2 * fit.reach < 0.06
    assert all(check.passed for check in SCENE.checks(data))


def test_other_exponents_fail_the_checks(rng):
    assert len(failed(synthetic((0.5, 0.388), rng))) == 5
    sphere, line, both_exponents = failed(synthetic((0.388, 0.388), rng))
    assert "sphere, weak disorder" in sphere
    assert "straight front, below" in line
    assert "the two exponents differ" in both_exponents


def test_differences_follow_from_the_spectrum(record):
    for index in (STRONG, WEAK):
        variance = np.sum(2 * record.power[index].mean(axis=0)) / (2 * np.pi * record.radius[index])
        plateau = record.difference[index, -1] ** 2
        assert 0.3 * 2 * variance < plateau < 3 * 2 * variance
        assert np.all(record.difference[index, :10] < record.difference[index, 20])
