"""Where the edge of a contact of boundary elements is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

Array = NDArray[np.float64]

N_ANGLE = 720
"""Rays on which the perimeter of a contact is looked for."""

EDGE = 0.25
"""Gap at the edge of the contact, relative to the range of attraction.

The crack of linear elasticity that is equivalent to a cohesive zone has its tip within the zone, at
a gap that scales with the range.
"""


def perimeter(gap: Array, pixel: float, edge: float) -> Array:
    """Outermost distance from the apex at which the gap is below that of the edge, ray by ray.

    Parameters
    ----------
    gap : (n_point, n_point) array
        Gap between the surfaces. (Units: reduced vertical length)
    pixel : float
        Grid spacing. (Units: reduced lateral length)
    edge : float
        Gap at the edge of the contact. (Units: reduced vertical length)

    Returns
    -------
    (N_ANGLE,) array
        Distance, 0 where a ray has no contact. (Units: reduced lateral length)
    """
    centre = len(gap) // 2
    angle = 2 * np.pi * np.arange(N_ANGLE) / N_ANGLE
    distance = np.arange(0.0, centre - 1, 0.25)
    rays = map_coordinates(
        gap,
        centre + distance * np.stack([np.cos(angle), np.sin(angle)])[:, :, None],
        order=1,
        mode="nearest",
    )
    within = rays < edge
    last = distance.size - 1 - np.argmax(within[:, ::-1], axis=1)
    last = np.minimum(last, distance.size - 2)
    ray = np.arange(N_ANGLE)
    near, far = rays[ray, last], rays[ray, last + 1]
    opening = far - near
    part = np.divide(edge - near, opening, out=np.zeros(N_ANGLE), where=opening > 0)
    return np.where(np.any(within, axis=1), (distance[last] + 0.25 * part) * pixel, 0.0)
