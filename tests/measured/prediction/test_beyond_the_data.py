"""What an output says of waves that were not measured agrees with its other numbers."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from crackfront.analysis.estimate import Estimate
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import Scales
from crackfront.measured.prediction.conditions import LARGEST_ENERGY, theory_verdict
from crackfront.measured.prediction.next_scan import measure_next
from crackfront.measured.prediction.prediction import predicted
from crackfront.measured.prediction.surface_remarks import spectrum_remarks
from crackfront.measured.scan.psd import Psd
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import measured_surface
from crackfront.measured.spectrum.stated import density_surface
from crackfront.surfaces.written_units import si_value
from tests.commands import run
from tests.measured.made import DETAIL, OVERVIEW, SCENE, shipped_surface, write_line

SIDE, N_POINT = 12.8e-6, 128


@pytest.fixture(scope="module")
def profile(tmp_path_factory):
    """Surface of a short profile, whose points miss most of the roughness."""
    spectrum = SelfAffineSpectrum(2 * SIDE / N_POINT, SIDE / 20, hurst=0.8)
    heights = gaussian_field(spectrum, N_POINT, SIDE, np.random.default_rng(5))[:, 3]
    micrometres = 60e-3 * heights / heights.std()
    path = write_line(
        tmp_path_factory.mktemp("profile") / "line.csv", micrometres, 1e6 * SIDE / N_POINT
    )
    path.write_text(f"x (um) z (um)\n{path.read_text()}")
    return measured_surface(read_measurements([path]))


def with_shares(surface, **changes):
    """A surface with other contributions to e_el."""
    shares = replace(surface.joint.shares, **changes)
    return replace(surface, joint=replace(surface.joint, shares=shares))


def lengths(sentence):
    """All lengths of a sentence (Units: m)."""
    texts = re.findall(r"[\d.]+(?:e[-+]?\d+)? [pnum]?m\b", sentence)
    return [si_value(text, "m", name="length") for text in texts]


def test_a_profile_without_short_waves_states_bounds_and_cannot_be_decided(profile):
    missing = profile.shares.missing_short
    assert missing.low < 1 < missing.value < missing.high
    prediction = predicted(profile, SCENE)
    rows = prediction.__repr__().splitlines()
    texts = {row[:18].strip(): row[18:] for row in rows}
    for name, word in {"hysteresis": "least", "e_el": "least", "w_appr": "most"}.items():
        assert texts[name].startswith(f"at {word} ")
    # With the missing waves e_el would be above w_int.
    assert prediction.e_el.value * (1 + missing.value) > SCENE.work_of_adhesion
    assert prediction.verdict.outcome == "cannot be decided"
    [undecided] = prediction.verdict.with_severity("undecided")
    assert undecided.concerns == "full conformity"


def test_a_series_of_samples_prints_bounds_as_the_page_does(tmp_path):
    density = Path(__file__).parents[3] / "examples/density.csv"
    table = tmp_path / "samples.csv"
    table.write_text(f"sample,psd\nA,{density}\n")
    sphere = ("--modulus", "0.7MPa", "--poisson", "0.5", "--radius", "1.25mm")
    words = ("samples", table, *sphere, "--work-of-adhesion", "63mJ/m2", "--no-figure")
    assert "A: hysteresis at least 22.7 mJ/m2" in run(*words, "--csv", tmp_path / "out.csv").output


def test_missing_waves_that_leave_e_el_below_w_int_do_not_change_the_verdict(profile):
    strong = replace(SCENE, work_of_adhesion=100 * SCENE.work_of_adhesion)
    verdict = theory_verdict(profile, strong)
    assert not verdict.with_severity("undecided", "fails")


def test_a_surface_that_is_measured_has_no_bounds_in_its_headline(prediction):
    assert not prediction.at_least
    assert "at least" not in repr(prediction)


def test_the_range_of_what_is_missing_contains_its_value(profile, surface):
    for shares in (profile.shares, surface.shares, shipped_surface(DETAIL).shares):
        for part in (shares.missing_short, shares.continued_long):
            assert part.low <= part.value <= part.high


def test_long_waves_that_cannot_matter_are_no_reservation(surface):
    parameters = surface.joint.fit.surface.copy()
    parameters[:, 4] = np.log(surface.joint.fit.lowest / 2)  # a roll-off outside of the scans
    fit = replace(surface.joint.fit, surface=parameters)
    assert not fit.has_roll_off
    for high, is_told in ((0.02, False), (0.4, True)):
        longer = Estimate(0.002, np.nan, 0.0, high)
        extended = with_shares(surface, continued_long=longer)
        extended = replace(extended, joint=replace(extended.joint, fit=fit))
        sentences = [remark.sentence for remark in spectrum_remarks(extended)]
        assert any("no plateau" in sentence for sentence in sentences) == is_told


def test_the_edge_of_the_hurst_exponents_counts_only_short_waves(surface):
    parameters = surface.joint.fit.surface.copy()
    parameters[:, 2] = 0.99
    fit = replace(surface.joint.fit, surface=parameters)
    for longer, is_told in ((0.0, True), (0.28, False)):
        part = Estimate(longer, np.nan, longer, longer)
        extended = with_shares(surface, continued=0.3, measured=0.7, continued_long=part)
        extended = replace(extended, joint=replace(extended.joint, fit=fit))
        sentences = [remark.sentence for remark in spectrum_remarks(extended)]
        assert any("Hurst" in sentence for sentence in sentences) == is_told


def test_a_surface_that_is_mostly_modelled_is_to_be_measured(surface):
    longer = Estimate(0.5, np.nan, 0.4, 0.6)
    for part, word in ((longer, "a side of"), (longer.each(lambda share: share / 10), "pixels of")):
        extended = with_shares(surface, measured=0.4, continued=0.6, continued_long=part)
        sentence = measure_next(extended).sentence
        assert f"a scan with {word}" in sentence.lower()
        assert "hardly narrow it, but would measure" in sentence


@pytest.mark.parametrize(
    ("scale", "coarseness", "scans"), [(1.0, 1.0, 1), (1e-2, 1.0, 1), (1e3, 1.0, 1), (1.0, 12.0, 2)]
)
def test_a_recommended_scan_has_pixels_tips_and_points_that_exist(
    profile, scale, coarseness, scans
):
    """From a profile of 128 nm to one of 13 mm, and one that misses more of the short waves."""
    density = profile.joint.density
    lateral = replace(density, wavevector=density.wavevector / scale / coarseness)
    spectra = {
        name: getattr(profile.joint, name).in_units(1 / scale)
        for name in ("spectrum", "recorded", "extended")
    }
    measurement = replace(profile.scans[0].measurement, tip_radius=5e-9)
    coarser = replace(
        profile,
        joint=replace(profile.joint, density=lateral, **spectra),
        scans=(replace(profile.scans[0], measurement=measurement),),
    )
    sentence = measure_next(coarser).sentence
    pixels = [lengths(text)[0] for text in re.findall(r"pixels of at most [\d.]+ \w+", sentence)]
    sides = [lengths(text)[0] for text in re.findall(r"side of at least [\d.]+ \w+", sentence)]
    assert len(pixels) == len(sides) == scans
    assert min(lengths(sentence)) >= 0.3e-9
    for side, pixel in zip(sides, pixels, strict=True):
        assert side / pixel < 4096 * 1.1  # lengths have two digits
    for side, pixel in zip(sides[1:], pixels, strict=False):
        assert side / 2 >= 2 * 4 * pixel * 0.9  # waves that the coarser scan contains too


def test_waves_below_the_size_of_atoms_are_not_missing(tmp_path):
    for shortest in (0.9e-9, 20e-9):
        wavevector = 2 * np.pi / np.geomspace(1e-6, shortest, 30)
        density = 1e-34 * (wavevector / wavevector[0]) ** -2.5
        psd = Psd(tmp_path / "psd.csv", "0" * 8, wavevector, density, False, "a density", ())
        missing = density_surface(psd).shares.missing_short.value
        assert (missing > 0) == (shortest > 1e-9)
    # From 20 nm to 1 nm e_el grows as the square root of the wavevector.
    expected = (20**0.5 - 1) / (1 - 50**-0.5)
    assert missing == pytest.approx(expected, rel=0.03)


def test_the_uncertainty_of_e_el_has_one_meaning(surface):
    """An interval of a factor of 2.2 is known within a factor of 1.48."""
    energy = surface.half_derivative
    wide = replace(energy, low=energy.value / 1.48, high=energy.value * 1.48)
    [remark] = [
        remark
        for remark in theory_verdict(replace(surface, half_derivative=wide), SCENE).remarks
        if remark.concerns == "e_el"
    ]
    assert "interval" in remark.sentence
    assert "known" not in remark.sentence


def test_an_e_el_beyond_the_law_says_which_one_the_numbers_are_for(surface):
    modulus = SCENE.contact_modulus * 1.03 * LARGEST_ENERGY / 0.1615
    scales = replace(SCENE, contact_modulus=modulus)
    prediction = predicted(surface, scales)
    by_spectrum = surface.conformity_energy(modulus).value
    assert prediction.e_el.value < by_spectrum
    [remark] = [
        remark_text
        for remark_text in prediction.verdict.remarks
        if "numbers are for" in remark_text.sentence
    ]
    assert f"{1e3 * by_spectrum:.3g} mJ/m2" in remark.sentence


@pytest.mark.parametrize(("slope", "just"), [(0.3004, True), (0.4, False)])
def test_a_value_that_is_printed_as_its_limit_is_just_beyond_it(surface, slope, just):
    *measures, slopes = surface.measures
    steeper = replace(
        surface, measures=(*measures, replace(slopes, rms=Estimate(slope, 0, 0.2, 0.5)))
    )
    [remark] = [
        remark for remark in theory_verdict(steeper, SCENE).remarks if "slope" in remark.concerns
    ]
    assert ("just above 0.3" in remark.sentence) == just


@pytest.mark.parametrize(
    ("scales", "attraction_range"),
    [
        (Scales(1.25e-3, 63e-3, 1e-3), None),
        (Scales(5e-9, 63e-3, 1e6), None),
        (Scales(1.25e-3, 63e-3, 1e12), None),
        (Scales(1e-6, 1e-6, 1e8), 1e-3),
    ],
)
def test_remedies_name_spheres_and_solids_that_exist(surface, scales, attraction_range):
    verdict = theory_verdict(surface, scales, attraction_range)
    remedies = [text for remark in verdict.remarks for text in remark.remedies]
    assert remedies
    for text in remedies:
        number = re.search(r"(above|below) ([\d.e+-]+ \w+(?:/m2)?)", text)
        if number and "modulus" in text:
            assert 100 <= si_value(number[2], "Pa", name="modulus") <= 1e12
        elif number and "radius" in text:
            assert si_value(number[2], "m", name="radius") <= 1
        elif number and "w_int" in text:
            assert si_value(number[2], "J/m^2", name="w_int") <= 10


@pytest.mark.parametrize(("factor", "words"), [(2.0, "includes"), (0.5, "lacks"), (1.0, None)])
def test_an_e_el_as_recorded_that_differs_is_explained(surface, factor, words):
    recorded = surface.half_derivative.each(lambda number: factor * number)
    page = repr(predicted(replace(surface, recorded=recorded), SCENE))
    [row] = [row for row in page.splitlines() if row.startswith("as recorded")]
    assert (f"{factor:g} times e_el" in row) == (words is not None)
    assert words is None or words in row


def test_trusted_waves_are_the_same_on_the_page_and_in_the_details():
    prediction = predicted(shipped_surface(OVERVIEW), SCENE)
    [scan] = prediction.surface.scans
    [row] = [row for row in repr(prediction).splitlines() if row.startswith("as recorded")]
    assert lengths(row.split("trusted")[1]) == pytest.approx(scan.band.wavelengths, rel=0.01)
