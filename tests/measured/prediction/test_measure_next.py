"""Which scan to measure next follows from what the draws leave open."""

import re
from dataclasses import replace

import pytest

from crackfront.measured.prediction.prediction import predicted
from crackfront.measured.prediction.surface_remarks import measure_next
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import measured_surface
from tests.measured.made import (
    DETAIL,
    OVERVIEW,
    SCENE,
    map_heights,
    shipped_surface,
    write_al3d,
)


def lengths(sentence):
    """Lengths that a sentence names, in um."""
    found = re.findall(r"([\d.]+) (nm|um)", sentence)
    return [float(number) * {"nm": 1e-3, "um": 1.0}[unit] for number, unit in found]


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
    detail, both = shipped_surface(DETAIL).joint.draws, surface.joint.draws
    longer, shorter = detail.factors_with
    assert both.factor < 1.5 * longer < shorter < detail.factor
    assert "would hardly narrow it" in measure_next(surface).sentence


@pytest.mark.parametrize("path", [DETAIL, OVERVIEW])
def test_the_advice_is_the_same_under_a_levelling_of_another_order(path):
    kinds = {
        re.sub(r"[\d.]+", "", measure_next(shipped_surface(path, **given)).sentence)
        for given in ({}, {"detrend": "4"})
    }
    assert len(kinds) == 1


@pytest.mark.usefixtures("few_draws")
def test_scans_that_disagree_stand_in_the_first_line_of_the_page(tmp_path, rng):
    heights = map_heights(rng)
    paths = [
        write_al3d(tmp_path / "as-made.al3d", heights),
        write_al3d(tmp_path / "louder.al3d", 3 * heights[::-1]),
    ]
    surface = measured_surface(read_measurements(paths))
    page = repr(predicted(surface, replace(SCENE, contact_modulus=1e3)))
    first = page.splitlines()[0]
    assert "disagrees with the other scans" in first
    assert page.count(first) == 1
    assert "Quasi-static" in page
