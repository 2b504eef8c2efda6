"""Grids in netCDF: sides and heights in the units that their attributes say."""

import netCDF4
import numpy as np
import pytest
from scipy.io import netcdf_file

from tests.measured.made import read, refusal

COUNT = 48


def classic(
    path, heights, dims=("x", "y"), name="heights", length=True, word="unit", units=("um", "um")
):
    """A classic netCDF file, sides of 20 um."""
    with netcdf_file(path, "w", version=2) as file:
        for dim in dims:
            file.createDimension(dim, COUNT)
            coordinate = file.createVariable(dim, "f8", (dim,))
            coordinate[:] = 20 / COUNT * np.arange(COUNT)
            setattr(coordinate, word, units[0])
            if length:
                coordinate.length = 20.0
        variable = file.createVariable(name, "f8", dims)
        variable[:] = heights
        setattr(variable, word, units[1])
    return path


@pytest.mark.parametrize(
    ("factor", "options"),
    [
        (1e6, {}),
        (1e9, {"units": ("um", "nm")}),
        (1e6, {"word": "units"}),
        (1e9, {"word": "units", "units": ("micrometer", "nanometer"), "length": False}),
        (1e6, {"name": "height"}),
        (1e9, {"name": "z", "word": "units", "units": ("um", "nm"), "length": False}),
        (1e6, {"dims": ("y", "x")}),
    ],
)
def test_sides_and_heights_have_each_their_unit(tmp_path, noise, factor, options):
    stored = factor * (noise.T if options.get("dims") else noise)
    measurement = read(classic(tmp_path / "scan.nc", stored, **options), detrend="center")
    assert measurement.format == "nc"
    assert measurement.size == pytest.approx((20e-6, 20e-6))
    np.testing.assert_allclose(measurement.heights, noise - noise.mean(), atol=1e-18)


def modern(path, variables, unit="um"):
    """A netCDF-4 file."""
    with netCDF4.Dataset(path, "w") as file:
        for dim in "xy":
            file.createDimension(dim, COUNT)
            file.createVariable(dim, "f8", (dim,))[:] = 20 / COUNT * np.arange(COUNT)[::-1]
            file[dim].units = unit
        for name, (values, attributes) in variables.items():
            file.createVariable(name, "f8", ("x", "y"), fill_value=-9999.0)[:] = values
            file[name].units = attributes
    return path


def test_fill_values_are_missing_and_descending_coordinates_turned(tmp_path, noise):
    holes = np.ma.array(1e9 * noise, mask=np.zeros(noise.shape, dtype=bool))
    holes[5, 6] = holes[20, 9] = np.ma.masked
    measurement = read(modern(tmp_path / "scan.nc", {"height": (holes, "nm")}), detrend="center")
    assert measurement.missing == pytest.approx(2 / noise.size)
    assert np.std(measurement.heights[::-1, ::-1] - noise) < 0.1 * np.std(noise)


def test_a_quantity_that_is_no_length_is_no_height(tmp_path, noise):
    arrays = {"a": (noise, "V"), "b": (1e6 * noise, "um")}
    assert read(modern(tmp_path / "scan.nc", arrays)).channel == "'b', 1 of 2"
    assert "channel 'a' contains voltage" in refusal(tmp_path / "scan.nc", channel="a")
    two = {"a": (noise, "um"), "b": (1e6 * noise, "um")}
    assert "do not say which one has the heights" in refusal(modern(tmp_path / "scan.nc", two))
    degrees = modern(tmp_path / "scan.nc", {"height": (noise, "m")}, "degrees_east")
    assert "states x in degrees_east, and height in m; write both" in refusal(degrees)
