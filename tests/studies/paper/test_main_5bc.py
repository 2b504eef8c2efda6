"""Main Fig. 5b, c: the contact on nanodiamond in SI units, its instabilities and fits."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure
from studies.paper.perimeters import advances
from tests.studies.paper.made import (
    computed,
    failed,
    parameters,
)


def film_parameters(**changes):
    coarse = {
        "seed": 1,
        "error": 0.5,
        "short_cutoff": 1.05e-6,
        "step": 240e-9,
        "retraction_step": 480e-9,
        "line_step": 480e-9,
        "n_surface": 2,
        "precision": 2e-8,
    }
    return parameters("main-5bc", **coarse | changes)


@pytest.fixture(scope="module")
def contact():
    return computed("main-5bc", film_parameters())


def test_nanodiamond_has_the_numbers_of_the_paper(contact):
    claims = failed(contact)
    assert not [claim for claim in claims if "k = 3 predicts" in claim or "wavelengths" in claim]
    assert contact.force.max() >= 1e-3
    assert np.all(np.diff(contact.line, axis=0) >= 0)
    assert np.all(contact.line_force <= 0.64e-3)
    # Half a decade of wavelengths contains three quarters of the energy of all.
    np.testing.assert_allclose(contact.elastic_energy / 11.14e-3, 0.625, rtol=0.1)


def test_a_wrong_nanodiamond_contact_fails_its_checks(contact):
    k3 = {
        "approach": np.array([63e-3 - 4 * contact.elastic_energy, 1e-4]),
        "retraction": np.array([63e-3 + 2 * contact.elastic_energy, 1e-4]),
    }
    claims = failed(replace(contact, **k3))
    assert not [claim for claim in claims if "hysteresis of" in claim]
    wrong = replace(
        contact,
        status="the cycle ended early",
        whole_elastic_energy=2 * contact.whole_elastic_energy,
        retraction=contact.approach * 1.01,
        widest=contact.widest / 100,
        tile_side=contact.tile_side / 10,
        synthetic_fit=contact.synthetic_fit * 1.1,
        simulated_fit=contact.simulated_fit * 2,
    )
    assert len(failed(wrong)) == 12


def test_an_advance_goes_on_across_the_first_ray():
    before = np.ones(64)
    after = before.copy()
    after[[62, 63, 0, 1, 2]] = 1.5
    after[10:13] = 1.5
    inner, outer = sorted(advances(before, after, 0.1), key=lambda part: part.extent)
    assert inner.angle.size == 3
    assert outer.extent == pytest.approx(5 * 2 * np.pi / 64 * 1.25)
    np.testing.assert_allclose(outer.outer, 1.5)
    assert advances(before, after, 0.6) == []
    (whole,) = advances(before, before + 1, 0.1)
    assert whole.extent == pytest.approx(2 * np.pi * 1.5)


def test_single_instabilities_are_narrower_than_the_parts_that_jump_in_a_load_step(contact):
    widest = [contact.extents[contact.surface == surface].max() for surface in (0, 1)]
    assert np.all(contact.widest > 20e-6)
    assert np.all(contact.widest <= np.array(widest) * (1 + 1e-12))
    assert contact.widest[0] < 0.9 * widest[0]


@pytest.mark.slow
def test_the_widest_instability_does_not_depend_on_the_load_step(contact):
    parameters = film_parameters(step=120e-9, n_surface=1)
    finer = computed("main-5bc", parameters)
    assert finer.extents.max() < contact.extents[contact.surface == 0].max()
    assert finer.widest[0] == pytest.approx(contact.widest[0], rel=0.02)


MEASURED = """force (mN),radius (um),branch
-0.15,70,approach
0.05,90,approach
0.5,110,approach
0.1,112,retraction
"""


@pytest.mark.slow
def test_measured_points_are_fitted_checked_and_drawn(tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text(MEASURED)
    record = computed("main-5bc", film_parameters(measured=str(path), step=960e-9, n_surface=1))
    value, low, high = record.measured_fit
    assert 0.02 < low < value < high
    assert "w_int from the measured approach with k = 3" in [
        check.claim for check in figure("main-5bc").checks(record)
    ]
    labels = [line.get_label() for line in figure("main-5bc").draw(record).axes[1].get_lines()]
    assert {"measured, approach", "measured, retraction"} <= set(labels)
