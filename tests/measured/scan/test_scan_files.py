"""Files of scans: what is refused before a library reads it."""

import os
import struct

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file

from crackfront.measured.scan import scan_files
from tests.measured.made import HEAD, one_cell, read, refusal, write_text

N_POINT = 48


@pytest.mark.parametrize("text", ["***", "1,5", "none", "1.2.3", "1-"])
def test_a_cell_that_is_no_number_is_refused_with_its_line(tmp_path, noise, text):
    path = write_text(tmp_path / "scan.txt", noise, one_cell(text))
    message = refusal(path)
    assert f"scan.txt, line {HEAD.count(chr(10)) + 21}:" in message
    assert repr(text) in message


def test_a_row_that_lacks_a_number_is_refused(tmp_path, noise):
    path = write_text(tmp_path / "scan.txt", noise, one_cell(""))
    assert f"the row has {N_POINT - 1} numbers and the row above has {N_POINT}" in refusal(path)


def test_damaged_points_in_three_columns_are_refused(tmp_path, noise):
    places = np.indices(noise.shape).reshape(2, -1).T
    rows = [f"{i} {j} {1e6 * noise[i, j]:.6f}" for i, j in places]
    path = tmp_path / "scan.xyz"
    path.write_text("\n".join([*rows[:5], "0 5 ***", *rows[6:]]))
    assert "line 6: number 3 of the row is '***'" in refusal(path, unit="um")
    path.write_text("\n".join([*rows[:5], "0 5 bad", *rows[6:]]))
    measurement = read(path, detrend="center", unit="um")
    assert measurement.missing == pytest.approx(1 / noise.size)


def test_folders_pipes_devices_and_empty_files_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "empty.al3d").touch()
    assert "is a folder" in refusal(tmp_path)
    assert "is a pipe" in refusal(tmp_path / "pipe")
    assert "is empty" in refusal(tmp_path / "empty.al3d")
    for name in ("/dev/zero", "/dev/null"):
        assert "is a device" in refusal(scan_files.Path(name))


def test_maps_that_claim_more_points_than_fit_are_refused_before_they_are_read(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("crackfront.core.resources.memory_at_hand", lambda: 20_000_000_000)
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
