"""Options of reading and predicting: the same in commands, library and configurations."""

import re
from pathlib import Path

import numpy as np
import pytest

import crackfront as cf
from crackfront.cli.surface_commands import predict, surface
from crackfront.measured.options import (
    PredictionOptions,
    ReadingOptions,
    SphereOptions,
    checked_options,
    for_files,
    reading_options,
)
from tests.measured.made import DETAIL, OVERVIEW, SCENE, measure_surfaces_once

READING, PREDICTION, SPHERE = (
    set(record.model_fields) for record in (ReadingOptions, PredictionOptions, SphereOptions)
)


def test_commands_have_the_options_of_the_library():
    known = {name: {item.name for item in command.params} for name, command in COMMANDS.items()}
    assert known["surface"] >= READING | SPHERE
    assert known["predict"] >= READING | PREDICTION | SPHERE


COMMANDS = {"surface": surface, "predict": predict}


def test_every_option_has_a_meaning_that_the_commands_show():
    for record in (ReadingOptions, PredictionOptions, SphereOptions):
        for name, field in record.model_fields.items():
            [shown] = [one.help for one in predict.params if one.name == name]
            assert shown.startswith(" ".join(field.description.split()))
    for function, names in ((cf.read_scan, READING), (cf.predict, PREDICTION)):
        assert names <= set(re.findall(r"\w+", function.__doc__))
    assert "One for all scans, one for each in order, or FILE=VALUE." in help_of("tip_radius")
    assert "May be repeated." in help_of("mask")


def help_of(name):
    """Help of an option of `crackfront predict`."""
    return next(one.help for one in predict.params if one.name == name)


def test_texts_and_numbers_mean_the_same():
    given = {"channel": 1, "detrend": 3, "size": [50, 40.0], "shortest": 4e-7, "mask": ()}
    texts = {"channel": "1", "detrend": "3", "size": "50,40", "shortest": "0.4um", "crop": None}
    one, other = (checked_options(ReadingOptions, values) for values in (given, texts))
    assert one.shortest == pytest.approx(other.shortest, rel=1e-12)
    assert (one.channel, one.detrend, one.size) == (other.channel, other.detrend, other.size)
    assert checked_options(PredictionOptions, {"range": 3e-10, "unit": "m"}).range == 3e-10


@pytest.mark.parametrize(
    "crop",
    ["0\u03bcm:10\u03bcm", "0µm:10µm", "0:10um", "0.0 nm:10 µm", "0\u00a0um:1e-5m", "0Å:10um"],
)
def test_a_crop_begins_at_zero_in_any_unit_of_length(crop):
    [[low, high]] = checked_options(ReadingOptions, {"crop": crop}).crop
    assert low == 0
    assert high == pytest.approx(1e-5)
    with pytest.raises(ValueError, match=r"^crop is '0kg', whose unit is not a unit of length"):
        checked_options(ReadingOptions, {"crop": "0kg:10um"})


@pytest.mark.parametrize("low", ["0.1um", "0.10um", "0.0001mm", "0.1 um", "100nm"])
def test_a_place_is_zero_only_if_its_number_is(low):
    [[found, _]] = checked_options(ReadingOptions, {"crop": f"{low}:1um"}).crop
    assert found == pytest.approx(1e-7)


def test_an_option_is_given_once_for_all_scans_or_once_for_each():
    crops = ["0:1um,0:1um", "1um:2um,0um:1um"]
    each = reading_options({"crop": crops, "channel": ("A",), "unit": "um"}, 2)
    assert [one.channel for one in each] == ["A", "A"]
    np.testing.assert_allclose([one.crop[0] for one in each], [(0, 1e-6), (1e-6, 2e-6)])
    with pytest.raises(ValueError, match=r"--channel is given 2 times for 3 scans"):
        reading_options({"channel": ["A", "B"]}, 3, "--")
    with pytest.raises(ValueError, match=r"^mask is for one scan, and 2 are named"):
        reading_options({"mask": "0:1um,0:1um"}, 2)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"channel": "Phase"}, "has no channel 'Phase'"),
        ({"crop": "1um"}, "^crop is '1um'; write both ends"),
        ({"crop": ((0, 1e-6, 0),)}, r"^crop is \(\(0, 1e-06, 0\),\); write both ends"),
        ({"crop": ((1e-6, 0), (0, 1e-6))}, r"^crop is .*, which ends where it begins or before"),
        ({"mask": (((1e-6, 0), (0, 1e-6)),)}, "^mask is .*, which ends where it begins or before"),
        ({"mask": "1um:2um"}, "has 2 dimension"),
        ({"detrend": "spline"}, "^detrend is 'spline'; choose one"),
        ({"detrend": 10}, "^detrend is 10; choose one"),
        ({"size": "5x5"}, "^size is '5x5'; write one number"),
        ({"size": (5, -5)}, r"^size is \(5, -5\); sides must be positive"),
        ({"shortest": -1.0}, "^shortest is -1 m; it must lie between"),
        ({"shortest": "4"}, "^shortest is '4', without a unit"),
        ({"mask": (((0.0,),),)}, "^mask is "),
    ],
)
def test_options_that_cannot_be_used_are_refused_by_their_names(given, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.read_scan(DETAIL, SCENE, **given)


@pytest.mark.parametrize("given", [{"crop": 3}, {"mask": 3}, {"longest": [1]}, {"unit": 1.5}])
def test_options_of_another_type_say_what_they_expect(given):
    with pytest.raises(TypeError, match=f"^{next(iter(given))} is .*; give a"):
        cf.predict(OVERVIEW, SCENE, **given)


def test_an_option_that_does_not_exist_is_refused():
    with pytest.raises(TypeError, match=r"predict\(\) got .* 'chanel'; did you mean channel\?"):
        cf.predict(OVERVIEW, SCENE, chanel=0)
    with pytest.raises(TypeError, match=r"read_scan\(\) got an unexpected .* 'range'; the options"):
        cf.read_scan(OVERVIEW, SCENE, range="1nm")


@pytest.fixture
def measured_once(monkeypatch):
    """Predictions of equal files measure their surface once."""
    measure_surfaces_once(monkeypatch)


@pytest.mark.usefixtures("measured_once")
def test_the_range_of_attraction_reaches_the_verdict_of_the_library():
    assert "attraction short against the sphere" in cf.predict(OVERVIEW, SCENE, range="3um").reason


@pytest.mark.usefixtures("measured_once")
def test_reservations_fail_where_the_library_is_strict():
    assert cf.predict(OVERVIEW, SCENE).verdict.with_severity("reservation")
    with pytest.raises(ValueError, match=r"^the theory applies with reservations: small slopes"):
        cf.predict(OVERVIEW, SCENE, strict=True)


def test_a_unit_may_be_given_for_each_file():
    files = [Path("a.txt"), Path("data/b.txt"), Path("c.txt")]
    given = for_files({"unit": ("b.txt=um", "c.txt=nm"), "size": ("a.txt=5,4",)}, files)
    found = reading_options(given, 3, "--")
    assert [one.unit for one in found] == [None, "um", "nm"]
    assert [one.size for one in found] == [(5, 4), None, None]
    in_order = reading_options({"unit": ["um", "nm", None], "size": [50, 40]}, 3)
    assert [one.unit for one in in_order] == ["um", "nm", None]
    assert {one.size for one in in_order} == {(50, 40)}
    assert for_files({"channel": ("x=1",)}, files) == {"channel": ("x=1",)}
    for unit in (("d.txt=um",), ("a.txt=um", "a.txt=nm"), ("a.txt=um", "nm")):
        with pytest.raises(ValueError, match=r"--unit is .*write FILE=VALUE once"):
            for_files({"unit": unit}, files)


@pytest.mark.parametrize("as_list", [tuple, list])
def test_a_crop_in_metres_is_one_value_for_all_scans(as_list):
    region = as_list([as_list([0, 3e-4]), as_list([0, 3e-4])])
    for n_scan in (1, 2):
        for one in reading_options({"crop": region}, n_scan):
            assert one.crop == ((0, 3e-4), (0, 3e-4))
    each = reading_options({"crop": [((0, 1e-4),), ((0, 2e-4),)]}, 2)
    assert [one.crop for one in each] == [((0, 1e-4),), ((0, 2e-4),)]


@pytest.mark.parametrize("detrend", [True, False])
def test_a_truth_value_is_no_trend(detrend):
    with pytest.raises(ValueError, match=f"detrend is {detrend}; choose one of"):
        checked_options(ReadingOptions, {"detrend": detrend})
