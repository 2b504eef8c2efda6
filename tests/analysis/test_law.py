"""The law of k: its limits, its lengths, the fit behind it, and the pages that tell its numbers."""

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from crackfront.analysis.finding import crossing, departure_of_spheres, finding, least_size
from crackfront.analysis.law import (
    LEAST_SIZE,
    TYPICAL_BREADTH,
    WEAKEST,
    infinite_ratio,
    law_value,
    pinning_factor,
    shipped_law,
    slope_breadth,
)
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.core import jkr
from crackfront.core.adhesion import force_correlation_length, larkin_length
from crackfront.core.spectrum import SelfAffineSpectrum
from studies.law.drawing import LawPoints, law_figure, spectra_points
from studies.law.fitting import LawCell, fitted_law, measured_cells
from studies.law.measure import PAGES, draw_law, law_of, read_spheres, renew_pages, sphere_table
from studies.law.page import limit_part, renewed_page

ROOT = Path(__file__).parents[2]
SPHERES = [ROOT / "docs/reference" / name for name in ("spheres.csv", "held-out.csv")]
FLAT = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
SPECTRA = (FLAT, SelfAffineSpectrum(0.01, 0.08, 0.8), SelfAffineSpectrum(0.01, 0.2, 0.3))


@pytest.fixture(scope="module")
def law():
    return shipped_law()


def test_the_law_rises_with_size_to_its_limit(law):
    size = np.geomspace(LEAST_SIZE, 1e6, 400)
    for s in (WEAKEST, 0.2, 0.84):
        k = law_value(law.coefficients, s, size)
        limit = law_value(law.coefficients, s, np.inf)
        assert np.all(np.diff(k) > 0)
        assert k[0] > 0
        assert k[-1] < limit == pytest.approx(k[-1], rel=1e-3)


def test_the_limit_falls_with_disorder_from_k_0(law):
    k = law_value(law.coefficients, np.linspace(0, law.disorder[1], 50), np.inf)
    assert k[0] == law.coefficients[0]
    assert np.all(np.diff(k) < 0)
    assert k[0] < 4


def test_the_law_approaches_its_limit_with_the_exponent_of_depinning(law):
    size = np.array([1e6, 1e7])
    missing = 1 - law_value(law.coefficients, 0.2, size) / law_value(law.coefficients, 0.2, np.inf)
    assert np.log10(missing[0] / missing[1]) == pytest.approx(0.612, abs=1e-3)


def force_correlator_length(kind, spectrum):
    """xi_u by quadrature of the spectrum of w_loc integrated along the front."""
    order = 1.0 if kind == "roughness" else 0.0
    ends = np.array([0, 2 * np.pi / spectrum.roll_off, 2 * np.pi / spectrum.short_cutoff])

    def moment(power):
        return sum(
            quad(lambda q: q ** (order + power) * float(spectrum.density(np.array(q))), a, b)[0]
            for a, b in pairwise(ends)
            if b > a
        )

    return np.sqrt(moment(0) / moment(2))


@pytest.mark.parametrize("kind", ["roughness", "chemical"])
@pytest.mark.parametrize("spectrum", SPECTRA, ids=["flat", "h08", "h03"])
def test_the_larkin_length_is_that_of_the_integrated_field(kind, spectrum):
    length = force_correlator_length(kind, spectrum)
    assert force_correlation_length(kind, spectrum) == pytest.approx(length, rel=1e-6)
    assert larkin_length(kind, spectrum, 0.3) == pytest.approx(2 * np.pi * length / 0.09, rel=1e-6)


def test_xi_u_of_roughness_is_the_rms_height_over_the_rms_slope():
    height, slope = SPECTRA[1].mean_square(0), SPECTRA[1].mean_square(1)
    assert force_correlation_length("roughness", SPECTRA[1]) == pytest.approx(
        np.sqrt(height / slope)
    )


@pytest.mark.parametrize(
    ("radius", "ratio"), [((3 / 2) ** (1 / 3), 2), ((8 / 3) ** (1 / 3), 3), (6 ** (1 / 3), 5)]
)
def test_the_springs_of_a_sphere_are_a_half_a_third_and_a_fifth_of_its_radius(radius, ratio):
    assert radius / jkr.spring(radius) == pytest.approx(ratio)


def test_the_shipped_law_is_fitted_to_the_shipped_cells(law):
    again = fitted_law(measured_cells())
    np.testing.assert_allclose(again.coefficients, law.coefficients, rtol=1e-6, atol=1e-6)
    assert again.rms == pytest.approx(law.rms, rel=1e-6)
    assert again.size == pytest.approx(law.size)


def test_the_fit_finds_the_law_that_was_planted(rng):
    truth = (3.6, 0.5, 0.1, 0.05, 1.0, 1.2, 2.0, 1.2, 0.6)
    template = measured_cells()[0]
    cells = [
        planted_cell(template, truth, s, g, breadth, 1 + 0.01 * rng.standard_normal())
        for s, breadth in zip(
            (0.1, 0.2, 0.4, 0.6, 0.84, 1.1), (1, 1.2, 1.4, 1, 1.4, 1.2), strict=True
        )
        for g in np.geomspace(0.3, 100, 10)
    ]
    found = fitted_law(cells)
    s, g = np.array([0.1, 0.4, 0.84]), np.array([1.0, 10.0, np.inf])
    np.testing.assert_allclose(
        law_value(found.coefficients, s[:, None], g),
        law_value(truth, s[:, None], g),
        rtol=0.03,
    )
    assert found.rms < 0.02
    assert found.exponent[0] == pytest.approx(0.612, abs=3 * found.exponent[1])


def planted_cell(template: LawCell, truth, s, g, breadth, noise):
    """A cell whose k is that of the law times the noise."""
    k = float(law_value(truth, s, g, breadth)) * noise
    place = {"disorder": s, "size": g, "breadth": breadth}
    return replace(template, **place, both=k, error=0.01 * k, numerical_error=0.0)


def test_the_interval_holds_the_three_errors():
    found = pinning_factor(0.3, 5.0)
    expected = np.sqrt(found.statistical**2 + found.numerical**2 + found.model**2)
    assert found.factor.standard_error == pytest.approx(expected)
    assert found.warning == ""
    assert pinning_factor(0.3, np.inf).factor.value > found.factor.value


def test_outside_of_what_was_measured_there_is_a_warning_and_a_wider_interval(law):
    strongest, inside = law.disorder[1], pinning_factor(law.disorder[1] * 0.999, 5.0)
    strong, small = pinning_factor(1.2 * strongest, 5.0), pinning_factor(0.3, 0.1)
    assert "above the strongest disorder" in strong.warning
    assert strong.factor.standard_error > inside.factor.standard_error
    assert "below the smallest" in small.warning
    assert small.factor.low == 0


def test_a_measured_k_is_extrapolated_by_the_ratio_of_the_law(law):
    ratio = infinite_ratio(0.2, 3.0)
    ends = law_value(law.coefficients, 0.2, np.array([np.inf, 3.0]))
    assert ratio.value == pytest.approx(ends[0] / ends[1])
    assert infinite_ratio(0.2, 1e7).value == pytest.approx(1, abs=1e-3)
    # Farther from the limit more is to be added, and less of that is known.
    assert infinite_ratio(0.2, 1.0).standard_error > ratio.standard_error > 0
    assert np.isnan(infinite_ratio(0.2, law.size[0] / 2).value)


def test_a_sphere_has_the_k_of_the_straight_front_at_the_springs_of_either_branch(law):
    found = sphere_factors("roughness", FLAT, 0.05, 1.9)
    w_rms = 2 * np.sqrt(0.05)
    for sign, branch in ((-1, found.approach), (1, found.retraction)):
        adhesion = 0.95 + sign * branch.factor.value * 0.05
        size = jkr.spring(1.9, adhesion) / larkin_length("roughness", FLAT, w_rms)
        k = law_value(law.coefficients, w_rms, size, slope_breadth("roughness", FLAT))
        assert branch.factor.value == pytest.approx(float(k))
    assert found.both.value == pytest.approx(
        (found.approach.factor.value + found.retraction.factor.value) / 2
    )
    assert found.size == pytest.approx(found.spring / found.larkin_length)


def test_what_is_no_number_has_no_k():
    with pytest.raises(TypeError, match="w_rms is 'inf'; give a number"):
        pinning_factor("inf", 5.0)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: pinning_factor(0.0, 1.0), "w_rms is 0 w_int"),
        (lambda: pinning_factor(2.0, 1.0), "w_rms is 2 w_int"),
        (lambda: pinning_factor(0.3, 0.0), "size g is 0"),
        (lambda: pinning_factor(0.3, np.nan), "size g is nan"),
        (lambda: sphere_factors("roughness", FLAT, 1.0, 1.9), "energy of full conformity is 1"),
        (lambda: sphere_factors("roughness", FLAT, 0.05, 0.0), "contact radius is 0"),
        (lambda: sphere_factors("roughness", FLAT, 0.05, 0.5), "nothing holds the edge"),
    ],
)
def test_what_has_no_k_is_refused(call, sentence):
    with pytest.raises(ValueError, match=sentence):
        call()


def test_spheres_lie_on_the_law_without_having_been_used(law):
    rows = [row for path in SPHERES for row in read_spheres(path)]
    apart = []
    for row in rows:
        found = law_of(row)
        if found.size > 1 and 2 * np.sqrt(row.elastic_energy) < law.disorder[1]:
            apart.append(found.both.value / row.both - 1)
    assert len(apart) > 20
    assert np.sqrt(np.mean(np.square(apart))) < 0.08


def test_the_pages_tell_the_numbers_of_the_shipped_law(tmp_path):
    rows = [row for path in SPHERES for row in read_spheres(path)]
    for name in PAGES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text((ROOT / name).read_text())
    renew_pages(tmp_path, rows)
    for name in PAGES:
        # Otherwise: python -m studies.law.measure pages --table (both) --output .
        assert (tmp_path / name).read_text() == (ROOT / name).read_text()
        assert "<!-- end -->" in (ROOT / name).read_text()


def test_a_part_that_there_is_not_is_refused(law):
    page = "<!-- weather of the law -->\n<!-- end -->"
    with pytest.raises(ValueError, match="no part of the law is weather; choose one of coeff"):
        renewed_page(page, law, measured_cells(), "", "")


def test_the_table_of_the_limit_holds_its_values_and_where_k_is_that_of_the_paper(law):
    text = limit_part()
    k = pinning_factor(0.4, np.inf).factor
    assert f"| 0.4 | {k.value:.2f} ({k.low:.2f} to {k.high:.2f}) |" in text
    s, low, high = crossing()
    assert float(law_value(law.coefficients, s, np.inf)) == pytest.approx(3)
    assert pinning_factor(low, np.inf).factor.low == pytest.approx(3)
    assert pinning_factor(high, np.inf).factor.high == pytest.approx(3)


def test_the_finding_is_three_sentences_with_the_numbers_of_the_law(law):
    text = finding(departure_of_spheres(0.0251, 65, 87))
    assert len(re.findall(r"\.(?= [A-Z]|$)", text)) == 3
    k_0 = pinning_factor(WEAKEST, np.inf).factor
    assert f"k is {k_0.value:.2f} ({k_0.low:.2f} to {k_0.high:.2f}) at vanishing" in text
    assert float(law_value(law.coefficients, 0.0, least_size())) == pytest.approx(3)
    assert "within 2.5% rms where g is above 1 (65 of 87" in text


def test_the_table_of_spheres_states_how_far_the_law_is():
    rows = [row for path in SPHERES for row in read_spheres(path)]
    table = sphere_table(rows)
    assert len(re.findall(r"^\| (?!spectrum|---)", table, re.MULTILINE)) == len(rows)
    assert re.search(r"For g above 1, \d+ rows: rms [\d.]+%, worst [\d.]+%", table)


def drawn_at(container):
    """Points of errorbars."""
    return np.transpose(container.lines[0].get_data())


def test_the_figure_collapses_fronts_and_spheres_on_one_curve(law):
    fronts = spectra_points(measured_cells())
    s, g = np.array([0.2, 0.4]), np.array([5.0, 10.0])
    spheres = LawPoints(
        "spheres",
        s,
        g,
        law_value(law.coefficients, s, g),
        np.full(2, 0.01),
        np.full(2, TYPICAL_BREADTH),
    )
    left, right = law_figure(fronts, spheres).axes
    curve = left.get_lines()[0].get_xydata()
    points = drawn_at(left.containers[len(fronts)])
    expected = np.interp(np.log(points[:, 0]), np.log(curve[:, 0]), curve[:, 1])
    np.testing.assert_allclose(points[:, 1], expected, rtol=1e-3)
    # Extrapolated they lie on the limit.
    np.testing.assert_allclose(
        drawn_at(right.containers[-1]), np.transpose([s, law_value(law.coefficients, s, np.inf)])
    )
    labels = [text.get_text() for text in left.get_legend().get_texts()]
    assert len(labels) == len(fronts) + 2
    assert "$H=0.8$" in labels
    theories = [text.get_text() for text in right.get_legend().get_texts()]
    assert [one[:5] for one in theories if "k = " in one] == ["$k = ", "$k = "]


def test_the_command_draws_the_law(tmp_path):
    (path,) = draw_law(
        tmp_path / "figures", [row for path in SPHERES for row in read_spheres(path)]
    )
    assert path.name == "law.png"
    assert path.stat().st_size > 10_000


def test_a_contact_is_refused_up_to_the_radius_at_which_it_is_lost_in_retraction():
    with pytest.raises(ValueError, match=r"at or below that of pull-off \(0\.56") as caught:
        sphere_factors("roughness", FLAT, 0.05, 0.5)
    lost = float(str(caught.value).split("(")[1].split(")")[0])
    k = sphere_factors("roughness", FLAT, 0.05, lost + 5e-4).retraction.factor.value
    assert jkr.pull_off_radius(1 - 0.05 + k * 0.05) == pytest.approx(lost, rel=1e-3)
