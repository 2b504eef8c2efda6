"""One map in the formats of instruments, standards and arrays: what is read is always the same."""

import hashlib
import zipfile

import h5py
import numpy as np
import pytest

from crackfront.topography.options import ReadingOptions
from crackfront.topography.reading import read_measurements

SIDE, N_POINT = 20e-6, 32
PIXEL = SIDE / N_POINT
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
        archive.writestr("main.xml", _X3P.format(pixel=PIXEL, n=N_POINT, checksum=checksum))
        archive.writestr("bindata/data.bin", numbers)


def write_sdf(path, heights):
    """ISO 25178-71: text with a head."""
    head = {
        "NumPoints": N_POINT,
        "NumProfiles": N_POINT,
        "Xscale": PIXEL,
        "Yscale": PIXEL,
        "Zscale": 1,
        "Zresolution": -1,
        "Compression": 0,
        "DataType": 7,
        "CheckType": 0,
    }
    rows = [" ".join(f"{value:.17e}" for value in row) for row in heights.T]
    lines = ["aISO-1.0", *(f"{name} = {value}" for name, value in head.items()), "*", *rows, "*"]
    path.write_text("\n".join(lines) + "\n")


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
    "sdf": (write_sdf, ReadingOptions(detrend="center")),
    "xyz": (write_xyz, ReadingOptions(detrend="center", unit="m")),
    "asc": (lambda path, heights: np.savetxt(path, heights.T), UNSTATED),
    "npy": (np.save, UNSTATED),
    "h5": (write_h5, UNSTATED),
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_map_is_the_same_in_every_format(tmp_path, rng, name):
    heights = 1e-8 * rng.standard_normal((N_POINT, N_POINT))
    write, options = WRITERS[name]
    path = tmp_path / f"scan.{name}"
    write(path, heights)
    [measurement] = read_measurements([path], options)
    assert measurement.format == name
    assert measurement.size == pytest.approx((SIDE, SIDE))
    np.testing.assert_allclose(measurement.heights, heights - heights.mean(), atol=1e-20)


def test_a_file_with_a_damaged_head_is_refused_with_a_sentence(tmp_path, rng):
    path = tmp_path / "scan.x3p"
    write_x3p(path, rng.standard_normal((N_POINT, N_POINT)))
    with zipfile.ZipFile(path) as archive:
        head, numbers = (archive.read(name) for name in ("main.xml", "bindata/data.bin"))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", head.replace(b"<Model>B</Model>", b"<Model/>"))
        archive.writestr("bindata/data.bin", numbers)
    with pytest.raises(ValueError, match=r"scan.x3p cannot be read as what its head says: .*; exp"):
        read_measurements([path])
