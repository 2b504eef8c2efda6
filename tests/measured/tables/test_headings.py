"""Headings of columns: names and units as programs and people write them."""

import pytest

from crackfront.measured.tables.headings import heading, headings_above


@pytest.mark.parametrize(
    "text",
    [
        *("force (uN)", "force [uN]", "force(uN)", "force / uN", "force/uN"),
        *("force_uN", "force, uN", "force (filtered) [uN]", "force (uN) (filtered)"),
    ],
)
def test_a_unit_is_read_in_every_notation(text):
    column = heading(text)
    assert column.unit == "uN"
    assert column.name.startswith("force")


@pytest.mark.parametrize("text", ["hurst (1)", "hurst [-]", "hurst ()", "hurst", "q/pi x 2D PSD"])
def test_a_pure_number_has_no_unit(text):
    assert heading(text).unit == ""


def test_units_may_stand_below_the_names():
    titles, (first, second) = headings_above(["# Film", "# x;z", "# [um];[nm]"], 2)
    assert titles == ("Film",)
    assert (first.name, first.unit, second.name, second.unit) == ("x", "um", "z", "nm")
