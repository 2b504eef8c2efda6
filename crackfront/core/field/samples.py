"""Samples of the field along its rays: one access for every kind, evaluated on demand."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.compiled import dispatched, implements, kernel
from crackfront.core.field.fields import Field, RayField, TileField
from crackfront.core.geometry.base import ray_direction, ray_start, weight, weight_slope


@dispatched
def sample_place(field: Any, sample: int) -> float:
    """Place of a sample (Units: reduced lateral length)."""
    raise NotImplementedError


@dispatched
def evaluate(field: Any, ray: int, sample: int) -> Any:
    """Weighted work of adhesion at a sample, and its slope where pieces are cubic.

    (Units: reduced energy / length, and / area)
    """
    raise NotImplementedError


@dispatched
def sample_count(field: Any) -> int:
    """Number of samples on a ray."""
    raise NotImplementedError


@dispatched
def is_cubic(field: Any) -> bool:
    """Whether the product is cubic between samples, or linear."""
    raise NotImplementedError


@dispatched
def make_memory(field: Any) -> SampleMemory:
    """Empty memory for the samples of a field."""
    raise NotImplementedError


@dispatched
def fetch(field: Any, memory: SampleMemory, ray: int, first: int, last: int) -> None:
    """Make sure that the memory contains a range of samples of a ray."""
    raise NotImplementedError


@dispatched
def peek(field: Any, memory: SampleMemory, ray: int | np.uint64, sample: int) -> Any:
    """Product and slope at a sample of a ray that has been fetched."""
    raise NotImplementedError


class SampleMemory(NamedTuple):
    """The samples of a tile near the front, so that each is evaluated once.

    Attributes
    ----------
    samples : (n_site, size, 2) array
        Products and slopes, or (n_site, size, 1) products where pieces are linear; sample m of a
        ray is in the slot m modulo size, a power of 2.
    first, last : (n_site,) int array
        Range of samples that are stored for each ray.
    """

    samples: NDArray[np.float64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


_LINEAR_MEMORY = 128
"""Samples of a ray that are remembered where pieces are straight; a power of 2.

More of them allow longer steps of a solver, and take memory and caches.
"""

_CUBIC_MEMORY = 32
"""Samples of a ray that are remembered where pieces are cubic; a power of 2.

A cubic piece does the work of four straight ones.
"""


def distance_ahead(field: Field) -> float:
    """Longest step that a solver may bound, half of the samples of a memory."""
    memory, last = _CUBIC_MEMORY if is_cubic(field) else _LINEAR_MEMORY, sample_count(field) - 1
    return float(memory // 2 * (sample_place(field, last) - sample_place(field, 0)) / last)


@implements(sample_place, RayField)
def _ray_place(field: Any, sample: int) -> float:
    return field.places[sample]


@implements(evaluate, RayField)
def _ray_evaluate(field: Any, ray: int, sample: int) -> Any:
    slope = field.slopes[ray, sample] if field.slopes.size > 0 else 0.0
    return field.products[ray, sample], slope


@implements(sample_count, RayField)
def _ray_count(field: Any) -> int:
    return field.places.size


@implements(is_cubic, RayField)
def _ray_cubic(field: Any) -> bool:
    return field.slopes.size > 0


@implements(make_memory, RayField)
def _ray_memory(field: Any) -> SampleMemory:
    """Nothing: such a field is its own memory."""
    return SampleMemory(np.empty((0, 0, 0)), np.empty(0, np.int64), np.empty(0, np.int64))


@implements(fetch, RayField)
def _ray_fetch(field: Any, memory: Any, ray: int, first: int, last: int) -> None:
    """Nothing to do: all samples are there."""


@implements(peek, RayField)
def _ray_peek(field: Any, memory: Any, ray: int, sample: int) -> Any:
    site, column = np.uint64(ray), np.uint64(sample)
    slope = field.slopes[site, column] if field.slopes.size > 0 else 0.0
    return field.products[site, column], slope


@implements(sample_place, TileField)
def _tile_place(field: Any, sample: int) -> float:
    return (sample + 1) * field.spacing + field.origin


@implements(evaluate, TileField)
def _tile_evaluate(field: Any, ray: int, sample: int) -> Any:
    """By bicubic B-splines."""
    n_x, n_y = field.coefficients.shape[0] - 3, field.coefficients.shape[1] - 3
    place = (sample + 1) * field.spacing + field.origin
    cosine, sine = ray_direction(field.geometry, ray)
    start_x, start_y = ray_start(field.geometry, ray, n_x, n_y, field.inverse_pixel)
    x = place * cosine * field.inverse_pixel + start_x
    y = place * sine * field.inverse_pixel + start_y
    column, row = np.floor(x), np.floor(y)
    value, by_x, by_y = _bicubic(
        field.coefficients, (int(column) - 1) % n_x, (int(row) - 1) % n_y, x - column, y - row
    )
    rise = (by_x * cosine + by_y * sine) * field.inverse_pixel
    times = weight(field.geometry, place)
    return times * value, weight_slope(field.geometry) * value + times * rise


@kernel(fastmath={"contract"})
def _bicubic(coefficients, i, j, t, u):
    """Value and derivatives of a B-spline, t and u pixels ahead of the second of four points."""
    t0, t3 = (1 - t) ** 3, t**3
    t1, t2 = 4 - 3 * t * t * (2 - t), 4 - 3 * (1 - t) * (1 - t) * (1 + t)
    u0, u3 = (1 - u) ** 3, u**3
    u1, u2 = 4 - 3 * u * u * (2 - u), 4 - 3 * (1 - u) * (1 - u) * (1 + u)
    # Derivatives of the weights.
    along = (-((1 - t) ** 2), t * (3 * t - 4), 1 + t * (2 - 3 * t), t * t)
    v0, v1, v2, v3 = -((1 - u) ** 2), u * (3 * u - 4), 1 + u * (2 - 3 * u), u * u
    total, by_x, by_y = 0.0, 0.0, 0.0
    for k, share in enumerate((t0, t1, t2, t3)):
        line = coefficients[i + k]
        c0, c1, c2, c3 = line[j], line[j + 1], line[j + 2], line[j + 3]
        part = u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
        total += share * part
        by_x += along[k] * part
        by_y += share * (v0 * c0 + v1 * c1 + v2 * c2 + v3 * c3)
    return total / 36.0, by_x / 12.0, by_y / 12.0


@implements(sample_count, TileField)
def _tile_count(field: Any) -> int:
    return field.n_sample


@implements(is_cubic, TileField)
def _tile_cubic(field: Any) -> bool:
    return field.cubic


@implements(make_memory, TileField)
def _tile_memory(field: Any) -> SampleMemory:
    count = field.geometry.n_site
    size, values = (_CUBIC_MEMORY, 2) if field.cubic else (_LINEAR_MEMORY, 1)
    return SampleMemory(
        np.empty((count, size, values)), np.zeros(count, np.int64), np.full(count, -1, np.int64)
    )


@implements(fetch, TileField)
def _tile_fetch(field: Any, memory: Any, ray: int, first: int, last: int) -> None:
    """Evaluate samples where some are missing; the test stays small so that it is inlined."""
    if first < memory.first[ray] or last > memory.last[ray]:
        # One type for all callers compiles one kernel, so that all compute the same bits.
        _fill(field, memory, np.int64(ray), first, last)


@implements(peek, TileField)
def _tile_peek(field: Any, memory: Any, ray: int, sample: int) -> Any:
    """From memory."""
    site = np.uint64(ray)
    slot = np.uint64(sample) & np.uint64(memory.samples.shape[1] - 1)
    slope = memory.samples[site, slot, 1] if field.cubic else 0.0
    return memory.samples[site, slot, 0], slope


@kernel
def _fill(field, memory, ray, first, last):
    """Evaluate the samples that are missing, in blocks, over those furthest from the front.

    Neighbours on a ray lie in the same part of the tile.
    """
    low, high = memory.first[ray], memory.last[ray]
    size = memory.samples.shape[1]
    block = size // 16
    if first > high + 1 or last < low - 1 or high < low:
        low, high = first, first - 1
    if last > high:
        for sample in range(high + 1, max(last, high + block) + 1):
            _store(field, memory, ray, sample)
        high = max(last, high + block)
        low = max(low, high - size + 1)
    if first < low:
        target = max(min(first, low - block), 0)
        for sample in range(target, low):
            _store(field, memory, ray, sample)
        low = target
        high = min(high, low + size - 1)
    memory.first[ray], memory.last[ray] = low, high


@kernel
def _store(field, memory, ray, sample):
    """Evaluate one sample."""
    slot = sample & (memory.samples.shape[1] - 1)
    product, slope = evaluate(field, ray, sample)
    memory.samples[ray, slot, 0] = product
    if field.cubic:
        memory.samples[ray, slot, 1] = slope
