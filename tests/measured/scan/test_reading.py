"""Measurements as they are used: cropped, levelled, without gaps, and one sentence for the rest."""

import numpy as np
import pytest

from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.library import surface_library
from crackfront.measured.scan.reading import read_measurements
from studies.accuracy import scans
from tests.measured.made import (
    HEAD,
    SIDE,
    measured_mean_square,
    read,
    refusal,
    write_al3d,
    write_text,
)

N_POINT = 48


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_surface_that_is_its_trend_is_refused(tmp_path, order):
    x, y = np.indices((N_POINT, N_POINT)) / N_POINT
    path = write_text(tmp_path / "plane.txt", 1e-5 * (x + 2 * y))
    if order == 0:
        assert read(path, detrend="center").heights.std() > 1e-6
    else:
        assert "nothing but the p" in refusal(path, detrend=order)


def test_a_crop_is_the_map_of_a_part(tmp_path, noise):
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(noise, SIDE / N_POINT, "whole"))
    part = tmp_path / "part.al3d"
    part.write_bytes(scans.al3d(noise[12:48, 6:42], SIDE / N_POINT, "part"))
    cropped, expected = read(path, crop="5um:20um,2.5um:17.5um"), read(part)
    assert cropped.size == pytest.approx(expected.size)
    np.testing.assert_allclose(cropped.heights, expected.heights, atol=1e-20)
    assert "ends at 20 um and the crop at 30 um" in refusal(path, crop="0:30um,0:1um")
    assert "leaves fewer than 8 points" in refusal(path, crop="0:1um,0:1um")
    assert "1; name both ends" in refusal(path, crop="0:10um")


def test_a_periodic_map_is_periodic_as_a_whole_and_without_a_tilt_taken_off(tmp_path, noise):
    path = tmp_path / "scan.nc"
    library = surface_library().Topography(noise, (SIDE, SIDE), periodic=True, unit="m")
    library.to_netcdf(str(path))
    assert read(path, detrend="center").periodic
    assert not read(path, detrend="center", crop="2um:18um,2um:18um").periodic
    assert not read(path, detrend="height").periodic


def test_a_mask_is_left_out_of_the_levelling_and_stays_in_the_map(tmp_path, noise):
    bump = np.zeros(noise.shape)
    bump[6:18, 24:36] = 5e-6
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(noise + bump, SIDE / N_POINT, "bump"))
    marked = tmp_path / "mask.npy"
    np.save(marked, (bump > 0).astype(float))
    region = "2.5um:7.5um,10um:15um"
    plain, by_file, by_region = (read(path, mask=mask) for mask in (None, marked, region))
    base = bump == 0
    assert np.std(by_file.heights[base]) == pytest.approx(np.std(noise[base]), rel=0.05)
    assert np.std(plain.heights[base]) > 3 * np.std(noise[base])
    np.testing.assert_array_equal(by_file.heights, by_region.heights)
    assert by_file.heights[~base].mean() == pytest.approx(5e-6, rel=0.1)
    assert by_file.levelling == "the paraboloid of all but 6.25% of the points"
    np.save(marked, np.zeros((3, 3)))
    assert "mask" in refusal(path, mask=marked)
    assert "points are left to fit" in refusal(path, mask="0um:20um,0um:20um")


def test_a_measurement_counts_once_under_any_name_in_any_unit(tmp_path, noise):
    path = write_text(tmp_path / "scan.txt", noise)
    copy, nanometres, mirrored = (tmp_path / f"{name}.txt" for name in ("copy", "nm", "mirrored"))
    copy.write_bytes(path.read_bytes())
    np.savetxt(nanometres, 1e9 * noise.T, fmt="%.1f")
    nanometres.write_text(HEAD.replace("units: um", "units: nm") + nanometres.read_text())
    for path_of_same in (copy, nanometres):
        assert f"{path_of_same} has the heights of {path}; a measurement counts" in refusal(
            path, path_of_same
        )
    with pytest.raises(ValueError, match=r"copy.txt has the heights of .*scan.txt"):
        read_measurements([path, copy], [ReadingOptions(), ReadingOptions(detrend="center")])
    assert len(read_measurements([path, write_text(mirrored, noise[::-1])])) == 2


@pytest.mark.parametrize(
    ("reliability", "low", "high"),
    [
        ({"resolution": {"value": 0.9, "unit": "um"}}, 0.9e-6, 0.9e-6),
        ({"tip_radius": {"value": 0.5, "unit": "um"}}, 0.7e-6, 2.5e-6),
        ({"resolution": {"value": 10, "unit": "nm"}}, 0.625e-6, 0.625e-6),
    ],
)
def test_the_reliability_that_a_file_states_bounds_the_wavelengths(
    tmp_path, monkeypatch, heights, reliability, low, high
):
    info = {"instrument": {"name": "test", "parameters": reliability}}
    library = surface_library().Topography(heights, (SIDE, SIDE), unit="m", info=info)
    library.to_netcdf(str(tmp_path / "scan.nc"))
    [measurement] = read_measurements([tmp_path / "scan.nc"])
    assert measurement.format == "nc"
    shortest = max(measurement.shortest, measurement.tip_wavelength)
    assert low * (1 - 1e-6) <= shortest <= high * (1 + 1e-6)
    assert measurement.tip_radius == pytest.approx(0.5e-6 if "tip_radius" in reliability else 0)
    assert not measurement.tip_is_assumed
    [named] = read_measurements([tmp_path / "scan.nc"], ReadingOptions(tip_radius=2e-6))
    assert named.tip_wavelength > measurement.tip_wavelength
    monkeypatch.setattr("crackfront.measured.scan.reading._SCANNING_PROBES", {"nc"})
    [assumed] = read_measurements([tmp_path / "scan.nc"])
    assert assumed.tip_is_assumed == ("tip_radius" not in reliability)
    assert assumed.tip_radius == pytest.approx(measurement.tip_radius or 10e-9)


def test_a_few_missing_points_are_interpolated(rng, tmp_path, heights, scan):
    holes = heights.copy()
    holes[rng.uniform(size=holes.shape) < 0.03] = np.nan
    path = write_al3d(tmp_path / "holes.al3d", holes)
    [whole], [filled] = read_measurements([scan]), read_measurements([path])
    assert filled.missing == pytest.approx(np.mean(np.isnan(holes)))
    assert np.all(np.isfinite(filled.heights))
    assert np.std(filled.heights - whole.heights) < 0.05 * np.std(whole.heights)
    ratio = measured_mean_square(analysed_scan(filled), 0.5) / measured_mean_square(
        analysed_scan(whole), 0.5
    )
    assert ratio == pytest.approx(1, abs=0.02)


def test_many_missing_points_are_refused(rng, tmp_path, heights):
    heights[rng.uniform(size=heights.shape) < 0.2] = np.nan
    path = write_al3d(tmp_path / "holes.al3d", heights)
    assert "20% of the points are missing" in refusal(path)


def test_surfaces_without_a_spectrum_are_refused(tmp_path, heights, scan):
    flat = write_al3d(tmp_path / "flat.al3d", np.zeros((64, 64)))
    tiny = write_al3d(tmp_path / "tiny.al3d", heights[:24, :24])
    assert "all heights are equal" in refusal(flat)
    assert "a spectrum needs 2 octaves" in refusal(tiny)
    assert "named twice" in refusal(scan, scan)
    assert "no file is named" in refusal()
