"""Files of fields: the work of adhesion on a periodic tile or on rays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.adhesion import AdhesionMap
from crackfront.dataset.files import UnreadableFileError, read_dataset, write_dataset
from crackfront.pinning import Interpolation, PolarField, polar_field
from crackfront.provenance import Provenance
from crackfront.records import LATERAL
from crackfront.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

NAME = "work_of_adhesion"
TOLERANCE = 1e-6
"""Largest deviation from equal spacing, relative to it."""


@dataclass(frozen=True, slots=True)
class PolarSamples:
    """Samples on rays, and the angles of the rays.

    Attributes
    ----------
    field : PolarField
        The samples.
    angles : (n_angle,) array
        Angles of the rays. (Units: rad)
    """

    field: PolarField
    angles: Array


def read_field(path: Path, interpolation: Interpolation = "linear") -> AdhesionMap | PolarSamples:
    """Work of adhesion of a file: a periodic tile, or samples on rays.

    The variable `work_of_adhesion` is in reduced units, in which w_int is 1/pi. Its dimensions
    are x and y (equal and uniform spacing, coordinates needed; the sphere's apex is the tile's
    centre, half a side from the first point) or radius and angle (radius as a coordinate; angles
    equally spaced in rad), in any order. On rings it is the radius alone.

    Parameters
    ----------
    path : Path
        netCDF file.
    interpolation : {"linear", "cubic"}, optional
        Pieces between samples on rays; without effect on a tile.

    Raises
    ------
    ValueError
        If the file is missing or truncated, or its content is not as said.
    """
    dataset = read_dataset(path)
    if NAME not in dataset:
        raise UnreadableFileError(
            f"{path} has no variable {NAME} (it has: {', '.join(map(str, dataset.data_vars))}); "
            f"name the field {NAME}"
        )
    values = dataset[NAME]
    dims = {str(name) for name in values.dims}
    known = dims in ({"x", "y"}, {"radius", "angle"}, {"radius"})
    if not known or not np.issubdtype(values.dtype, np.number):
        raise UnreadableFileError(
            f"{path}: {NAME} is {values.dtype} of ({', '.join(map(str, values.dims))}); it must be "
            "numbers of (x, y) or of (radius, angle), or of (radius) for rings"
        )
    return _tile(path, values) if "x" in dims else _rays(path, values, interpolation)


def write_field(
    path: Path, adhesion: AdhesionMap, origin: Provenance, **attributes: str | float
) -> None:
    """Write a periodic tile as :func:`read_field` reads it.

    Parameters
    ----------
    path : Path
        netCDF file.
    adhesion : AdhesionMap
        Work of adhesion on the tile.
    origin : Provenance
        Where it comes from.
    **attributes : str or float
        What else the file says of itself.
    """
    values = adhesion.work_of_adhesion
    about = {"units": "pi w_int", "long_name": "local work of adhesion; w_int is 1/pi"}
    axis = {"units": LATERAL}
    coordinates = {
        name: ((name,), adhesion.pixel * np.arange(count), axis)
        for name, count in zip(("x", "y"), values.shape, strict=True)
    }
    dataset = xr.Dataset(
        {NAME: (("x", "y"), values, about)},
        coords=coordinates,
        attrs={"e_el": adhesion.elastic_energy, "w_rms": adhesion.rms, **attributes},
    )
    write_dataset(path, dataset, origin)


def _tile(path: Path, values: xr.DataArray) -> AdhesionMap:
    """Map of a periodic tile."""
    try:
        samples, pixel = tile_samples(values)
    except ValueError as error:
        raise UnreadableFileError(f"{path}: {error}") from error
    # The refusal of values that are not finite, with their place, is that of the field.
    with np.errstate(invalid="ignore"):
        rms = float(np.std(samples) / WORK_OF_ADHESION)
    return AdhesionMap(samples, pixel, elastic_energy=rms**2 / 4, rms=rms)


def tile_samples(values: xr.DataArray) -> tuple[Array, float]:
    """Values of a tile, first axis x, and their spacing.

    Parameters
    ----------
    values : xarray.DataArray
        Values of the dimensions x and y, in any order, with their coordinates.

    Raises
    ------
    ValueError
        If a coordinate is missing or not uniform, or the two spacings differ.
    """
    pixels = [_spacing(values, name) for name in ("x", "y")]
    if abs(pixels[1] / pixels[0] - 1) > TOLERANCE:
        raise ValueError(
            f"the spacing is {pixels[0]:.6g} in x and {pixels[1]:.6g} in y; they must be equal"
        )
    return np.ascontiguousarray(values.transpose("x", "y"), dtype=float), pixels[0]


def _spacing(values: xr.DataArray, name: str) -> float:
    """Uniform spacing of a coordinate."""
    if name not in values.coords or values.sizes[name] < 2:
        raise ValueError(
            f"{values.name} has {values.sizes[name]} point(s) along {name} and "
            f"{'a' if name in values.coords else 'no'} coordinate {name}; give 2 or more with "
            "their positions"
        )
    steps = np.diff(np.asarray(values[name], dtype=float))
    mean = float(np.mean(steps))
    if not (mean > 0 and np.max(np.abs(steps - mean)) <= TOLERANCE * mean):
        raise ValueError(
            f"{name} advances by {np.min(steps):.6g} to {np.max(steps):.6g}; it must "
            "increase in equal steps"
        )
    return mean


def _rays(path: Path, values: xr.DataArray, interpolation: Interpolation) -> PolarSamples:
    """Field of samples on rays."""
    if "radius" not in values.coords:
        raise UnreadableFileError(f"{path}: {NAME} has no coordinate radius; give the radii")
    if "angle" not in values.dims:
        values = values.expand_dims("angle")
    count = values.sizes["angle"]
    angles = 2 * np.pi * np.arange(count) / count
    if "angle" in values.coords and count > 1:
        angles = np.asarray(values["angle"], dtype=float)
        steps = np.diff(angles) * count / (2 * np.pi)
        if not np.all(np.abs(np.abs(steps) - 1) <= TOLERANCE) or np.ptp(np.sign(steps)) > 0:
            raise UnreadableFileError(
                f"{path}: {count} angles lie between {np.min(angles):.6g} and "
                f"{np.max(angles):.6g}; they must be equally spaced over the whole circle, in rad"
            )
    samples = np.asarray(values.transpose("radius", "angle"), dtype=float)
    radii = np.asarray(values["radius"], dtype=float)
    return PolarSamples(polar_field(radii, samples, interpolation), angles)
