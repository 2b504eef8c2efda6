"""Tables of measured errors."""

from dataclasses import asdict

import numpy as np
import pytest

from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import write_dataset
from studies.accuracy.files import errors_dataset
from studies.accuracy.report import error_tables, measured
from studies.accuracy.scenes import SCENES
from studies.accuracy.study import Errors, SceneErrors

SCENE = SCENES["octaves-0.05"]


def stored_errors(of_k, folder):
    """Write errors of k, (realisation, branch), for a request of 0.01, as the study does."""
    (trial,) = SCENE.requested_trials([0.01])
    ones = np.ones(len(of_k))
    settings = {name: value for name, value in asdict(trial.settings).items() if name != "angles"}
    adhesion = SCENE.elastic_energy * of_k
    errors = Errors("requested", 0.01, ones, adhesion, ones, ones, ones, **settings)
    study = SceneErrors(SCENE, (errors,), np.tile([0.8, 1.0], (len(of_k), 1)), ones)
    write_dataset(folder / f"expected-{SCENE.name}.nc", errors_dataset(study), provenance())


def test_rare_avalanches_are_counted_and_left_out_of_the_rms_of_the_others(tmp_path):
    of_k = np.full((20, 2), 1e-4)
    of_k[7, 1] = -0.05
    stored_errors(of_k, tmp_path)
    table = error_tables(measured(tmp_path))["Errors on many surfaces"]
    shown, pooled = table.records()
    assert float(shown["rms error of k of w_appr"]) == pytest.approx(1e-4)
    expected = pytest.approx(0.05 / np.sqrt(20), rel=0.02)
    assert float(shown["rms error of k of w_retr"]) == expected
    assert float(shown["median error"]) == pytest.approx(1e-4)
    assert float(shown["rms of the others"]) == pytest.approx(1e-4)
    assert shown["above the request %"] == "2.5"
    assert [*pooled.values()][8:] == [*shown.values()][8:]
