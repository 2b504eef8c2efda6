"""Files of fields: the work of adhesion on a periodic tile or on rays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.adhesion import AdhesionMap
from crackfront.core.field.fields import Interpolation, RayField, polar_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, LATERAL
from crackfront.data.bounds import LENGTH, refuse_outside
from crackfront.data.files import UnreadableFileError, read_dataset, write_dataset
from crackfront.data.provenance import Provenance
from crackfront.data.tiles import TOLERANCE, refuse_extreme, tile_samples
from crackfront.simulate.si_units import SURFACES
from crackfront.simulate.surfaces import surface_adhesion

Array = NDArray[np.float64]

NAME = SURFACES["chemical"].name
_HEIGHT = SURFACES["roughness"].name

_COPIES = 6
"""Memory of a field in use over that of its values: as numbers of double precision, as splines."""


@dataclass(frozen=True, slots=True)
class PolarSamples:
    """Samples on rays, and the angles of the rays (Units: rad)."""

    field: RayField
    angles: Array


def read_field(path: Path, interpolation: Interpolation = "linear") -> AdhesionMap | PolarSamples:
    """Work of adhesion of a file: a periodic tile, or samples on rays.

    The variable `work_of_adhesion` is in reduced units, in which w_int is 1/pi, or relative to
    w_int where its attribute `units` says so, as that of the library does. Its dimensions
    are x and y (equal and uniform spacing, coordinates needed; the sphere's apex is the tile's
    centre, half a side from the first point) or radius and angle (radius as a coordinate; angles
    equally spaced in rad), in any order. On rings it is the radius alone. A variable `height`
    instead is a rough surface as the library makes it.

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
    if NAME not in dataset and _HEIGHT in dataset:
        with _naming(path):
            return surface_adhesion(dataset[_HEIGHT])
    if NAME not in dataset:
        raise UnreadableFileError(
            f"{path} has no variable {NAME} (it has: {', '.join(map(str, dataset.data_vars))}); "
            f"name the field {NAME}, or the heights of a surface {_HEIGHT}"
        )
    values = dataset[NAME]
    dims = {str(name) for name in values.dims}
    known = dims in ({"x", "y"}, {"radius", "angle"}, {"radius"})
    if not known or not _is_real(values):
        raise UnreadableFileError(
            f"{path}: {NAME} is {values.dtype} of ({', '.join(map(str, values.dims))}); it must be "
            "real numbers of (x, y) or of (radius, angle), or of (radius) for rings"
        )
    if others := [name for name in values.coords if not _is_real(values[name])]:
        raise UnreadableFileError(
            f"{path}: {others[0]} is {values[others[0]].dtype}; places must be real numbers"
        )
    _refuse_other_units(path, values)
    if values.attrs.get("units") == ADHESION:
        values = values * WORK_OF_ADHESION
    return _tile(path, values) if "x" in dims else _rays(path, values, interpolation)


def _is_real(values: xr.DataArray) -> bool:
    """Whether values are real numbers."""
    return np.issubdtype(values.dtype, np.floating) or np.issubdtype(values.dtype, np.integer)


def write_field(
    path: Path, adhesion: AdhesionMap, origin: Provenance, **attributes: str | float
) -> None:
    """Write a periodic tile as :func:`read_field` reads it, with what else it says of itself."""
    values = adhesion.work_of_adhesion / WORK_OF_ADHESION
    about = {"units": ADHESION, "long_name": "local work of adhesion"}
    axis = {"units": LATERAL}
    coordinates = {
        name: ((name,), adhesion.pixel * np.arange(count), axis)
        for name, count in zip(("x", "y"), values.shape, strict=True)
    }
    dataset = xr.Dataset(
        {NAME: (("x", "y"), values, about)},
        coords=coordinates,
        attrs={"e_el": adhesion.e_el, "w_rms": adhesion.w_rms, **attributes},
    )
    write_dataset(path, dataset, origin)


def _refuse_other_units(path: Path, values: xr.DataArray) -> None:
    """Raise if the field or a length says that it is in units other than reduced ones."""
    lengths = [values[name] for name in ("x", "y", "radius") if name in values.coords]
    for part in (values, *lengths):
        units = str(part.attrs.get("units", ""))
        if units not in ("", "1", ADHESION) and not units.startswith("reduced"):
            raise UnreadableFileError(
                f"{path}: {part.name} is in {units}; convert it to reduced units, as "
                "crackfront.in_reduced_units does, and remove or renew its attribute units"
            )


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Begin a refusal with the name of the file."""
    try:
        yield
    except ValueError as error:
        raise UnreadableFileError(f"{path}: {error}") from error


def _refuse_extreme(path: Path, samples: Array) -> None:
    """Raise if a sample is larger than any work of adhesion."""
    with _naming(path):
        refuse_extreme(f"{NAME} / w_int", samples, WORK_OF_ADHESION)


def _tile(path: Path, values: xr.DataArray) -> AdhesionMap:
    """Map of a periodic tile."""
    with _naming(path):
        samples, pixel = tile_samples(values)
    _refuse_extreme(path, samples)
    # The refusal of values that are not finite, with their place, is that of the field.
    with np.errstate(invalid="ignore"):
        rms = float(np.std(samples) / WORK_OF_ADHESION)
    corner = float(values["x"][0]), float(values["y"][0])
    return AdhesionMap(samples, pixel, e_el=rms**2 / 4, w_rms=rms, corner=corner)


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
    _refuse_extreme(path, samples)
    radii = np.asarray(values["radius"], dtype=float)
    with np.errstate(invalid="ignore", over="ignore"):
        for distance in (np.max(radii, initial=LENGTH.least), np.min(np.diff(radii), initial=1.0)):
            # The refusal of radii that do not increase is that of the field.
            if distance > 0:
                refuse_outside(f"{path}: a radius or the distance of two", float(distance), LENGTH)
    return PolarSamples(polar_field(radii, samples, interpolation), angles)
