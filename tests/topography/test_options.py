"""Options of reading and predicting: the same in commands, library and configurations."""

import inspect

import numpy as np
import pytest

import crackfront as cf
from crackfront.cli.surface import SphereOptions, predict, surface
from crackfront.sweep.sections import SurfaceSection
from crackfront.topography.options import (
    PredictionOptions,
    ReadingOptions,
    declared,
    options_for_each,
    parsed_options,
)
from tests.topography.made import DETAIL, OVERVIEW, SCENE

READING = {one.name for one in declared(ReadingOptions)}
PREDICTION = {one.name for one in declared(PredictionOptions)}
SPHERE = {one.name for one in declared(SphereOptions)}


def keywords(function):
    """Names of the keywords that `help` shows."""
    known = inspect.signature(function).parameters.values()
    return {item.name for item in known if item.kind is item.KEYWORD_ONLY}


def test_commands_library_and_configurations_have_the_same_options():
    assert keywords(cf.read_scan) == READING == set(SurfaceSection.model_fields) - {"file"}
    assert keywords(cf.predict) == READING | PREDICTION | {"strict"}
    known = {name: {item.name for item in command.params} for name, command in COMMANDS.items()}
    assert known["surface"] >= READING | SPHERE
    assert known["predict"] >= READING | PREDICTION | SPHERE


COMMANDS = {"surface": surface, "predict": predict}


def test_help_of_the_library_says_what_each_option_means():
    for name in READING | PREDICTION:
        assert f"\n    {name} : " in cf.predict.__doc__
    assert "{options}" not in cf.read_scan.__doc__


def test_texts_and_numbers_mean_the_same():
    given = {"channel": 1, "detrend": 3, "size": [50, 40.0], "shortest": 4e-7, "mask": ()}
    texts = {"channel": "1", "detrend": "3", "size": "50,40", "shortest": "0.4um", "crop": None}
    one, other = (parsed_options(ReadingOptions, values) for values in (given, texts))
    assert one.shortest == pytest.approx(other.shortest, rel=1e-12)
    assert (one.channel, one.detrend, one.size) == (other.channel, other.detrend, other.size)
    assert parsed_options(PredictionOptions, {"range": 3e-10, "unit": "m"}).range == 3e-10


def test_an_option_is_given_once_for_all_scans_or_once_for_each():
    crops = ["0:1um,0:1um", "1um:2um,0um:1um"]
    each = options_for_each(ReadingOptions, {"crop": crops, "channel": ("A",), "unit": "um"}, 2)
    assert [one.channel for one in each] == ["A", "A"]
    np.testing.assert_allclose([one.crop[0] for one in each], [(0, 1e-6), (1e-6, 2e-6)])
    with pytest.raises(ValueError, match=r"--channel is given 2 times for 3 scan\(s\)"):
        options_for_each(ReadingOptions, {"channel": ["A", "B"]}, 3, "--")
    with pytest.raises(ValueError, match=r"^mask is for one scan, and 2 are named"):
        options_for_each(ReadingOptions, {"mask": "0:1um,0:1um"}, 2)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"channel": "Phase"}, "has no channel 'Phase'"),
        ({"crop": "1um"}, "^crop is '1um'; write both ends"),
        ({"mask": "1um:2um"}, "has 2 dimension"),
        ({"detrend": "spline"}, "^detrend is 'spline'; choose one"),
        ({"detrend": 10}, "^detrend is 10; choose one"),
        ({"size": "5x5"}, "^size is '5x5'; write one number"),
        ({"size": (5, -5)}, r"^size is \(5, -5\); sides must be positive"),
        ({"shortest": -1.0}, "^shortest is -1 m; it must lie between"),
        ({"shortest": "4"}, "^shortest is '4', without a unit"),
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
    with pytest.raises(TypeError, match="unexpected keyword argument 'chanel'"):
        cf.predict(OVERVIEW, SCENE, chanel=0)


def test_the_range_of_attraction_reaches_the_verdict_of_the_library():
    with pytest.raises(ValueError, match=r"does not apply: .*attraction short against the sphere"):
        cf.predict(OVERVIEW, SCENE, range="3um")


def test_reservations_fail_where_the_library_is_strict():
    assert cf.predict(OVERVIEW, SCENE).verdict.of("reservation")
    with pytest.raises(ValueError, match=r"^the theory applies with reservations: small slopes"):
        cf.predict(OVERVIEW, SCENE, strict=True)
