"""Main Fig. 4: from heights to the local work of adhesion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from studies.paper.figure import figure
from tests.studies.paper.made import computed, failed, parameters

COARSE = {"seed": 1, "short_cutoff": 0.0025, "n_point": 256}


@pytest.fixture(scope="module")
def record():
    return computed("main-4", parameters("main-4", **COARSE))


def test_a_mapped_surface_keeps_parseval_its_mean_and_its_peaks(record):
    assert failed(record) == []
    assert np.count_nonzero(record.band_modes >= 100) >= 4


def test_the_peak_is_the_highest_point_shown_that_has_room(record):
    room = len(record.position) // 5
    assert record.heights[tuple(record.peak)] == record.heights[room:-room, 3:-3].max()
    assert record.heights[tuple(record.valley)] == record.heights[room:-room, 3:-3].min()


def test_a_mapping_of_the_wrong_sign_fails_its_checks(record):
    wrong = replace(
        record,
        adhesion=2 * record.mean - record.adhesion,
        peak_mean=record.valley_mean,
        valley_mean=record.peak_mean,
        band_correlation=-record.band_correlation,
    )
    assert len(failed(wrong)) == 3


def test_the_rms_that_the_main_text_prints_fails_parseval(record):
    claims = failed(replace(record, rms=math.sqrt(2 * record.energy)))
    assert len(claims) == 1
    assert "Parseval" in claims[0]


def test_a_figure_of_a_mapping_shows_two_maps_and_two_profiles(record):
    drawn = figure("main-4").draw(record)
    maps = [axes for axes in drawn.axes if axes.images]
    assert len(maps) == 2
    assert len(drawn.axes) == 6
    assert all("/" in axes.get_ylabel() for axes in drawn.axes)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"roll_off": 0.002}, "roll_off 0.002 is shorter than short_cutoff 0.0025"),
        ({"patch": 0.2}, "patch is 0.2; it must have at least four short cutoffs .0.01. and fit"),
        ({"patch": 0.005}, "patch is 0.005; it must have at least four"),
        ({"n_point": 100}, "n_point is 100; the short cutoff 0.0025 needs two points, so 128"),
        ({"elastic_energy": 1.0}, "less than 1"),
    ],
)
def test_surfaces_that_cannot_be_mapped_are_refused(change, sentence):
    with pytest.raises(ValidationError, match=sentence):
        parameters("main-4", **COARSE | change)
