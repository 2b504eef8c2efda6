"""Samples of the field along its rays: one access for every kind, evaluated on demand.

The functions here are called from compiled code; numba picks the implementation by the type of
the field.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from crackfront.pinning.fields import Field, PolarField, TileField

Array = NDArray[np.float64]


def sample_radius(field: Field, sample: int) -> float:
    """Radius of a sample (Units: reduced lateral length)."""
    return _pick(field, _polar_radius, _tile_radius)(field, sample)


def sample_product(field: Field, ray: int, sample: int) -> float:
    """Radius times work of adhesion at a sample of a ray (Units: reduced energy / length)."""
    return _pick(field, _polar_product, _tile_product)(field, ray, sample)


def sample_count(field: Field) -> int:
    """Number of samples on a ray."""
    return _pick(field, _polar_count, _tile_count)(field)


def _polar_radius(field: Any, sample: int) -> float:
    """Radius of a sample of a polar field."""
    return field.radii[sample]


def _tile_radius(field: Any, sample: int) -> float:
    """Radius of a sample of a tile."""
    return (sample + 1) * field.spacing


def _polar_product(field: Any, ray: int, sample: int) -> float:
    """Product at a sample of a polar field."""
    return field.products[ray, sample]


def _tile_product(field: Any, ray: int, sample: int) -> float:
    """Product at a sample of a tile, by bicubic B-splines."""
    coefficients = field.coefficients
    n_x, n_y = coefficients.shape[0] - 3, coefficients.shape[1] - 3
    radius = (sample + 1) * field.spacing
    x = radius * field.cosine[ray] * field.inverse_pixel + 0.5 * n_x
    y = radius * field.sine[ray] * field.inverse_pixel + 0.5 * n_y
    column, row = np.floor(x), np.floor(y)
    t, u = x - column, y - row
    i, j = (int(column) - 1) % n_x, (int(row) - 1) % n_y
    t0, t3 = (1 - t) ** 3, t**3
    t1, t2 = 4 - 3 * t * t * (2 - t), 4 - 3 * (1 - t) * (1 - t) * (1 + t)
    u0, u3 = (1 - u) ** 3, u**3
    u1, u2 = 4 - 3 * u * u * (2 - u), 4 - 3 * (1 - u) * (1 - u) * (1 + u)
    total = 0.0
    for k, weight in enumerate((t0, t1, t2, t3)):
        line = coefficients[i + k]
        total += weight * (u0 * line[j] + u1 * line[j + 1] + u2 * line[j + 2] + u3 * line[j + 3])
    return radius * total / 36.0


def _polar_count(field: Any) -> int:
    """Number of samples of a polar field."""
    return field.radii.size


def _tile_count(field: Any) -> int:
    """Number of samples of a tile."""
    return field.n_sample


def _pick(field: Any, polar: Any, tile: Any) -> Any:
    """Choose an implementation by the kind of field."""
    return polar if isinstance(field, PolarField) else tile


def _chooser(polar: Any, tile: Any) -> Any:
    """Choose an implementation by the compiled type of field."""

    def choose(field: Any, *_: Any) -> Any:
        kinds = {PolarField: polar, TileField: tile}
        return kinds.get(field.instance_class) if isinstance(field, types.BaseNamedTuple) else None

    return choose


class SampleMemory(NamedTuple):
    """The samples of a tile near the front, so that each is evaluated once.

    Attributes
    ----------
    products : (n_angle, MEMORY) array
        Products at samples; sample m of a ray has the place m modulo MEMORY.
    samples : (n_angle, MEMORY) int array
        Which sample each place holds.
    """

    products: Array
    samples: NDArray[np.int32]


MEMORY = 64
"""Samples of a ray that are remembered."""


def make_memory(field: Field) -> SampleMemory:
    """Empty memory for the samples of a field."""
    return _pick(field, _polar_memory, _tile_memory)(field)


def recall(field: Field, memory: SampleMemory, ray: int, sample: int) -> float:
    """Product at a sample of a ray, from memory where it has been asked for before."""
    return _pick(field, _polar_recall, _tile_recall)(field, memory, ray, sample)


def _polar_memory(field: Any) -> SampleMemory:
    """Nothing: a polar field is its own memory."""
    return SampleMemory(np.empty((0, 0)), np.empty((0, 0), np.int32))


def _tile_memory(field: Any) -> SampleMemory:
    """Empty places for the rays of a tile."""
    size = (field.cosine.size, MEMORY)
    return SampleMemory(np.empty(size), np.full(size, -1, np.int32))


def _polar_recall(field: Any, memory: Any, ray: int, sample: int) -> float:
    """Product at a sample of a polar field."""
    return field.products[ray, sample]


def _tile_recall(field: Any, memory: Any, ray: int, sample: int) -> float:
    """Product at a sample of a tile, evaluated when its place holds another."""
    place = sample % MEMORY
    if memory.samples[ray, place] != sample:
        memory.samples[ray, place] = sample
        memory.products[ray, place] = sample_product(field, ray, sample)
    return memory.products[ray, place]


@overload(make_memory)
def _overload_memory(field: Any) -> Any:
    return _chooser(_polar_memory, _tile_memory)(field)


@overload(recall)
def _overload_recall(field: Any, memory: Any, ray: int, sample: int) -> Any:
    return _chooser(_polar_recall, _tile_recall)(field)


@overload(sample_radius)
def _overload_radius(field: Any, sample: int) -> Any:
    return _chooser(_polar_radius, _tile_radius)(field)


@overload(sample_product)
def _overload_product(field: Any, ray: int, sample: int) -> Any:
    return _chooser(_polar_product, _tile_product)(field)


@overload(sample_count)
def _overload_count(field: Any) -> Any:
    return _chooser(_polar_count, _tile_count)(field)
