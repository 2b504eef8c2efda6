"""A measured map as the field of a simulation."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.tile import scan_surface
from crackfront.surfaces.surface_adhesion import surface_adhesion
from studies.accuracy import scans
from tests.measured.made import (
    SCENE,
    SIDE,
    SPECTRUM,
    map_heights,
    measured_mean_square,
    periodic_measurement,
    write_al3d,
    write_line,
)


def measured_adhesion(measurement, scales):
    """Work of adhesion of the surface of a map whose waves are all trusted."""
    band = SimpleNamespace(stripes=())
    parts = {"measurement": measurement, "trusted_measurement": measurement, "band": band}
    trusted = SimpleNamespace(**parts, unevenness=0.0)
    return surface_adhesion(scan_surface(trusted, scales))


def test_a_line_scan_is_no_field(rng, tmp_path):
    path = write_line(tmp_path / "line.xyz", 1e6 * map_heights(rng)[0], 20 / 128)
    [measurement] = read_measurements([path], ReadingOptions(unit="um"))
    with pytest.raises(ValueError, match="is a line scan, not a map"):
        measured_adhesion(measurement, SCENE)


def test_oblong_pixels_are_read_and_made_square_for_a_field(tmp_path, heights, scan):
    [whole] = read_measurements([scan])
    content = scans.al3d(heights[:, ::2], SIDE / 128, "oblong")
    narrow, wide = f"{SIDE / 128:.10g}".encode(), f"{SIDE / 64:.10g}".encode()
    at = content.index(b"PixelSizeYMeter") + 20
    assert content[at : at + len(narrow)] == narrow
    path = tmp_path / "oblong.al3d"
    path.write_bytes(content[:at] + wide.ljust(30, b"\0") + content[at + 30 :])
    [oblong] = read_measurements([path])
    assert oblong.pixels == pytest.approx((SIDE / 128, SIDE / 64))
    assert oblong.shortest == pytest.approx(4 * SIDE / 64)
    square = replace(whole, shortest=oblong.shortest)
    adhesions = [measured_adhesion(item, SCENE) for item in (square, oblong)]
    assert adhesions[1].pixel == pytest.approx(adhesions[0].pixel)
    assert adhesions[1].e_el == pytest.approx(adhesions[0].e_el, rel=0.02)


def test_the_tile_of_a_map_is_its_mirror_images_around_it(scan):
    [measurement] = read_measurements([scan])
    adhesion = measured_adhesion(measurement, SCENE)
    assert adhesion.work_of_adhesion.shape == (256, 256)
    assert adhesion.pixel * SCENE.lateral == pytest.approx(SIDE / 128)
    mean = np.mean(adhesion.work_of_adhesion) / WORK_OF_ADHESION
    assert mean == pytest.approx(1 - adhesion.e_el)
    measured = SCENE.contact_modulus / 4 * measured_mean_square(analysed_scan(measurement), 0.5)
    energy = adhesion.e_el * SCENE.work_of_adhesion
    assert energy == pytest.approx(measured, rel=0.25)
    # The sum over x leaves a function of y alone, even about the edges of the scan.
    along_front = adhesion.work_of_adhesion.sum(axis=0)
    assert along_front == pytest.approx(np.roll(along_front[::-1], 128), rel=1e-9)


def test_a_periodic_map_is_a_tile_as_it_stands(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    adhesion = measured_adhesion(periodic_measurement(heights), SCENE)
    expected = rough_adhesion(heights / SCENE.vertical, SIDE / 128 / SCENE.lateral)
    assert adhesion.pixel == pytest.approx(expected.pixel)
    assert adhesion.work_of_adhesion == pytest.approx(expected.work_of_adhesion, rel=1e-9)


def test_a_map_too_rough_for_full_conformity_is_no_field(tmp_path, heights):
    path = write_al3d(tmp_path / "rough.al3d", 20 * heights)
    with pytest.raises(ValueError, match="full conformity needs less than"):
        measured_adhesion(read_measurements([path])[0], SCENE)
