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

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.kinds import Field, PolarField, TileField

Array = NDArray[np.float64]


def sample_radius(field: Field, sample: int) -> float:
    """Radius of a sample (Units: reduced lateral length)."""
    return _pick(field, _polar_radius, _tile_radius)(field, sample)


def sample_product(field: Field, ray: int, sample: int) -> float:
    """Radius times work of adhesion at a sample of a ray (Units: reduced energy / length)."""
    return evaluate(field, ray, sample)[0]


def evaluate(field: Field, ray: int, sample: int) -> tuple[float, float]:
    """Radius times work of adhesion at a sample, and its slope where pieces are cubic.

    (Units: reduced energy / length, and / area)
    """
    return _pick(field, _polar_evaluate, _tile_evaluate)(field, ray, sample)


def sample_count(field: Field) -> int:
    """Number of samples on a ray."""
    return _pick(field, _polar_count, _tile_count)(field)


def is_cubic(field: Field) -> bool:
    """Whether the product is cubic between samples, or linear."""
    return _pick(field, _polar_cubic, _tile_cubic)(field)


def _polar_radius(field: Any, sample: int) -> float:
    """Radius of a sample of a polar field."""
    return field.radii[sample]


def _tile_radius(field: Any, sample: int) -> float:
    """Radius of a sample of a tile."""
    return (sample + 1) * field.spacing


def _polar_evaluate(field: Any, ray: int, sample: int) -> tuple[float, float]:
    """Product and slope at a sample of a polar field."""
    slope = field.slopes[ray, sample] if field.slopes.size > 0 else 0.0
    return field.products[ray, sample], slope


def _tile_evaluate(field: Any, ray: int, sample: int) -> tuple[float, float]:
    """Product and slope at a sample of a tile, by bicubic B-splines."""
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
    # Derivatives of the weights.
    along = (-((1 - t) ** 2), t * (3 * t - 4), 1 + t * (2 - 3 * t), t * t)
    v0, v1, v2, v3 = -((1 - u) ** 2), u * (3 * u - 4), 1 + u * (2 - 3 * u), u * u
    total, by_x, by_y = 0.0, 0.0, 0.0
    for k, weight in enumerate((t0, t1, t2, t3)):
        line = coefficients[i + k]
        c0, c1, c2, c3 = line[j], line[j + 1], line[j + 2], line[j + 3]
        part = u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
        total += weight * part
        by_x += along[k] * part
        by_y += weight * (v0 * c0 + v1 * c1 + v2 * c2 + v3 * c3)
    rise = (by_x * field.cosine[ray] + by_y * field.sine[ray]) * field.inverse_pixel
    return radius * total / 36.0, total / 36.0 + radius * rise / 12.0


def _polar_count(field: Any) -> int:
    """Number of samples of a polar field."""
    return field.radii.size


def _tile_count(field: Any) -> int:
    """Number of samples of a tile."""
    return field.n_sample


def _polar_cubic(field: Any) -> bool:
    """Whether a polar field has slopes."""
    return field.slopes.size > 0


def _tile_cubic(field: Any) -> bool:
    """Whether a tile is cubic between samples."""
    return field.cubic


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
    samples : (n_angle, size, 2) array
        Products and slopes, or (n_angle, size, 1) products where pieces are linear; sample m of a
        ray has the place m modulo size, a power of 2.
    first, last : (n_angle,) int array
        Range of samples that each ray holds.
    """

    samples: NDArray[np.float64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


_LINEAR_MEMORY, _CUBIC_MEMORY = 128, 32
"""Samples of a ray that are remembered: a cubic piece does the work of four straight ones."""


@jit
def samples_ahead(field):
    """Largest number of samples that a solver may look ahead."""
    return (_CUBIC_MEMORY if is_cubic(field) else _LINEAR_MEMORY) // 2


def make_memory(field: Field) -> SampleMemory:
    """Empty memory for the samples of a field."""
    return _pick(field, _polar_memory, _tile_memory)(field)


def fetch(field: Field, memory: SampleMemory, ray: int, first: int, last: int) -> None:
    """Make sure that the memory holds a range of samples of a ray."""
    return _pick(field, _polar_fetch, _tile_fetch)(field, memory, ray, first, last)


def peek(field: Field, memory: SampleMemory, ray: int, sample: int) -> tuple[float, float]:
    """Product and slope at a sample of a ray that has been fetched."""
    return _pick(field, _polar_peek, _tile_peek)(field, memory, ray, sample)


def _polar_memory(field: Any) -> SampleMemory:
    """Nothing: a polar field is its own memory."""
    return SampleMemory(np.empty((0, 0, 0)), np.empty(0, np.int64), np.empty(0, np.int64))


def _tile_memory(field: Any) -> SampleMemory:
    """Empty places for the rays of a tile."""
    count = field.cosine.size
    size, values = (_CUBIC_MEMORY, 2) if field.cubic else (_LINEAR_MEMORY, 1)
    return SampleMemory(
        np.empty((count, size, values)), np.zeros(count, np.int64), np.full(count, -1, np.int64)
    )


def _polar_fetch(field: Any, memory: Any, ray: int, first: int, last: int) -> None:
    """Nothing to do: all samples are there."""


def _tile_fetch(field: Any, memory: Any, ray: int, first: int, last: int) -> None:
    """Evaluate samples where some are missing; the test stays small so that it is inlined."""
    if first < memory.first[ray] or last > memory.last[ray]:
        fill_tile(field, memory, ray, first, last)


@kernel
def fill_tile(field, memory, ray, first, last):
    """Evaluate the samples that are missing, in blocks, and forget the furthest ones.

    Neighbours on a ray use the same part of the tile.
    """
    low, high = memory.first[ray], memory.last[ray]
    size = memory.samples.shape[1]
    block = size // 16
    if first > high + 1 or last < low - 1 or high < low:
        low, high = first, first - 1
    if last > high:
        for sample in range(high + 1, max(last, high + block) + 1):
            store_sample(field, memory, ray, sample)
        high = max(last, high + block)
        low = max(low, high - size + 1)
    if first < low:
        target = max(min(first, low - block), 0)
        for sample in range(target, low):
            store_sample(field, memory, ray, sample)
        low = target
        high = min(high, low + size - 1)
    memory.first[ray], memory.last[ray] = low, high


@kernel
def store_sample(field, memory, ray, sample):
    """Evaluate one sample."""
    place = sample & (memory.samples.shape[1] - 1)
    product, slope = evaluate(field, ray, sample)
    memory.samples[ray, place, 0] = product
    if field.cubic:
        memory.samples[ray, place, 1] = slope


def _polar_peek(field: Any, memory: Any, ray: int, sample: int) -> tuple[float, float]:
    """Product and slope at a sample of a polar field."""
    slope = field.slopes[ray, sample] if field.slopes.size > 0 else 0.0
    return field.products[ray, sample], slope


def _tile_peek(field: Any, memory: Any, ray: int, sample: int) -> tuple[float, float]:
    """Product and slope at a sample of a tile, from memory."""
    place = sample & (memory.samples.shape[1] - 1)
    slope = memory.samples[ray, place, 1] if field.cubic else 0.0
    return memory.samples[ray, place, 0], slope


@overload(make_memory)
def _overload_memory(field: Any) -> Any:
    return _chooser(_polar_memory, _tile_memory)(field)


@overload(fetch)
def _overload_fetch(field: Any, memory: Any, ray: int, first: int, last: int) -> Any:
    return _chooser(_polar_fetch, _tile_fetch)(field)


@overload(peek)
def _overload_peek(field: Any, memory: Any, ray: int, sample: int) -> Any:
    return _chooser(_polar_peek, _tile_peek)(field)


@overload(sample_radius)
def _overload_radius(field: Any, sample: int) -> Any:
    return _chooser(_polar_radius, _tile_radius)(field)


@overload(evaluate)
def _overload_evaluate(field: Any, ray: int, sample: int) -> Any:
    return _chooser(_polar_evaluate, _tile_evaluate)(field)


@overload(sample_count)
def _overload_count(field: Any) -> Any:
    return _chooser(_polar_count, _tile_count)(field)


@overload(is_cubic)
def _overload_cubic(field: Any) -> Any:
    return _chooser(_polar_cubic, _tile_cubic)(field)
