"""The field under and between fronts: linear between the samples of a ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crackfront.compiled import jit
from crackfront.pinning.fields import Field, PolarField, TileField
from crackfront.pinning.samples import sample_count, sample_product, sample_radius

Array = NDArray[np.float64]


@jit
def segment_below(field, radius, direction):
    """Index of the sample below a radius; a radius on a sample belongs to the segment ahead."""
    low, high = 0, sample_count(field) - 1
    while high - low > 1:
        middle = (low + high) // 2
        inside = sample_radius(field, middle)
        if inside < radius or (direction > 0 and inside == radius):
            low = middle
        else:
            high = middle
    return low


@jit
def front_products(radius, field):
    """Radius times work of adhesion under a front, (n_angle,) array."""
    products = np.empty(radius.size)
    for i in range(radius.size):
        low = segment_below(field, radius[i], 1)
        inner, outer = sample_radius(field, low), sample_radius(field, low + 1)
        start, end = sample_product(field, i, low), sample_product(field, i, low + 1)
        products[i] = start + (end - start) / (outer - inner) * (radius[i] - inner)
    return products


def front_adhesion(radius: Array, field: Field) -> Array:
    """Work of adhesion under a front, w_loc(a(theta), theta).

    Parameters
    ----------
    radius : (n_angle,) array
        Front inside the field. (Units: reduced lateral length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    (n_angle,) array
        Work of adhesion. (Units: reduced energy / area)
    """
    return np.asarray(front_products(radius, field) / radius)


@jit
def _ray_adhesion(field, ray, inner, outer):
    """Integral of the product along a ray, exact for its linear pieces."""
    total, low, position = 0.0, segment_below(field, inner, 1), inner
    while position < outer:
        left, right = sample_radius(field, low), sample_radius(field, low + 1)
        start, end = sample_product(field, ray, low), sample_product(field, ray, low + 1)
        stop = min(right, outer)
        middle = 0.5 * (position + stop)
        total += (start + (end - start) / (right - left) * (middle - left)) * (stop - position)
        position, low = stop, low + 1
    return total


@jit
def _swept_adhesion(before, after, field):
    """Adhesion energy between two fronts, positive where the second lies outside."""
    total = 0.0
    for i in range(before.size):
        low, high = min(before[i], after[i]), max(before[i], after[i])
        total += np.sign(after[i] - before[i]) * _ray_adhesion(field, i, low, high)
    return 2 * np.pi * total / before.size


def swept_adhesion(before: Array, after: Array, field: Field) -> float:
    """Adhesion energy gained when one front turns into another.

    Parameters
    ----------
    before, after : (n_angle,) array
        Fronts inside the field. (Units: reduced lateral length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    float
        Integral of w_loc over the area between them, negative where contact is given up.
        (Units: reduced energy)
    """
    return float(_swept_adhesion(before, after, field))


@jit
def _sample_rays(field):
    """Products at all samples of all rays."""
    products = np.empty((field.cosine.size, field.n_sample))
    for ray in range(products.shape[0]):
        for sample in range(products.shape[1]):
            products[ray, sample] = sample_product(field, ray, sample)
    return products


def sampled_on_rays(field: TileField) -> PolarField:
    """The same field with all samples evaluated beforehand, as the paper's code has it.

    Parameters
    ----------
    field : TileField
        Field on a tile.

    Returns
    -------
    PolarField
        Field with identical samples; it takes n_angle * n_sample numbers of memory.
    """
    radii = field.spacing * np.arange(1, field.n_sample + 1, dtype=np.float64)
    return PolarField(radii, _sample_rays(field))
