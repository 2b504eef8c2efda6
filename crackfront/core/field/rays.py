"""The field under and between fronts."""

from __future__ import annotations

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.field.fields import Field, RayField, TileField
from crackfront.core.field.pieces import blend, evaluate_piece, ordinates
from crackfront.core.field.samples import evaluate, sample_count, sample_place
from crackfront.core.geometry.base import weight


@jit
def segment_below(field, place, direction):
    """Index of the sample below a place; for a place on a sample, of the segment ahead."""
    low, high = 0, sample_count(field) - 1
    while high - low > 1:
        middle = (low + high) // 2
        inside = sample_place(field, middle)
        if inside < place or (direction > 0 and inside == place):
            low = middle
        else:
            high = middle
    return low


@jit
def front_products(front, field):
    """Weighted work of adhesion under a front, (n_site,) array."""
    products = np.empty(front.size)
    for i in range(front.size):
        low = segment_below(field, front[i], 1)
        inner, outer = sample_place(field, low), sample_place(field, low + 1)
        products[i] = blend(evaluate_piece(field, i, low), (front[i] - inner) / (outer - inner))
    return products


def front_adhesion(front: Array, field: Field) -> Array:
    """Work of adhesion under a front, w_loc(a(theta), theta).

    Parameters
    ----------
    front : (n_site,) array
        Front inside the field. (Units: reduced lateral length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    (n_site,) array
        Work of adhesion. (Units: reduced energy / area)
    """
    return np.asarray(front_products(front, field) / _weights(front, field.geometry))


@jit
def _weights(front, geometry):
    """Weights of the work of adhesion under a front."""
    weights = np.empty(front.size)
    for i in range(front.size):
        weights[i] = weight(geometry, front[i])
    return weights


@jit
def _ray_adhesion(field, ray, inner, outer):
    """Integral of the product along a ray, by Simpson's rule, which is exact for its pieces."""
    if inner >= outer:
        return 0.0
    total, low, position = 0.0, segment_below(field, inner, 1), inner
    start = evaluate(field, ray, low)
    while position < outer:
        lower, upper = sample_place(field, low), sample_place(field, low + 1)
        end = evaluate(field, ray, low + 1)
        piece = ordinates(field, low, start, end)
        stop = min(upper, outer)
        first, last = (position - lower) / (upper - lower), (stop - lower) / (upper - lower)
        values = blend(piece, first) + 4 * blend(piece, 0.5 * (first + last)) + blend(piece, last)
        total += values / 6 * (stop - position)
        position, low, start = stop, low + 1, end
    return total


@jit
def _swept_adhesion(before, after, field):
    """Sum over the rays of the adhesion energy between two fronts, per width of a site."""
    total = 0.0
    for i in range(before.size):
        low, high = min(before[i], after[i]), max(before[i], after[i])
        total += np.sign(after[i] - before[i]) * _ray_adhesion(field, i, low, high)
    return total


def swept_adhesion(before: Array, after: Array, field: Field) -> float:
    """Adhesion energy gained when one front turns into another.

    Parameters
    ----------
    before, after : (n_site,) array
        Fronts inside the field. (Units: reduced lateral length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    float
        Integral of w_loc over the area between them, negative where contact is given up.
        (Units: reduced energy)
    """
    total = _swept_adhesion(before, after, field)
    return float(field.geometry.perimeter * total / before.size)


@kernel
def _sample_rays(field, products, slopes):
    """Fill in products, and slopes where pieces are cubic, at all samples of all rays."""
    for ray in range(products.shape[0]):
        for sample in range(products.shape[1]):
            products[ray, sample], slope = evaluate(field, ray, sample)
            if field.cubic:
                slopes[ray, sample] = slope


def sampled_on_rays(field: TileField) -> RayField:
    """Field with all samples evaluated beforehand, as in the code of the paper.

    Parameters
    ----------
    field : TileField
        Field on a tile.

    Returns
    -------
    RayField
        Field with identical samples, n_site * n_sample numbers.
    """
    places = field.spacing * np.arange(1, field.n_sample + 1, dtype=np.float64) + field.origin
    # numpy allocates in large pages, which halves the time to find a sample.
    products = np.empty((field.geometry.n_site, field.n_sample))
    slopes = np.empty(products.shape if field.cubic else (0, 0))
    _sample_rays(field, products, slopes)
    return RayField(field.geometry, places, products, slopes)
