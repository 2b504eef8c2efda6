"""Predictions as results: of a series, with their options, as numbers and as a drawing."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import crackfront as cf
from crackfront.analysis.estimate import REACH, Estimate
from crackfront.core.adhesion import front_stress_intensity, overlap_share, rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from crackfront.measured.prediction.conditions import theory_verdict, zero_load_radius
from crackfront.measured.prediction.prediction import predicted
from crackfront.measured.prediction.works_by_source import reason_for_differences, works_by_source
from tests.measured.made import SCENE

SPHERE = {"radius": "1.25mm", "work_of_adhesion": "63mJ/m2", "poisson": 0.5}


@pytest.fixture(scope="module")
def rough():
    """A surface by its numbers, which is quick to predict."""
    return cf.self_affine_surface(rms="40nm", roll_off="2um", hurst=0.8, short_cutoff="20nm")


def test_a_theory_that_does_not_apply_is_a_result_with_a_reason(rough):
    moduli = ("0.5MPa", "5GPa", "0.7MPa")
    series = [cf.predict(rough, modulus=modulus, **SPHERE) for modulus in moduli]
    assert [result.applies for result in series] == [True, False, True]
    values = [result.hysteresis.value for result in series]
    assert np.isfinite(values).tolist() == [True, False, True]
    stiff = series[1]
    assert series[0].reason == ""
    assert "full conformity fails" in stiff.reason
    assert "It would be met with" in stiff.reason
    assert stiff.reason in " ".join(repr(stiff).split())
    assert stiff.e_el.value > stiff.work_of_adhesion
    assert stiff.pull_off_force_smooth == pytest.approx(series[0].pull_off_force_smooth)
    with pytest.raises(ValueError, match=r"does not apply: .*full conformity"):
        cf.predict(rough, modulus="5GPa", strict=True, **SPHERE)


def test_a_sphere_may_be_stated_as_in_the_command(rough):
    by_options = cf.predict(rough, modulus="0.7MPa", **SPHERE)
    assert by_options.hysteresis.value == cf.predict(rough, SCENE).hysteresis.value
    with pytest.raises(ValueError, match=r"modulus is '0\.7MPa', and a sphere is given"):
        cf.predict(rough, SCENE, modulus="0.7MPa")
    with pytest.raises(ValueError, match="the sphere is incomplete; name all of modulus"):
        cf.predict(rough, modulus="0.7MPa")


def test_a_prediction_as_a_dictionary_is_json_with_all_numbers(rough):
    for modulus in ("0.7MPa", "5GPa"):
        result = cf.predict(rough, modulus=modulus, **SPHERE)
        content = json.loads(json.dumps(result.to_dict(), allow_nan=False))
        assert content["outcome"] == result.verdict.outcome
        assert len(content["remarks"]) == len(result.verdict.remarks)
        assert (content["prediction"] is None) == (not result.applies)
        if result.applies:
            entry = content["prediction"]["hysteresis"]
            assert (entry["value"], entry["units"]) == (result.hysteresis.value, "J m-2")


def test_a_prediction_draws_the_forces_of_both_branches(rough):
    result = cf.predict(rough, modulus="0.7MPa", **SPHERE)
    axes = result.plot(Figure().add_subplot())
    lowest = [line.get_xdata().min() for line in axes.lines[:3]]
    expected = [
        1.5 * np.pi * result.radius * work
        for work in (result.w_appr.value, result.w_retr.value, result.work_of_adhesion)
    ]
    np.testing.assert_allclose(lowest, -1e6 * np.array(expected), rtol=1e-3)
    stiff = cf.predict(rough, modulus="5GPa", **SPHERE).plot(Figure().add_subplot())
    assert [text.get_text()[:6] for text in stiff.get_legend().get_texts()] == ["smooth"]
    with pytest.raises(TypeError, match="axes is 3; give one Axes"):
        result.plot(3)


def test_an_error_of_the_work_of_adhesion_adds_to_the_intervals_in_quadrature(surface, prediction):
    error = 2e-3
    wider = predicted(surface, SCENE, adhesion_error=error)
    ends = [
        predicted(surface, replace(SCENE, work_of_adhesion=SCENE.work_of_adhesion + shift))
        for shift in (-REACH * error, REACH * error)
    ]
    for name in ("w_appr", "w_retr"):
        exact, wide = getattr(prediction, name), getattr(wider, name)
        low, high = (getattr(end, name).value for end in ends)
        assert wide.value == exact.value
        assert wide.value - wide.low == pytest.approx(
            math.hypot(exact.value - exact.low, exact.value - low)
        )
        assert wide.high - wide.value == pytest.approx(
            math.hypot(exact.high - exact.value, high - exact.value)
        )
    assert "w_int" in [remark.concerns for remark in wider.verdict.with_severity("note")]
    assert wider.hysteresis.low < prediction.hysteresis.low
    assert wider.hysteresis.high > prediction.hysteresis.high


def test_an_error_that_reaches_zero_is_named_with_the_largest_one(rough):
    with pytest.raises(ValueError, match=r"error of 40 mJ/m2.* give an error below 32\.1 mJ"):
        cf.predict(rough, SCENE, work_of_adhesion_error="40mJ/m2")


@pytest.mark.parametrize(
    ("thickness", "severity"), [("2mm", "holds"), ("0.5mm", "reservation"), (None, "note")]
)
def test_a_thickness_is_compared_with_the_contact_and_else_a_half_space(rough, thickness, severity):
    result = cf.predict(rough, SCENE, thickness=thickness)
    [remark] = [item for item in result.verdict.remarks if item.concerns == "thickness"]
    assert remark.severity == severity
    assert "half-space" in remark.sentence
    assert "half-space" in repr(result)
    millimetres = float((thickness or "0mm").removesuffix("mm"))
    radii = f"{1e-3 * millimetres / result.contact_radius:.2g} radii"
    assert (radii in remark.sentence) == (thickness is not None)
    assert result.hysteresis.value == cf.predict(rough, SCENE).hysteresis.value


def test_long_waves_need_a_thick_layer_under_a_small_contact(surface):
    small = replace(SCENE, radius=1e-8)
    thickness = 20 * zero_load_radius(small)
    assert thickness < surface.measures[1].longest
    verdict = theory_verdict(surface, small, thickness=thickness)
    assert "thickness" in [remark.concerns for remark in verdict.with_severity("reservation")]


def test_the_paper_stands_next_to_the_law_and_the_corrected_values(prediction):
    paper, front, corrected = works_by_source(prediction)
    w_int, e_el = prediction.work_of_adhesion, prediction.e_el.value
    assert paper.w_appr.value == pytest.approx(w_int - 4 * e_el)
    assert paper.w_retr.value == pytest.approx(w_int + 2 * e_el)
    assert paper.hysteresis.value == pytest.approx(6 * e_el)
    assert paper.w_appr.low == pytest.approx(w_int - 4 * prediction.e_el.high)
    assert front.hysteresis == prediction.front_hysteresis
    assert front.w_retr.value - front.w_appr.value == pytest.approx(front.hysteresis.value)
    assert corrected.w_appr == prediction.w_appr
    assert paper.hysteresis.value > front.hysteresis.value > corrected.hysteresis.value
    text = " ".join(repr(prediction).split())
    entry = text.partition(paper.source)[2].partition("The theory applies")[0]
    for work in (paper.hysteresis, paper.w_appr, paper.w_retr, front.hysteresis):
        assert f"{1e3 * work.value:.3g} mJ/m2" in entry


def test_the_reason_for_other_works_has_the_k_of_the_prediction(prediction):
    assert f"is {prediction.k.value:.3g} at" in reason_for_differences(prediction)
    assert "boundary elements" in reason_for_differences(prediction)
    weak = cf.self_affine_surface(rms="1nm", roll_off="2um", hurst=0.8, short_cutoff="20nm")
    large = cf.predict(
        weak, radius="10mm", modulus="0.7MPa", poisson=0.5, work_of_adhesion="63mJ/m2"
    )
    assert "boundary elements" not in reason_for_differences(large)


def test_the_paper_s_numbers_for_nanodiamond_follow_from_its_e_el(prediction):
    """18.4, 85.3 and 66.8 mJ/m2 of e_el = 11.14 mJ/m2."""
    nanodiamond = replace(prediction, e_el=Estimate(11.14e-3, 0.0, 11.14e-3, 11.14e-3))
    paper = works_by_source(nanodiamond)[0]
    works = [1e3 * work.value for work in (paper.w_appr, paper.w_retr, paper.hysteresis)]
    assert works == pytest.approx([18.4, 85.3, 66.8], abs=0.06)


def test_solids_overlap_on_the_part_of_the_front_that_the_theory_quotes():
    """At e_el/w_int = 0.177: 0.9% of the front, next to a negative w_loc on 16%."""
    assert overlap_share(0.177) == pytest.approx(0.009, abs=0.0005)
    spectrum = SelfAffineSpectrum(0.02, 0.08, hurst=0.8).with_elastic_energy(0.177)
    heights = gaussian_field(spectrum, 1024, 4.0, np.random.default_rng(2))
    stress = front_stress_intensity(heights, 4.0 / 1024)
    jkr = math.sqrt(2 * CONTACT_MODULUS * WORK_OF_ADHESION)
    adhesion = rough_adhesion(heights, 4.0 / 1024)
    assert np.mean(stress < -jkr) == pytest.approx(overlap_share(adhesion.e_el), rel=0.1)
    assert np.mean(adhesion.work_of_adhesion < 0) == pytest.approx(0.164, rel=0.05)


def test_the_overlap_is_reported_next_to_the_negative_w_loc(prediction):
    relative = prediction.e_el.value / prediction.work_of_adhesion
    assert prediction.overlap_share == overlap_share(relative)
    [remark] = [item for item in prediction.verdict.remarks if "attraction ne" in item.concerns]
    for share in (prediction.negative_share, prediction.overlap_share):
        assert f"{share:.2%}" in remark.sentence


def test_a_slope_that_an_assumed_cutoff_decides_is_undecided_and_says_so():
    numbers = {"rms": "120nm", "correlation_length": "1um", "hurst": 0.8}
    assumed = cf.predict(cf.self_affine_surface(**numbers), SCENE)
    [remark] = assumed.verdict.with_severity("undecided")
    assert "short cutoff, which is assumed to be 1 nm" in remark.sentence
    assert any("--short-cutoff" in text for text in remark.remedies)
    named = cf.predict(cf.self_affine_surface(**numbers, short_cutoff="1nm"), SCENE)
    assert "small slopes fails" in named.reason
    assert "assumed" not in named.reason
    longer = cf.predict(cf.self_affine_surface(**numbers, short_cutoff="100nm"), SCENE)
    assert longer.verdict.outcome == "applies with reservations"


def test_an_interval_that_its_digits_do_not_show_is_left_out(prediction):
    narrow = Estimate(105.01e-6, 0.0, 104.99e-6, 105.02e-6)
    page = repr(replace(prediction, pull_off_force=narrow))
    assert "pull-off force    105 uN; smooth" in page
