r"""Even real filters of a front: vectors whose modes are multiplied by factors.

Sites in pairs are the real and the imaginary part of one number, so that a transform has half the
length. With its modes Z and M of them, factors f and the angle phi = pi k / M,

.. math:: Z'_k = (s - d \sin\varphi) Z_k + i d \cos\varphi\, \overline{Z_{M-k}} ,
   \qquad s, d = (f_k \pm f_{M-k}) / 2 .
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from numba.extending import overload
from numpy.typing import NDArray
from rocket_fft import lowlevel

from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import mode_stiffness

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]


class Transform(NamedTuple):
    """Work space for the modes of a front; arrays have one entry a mode.

    Attributes
    ----------
    paired : bool
        Whether sites stand in pairs; where their number is odd, each has a mode of its own.
    cosine, sine : array
        Of pi k / M.
    before, after : complex array
        Modes before and after a filter.
    """

    paired: bool
    cosine: Array
    sine: Array
    before: Modes
    after: Modes


class Filter(NamedTuple):
    """Factors of each mode and of its conjugate partner, and the work space to apply them."""

    transform: Transform
    straight: Array
    crossed: Array


@jit
def make_transform(count, like):
    """Work space for a front of `count` sites, of the precision of a complex array."""
    size = count // 2 if count % 2 == 0 else count
    cosine, sine = np.empty(size), np.empty(size)
    for k in range(size):
        angle = np.pi * k / size
        cosine[k], sine[k] = np.cos(angle), np.sin(angle)
    return Transform(
        count % 2 == 0, cosine, sine, np.empty(size, like.dtype), np.empty(size, like.dtype)
    )


@jit
def make_filter(transform):
    """Filter without factors yet."""
    shape, real = transform.sine.shape, transform.before.real.dtype
    return Filter(transform, np.empty(shape, real), np.empty(shape, real))


@kernel
def set_filter(filtering, geometry, shift, inverted):
    """Give a filter the stiffness of the line plus a shift, or the inverse of that."""
    transform = filtering.transform
    size = transform.sine.size
    for k in range(size):
        one = mode_stiffness(geometry, k if transform.paired else min(k, size - k)) + shift
        other = mode_stiffness(geometry, size - k) + shift if transform.paired else one
        if inverted:
            one, other = 1.0 / one, 1.0 / other
        difference = 0.5 * (one - other)
        filtering.straight[k] = 0.5 * (one + other) - difference * transform.sine[k]
        filtering.crossed[k] = difference * transform.cosine[k]


_AXIS = np.zeros(1, np.int64)


def _to_modes(vector: Any, modes: Any) -> None:
    """Modes of a vector, into memory that is there."""
    modes[:] = scipy.fft.fft(vector)


def _from_modes(modes: Any, vector: Any) -> None:
    """Vector of the modes, into memory that is there."""
    vector[:] = scipy.fft.ifft(modes)


@overload(_to_modes)
def _to_modes_compiled(vector, modes):
    """By what scipy calls, as scipy's own functions allocate memory every time."""
    return lambda vector, modes: lowlevel.c2c(vector, modes, _AXIS, True, 1.0, 1)


@overload(_from_modes)
def _from_modes_compiled(modes, vector):
    """The same backward."""
    return lambda modes, vector: lowlevel.c2c(modes, vector, _AXIS, False, 1.0 / modes.size, 1)


@kernel
def apply_filter(filtering, vector, result):
    """Apply a filter to a vector; return the product of vector and result."""
    before, after = filtering.transform.before, filtering.transform.after
    straight, crossed = filtering.straight, filtering.crossed
    if filtering.transform.paired:
        _to_modes(vector.view(before.dtype), before)
    else:
        for i in range(vector.size):
            before[i] = vector[i]
        _to_modes(before, before)
    modes, mixed = before.view(straight.dtype), after.view(straight.dtype)
    # The partner of the first mode is itself.
    product = 0.0 + _mix(modes[:2], modes[:2], straight[:1], crossed[:1], mixed[:2])
    product += _mix(modes[2:], modes[2:], straight[1:], crossed[1:], mixed[2:])
    if filtering.transform.paired:
        _from_modes(after, result.view(before.dtype))
    else:
        _from_modes(after, after)
        for i in range(result.size):
            result[i] = after[i].real
    return product / before.size


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _mix(modes, partners, straight, crossed, mixed):
    """Filter modes with their partners in reverse; return the product before and after.

    Modes are given as real and imaginary parts in turn.
    """
    total, last = straight.dtype.type(0.0), np.uint64(partners.size - 1)
    for column in range(straight.size):
        # Numbers without a sign, as those that may count from the end are no loop for vectors.
        k = np.uint64(2) * np.uint64(column)
        real, imaginary = modes[k], modes[k + np.uint64(1)]
        mixed[k] = straight[column] * real + crossed[column] * partners[last - k]
        mixed[k + np.uint64(1)] = (
            straight[column] * imaginary + crossed[column] * partners[last - k - np.uint64(1)]
        )
        total += real * mixed[k] + imaginary * mixed[k + np.uint64(1)]
    return total
