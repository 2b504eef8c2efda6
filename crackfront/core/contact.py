"""The contact of a sphere with a given tile: a field that resolves it and is large enough."""

from __future__ import annotations

import math

import numpy as np
from scipy.fft import next_fast_len

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.field.fields import Interpolation, TileField, tile_field
from crackfront.core.geometry.sphere import sphere
from crackfront.core.units import WORK_OF_ADHESION


def contact_field(
    adhesion: AdhesionMap,
    max_penetration: float,
    n_angle: int | None = None,
    spacing: float | None = None,
    interpolation: Interpolation = "cubic",
    *,
    band_limited: bool = False,
) -> TileField:
    """Field of a sphere on a tile, which no front can leave up to a penetration.

    By no passing, a front stays inside the circle in equilibrium with the tile's largest work of
    adhesion; a tenth more allows for the overshoot of the splines between the points.

    Parameters
    ----------
    adhesion : AdhesionMap
        Work of adhesion on the tile, which may be smaller than the contact.
    max_penetration : float
        Largest penetration. (Units: reduced vertical length)
    n_angle : int, optional
        Sites of the front; by default at least one a pixel on the smooth contact's largest circle.
    spacing : float, optional
        Distance of samples along a ray; by default half a pixel, or a quarter where straight
        pieces join the samples. (Units: reduced lateral length)
    interpolation, band_limited
        As of :func:`crackfront.core.field.fields.tile_field`.

    Raises
    ------
    ValueError
        If the penetration is below pull-off, or as :func:`crackfront.core.field.fields.tile_field`.
    """
    if n_angle is None:
        circle = 2 * math.pi * jkr.equilibrium_radius(max_penetration)
        n_angle = n_site(circle / adhesion.pixel)
    if spacing is None:
        spacing = adhesion.pixel / (2 if interpolation == "cubic" else 4)
    values = adhesion.work_of_adhesion
    # The refusal of values that are not finite, with their place, is tile_field's.
    strongest = float(np.max(values, where=np.isfinite(values), initial=WORK_OF_ADHESION))
    largest = 1.1 * jkr.equilibrium_radius(max_penetration, strongest / WORK_OF_ADHESION)
    return tile_field(
        adhesion, sphere(n_angle), spacing, largest, interpolation, band_limited=band_limited
    )


def n_site(least: float) -> int:
    """Even number of sites, 4 or more and not below a number, whose transforms are fast.

    Transforms are fast of lengths without large prime factors. From 256 sites on the number is a
    multiple of 8, so that four pairs of sites are transformed at once; from 16384 on, of 32.
    """
    least = max(4.0, least * (1 - 1e-12))
    together = 2 if least < 256 else 8 if least < 16384 else 32
    return together * int(next_fast_len(math.ceil(least / together), real=True))
