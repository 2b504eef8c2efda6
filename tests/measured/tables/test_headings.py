"""Headings of columns: names and units as programs and people write them."""

import pytest

from crackfront.measured.options import (
    PredictionOptions,
    PsdOptions,
    ReadingOptions,
    SelfAffineOptions,
    SphereOptions,
)
from crackfront.measured.samples.sample import SampleOptions
from crackfront.measured.tables.headings import heading, headings_above


@pytest.mark.parametrize(
    "text",
    [
        *("force (uN)", "force [uN]", "force(uN)", "force / uN", "force/uN"),
        *("force_uN", "force, uN", "force (filtered) [uN]", "force (uN) (filtered)"),
    ],
)
def test_a_unit_is_read_in_every_notation(text):
    found = heading(text)
    assert found.unit == "uN"
    assert found.name.startswith("force")


@pytest.mark.parametrize("text", ["hurst (1)", "hurst [-]", "hurst ()", "hurst", "q/pi x 2D PSD"])
def test_a_pure_number_has_no_unit(text):
    assert heading(text).unit == ""


def test_no_option_of_a_sample_ends_in_a_unit():
    records = SampleOptions, SphereOptions, ReadingOptions, PsdOptions, SelfAffineOptions
    for record in (*records, PredictionOptions):
        for name in record.model_fields:
            assert heading(name).name == name


def test_units_may_stand_below_the_names():
    titles, (first, second) = headings_above(["# Film", "# x;z", "# [um];[nm]"], 2)
    assert titles == ("Film",)
    assert (first.name, first.unit, second.name, second.unit) == ("x", "um", "z", "nm")
