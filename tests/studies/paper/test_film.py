"""Main Fig. 5a and SI Fig. S-6: spectral densities of the nanodiamond film."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure, load_figure
from studies.paper.film import conformity_energy
from tests.studies.paper.made import computed, failed, parameters, with_measured

SYNTHETIC = {"shortest": 0.5e-6, "tile_roll_offs": 10.0, "realisations": 4, "seed": 3}


@pytest.fixture(scope="module")
def scales():
    return computed("main-5a", parameters("main-5a"))


@pytest.fixture(scope="module")
def synthetic():
    return computed("si-6", parameters("si-6", **SYNTHETIC))


def test_the_film_has_the_numbers_of_the_paper(scales):
    assert failed(scales) == []


def test_a_film_of_half_the_plateau_fails_the_numbers_of_the_paper(scales):
    assert len(failed(computed("main-5a", parameters("main-5a", plateau=4.2e-27)))) == 4


def test_synthetic_surfaces_have_the_density_of_their_spectrum(synthetic):
    # The cutoff is longer here than the scales that carry e_el, and that is said.
    assert failed(synthetic) == [
        "density of the lines over the density of the film's spectrum, in the same range",
        "the included scales contain those that carry 80% of e_el",
    ]


def test_a_density_of_the_wrong_convention_fails_its_checks(synthetic):
    claims = failed(replace(synthetic, synthetic=2 * synthetic.synthetic))
    assert len(claims) == 5


def test_measured_profiles_are_drawn_and_give_their_own_energy(tmp_path):
    # The exact density of the film, in other units.
    q = np.geomspace(1e4, 1e9, 400)
    density = parameters("main-5a").spectrum.profile_density(q)
    rows = (f"{a / 1e6:.12g},{b * 1e18:.12g}\n" for a, b in zip(q, density, strict=True))
    path = with_measured(tmp_path, "main-5a", "q (1/um),C1D (um^3)\n" + "".join(rows))
    record = computed("main-5a", load_figure(path, "quick"))
    assert failed(record) == []
    assert len(figure("main-5a").checks(record)) == 11
    energy = conformity_energy(
        record.measured_wavevector, record.measured_profile, record.contact_modulus
    )
    assert energy == pytest.approx(11.14e-3, abs=0.05e-3)
    labels = figure("main-5a").draw(record).axes[1].get_legend_handles_labels()[1]
    assert "measured" in labels
