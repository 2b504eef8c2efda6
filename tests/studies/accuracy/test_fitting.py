"""The laws of numerical errors: fitted to known ones, held to unseen surfaces."""

import math
import re
from dataclasses import asdict

import numpy as np
import pytest

from crackfront.simulate.laws import LAW_CUTOFFS, read_laws
from studies.accuracy.fitting import fit_laws
from studies.accuracy.scenes import HELD_OUT, SCENES
from studies.accuracy.study import Errors, SceneErrors, scene_errors

MODERATE = SCENES["chemical-0.04"]

UNSEEN = re.compile("c015|f013|band|h02|h05|h09")


def gaussian(rng, shape):
    """Scatter of unit variance."""
    return rng.standard_normal(shape)


def rare(rng, shape):
    """Scatter of unit variance, of one value in ten."""
    return math.sqrt(10) * (rng.uniform(size=shape) < 0.1) * rng.choice([-1, 1], size=shape)


def synthetic_study(bias, scatter, noise=gaussian, n_realisation=400, seed=5, scene=MODERATE):
    """A study whose errors of k have a given bias and scatter, by setting and value."""
    rng = np.random.default_rng(seed)
    ones, signs = np.ones(n_realisation), np.array([-1, 1])
    errors, of_few_sites = [], 0.0
    few = 5.0 if scene.elastic_energy > 0.2 else 2.2
    for setting, value, numerics in scene.single_trials:
        if setting == "finer":
            continue
        of_k = scatter(setting, value) * noise(rng, (n_realisation, 2)) + signs * bias(
            setting, value
        )
        if setting != "sites":
            of_k += of_few_sites
        elif value == few:
            of_few_sites = of_k
        adhesion = scene.elastic_energy * of_k
        settings = {
            name: law_settings
            for name, law_settings in asdict(numerics).items()
            if name != "angles"
        }
        errors.append(Errors(setting, value, ones, adhesion, ones, ones, ones, **settings))
    reference = np.tile([0.9, 1.0], (n_realisation, 1))
    return SceneErrors(scene, tuple(errors), reference, ones)


def test_rare_avalanches_count_with_their_mean_square():
    def law(seed):
        study = synthetic_study(
            lambda *_: 0.0, lambda setting, value: value**-3.0, rare, n_realisation=8, seed=seed
        )
        return next(law for law in fit_laws([study]) if law.setting == "cubic")

    squares = [(law(seed).error(3, LAW_CUTOFFS) * 3**3) ** 2 for seed in range(60)]
    assert 0.8 < np.mean(squares) < 1.25


def test_the_fit_finds_the_law_behind_the_errors():
    def bias(setting, value):
        return math.exp(1 - 2 * value) if setting == "sites" else 0.0

    def scatter(setting, value):
        return 0.3 * value**-3 if setting == "cubic" else 1e-3

    laws = {(law.setting, law.direction): law for law in fit_laws([synthetic_study(bias, scatter)])}
    assert laws["sites", -1].bias == pytest.approx((1, -2), abs=0.1)
    assert laws["cubic", 1].scatter == pytest.approx((math.log(0.3), -3), abs=0.2)
    assert laws["cubic", 1].error(4, LAW_CUTOFFS) == pytest.approx(0.3 / 64, rel=0.1)
    assert laws["cubic", 1].error(4, 4 * LAW_CUTOFFS) == pytest.approx(0.15 / 64, rel=0.1)


def largest_error(name, n_realisation, requested=0.03):
    """The larger rms error of k of both branches of held-out surfaces, relative to the request."""
    scene = SCENES[name]
    numbers = range(HELD_OUT, HELD_OUT + n_realisation)
    (error,) = scene_errors(scene, scene.requested_trials([requested]), numbers).errors
    return np.max(np.sqrt(np.mean(error.adhesion**2, axis=0))) / scene.elastic_energy / requested


@pytest.mark.slow
def test_laws_hold_for_a_band_between_the_shapes_that_they_know():
    assert largest_error("band-0.1", 2) < 1.5


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("name", [name for name in SCENES if UNSEEN.match(name)])
def test_laws_hold_within_half_for_spectra_and_surfaces_they_never_saw(name):
    assert largest_error(name, 8) < 1.5


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_the_laws_of_the_package_are_those_that_the_study_gives():
    stored = {
        (law.setting, law.direction): law
        for law in read_laws()
        if (law.shape, law.elastic_energy) == ("h08", 0.0025)
    }
    scene = SCENES["h08-0.0025"]
    study = scene_errors(scene, scene.single_trials, range(24))
    for law in fit_laws([study]):
        before = stored[law.setting, law.direction]
        assert law.bias == pytest.approx(before.bias, abs=0.02)
        assert law.scatter == pytest.approx(before.scatter, abs=0.02)
