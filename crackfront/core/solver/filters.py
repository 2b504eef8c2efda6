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

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import mode_stiffness

Modes = NDArray[np.complex128]


class Filter(NamedTuple):
    """Factors of the modes of a front and work space to apply them; arrays have one entry a mode.

    Attributes
    ----------
    paired : bool
        Whether sites form pairs; where their number is odd, each has a mode of its own.
    straight, crossed : array
        Factors of a mode and of its conjugate partner.
    cosine, sine : array
        Of pi k / M.
    before, after : complex array
        Modes before and after the filter.
    """

    paired: bool
    straight: Array
    crossed: Array
    cosine: Array
    sine: Array
    before: Modes
    after: Modes


@jit
def make_filter(count, like):
    """Filter of `count` sites without factors yet, of the precision of a complex array."""
    size = count // 2 if count % 2 == 0 else count
    straight, crossed = np.empty(size, like.real.dtype), np.empty(size, like.real.dtype)
    before, after = np.empty(size, like.dtype), np.empty(size, like.dtype)
    cosine, sine = np.empty(size), np.empty(size)
    for k in range(size):
        angle = np.pi * k / size
        cosine[k], sine[k] = np.cos(angle), np.sin(angle)
    return Filter(count % 2 == 0, straight, crossed, cosine, sine, before, after)


@kernel
def set_stiffness(filtering, geometry):
    """Set the factors to the stiffness of the line."""
    for k in range(filtering.sine.size):
        mode, partner = _front_modes(filtering, k)
        factor = mode_stiffness(geometry, mode)
        _set_factors(filtering, k, factor, mode_stiffness(geometry, partner))


@kernel
def set_inverse(filtering, geometry, shift):
    """Set the factors to the inverse of the stiffness of the line plus a shift."""
    for k in range(filtering.sine.size):
        mode, partner = _front_modes(filtering, k)
        factor = 1.0 / (mode_stiffness(geometry, mode) + shift)
        _set_factors(filtering, k, factor, 1.0 / (mode_stiffness(geometry, partner) + shift))


@kernel
def _front_modes(filtering, k):
    """Numbers of the two modes of the front that mode k of a transform mixes."""
    size = filtering.sine.size
    if filtering.paired:
        return k, size - k
    return min(k, size - k), min(k, size - k)


@kernel
def _set_factors(filtering, k, factor, partner):
    """Set the factors of mode k of a transform from the factors of two modes of the front."""
    difference = 0.5 * (factor - partner)
    filtering.straight[k] = 0.5 * (factor + partner) - difference * filtering.sine[k]
    filtering.crossed[k] = difference * filtering.cosine[k]


_AXIS = np.zeros(1, np.int64)


def _forward(source: Any, modes: Any) -> None:
    """Write the modes of a vector into an array."""
    modes[:] = scipy.fft.fft(source)


def _backward(modes: Any, target: Any) -> None:
    """Write the vector of modes into an array."""
    target[:] = scipy.fft.ifft(modes)


# scipy's own functions would allocate memory at every call, the library below them does not.


@overload(_forward)
def _forward_compiled(source, modes):
    return lambda source, modes: lowlevel.c2c(source, modes, _AXIS, True, 1.0, 1)


@overload(_backward)
def _backward_compiled(modes, target):
    return lambda modes, target: lowlevel.c2c(modes, target, _AXIS, False, 1.0 / modes.size, 1)


@kernel
def apply_filter(filtering, vector, result):
    """Apply a filter to a vector; return the product of vector and result."""
    before, after = filtering.before, filtering.after
    straight, crossed = filtering.straight, filtering.crossed
    if filtering.paired:
        _forward(vector.view(before.dtype), before)
    else:
        for i in range(vector.size):
            before[i] = vector[i]
        _forward(before, before)
    modes, mixed = before.view(straight.dtype), after.view(straight.dtype)
    # The partner of the first mode is itself.
    product = 0.0 + _mix(modes[:2], modes[:2], straight[:1], crossed[:1], mixed[:2])
    product += _mix(modes[2:], modes[2:], straight[1:], crossed[1:], mixed[2:])
    if filtering.paired:
        _backward(after, result.view(before.dtype))
    else:
        _backward(after, after)
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
