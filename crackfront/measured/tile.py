"""A measured map as a surface for simulations, mirrored to a periodic tile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crackfront.core.units import Scales
from crackfront.measured.density.bands import Scan
from crackfront.measured.prediction.conditions import zero_load_radius
from crackfront.measured.prediction.remarks import remark_text
from crackfront.measured.prediction.surface_remarks import scan_remarks
from crackfront.measured.tile_heights import tile_heights
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    from xarray import DataArray


def scan_surface(scan: Scan, sphere: Scales) -> DataArray:
    """A measured map as a surface for simulations, on a periodic tile around the scan.

    The scan is mirrored at its edges, so that the tile has twice its sides and no steps; a periodic
    scan is the tile itself. Oblong pixels are interpolated to square ones by cubic splines. Waves
    shorter than the trusted ones are removed.

    Parameters
    ----------
    scan : Scan
        A map with its trusted band.
    sphere : Scales
        Sphere whose reduced units the surface has.

    Returns
    -------
    xarray.DataArray
        `height(x, y)` in reduced units, with the apex of the sphere at the centre of the scan. Its
        attributes document the treatment.

    Raises
    ------
    ValueError
        If the measurement is a line.
    """
    # The import is slow, and predictions import this module too.
    from crackfront.surfaces.surface_array import surface_array

    measurement = scan.trusted_measurement
    notes = scan_remarks([scan], zero_load_radius(sphere))
    heights, pixel = tile_heights(measurement)
    tile = "the scan mirrored at its edges, with twice its sides"
    if measurement.periodic:
        tile = "the scan itself, as its file states that it is periodic"
    return surface_array(
        "roughness",
        heights / sphere.vertical,
        pixel / sphere.lateral,
        source=f"{measurement.path}, {measurement.format}, checksum {measurement.checksum}",
        levelling=f"{measurement.levelling} was subtracted: form and tilt are no roughness",
        tile=tile,
        waves=f"those shorter than {prefixed('m', measurement.shortest)} were removed, as they "
        "cannot be trusted",
        notes=" ".join(map(remark_text, notes)),
    )
