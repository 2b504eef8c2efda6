"""Files of fields: the work of adhesion on a periodic tile or on rays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.core.adhesion import AdhesionMap
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Interpolation, RayField, polar_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.bounds import LENGTH, refuse_outside
from crackfront.data.files import UnreadableFileError, read_dataset
from crackfront.data.tiles import TOLERANCE, refuse_extreme
from crackfront.simulate.given import reduced_adhesion, surface_adhesion
from crackfront.simulate.si_units import SURFACES, refuse_other_units

NAME = SURFACES["chemical"].name
_HEIGHT = SURFACES["roughness"].name

_REAL = "fiu"
"""Kinds of types of numpy that are real numbers."""

_COPIES = 6
"""Memory of a field in use over that of its values: as numbers of double precision, as splines."""


@dataclass(frozen=True, slots=True)
class PolarSamples:
    """Samples on rays, and the angles of the rays (Units: rad)."""

    field: RayField
    angles: Array


def read_field(path: Path, interpolation: Interpolation = "linear") -> AdhesionMap | PolarSamples:
    """Work of adhesion of a file: a periodic tile, or samples on rays.

    A tile is a surface of the library, `height(x, y)` or `work_of_adhesion(x, y)`, as of
    :func:`crackfront.simulate.surfaces.surface_adhesion`, the sphere's apex at its centre, half a
    side from the first point. Works of adhesion whose attribute `units` is missing are in reduced
    units. Those on rays have the dimensions radius and angle (radius as a coordinate; angles
    equally spaced in rad), in any order, on rings the radius alone.

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
    dataset = read_dataset(path, copies=_COPIES)
    try:
        return _field(dataset, interpolation)
    except ValueError as error:
        raise UnreadableFileError(f"{path}: {error}") from error


def _field(dataset: xr.Dataset, interpolation: Interpolation) -> AdhesionMap | PolarSamples:
    """Work of adhesion of a dataset, by what it holds."""
    if NAME not in dataset and _HEIGHT in dataset:
        return surface_adhesion(dataset[_HEIGHT])
    if NAME not in dataset:
        raise ValueError(
            f"the file has no variable {NAME} (it has: {', '.join(map(str, dataset.data_vars))}); "
            f"name the field {NAME}, or the heights of a surface {_HEIGHT}"
        )
    values = dataset[NAME]
    known = {*values.dims} in ({"x", "y"}, {"radius", "angle"}, {"radius"})
    if not known or values.dtype.kind not in _REAL:
        raise ValueError(
            f"{NAME} is {values.dtype} of ({', '.join(map(str, values.dims))}); it must be "
            "real numbers of (x, y) or of (radius, angle), or of (radius) for rings"
        )
    for name, places in values.coords.items():
        if places.dtype.kind not in _REAL:
            raise ValueError(f"{name} is {places.dtype}; places must be real numbers")
    if "x" in values.dims:
        return surface_adhesion(values)
    refuse_other_units(values.coords.to_dataset().drop_vars("angle", errors="ignore"))
    values = reduced_adhesion(values.transpose("radius", "angle", missing_dims="ignore"))
    refuse_extreme(f"{NAME} / w_int", values.to_numpy(), WORK_OF_ADHESION)
    return _rays(values, interpolation)


def _rays(values: xr.DataArray, interpolation: Interpolation) -> PolarSamples:
    """Field of samples on rays."""
    if "radius" not in values.coords:
        raise ValueError(f"{NAME} has no coordinate radius; give the radii")
    if "angle" not in values.dims:
        values = values.expand_dims("angle")
    count = values.sizes["angle"]
    angles = 2 * np.pi * np.arange(count) / count
    if "angle" in values.coords and count > 1:
        angles = np.asarray(values["angle"], dtype=float)
        steps = np.diff(angles) * count / (2 * np.pi)
        if not np.all(np.abs(np.abs(steps) - 1) <= TOLERANCE) or np.ptp(np.sign(steps)) > 0:
            raise ValueError(
                f"{count} angles lie between {np.min(angles):.6g} and {np.max(angles):.6g}; they "
                "must be equally spaced over the whole circle, in rad"
            )
    radii = np.asarray(values["radius"], dtype=float)
    with np.errstate(invalid="ignore", over="ignore"):
        for distance in (np.max(radii, initial=LENGTH.least), np.min(np.diff(radii), initial=1.0)):
            # The refusal of radii that do not increase is that of the field.
            if distance > 0:
                refuse_outside("a radius or the distance of two", float(distance), LENGTH)
    samples = values.transpose("radius", "angle").to_numpy()
    return PolarSamples(polar_field(radii, samples, interpolation), angles)
