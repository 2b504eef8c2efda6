"""Checksums: whatever bit of a result is flipped, its checksum or its reader finds it."""

import hashlib
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import crackfront as cf
from crackfront.cli import main
from crackfront.simulate.checksums import digest_path, is_whole, sums_text
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import UnreadableFileError, read_dataset, write_dataset


@contextmanager
def flipped(path, bit):
    """A file of which one bit is the other for a while."""
    with path.open("rb+", buffering=0) as file:
        file.seek(bit // 8)
        [byte] = file.read(1)
        for value in (byte ^ 1 << bit % 8, byte):
            file.seek(bit // 8)
            file.write(bytes([value]))
            if value != byte:
                yield


@pytest.mark.parametrize("named", [True, False])
def test_a_file_is_whole_if_its_name_or_the_file_next_to_it_states_its_checksum(tmp_path, named):
    content = b"content"
    digest = hashlib.sha256(content).hexdigest()
    path = tmp_path / (f"batch-0-3-{digest[:16]}.nc" if named else "fit.nc")
    path.write_bytes(content)
    assert is_whole(path) == named
    if not named:
        digest_path(path).write_text(sums_text({path.name: digest}))
    assert is_whole(path)
    for bit in range(8 * len(content)):
        with flipped(path, bit):
            assert not is_whole(path)


def test_a_checksum_that_was_cut_short_confirms_nothing(tmp_path):
    path = tmp_path / "table.nc"
    path.write_bytes(b"rows")
    digest_path(path).write_text(hashlib.sha256(b"rows").hexdigest()[:3])
    assert not is_whole(path)


@pytest.mark.parametrize("values", ["numbers", "counts"])
def test_no_flipped_bit_of_an_array_in_a_netcdf_file_is_believed(tmp_path, rng, values):
    checksums = {
        "numbers": rng.standard_normal(4000),
        "counts": rng.integers(2**60, size=4000),
    }[values]
    path = tmp_path / "array.nc"
    write_dataset(path, xr.Dataset({"a": ("x", checksums)}), provenance())
    assert np.array_equal(read_dataset(path).a, checksums)
    start = path.read_bytes().index(checksums.tobytes()[:16000])
    for bit in (8 * start + rng.integers(8 * 16000, size=40)).tolist():
        with (
            flipped(path, bit),
            pytest.raises(UnreadableFileError, match=r"array.nc is not a complete"),
        ):
            read_dataset(path)


def test_a_damaged_result_that_a_person_keeps_is_refused_with_one_sentence(tmp_path):
    path = tmp_path / "surface.nc"
    surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
    cf.save_result(surface, path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    options = ["--max-penetration", "0.1", "--output", str(tmp_path / "cycle.nc")]
    result = CliRunner().invoke(main, ["cycle", "--field", str(path), *options])
    assert result.exit_code == 2
    assert result.output.splitlines() == [
        f"Error: {path} is not a complete netCDF file; write it again, or name another"
    ]
