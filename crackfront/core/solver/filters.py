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
def set_filter(filtering, geometry, shift, inverted):
    """Set the factors to the stiffness of the line plus a shift, or to the inverse of this sum."""
    size, paired = filtering.sine.size, filtering.paired
    for k in range(size):
        factor = mode_stiffness(geometry, k if paired else min(k, size - k)) + shift
        partner = mode_stiffness(geometry, size - k) + shift if paired else factor
        if inverted:
            factor, partner = 1.0 / factor, 1.0 / partner
        difference = 0.5 * (factor - partner)
        filtering.straight[k] = 0.5 * (factor + partner) - difference * filtering.sine[k]
        filtering.crossed[k] = difference * filtering.cosine[k]


_AXIS = np.zeros(1, np.int64)


def _transform(source: Any, target: Any, forward: bool) -> None:
    """Write the modes of a vector or, backward, the vector of modes into a target."""
    target[:] = scipy.fft.fft(source) if forward else scipy.fft.ifft(source)


@overload(_transform)
def _transform_compiled(source, target, forward):
    """Call the library below scipy, whose own functions allocate memory every time."""
    return lambda source, target, forward: lowlevel.c2c(
        source, target, _AXIS, forward, 1.0 if forward else 1.0 / source.size, 1
    )


@kernel
def apply_filter(filtering, vector, result):
    """Apply a filter to a vector; return the product of vector and result."""
    before, after = filtering.before, filtering.after
    straight, crossed = filtering.straight, filtering.crossed
    if filtering.paired:
        _transform(vector.view(before.dtype), before, True)
    else:
        for i in range(vector.size):
            before[i] = vector[i]
        _transform(before, before, True)
    modes, mixed = before.view(straight.dtype), after.view(straight.dtype)
    # The partner of the first mode is itself.
    product = 0.0 + _mix(modes[:2], modes[:2], straight[:1], crossed[:1], mixed[:2])
    product += _mix(modes[2:], modes[2:], straight[1:], crossed[1:], mixed[2:])
    if filtering.paired:
        _transform(after, result.view(before.dtype), False)
    else:
        _transform(after, after, False)
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
