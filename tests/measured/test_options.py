"""Options of reading and predicting: the same in commands, library and configurations."""

from pathlib import Path

import numpy as np
import pytest

import crackfront as cf
from crackfront.measured.options import (
    PredictionOptions,
    ReadingOptions,
    checked_options,
    for_files,
    reading_options,
)
from tests.measured.made import DETAIL, OVERVIEW, SCENE, measure_surfaces_once


def test_texts_and_numbers_mean_the_same():
    numbers = {"channel": 1, "detrend": 3, "size": [50, 40.0], "shortest": 4e-7, "mask": ()}
    texts = {"channel": "1", "detrend": "3", "size": "50,40", "shortest": "0.4um", "crop": None}
    from_numbers, from_texts = (
        checked_options(ReadingOptions, values) for values in (numbers, texts)
    )
    assert from_numbers.shortest == pytest.approx(from_texts.shortest, rel=1e-12)
    assert (from_numbers.channel, from_numbers.detrend, from_numbers.size) == (
        from_texts.channel,
        from_texts.detrend,
        from_texts.size,
    )
    assert checked_options(PredictionOptions, {"range": 3e-10, "unit": "m"}).range == 3e-10


def test_an_option_is_given_once_for_all_scans_or_once_for_each():
    crops = ["0:1um,0:1um", "1um:2um,0um:1um"]
    options = reading_options({"crop": crops, "channel": ("A",), "unit": "um"}, 2)
    assert [option.channel for option in options] == ["A", "A"]
    np.testing.assert_allclose([option.crop[0] for option in options], [(0, 1e-6), (1e-6, 2e-6)])
    with pytest.raises(ValueError, match=r"--channel is given 2 times for 3 scans"):
        reading_options({"channel": ["A", "B"]}, 3, "--")
    with pytest.raises(ValueError, match=r"^mask is for one scan, and 2 are named"):
        reading_options({"mask": "0:1um,0:1um"}, 2)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
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
def test_options_that_cannot_be_used_are_refused_by_their_names(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.read_scan(DETAIL, SCENE, **arguments)


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
    arguments = for_files({"unit": ("b.txt=um", "c.txt=nm"), "size": ("a.txt=5,4",)}, files)
    options = reading_options(arguments, 3, "--")
    assert [option.unit for option in options] == [None, "um", "nm"]
    assert [option.size for option in options] == [(5, 4), None, None]
    in_order = reading_options({"unit": ["um", "nm", None], "size": [50, 40]}, 3)
    assert [option.unit for option in in_order] == ["um", "nm", None]
    assert {option.size for option in in_order} == {(50, 40)}
    assert for_files({"channel": ("x=1",)}, files) == {"channel": ("x=1",)}
    for unit in (("d.txt=um",), ("a.txt=um", "a.txt=nm"), ("a.txt=um", "nm")):
        with pytest.raises(ValueError, match=r"--unit is .*write FILE=VALUE once"):
            for_files({"unit": unit}, files)
