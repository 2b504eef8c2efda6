"""The law of k: its limits, its lengths, and what it refuses."""

from dataclasses import astuple
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from crackfront.analysis.law import (
    LEAST_SIZE,
    TYPICAL_BREADTH,
    WEAKEST,
    infinite_ratio,
    law_value,
    pinning_factor,
    pinning_factors,
    shipped_law,
    spectral_breadth,
)
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.core import jkr
from crackfront.core.adhesion import force_correlation_length, larkin_length
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum

FLAT = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
RING = TabulatedSpectrum((1.2, 1.199, 1.0), (1e-4, 1.0, 1.0))
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


def test_a_front_that_is_hardly_pinned_has_a_k_of_zero(law):
    assert law_value(law.coefficients, 0.2, 1e-250) == 0.0


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


@pytest.mark.parametrize(
    ("radius", "ratio"), [((3 / 2) ** (1 / 3), 2), ((8 / 3) ** (1 / 3), 3), (6 ** (1 / 3), 5)]
)
def test_the_springs_of_a_sphere_are_a_half_a_third_and_a_fifth_of_its_radius(radius, ratio):
    assert radius / jkr.spring(radius) == pytest.approx(ratio)


def test_the_springs_of_a_sphere_are_infinitely_long_up_to_pull_off():
    lost = jkr.pull_off_radius(0.7)
    assert jkr.spring(0.99 * lost, 0.7) == np.inf
    assert np.isfinite(jkr.spring(1.01 * lost, 0.7))


def test_the_interval_holds_the_three_errors(law):
    factor = pinning_factor(0.3, 5.0)
    expected = np.sqrt(factor.statistical**2 + factor.numerical**2 + factor.model**2)
    assert factor.factor.standard_error == pytest.approx(expected)
    assert factor.warning == ""
    # Without a breadth the law's error is that between the narrowest and the broadest spectrum too.
    factor_at_5 = pinning_factor(0.3, 5.0, breadth=TYPICAL_BREADTH)
    ends = law_value(law.coefficients, 0.3, 5.0, np.array(law.breadth))
    assert factor.model == pytest.approx(np.hypot(factor_at_5.model, np.ptp(ends) / np.sqrt(12)))
    assert pinning_factor(0.3, np.inf).factor.value > factor.factor.value


def test_outside_of_what_was_measured_there_is_a_warning_and_a_wider_interval(law):
    strongest, inside = law.disorder[1], pinning_factor(law.disorder[1] * 0.999, 5.0)
    strong, small = pinning_factor(1.2 * strongest, 5.0), pinning_factor(0.3, 0.1)
    assert "above the strongest disorder" in strong.warning
    assert strong.factor.standard_error > inside.factor.standard_error
    assert "below the smallest" in small.warning
    usual = pinning_factor(0.3, 5.0, breadth=law.breadth[1])
    broad = pinning_factor(0.3, 5.0, breadth=1.5 * law.breadth[1])
    assert "above the largest that was measured" in broad.warning
    assert broad.factor.standard_error > usual.factor.standard_error
    assert small.factor.low == 0
    narrow = pinning_factor(0.3, 5.0, breadth=0.25)
    assert "breadth 0.25 of the spectrum is below the smallest that was measured" in narrow.warning
    narrowest = pinning_factor(0.3, 5.0, breadth=law.breadth[0])
    assert narrow.factor.standard_error > narrowest.factor.standard_error
    for limit in (pinning_factor(WEAKEST, 5.0), pinning_factor(0.3, 1e9)):
        assert limit.warning == ""


@pytest.mark.parametrize("breadth", [None, 0.9, 10.0])
def test_k_of_an_array_of_fronts_is_that_of_each_front(breadth):
    w_rms, size = np.array([WEAKEST, 0.3, 1.9])[:, None], np.array([0.1, 5.0, np.inf])
    fronts = pinning_factors(w_rms, size, breadth)
    for place in np.ndindex(3, 3):
        front = pinning_factor(w_rms[place[0], 0], size[place[1]], breadth=breadth)
        assert astuple(fronts.factor.at(place)) == pytest.approx(astuple(front.factor), rel=1e-6)
        for name in ("statistical", "numerical", "model"):
            error = getattr(fronts, name)[place]
            assert error == pytest.approx(getattr(front, name), rel=1e-6)


@pytest.mark.parametrize(("kind", "mean"), [("roughness", 1 - 0.8**2 / 4), ("chemical", 1.0)])
def test_the_negative_share_is_the_part_of_gaussian_works_of_adhesion_below_zero(rng, kind, mean):
    works = mean + 0.8 * rng.standard_normal(10**6)
    assert pinning_factor(0.8, 5.0, kind).negative_share == pytest.approx(
        np.mean(works < 0), abs=2e-3
    )


def test_a_measured_k_is_extrapolated_by_the_ratio_of_the_law(law):
    ratio = infinite_ratio(0.2, 3.0)
    ends = law_value(law.coefficients, 0.2, np.array([np.inf, 3.0]))
    assert ratio.value == pytest.approx(ends[0] / ends[1])
    assert infinite_ratio(0.2, 1e7).value == pytest.approx(1, abs=1e-3)
    # Farther from the limit more is to be added, and less of that is known.
    assert infinite_ratio(0.2, 1.0).standard_error > ratio.standard_error > 0
    assert np.isnan(infinite_ratio(0.2, law.size[0] / 2).value)


def test_a_sphere_has_the_k_of_the_straight_front_at_the_springs_of_either_branch(law):
    factors = sphere_factors("roughness", FLAT, 0.05, 1.9)
    w_rms = 2 * np.sqrt(0.05)
    for sign, branch in ((-1, factors.approach), (1, factors.retraction)):
        adhesion = 0.95 + sign * branch.factor.value * 0.05
        size = jkr.spring(1.9, adhesion) / larkin_length("roughness", FLAT, w_rms)
        k = law_value(law.coefficients, w_rms, size, spectral_breadth("roughness", FLAT))
        assert branch.factor.value == pytest.approx(float(k))
    # The errors of both branches are those of one law.
    branches = [astuple(branch.factor) for branch in (factors.approach, factors.retraction)]
    assert astuple(factors.both) == pytest.approx(np.mean(branches, axis=0))
    assert factors.size == pytest.approx(factors.spring / factors.larkin_length)


def test_narrow_spectra_have_the_smallest_k_at_strong_disorder_and_nearly_the_same_at_weak():
    breadths = [
        spectral_breadth("roughness", spectrum_or_breadth)
        for spectrum_or_breadth in (RING, *SPECTRA)
    ]
    assert breadths[0] < 0.5 < breadths[1] < breadths[2]
    ring, flat, broad = (
        pinning_factor(0.84, np.inf, breadth=breadth).factor.value for breadth in breadths[:3]
    )
    assert ring < flat < broad
    weak = [pinning_factor(WEAKEST, 3.0, breadth=breadth).factor.value for breadth in breadths]
    assert weak == pytest.approx([weak[0]] * 4, rel=0.04)
    limits = [
        pinning_factor(WEAKEST, np.inf, breadth=spectrum_or_breadth).factor.value
        for spectrum_or_breadth in breadths
    ]
    assert limits == pytest.approx([limits[0]] * 4)


def test_a_spectrum_in_pieces_of_equal_variance_is_as_broad_as_their_number():
    # Two rings of equal variance, q^3 C d(ln q), share it over twice the e-folds of one.
    pair = TabulatedSpectrum(
        (4.8, 4.796, 4.0, 3.996, 1.2, 1.199, 1.0), (1e-7, 64.0, 64.0, 1e-7, 1e-7, 1.0, 1.0)
    )
    ring_excess, two = (spectral_breadth("roughness", spectrum) - 0.25 for spectrum in (RING, pair))
    assert two == pytest.approx(2 * ring_excess, rel=0.02)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: pinning_factor(0.0, 1.0), "w_rms is 0.0; it must be"),
        (lambda: pinning_factor(2.0, 1.0), "w_rms is 2.0; it must be less than 2"),
        (lambda: pinning_factor(0.3, 0.0), "size is 0.0; it must be"),
        (lambda: pinning_factor(0.3, np.nan), "size is nan; it must be"),
        (lambda: pinning_factor(0.3, 5.0, breadth=0.1), "breadth is 0.1; it must be greater"),
        (lambda: pinning_factor(0.3, 5.0, "rough"), "kind is 'rough'; it must be"),
        (lambda: sphere_factors("roughness", FLAT, 1.0, 1.9), "energy of full conformity is 1"),
        (lambda: sphere_factors("roughness", FLAT, 0.05, 0.0), "contact radius is 0"),
        (lambda: sphere_factors("roughness", FLAT, 0.05, 0.5), "the edge is unstable"),
    ],
)
def test_what_has_no_k_is_refused(call, sentence):
    with pytest.raises(ValueError, match=sentence):
        call()


def test_a_contact_is_refused_up_to_the_radius_at_which_it_is_lost_in_retraction():
    with pytest.raises(ValueError, match=r"at or below pull-off \(0\.56") as caught:
        sphere_factors("roughness", FLAT, 0.05, 0.5)
    lost = float(str(caught.value).split("(")[1].split(")")[0])
    k = sphere_factors("roughness", FLAT, 0.05, lost + 5e-4).retraction.factor.value
    assert jkr.pull_off_radius(1 - 0.05 + k * 0.05) == pytest.approx(lost, rel=1e-3)
