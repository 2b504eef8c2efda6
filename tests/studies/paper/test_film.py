"""Main Fig. 5a and SI Fig. S-6: spectral densities of the nanodiamond film."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from crackfront.sweep.section import ConfigurationError
from studies.paper.figure import figure, load_figure
from studies.paper.film import conformity_energy
from studies.paper.si_6 import profile_periodogram
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


def test_a_range_that_is_too_narrow_fails_its_check(scales):
    claims = failed(replace(scales, longest=scales.longest * 0.9))
    assert len([claim for claim in claims if "share" in claim]) == 3


def test_synthetic_surfaces_have_the_density_of_their_spectrum(synthetic):
    # The cutoff is longer here than the scales that carry e_el, and that is said.
    assert failed(synthetic) == [
        "density of the lines over that of the film's spectrum, in the same range",
        "the included scales hold those that carry 80% of e_el",
    ]


def test_a_density_of_the_wrong_convention_fails_its_checks(synthetic):
    claims = failed(replace(synthetic, synthetic=2 * synthetic.synthetic))
    assert len(claims) == 5


def test_the_density_of_lines_is_that_of_a_single_wave():
    n_point, pixel, amplitude = 32, 0.5, 3.0
    side = n_point * pixel
    wave = amplitude * np.cos(2 * np.pi * 5 * np.arange(n_point) / n_point)
    density = profile_periodogram(np.tile(wave[:, None], 4), pixel)
    assert density[4] == pytest.approx(amplitude**2 / 4 * side)
    assert np.delete(density, 4) == pytest.approx(0.0, abs=1e-25)


@pytest.mark.parametrize("name", ["main-5a", "si-6"])
def test_figures_of_densities_have_units_in_si(name, request):
    record = request.getfixturevalue({"main-5a": "scales", "si-6": "synthetic"}[name])
    drawn = figure(name).draw(record)
    assert all("(m$^" in axes.get_ylabel() for axes in drawn.axes)
    assert "m$^{-1}$" in drawn.axes[-1].get_xlabel()


def test_measured_profiles_are_drawn_and_give_their_own_energy(tmp_path):
    # The exact density of the film, in other units.
    q = np.geomspace(1e4, 1e9, 400)
    density = parameters("main-5a").spectrum.profile_density(q)
    rows = (f"{a / 1e6:.12g},{b * 1e18:.12g}\n" for a, b in zip(q, density, strict=True))
    path = with_measured(tmp_path, "main-5a", "q (1/um),C1D (um^3)\n" + "".join(rows))
    record = computed("main-5a", load_figure(path, "quick"))
    assert failed(record) == []
    assert len(figure("main-5a").checks(record)) == 11
    found = conformity_energy(
        record.measured_wavevector, record.measured_profile, record.contact_modulus
    )
    assert found == pytest.approx(11.14e-3, abs=0.05e-3)
    labels = figure("main-5a").draw(record).axes[1].get_legend_handles_labels()[1]
    assert "measured" in labels


def test_a_configuration_with_a_wrong_file_is_refused_before_any_work(tmp_path):
    path = with_measured(tmp_path, "main-5a", "q (1/m),C1D (m^3)\n1,1\n1,1\n")
    with pytest.raises(ConfigurationError, match=r"measured\.csv, line 3: q is 1 1/m after 1 1/m"):
        load_figure(path, "quick")
    path.write_text(path.read_text().replace("measured.csv", "none.csv"))
    with pytest.raises(ConfigurationError, match=r"none\.csv cannot be read: No such file"):
        load_figure(path, "quick")


@pytest.mark.parametrize(
    ("name", "changes", "sentence"),
    [
        ("main-5a", {"longest": 1e-6}, "longest is 1e-06; show ten roll-off"),
        ("main-5a", {"roll_off": 1e-10}, "roll_off 1e-10 is shorter than"),
        ("si-6", {"shortest": 1e-5}, "it must lie between"),
        ("si-6", {"longest": 1e-5}, "must not be below the side"),
    ],
)
def test_films_that_cannot_be_shown_are_refused(name, changes, sentence):
    with pytest.raises(ValidationError, match=sentence):
        parameters(name, **changes)
