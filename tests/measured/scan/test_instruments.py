"""Files of instruments: formats, channels, units and sides, and what cannot be read."""

import hashlib
import subprocess
import sys
import zipfile

import h5py
import numpy as np
import pytest

import crackfront as cf
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.library import surface_library
from crackfront.measured.scan.reading import read_measurements
from studies.accuracy import scans
from tests.measured.made import SIDE, read, refusal, write_text

N_POINT = 48
PLAIN = {"unit": "um", "size": (20.0,)}


def write_arrays(path, **channels):
    """Arrays in one file."""
    with h5py.File(path, "w") as file:
        for name, values in channels.items():
            file[name] = values
    return path


def test_sides_that_cannot_be_are_refused_and_may_be_named(tmp_path, noise):
    path = tmp_path / "scan.al3d"
    path.write_bytes(scans.al3d(noise, 160 / N_POINT, "metres for micrometres"))
    message = refusal(path)
    assert "states sides of 160 m x 160 m, which no instrument measures" in message
    assert "--size 160,160 --unit um" in message
    measurement = read(path, size="160,160", unit="um")
    assert measurement.size == pytest.approx((160e-6, 160e-6))
    assert np.std(measurement.heights) == pytest.approx(np.std(noise), rel=0.1)
    plain = write_arrays(tmp_path / "plain.h5", surface=noise)
    assert "cannot have sides of 20 m x 20 m" in refusal(plain, unit="m", size=(20.0, 20.0))
    assert "which cannot be" in refusal(plain, unit="pm", size=(1e7, 1e7))


def test_a_channel_is_chosen_by_name_or_number(tmp_path, noise):
    path = tmp_path / "scan.txt"
    first_text, two = (write_text(tmp_path / f"{n}.txt", n * noise).read_text() for n in (1, 3))
    path.write_text(first_text + two.replace("Channel: Main", "Channel: Other"))
    by_default, by_name, by_number = (read(path, channel=name) for name in (None, "Other", 1))
    assert by_default.channel.startswith("'Main', 0 of 2 ")
    assert by_name.channel == by_number.channel
    assert by_name.channel.startswith("'Other', 1 of 2 ")
    assert np.std(by_name.heights) == pytest.approx(3 * np.std(by_default.heights), rel=1e-4)
    message = refusal(path, channel="Phase")
    assert "has no channel 'Phase'; choose by number or name with --channel: 0 'Main'" in message


ARRAYS = {
    "named": ({"intensity": 0, "topography": 1}, "'topography', 1 of 2"),
    "in a group": ({"scan/height": 1, "scan/quality": 0}, "'scan/height', 0 of 2"),
    "z": ({"amplitude": 0, "z": 1}, "'z', 1 of 2"),
    "sensor": ({"Phase": 0, "ZSensor": 1}, "'ZSensor', 1 of 2"),
    "single": ({"anything": 1}, "'anything'"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_the_array_that_is_named_as_heights_is_read(tmp_path, rng, noise, name):
    arrays, channel = ARRAYS[name]
    values = (rng.uniform(size=noise.shape), 1e6 * noise)
    path = write_arrays(tmp_path / "a.h5", **{key: values[which] for key, which in arrays.items()})
    measurement = read(path, detrend="center", **PLAIN)
    assert measurement.channel == channel
    np.testing.assert_allclose(measurement.heights, noise - noise.mean(), atol=1e-18)


@pytest.mark.parametrize(
    "names", [("a", "b"), ("height", "height_retrace"), ("HeightAmplitude", "data"), ("x", "y")]
)
@pytest.mark.parametrize("kind", ["h5", "npz"])
def test_several_arrays_of_which_none_or_two_are_named_as_heights_are_refused(
    tmp_path, noise, names, kind
):
    path = tmp_path / f"a.{kind}"
    arrays = dict.fromkeys(names, 1000000.0 * noise)
    if kind == "h5":
        write_arrays(path, **arrays)
    else:
        np.savez(path, **arrays)
    message = refusal(path, **PLAIN)
    assert "contains 2 arrays, and their names do not say which one has the heights" in message
    assert all(f"'{name}'" in message for name in names)
    assert read(path, channel=names[1], **PLAIN).channel == f"'{names[1]}', 1 of 2"
    assert not any(channel.is_default for channel in cf.list_channels(path))
    masked = write_arrays(tmp_path / "scan.h5", surface=1e6 * noise)
    assert "contains 2 arrays" in refusal(masked, mask=path, **PLAIN)


def test_channels_are_listed_and_those_of_other_quantities_refused(monkeypatch, scan):
    module = surface_library().IO.Reader
    assert [str(listed) for listed in cf.list_channels(scan)] == [
        "0 'Default' (height), 128 x 128 points, default"
    ]
    monkeypatch.setattr(module.ChannelInfo, "unit", property(lambda channel: ("nm", None)))
    assert "channel 'Default' contains another quantity, not heights; export" in refusal(scan)
    kind = property(lambda channel: module.DataKind.PHASE)
    monkeypatch.setattr(module.ChannelInfo, "data_kind", kind)
    monkeypatch.setattr(module.ChannelInfo, "unit", "m")
    assert "channel 'Default' contains phase, not heights" in refusal(scan)


def test_heights_have_a_unit_of_their_own_where_none_is_stated_or_it_cannot_be(tmp_path, noise):
    nanometres, head = tmp_path / "plain.txt", "# Width: 20 µm\n# Height: 20 µm\n"
    np.savetxt(nanometres, 1e9 * noise.T)
    assert "name the right one, as in --height-unit nm" in refusal(nanometres, unit="um", size=20)
    scans = [read(nanometres, unit="um", size=20, height_unit="nm")]
    for unit, options in (("m", {}), ("µm", {"unit": None})):
        path = tmp_path / f"stated-{unit}.txt"
        path.write_text(f"{head}# Value units: {unit}\n{nanometres.read_text()}")
        scans.append(read(path, height_unit="nm", **options))
    for scan in scans:
        assert scan.size == pytest.approx((20e-6, 20e-6))
        np.testing.assert_allclose(scan.heights, scans[0].heights, rtol=1e-9)
    assert np.std(scans[0].heights) == pytest.approx(np.std(noise), rel=0.1)
    assert "--height-unit kg is not a unit of length" in refusal(
        nanometres, height_unit="kg", **PLAIN
    )
    path.write_text(path.read_text().replace("units: µm", "units: nm"))
    assert "states heights in nm, which are possible; leave" in refusal(path, height_unit="um")


def test_units_and_sizes_that_a_file_lacks_must_be_named(tmp_path, heights, scan):
    path = tmp_path / "plain.txt"
    np.savetxt(path, 1e6 * heights)
    assert "read as asc, states no unit of length; name it, as in --unit um" in refusal(path)
    assert "states no size" in refusal(path, unit="um")
    assert "--unit kg is not a unit of length" in refusal(path, unit="kg", size=(20.0, 20.0))
    assert "2 dimensions" in refusal(path, unit="um", size=(20.0, 20.0, 20.0))
    [measurement] = read_measurements([path], ReadingOptions(**PLAIN))
    assert measurement.size == pytest.approx((20e-6, 20e-6))
    assert np.std(measurement.heights) == pytest.approx(
        np.std(read_measurements([scan])[0].heights), rel=1e-6
    )


def test_units_and_sizes_that_a_file_states_are_not_overruled(scan):
    assert "states its own unit, m" in refusal(scan, unit="nm")
    assert "states its own size" in refusal(scan, size=(1.0, 1.0))


_LEAN = """
import sys
from pathlib import Path
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
[scan] = read_measurements([Path(sys.argv[1])])
assert scan.format == "al3d"
assert "SurfaceTopography.IO.X3P" not in sys.modules and "matplotlib" not in sys.modules
[points] = read_measurements([Path(sys.argv[2])], ReadingOptions(unit="m"))
assert points.format == "xyz"
import SurfaceTopography
whole = SurfaceTopography.read_topography(sys.argv[1])
assert whole.detrend().rms_height_from_area() > 0
"""


@pytest.mark.slow
def test_a_scan_is_read_without_the_readers_of_other_formats_which_come_when_used(
    scan, tmp_path, rng
):
    write_xyz(tmp_path / "scan.xyz", 1e-8 * rng.standard_normal((N_SIDE, N_SIDE)))
    subprocess.run([sys.executable, "-c", _LEAN, scan, tmp_path / "scan.xyz"], check=True)


def test_a_missing_library_is_named_with_the_command_that_installs_it(monkeypatch, scan):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    assert "pip install '.[surfaces]'" in refusal(scan)


N_SIDE = 32
PIXEL = SIDE / N_SIDE
UNSTATED = ReadingOptions(detrend="center", unit="m", size=(SIDE, SIDE))


_X3P = """<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">
<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>
<CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{pixel}</Increment></CX>
<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{pixel}</Increment></CY>
<CZ><AxisType>A</AxisType><DataType>D</DataType><Increment>1</Increment></CZ></Axes></Record1>
<Record2><Date>2026-01-01T00:00:00</Date><Creator>test</Creator>
<Instrument><Manufacturer>A</Manufacturer><Model>B</Model><Serial>1</Serial>
<Version>1</Version></Instrument>
<CalibrationDate>2026-01-01T00:00:00</CalibrationDate>
<ProbingSystem><Type>Software</Type><Identification/></ProbingSystem></Record2>
<Record3><MatrixDimension><SizeX>{n}</SizeX><SizeY>{n}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
<DataLink><PointDataLink>bindata/data.bin</PointDataLink>
<MD5ChecksumPointData>{checksum}</MD5ChecksumPointData></DataLink></Record3>
<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></p:ISO5436_2>"""


def write_x3p(path, heights):
    """ISO 5436-2: a ZIP file of XML and numbers."""
    numbers = heights.T.astype("<f8").tobytes()
    checksum = hashlib.md5(numbers).hexdigest()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", _X3P.format(pixel=PIXEL, n=N_SIDE, checksum=checksum))
        archive.writestr("bindata/data.bin", numbers)


def write_h5(path, heights):
    """An array in HDF5."""
    with h5py.File(path, "w") as file:
        file["surface"] = heights


def write_xyz(path, heights):
    """Points in three columns."""
    places = PIXEL * np.indices(heights.shape).reshape(2, -1)
    np.savetxt(path, np.column_stack([*places, heights.ravel()]))


WRITERS = {
    "x3p": (write_x3p, ReadingOptions(detrend="center")),
    "xyz": (write_xyz, ReadingOptions(detrend="center", unit="m")),
    "asc": (lambda path, heights: np.savetxt(path, heights.T), UNSTATED),
    "npy": (np.save, UNSTATED),
    "h5": (write_h5, UNSTATED),
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_map_is_the_same_in_every_format(tmp_path, rng, name):
    heights = 1e-8 * rng.standard_normal((N_SIDE, N_SIDE))
    write, options = WRITERS[name]
    path = tmp_path / f"scan.{name}"
    write(path, heights)
    [measurement] = read_measurements([path], options)
    assert measurement.format == name
    assert measurement.size == pytest.approx((SIDE, SIDE))
    np.testing.assert_allclose(measurement.heights, heights - heights.mean(), atol=1e-20)
