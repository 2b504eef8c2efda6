"""Files of scans: what is refused before a library reads it, channels, parts and levelling."""

import os
import struct
import warnings

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file

from crackfront.topography import files
from crackfront.topography.levelling import levelled
from crackfront.topography.options import ReadingOptions, parsed_options
from crackfront.topography.reading import read_measurements
from studies.accuracy import scans

SIDE, N_POINT = 20e-6, 48
HEAD = "# Channel: Main\n# Width: 20 um\n# Height: 20 um\n# Value units: um\n"


@pytest.fixture
def heights(rng):
    return 1e-7 * rng.standard_normal((N_POINT, N_POINT))


def write_text(path, heights, cell=lambda row, column, text: text):
    """A map as text, in um."""
    rows = (
        " ".join(cell(i, j, f"{value:.6f}") for j, value in enumerate(row))
        for i, row in enumerate(1e6 * heights.T)
    )
    path.write_text(HEAD + "\n".join(rows) + "\n")
    return path


def one_cell(text):
    """What replaces a cell in the middle by a text."""
    return lambda row, column, known: text if (row, column) == (20, 7) else known


def read(path, **given):
    """Measurement of a file, read by options as a user gives them."""
    return read_measurements([path], parsed_options(ReadingOptions, given))[0]


def refusal(path, **given):
    """Sentence for a file that is refused."""
    with pytest.raises(ValueError, match=r".") as caught:
        read(path, **given)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("text", ["***", "1,5", "NULL", "1.2.3", "--"])
def test_a_cell_that_is_no_number_is_refused_with_its_line(tmp_path, heights, text):
    path = write_text(tmp_path / "scan.txt", heights, one_cell(text))
    message = refusal(path)
    assert f"scan.txt, line {HEAD.count(chr(10)) + 21}:" in message
    assert repr(text) in message


def test_a_damaged_first_row_is_no_head(tmp_path, heights):
    damaged = write_text(
        tmp_path / "scan.txt", heights, lambda i, j, text: "***" if (i, j) == (0, 3) else text
    )
    assert "number 4 of the row is '***'" in refusal(damaged)
    damaged = write_text(
        tmp_path / "scan.txt", heights, lambda i, j, text: "x" if (i, j) == (0, 0) else text
    )
    assert "number 1 of the row is 'x'" in refusal(damaged)


def test_a_row_that_lacks_a_number_is_refused(tmp_path, heights):
    path = write_text(tmp_path / "scan.txt", heights, one_cell(""))
    assert f"the row has {N_POINT - 1} numbers and the row above has {N_POINT}" in refusal(path)


def test_damaged_points_in_three_columns_are_refused(tmp_path, heights):
    places = np.indices(heights.shape).reshape(2, -1).T
    rows = [f"{i} {j} {1e6 * heights[i, j]:.6f}" for i, j in places]
    path = tmp_path / "scan.xyz"
    path.write_text("\n".join([*rows[:5], "0 5 ***", *rows[6:]]))
    assert "line 6: number 3 of the row is '***'" in refusal(path, unit="um")
    path.write_text("\n".join([*rows[:5], "0 5 bad", *rows[6:]]))
    found = read(path, detrend="center", unit="um")
    assert found.missing == pytest.approx(1 / heights.size)


def test_decimal_commas_are_read_as_points(tmp_path, heights):
    [points] = read_measurements([write_text(tmp_path / "points.txt", heights)])
    path = tmp_path / "commas.txt"
    path.write_text(
        (tmp_path / "points.txt").read_text().replace(".", ",").replace("20 um", "20,0 um")
    )
    [commas] = read_measurements([path])
    assert commas.size == points.size
    np.testing.assert_array_equal(commas.heights, points.heights)


def test_missing_points_written_as_nan_are_filled(tmp_path, heights):
    [found] = read_measurements([write_text(tmp_path / "scan.txt", heights, one_cell("nan"))])
    assert found.missing == pytest.approx(1 / heights.size)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_surface_that_is_its_trend_is_refused(tmp_path, order):
    x, y = np.indices((N_POINT, N_POINT)) / N_POINT
    path = write_text(tmp_path / "plane.txt", 1e-5 * (x + 2 * y))
    if order == 0:
        assert read(path, detrend="center").heights.std() > 1e-6
    else:
        assert "nothing but the p" in refusal(path, detrend=order)


def test_folders_pipes_devices_and_empty_files_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "empty.al3d").touch()
    assert "is a folder" in refusal(tmp_path)
    assert "is a pipe" in refusal(tmp_path / "pipe")
    assert "is empty" in refusal(tmp_path / "empty.al3d")
    for name in ("/dev/zero", "/dev/null"):
        assert "is a device" in refusal(files.Path(name))


def test_files_larger_than_the_memory_are_refused_unread(tmp_path):
    path = tmp_path / "sparse.nc"
    with path.open("wb") as file:
        file.truncate(300_000_000_000)
    assert "has 300 GB; more than" in refusal(path)


def test_maps_that_claim_more_points_than_fit_are_refused_before_they_are_read(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("crackfront.data.bounds.memory_at_hand", lambda: 20_000_000_000)
    with h5py.File(tmp_path / "huge.h5", "w") as file:
        file.create_dataset("surface", shape=(200_000, 200_000), dtype="f8", chunks=(1000, 1000))
    message = refusal(tmp_path / "huge.h5", unit="um", size=(10.0, 10.0))
    assert "claims 200000 x 200000 points, would need 4 TB of memory; here are 20 GB" in message
    with netcdf_file(tmp_path / "small.nc", "w", version=2) as file:
        for name in "xy":
            file.createDimension(name, 64)
            variable = file.createVariable(name, "f8", (name,))
            variable.length, variable.unit = 1e-5, "m"
        file.createVariable("heights", "f8", ("x", "y")).unit = "m"
    content = (tmp_path / "small.nc").read_bytes()
    claim = content.replace(struct.pack(">I", 64), struct.pack(">I", 200_000))
    (tmp_path / "claim.nc").write_bytes(claim)
    assert "claim.nc" in refusal(tmp_path / "claim.nc")


def write_h5(path, **channels):
    """Arrays in one file."""
    with h5py.File(path, "w") as file:
        for name, values in channels.items():
            file[name] = values
    return path


def test_sides_that_cannot_be_are_refused_and_may_be_named(tmp_path, heights):
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(heights, 160 / N_POINT, "metres for micrometres"))
    message = refusal(path)
    assert "states sides of 160 m x 160 m, which no instrument measures" in message
    assert "--size 160,160 --unit um" in message
    found = read(path, size="160,160", unit="um")
    assert found.size == pytest.approx((160e-6, 160e-6))
    assert np.std(found.heights) == pytest.approx(np.std(heights), rel=0.1)
    plain = write_h5(tmp_path / "plain.h5", surface=heights)
    assert "cannot have sides of 20 m x 20 m" in refusal(plain, unit="m", size=(20.0, 20.0))
    assert "which cannot be" in refusal(plain, unit="pm", size=(1e7, 1e7))


def test_a_crop_is_the_map_of_a_part(tmp_path, heights):
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(heights, SIDE / N_POINT, "whole"))
    part = tmp_path / "part.al3d"
    part.write_bytes(scans.al3d(heights[12:48, 6:42], SIDE / N_POINT, "part"))
    found, expected = read(path, crop="5um:20um,2.5um:17.5um"), read(part)
    assert found.size == pytest.approx(expected.size)
    np.testing.assert_allclose(found.heights, expected.heights, atol=1e-20)
    assert "ends at 20 um and the crop at 30 um" in refusal(path, crop="0:30um,0:1um")
    assert "leaves fewer than 8 points" in refusal(path, crop="0:1um,0:1um")
    assert "1; name both ends" in refusal(path, crop="0:10um")
    for text in ("5um", "5um:2um,0um:5um", "5:6,7:8", "1um:2um,1um:2um,1um:2um"):
        assert refusal(path, crop=text).startswith("crop is ")


def test_a_channel_is_chosen_by_name_or_number(tmp_path, heights):
    path = tmp_path / "scan.txt"
    one, two = (write_text(tmp_path / f"{n}.txt", n * heights).read_text() for n in (1, 3))
    path.write_text(one + two.replace("Channel: Main", "Channel: Other"))
    by_default, by_name, by_number = (read(path, channel=name) for name in (None, "Other", 1))
    assert by_default.channel == "'Main', 0 of 2"
    assert by_name.channel == by_number.channel == "'Other', 1 of 2"
    assert np.std(by_name.heights) == pytest.approx(3 * np.std(by_default.heights), rel=1e-4)
    message = refusal(path, channel="Phase")
    assert "has no channel 'Phase'; choose by number or name with --channel: 0 'Main'" in message


def test_levelling_by_order_takes_such_a_polynomial_off(rng):
    x, y = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    rough = 1e-3 * rng.standard_normal(x.shape)
    everywhere = np.ones(x.shape, dtype=bool)
    trend = 2 + x - 3 * y + x * y**2 + 4 * x**3
    third = levelled(rough + trend, everywhere, 3)
    np.testing.assert_allclose(third, levelled(rough, everywhere, 3), atol=1e-12)
    assert np.std(levelled(rough + trend, everywhere, 2)) > 0.1
    for name, order in (("center", 0), ("height", 1), ("curvature", 2)):
        np.testing.assert_array_equal(
            levelled(rough + trend, everywhere, name), levelled(rough + trend, everywhere, order)
        )


def test_warnings_of_parsers_are_none_of_the_users(tmp_path, heights, monkeypatch):
    path, mask = tmp_path / "scan.npy", tmp_path / "mask.npy"
    np.save(path, 1e6 * heights)
    np.save(mask, np.zeros(heights.shape))
    library = pytest.importorskip("SurfaceTopography")
    opened = library.open_topography

    def warning(*arguments, **options):
        warnings.warn("wmf image format is not supported", UserWarning, stacklevel=2)
        return opened(*arguments, **options)

    monkeypatch.setattr(library, "open_topography", warning)
    found = read(path, unit="um", size="5,4", mask=mask)
    assert found.heights.shape == heights.shape


def test_a_mask_is_left_out_of_the_levelling_and_stays_in_the_map(tmp_path, heights):
    bump = np.zeros(heights.shape)
    bump[6:18, 24:36] = 5e-6
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(heights + bump, SIDE / N_POINT, "bump"))
    marked = tmp_path / "mask.npy"
    np.save(marked, (bump > 0).astype(float))
    region = "2.5um:7.5um,10um:15um"
    plain, by_file, by_region = (read(path, mask=mask) for mask in (None, marked, region))
    base = bump == 0
    assert np.std(by_file.heights[base]) == pytest.approx(np.std(heights[base]), rel=0.05)
    assert np.std(plain.heights[base]) > 3 * np.std(heights[base])
    np.testing.assert_array_equal(by_file.heights, by_region.heights)
    assert by_file.heights[~base].mean() == pytest.approx(5e-6, rel=0.1)
    assert by_file.levelling == "the paraboloid of all but 6.25% of the points"
    np.save(marked, np.zeros((3, 3)))
    assert "mask" in refusal(path, mask=marked)
    assert "points are left to fit" in refusal(path, mask="0um:20um,0um:20um")


def test_several_files_may_have_options_each(tmp_path, heights):
    paths = [write_text(tmp_path / f"{number}.txt", heights) for number in range(2)]
    both = [ReadingOptions(detrend="center"), ReadingOptions(detrend=4)]
    found = read_measurements(paths, both)
    assert [item.levelling for item in found] == ["the mean", "the polynomial of order 4"]
