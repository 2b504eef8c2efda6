"""Checksums: whatever bit of a result is flipped, its list or its reader finds it."""

import subprocess
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import crackfront as cf
from crackfront.cli import main
from crackfront.data.digests import SUMS, result_files
from crackfront.data.files import (
    UnreadableFileError,
    damaged_files,
    read_dataset,
    write_dataset,
    write_sums,
)
from crackfront.data.provenance import provenance


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


@pytest.fixture
def listed(tmp_path):
    """A folder of results of several kinds, with its list."""
    for name in ("fit.json", "figures/loop.pdf", "summary.html", "shards/notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"{name}\n")
    write_sums(tmp_path)
    return tmp_path


def test_the_list_of_a_folder_is_what_sha256sum_checks(listed):
    command = ["sha256sum", "--check", SUMS]
    done = subprocess.run(command, cwd=listed, capture_output=True, text=True, check=True)
    assert done.stdout.count(": OK") == 4
    assert damaged_files(listed) == []
    (listed / "fit.json").write_text("else\n")
    assert subprocess.run(command, cwd=listed, capture_output=True, check=False).returncode == 1
    assert damaged_files(listed) == [listed / "fit.json"]


@pytest.mark.parametrize("stride", [7, pytest.param(1, marks=pytest.mark.slow)])
def test_every_single_bit_of_a_listed_file_counts(listed, stride):
    for path in result_files(listed):
        for bit in range(0, 8 * path.stat().st_size, stride):
            with flipped(path, bit):
                assert damaged_files(listed) == [path], f"bit {bit}"
    assert damaged_files(listed) == []


def test_a_listed_file_that_is_cut_or_emptied_is_damaged(listed):
    path = listed / "fit.json"
    content = path.read_bytes()
    for left in (*(content[:length] for length in range(len(content))), content + b" "):
        path.write_bytes(left)
        assert damaged_files(listed) == [path]


def test_logs_checkpoints_and_what_was_set_aside_are_not_listed(listed):
    for name in ("logs/fit.log", "checkpoints/a.nc", "benchmarks/fit.tsv", "fit.md.damaged", ".a"):
        (listed / name).parent.mkdir(exist_ok=True)
        (listed / name).write_text("text")
    assert len(list(result_files(listed))) == 4


def test_a_damaged_folder_gets_no_list(listed):
    (listed / "fit.nc").write_bytes(b"half")
    with pytest.raises(ValueError, match=r"fit.nc is damaged; run crackfront repair"):
        write_sums(listed)
    assert not (listed / SUMS).exists()


def test_an_empty_folder_gets_no_list(tmp_path):
    with pytest.raises(ValueError, match="holds no file; name a folder of results"):
        write_sums(tmp_path)


@pytest.mark.parametrize("values", ["numbers", "counts", "letters"])
def test_no_flipped_bit_of_an_array_in_a_netcdf_file_is_believed(tmp_path, rng, values):
    known = {
        "numbers": rng.standard_normal(4000),
        "counts": rng.integers(2**60, size=4000),
        "letters": np.array([f"{number:032x}" for number in rng.integers(2**60, size=900)]),
    }[values]
    path = tmp_path / "array.nc"
    write_dataset(path, xr.Dataset({"a": ("x", known)}), provenance())
    assert np.array_equal(read_dataset(path).a, known)
    stored = known.astype("S32") if values == "letters" else known
    start = path.read_bytes().index(stored.tobytes()[:16000])
    for bit in (8 * start + rng.integers(8 * 16000, size=40)).tolist():
        with (
            flipped(path, bit),
            pytest.raises(UnreadableFileError, match=r"array.nc is no complete"),
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
        f"Error: {path} is no complete netCDF file; write it again, or name another"
    ]
