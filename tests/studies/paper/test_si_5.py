"""SI Fig. S-5: the figure of a sweep and what the paper reads off it."""

import numpy as np
import pytest

from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.table import SweepTable
from crackfront.simulate.provenance import provenance
from studies.paper.figure import figure
from studies.paper.si_5 import ParametricStudy, ParametricStudyParameters, study_fit
from studies.records import read_record, write_record

SCENE = figure("si-5")
AMPLITUDES = np.array([0.002, 0.01, 0.05, 0.15])
LENGTHS = np.array([0.01, 0.04])


def study(factor, onset=(0.001, 0.004), exponent=2.0):
    """Two spectra whose k rises from 0 at their onset to a factor."""
    energy = np.broadcast_to(AMPLITUDES[:, None], (2, 4, 3))
    rise = 1 - np.exp(-((energy / np.array(onset)[:, None, None]) ** 4))
    scatter = 0.02 * np.random.default_rng(1).standard_normal(energy.shape)
    reach = energy * factor * (energy / 0.05) ** (exponent / 2 - 1) * rise * (1 + scatter)
    zero = np.zeros_like(energy)
    table = SweepTable(
        spectrum=np.array(["short", "long"]),
        short_cutoff=LENGTHS / 2,
        roll_off=LENGTHS,
        hurst=np.array([0.8, 0.8]),
        correlation_length=LENGTHS,
        amplitude=AMPLITUDES,
        e_el=energy,
        w_rms=2 * np.sqrt(energy),
        w_appr=1 - energy - reach,
        w_retr=1 - energy + reach,
        w_appr_from_force=1 - energy - reach,
        w_retr_from_force=1 - energy + reach,
        w_appr_numerical_error=zero,
        w_retr_numerical_error=zero,
        contact_radius=zero + 1.9,
        spring=np.full(zero.shape[:2], np.nan),
    )
    fit = fit_sweep(table, lowest_elastic_energy=0.01, highest_elastic_energy=0.15)
    parameters = ParametricStudyParameters(sweep="config/test.yaml")
    return SCENE.compute(parameters, lambda line: None, fit), fit


def verdicts(figure_data):
    return [check.passed for check in SCENE.checks(figure_data)]


def test_a_sweep_that_follows_the_law_passes_every_check():
    assert verdicts(study(3.0)[0]) == [True] * 5


@pytest.mark.parametrize(
    ("options", "failing"),
    [
        ({"factor": 2.0}, 0),
        ({"factor": 2.6}, 1),
        ({"factor": 3.0, "exponent": 2.5}, 2),
        ({"factor": np.array([2.4, 3.6])[:, None, None]}, 3),
        ({"factor": 3.0, "onset": (0.02, 0.001)}, 4),
    ],
)
def test_each_deviation_from_the_law_fails_its_check(options, failing):
    assert not verdicts(study(**options)[0])[failing]


def test_a_spread_that_only_rounds_to_the_allowed_one_fails_and_is_told_with_its_decimal():
    check = SCENE.checks(study(np.array([2.8, 3.1])[:, None, None])[0])[3]
    spread = float(check.computed.rstrip("%"))
    assert 10 < spread < 10.5
    assert not check.passed


@pytest.mark.parametrize("onset", [(0.0002, 0.0005), (0.005, 0.004)])
def test_the_order_of_onsets_between_the_same_amplitudes_is_undecided(onset):
    check = SCENE.checks(study(3.0, onset=onset)[0])[4]
    assert check.computed == "0 of 0"
    assert check.result == "cannot be decided"


def test_onsets_against_the_order_of_their_lengths_fail():
    check = SCENE.checks(study(3.0, onset=(0.02, 0.001))[0])[4]
    assert (check.computed, check.result) == ("0 of 1", "FAIL")


def test_the_fit_from_the_data_of_the_figure_is_that_of_the_sweep(tmp_path):
    study_of_figure, fit = study(3.0)
    path = tmp_path / "si-5.nc"
    write_record(path, study_of_figure, provenance(), title=SCENE.title)
    again = study_fit(read_record(path, ParametricStudy))
    assert again.pooled.factor == fit.pooled.factor
    assert np.array_equal(again.cells.factor.low, fit.cells.factor.low)
