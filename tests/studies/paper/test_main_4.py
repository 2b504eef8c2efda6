"""Main Fig. 4: from heights to the local work of adhesion."""

from dataclasses import replace

import numpy as np
import pytest

from tests.studies.paper.made import computed, failed, parameters

COARSE = {"seed": 1, "short_cutoff": 0.0025, "n_point": 256}


@pytest.fixture(scope="module")
def record():
    return computed("main-4", parameters("main-4", **COARSE))


def test_a_mapped_surface_keeps_parseval_its_mean_and_its_peaks(record):
    assert failed(record) == []
    assert np.count_nonzero(record.band_modes >= 100) >= 4


def test_a_mapping_of_the_wrong_sign_fails_its_checks(record):
    wrong = replace(
        record,
        adhesion=2 * record.mean - record.adhesion,
        peak_mean=record.valley_mean,
        valley_mean=record.peak_mean,
        band_correlation=-record.band_correlation,
    )
    assert len(failed(wrong)) == 3
