"""Which scan to measure next follows from what the draws leave open."""

import re

from crackfront.measured.prediction.surface_remarks import measure_next
from tests.measured.made import (
    DETAIL,
    OVERVIEW,
    shipped_surface,
)


def lengths(sentence):
    """Lengths that a sentence names, in um."""
    lengths_and_units = re.findall(r"([\d.]+) (nm|um)", sentence)
    return [float(number) * {"nm": 1e-3, "um": 1.0}[unit] for number, unit in lengths_and_units]


def test_a_detail_needs_a_larger_scan_and_an_overview_a_finer_one():
    larger = measure_next(shipped_surface(DETAIL)).sentence
    assert "a scan with a side of" in larger.lower()
    side, pixel = lengths(larger)
    assert side > 7.2  # that of the detail
    assert pixel < 3.6 / 4  # waves that the detail holds too
    finer = measure_next(shipped_surface(OVERVIEW)).sentence
    assert "a scan with pixels of at most" in finer.lower()
    pixel, side = lengths(finer)
    assert pixel < 0.3 / 4
    assert side > 2 * 1.32  # waves that the overview holds too


def test_the_scan_that_is_asked_for_narrows_the_interval_as_much_as_was_said(surface):
    detail, joined = shipped_surface(DETAIL).joint.draws, surface.joint.draws
    longer, shorter = detail.factors_if_known
    assert joined.factor < 1.5 * longer < shorter < detail.factor
    assert "would hardly narrow it" in measure_next(surface).sentence
