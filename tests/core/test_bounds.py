"""Bounds of what comes from outside: refused at once, with what is needed and what is at hand."""

import math
import os
import resource
import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray as xr

from crackfront import random_surface
from crackfront.core.arguments import regular_file
from crackfront.core.bounds import LENGTH, check_within
from crackfront.core.resources import (
    TooLargeError,
    check_memory,
)
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.storage import read_dataset
from tests.commands import refused


@pytest.mark.parametrize("value", [1e300, -1.0, math.nan, math.inf, 0.0])
def test_a_number_outside_of_its_bounds_is_named(value):
    with pytest.raises(ValueError, match=r"spring is .*; it must lie between 1e-09 and 1e\+09 m"):
        check_within("spring", value, LENGTH, "m")


def test_memory_is_refused_with_what_is_needed_and_what_is_at_hand():
    with pytest.raises(TooLargeError, match=r"a tile would need 300 PB of memory; here are .*: no"):
        check_memory("a tile", 3e17, "no")
    check_memory("a tile", 1e6, "no")


def test_a_limit_that_the_process_sets_itself_is_what_is_at_hand_from_then_on():
    code = (
        "import resource; from crackfront.core.resources import memory_at_hand\n"
        "assert memory_at_hand() > 1e9\n"
        "resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))\n"
        "free = memory_at_hand()\n"
        "assert 0 < free < 1e9\n"
        "taken = bytearray(10**8)\n"
        "assert memory_at_hand() < free - 9e7"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=600)


def special(kind, path):
    """Something of a name that is no file."""
    if kind == "a pipe":
        os.mkfifo(path)
    elif kind == "a folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    return path


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "a device"])
def test_what_is_no_file_is_named_at_once(tmp_path, kind):
    path = special(kind, tmp_path / "x.yaml")
    with pytest.raises(ValueError, match=f"x.yaml is {kind}, not a file; name a file"):
        regular_file(path)
    assert f"is {kind}, not a file" in refused("plan", path)
    assert "x.yaml is not a file; check the name" in refused(
        *("cycle", "--field", path, "--max-penetration", 1, "--output", tmp_path / "out.nc")
    )


def test_a_file_that_claims_300_gigabytes_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "field.nc"
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with netCDF4.Dataset(path, "w") as file:
        for name in ("x", "y"):
            file.createDimension(name, 10**6)
        file.createVariable("work_of_adhesion", "f8", ("x", "y"), zlib=True)
    assert path.stat().st_size < 1e6
    with pytest.raises(TooLargeError, match=r"field.nc would need 8 TB of memory; here are"):
        read_dataset(path)
    sentence = refused(
        *("cycle", "--field", path, "--max-penetration", 1, "--output", tmp_path / "out.nc")
    )
    assert "field.nc would need 48 TB of memory" in sentence
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4e6


@pytest.fixture
def tile(tmp_path):
    """File of a smooth tile."""
    axis = np.linspace(0, 2, 8, endpoint=False)
    values = np.full((8, 8), WORK_OF_ADHESION)
    dataset = xr.Dataset({"work_of_adhesion": (("x", "y"), values)}, {"x": axis, "y": axis})
    dataset.to_netcdf(tmp_path / "tile.nc")
    return tmp_path / "tile.nc"


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"--error": "inf"}, "'--error': inf is not in the range"),
        ({"--error": "nan"}, "'--error': nan is not a number"),
        ({"--step": 1e-300}, "load steps with 44.8 sites"),
        ({"--step": 1e-15}, "load steps with 44.8 sites and 57.1 samples a ray would need"),
        ({"--max-penetration": 1e15}, "of memory; here are"),
        ({"--max-penetration": 1e308}, "'--max-penetration': 1e+308 is not in the range"),
    ],
)
def test_absurd_options_of_a_cycle_are_refused(tile, tmp_path, options, sentence):
    arguments = {"--max-penetration": 1, "--step": 0.25, "--output": tmp_path / "out.nc"} | options
    assert sentence in refused(
        *("cycle", "--field", tile), *(part for pair in arguments.items() for part in pair)
    )


@pytest.mark.parametrize("value", [1e308, 1e30, -1e30])
def test_a_field_with_one_absurd_value_is_refused_with_its_place(tile, tmp_path, value):
    dataset = xr.load_dataset(tile)
    dataset["work_of_adhesion"][3, 5] = value
    dataset.to_netcdf(tile)
    sentence = refused(
        *("cycle", "--field", tile, "--max-penetration", 1, "--output", tmp_path / "out.nc")
    )
    assert "at index 3, 5 (1 such value); it must lie between -10000 and 10000" in sentence


def test_a_surface_that_no_machine_holds_is_refused_before_it_is_made():
    with pytest.raises(TooLargeError, match=r"tiles of .* points would need .* of memory; here"):
        random_surface(short_cutoff=1e-6, elastic_energy=0.05, side=10.0)
    with pytest.raises(ValueError, match="seed is 9223372036854775808; it must lie between 0"):
        random_surface(short_cutoff=0.2, elastic_energy=0.05, side=4, seed=2**63)
