r"""Even real filters of a front: vectors whose modes are multiplied by factors.

Sites in pairs are the real and the imaginary part of one number, so that a transform has half the
length. With its modes Z and M of them, factors f and the angle phi = pi k / M,

.. math:: Z'_k = (s - d \sin\varphi) Z_k + i d \cos\varphi\, \overline{Z_{M-k}} ,
   \qquad s, d = (f_k \pm f_{M-k}) / 2 .

Large fronts are transformed in :data:`ROWS` parts, which threads share: mode k then stands in row
k % rows and column k // rows.
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
from crackfront.core.solver.team import LARGE, bounds, hear, my_blocks, summed, tell, wait

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]


ROWS = 4
"""Parts in which a large front is transformed."""


class Transform(NamedTuple):
    """Work space for the modes of a front; all arrays have the shape (rows, columns).

    Attributes
    ----------
    paired : bool
        Whether sites stand in pairs; each has a mode of its own where their number is odd.
    turn : array
        Of what a part is turned between the first step of a transform and the others.
    cosine, sine : array
        Of pi k / M.
    before, after : array
        Modes before and after a filter.
    """

    paired: bool
    turn: Modes
    cosine: Array
    sine: Array
    before: Modes
    after: Modes


class Filter(NamedTuple):
    """Factors of a mode and of its conjugate partner, (rows, columns) arrays."""

    straight: Array
    crossed: Array


@jit
def make_transform(count, like):
    """Work space for a front of `count` sites, of the precision of a complex array."""
    half = count // 2 if count % 2 == 0 else count
    rows = ROWS if count >= LARGE and half % ROWS == 0 else 1
    shape = (rows, half // rows)
    turn = np.empty(shape, like.dtype)
    cosine, sine = np.empty(shape), np.empty(shape)
    for row in range(rows):
        for column in range(shape[1]):
            angle = np.pi * (row + rows * column) / half
            cosine[row, column], sine[row, column] = np.cos(angle), np.sin(angle)
            if rows > 1:
                angle = 2 * np.pi * row * column / half
                turn[row, column] = complex(np.cos(angle), -np.sin(angle))
    before, after = np.empty(shape, like.dtype), np.empty(shape, like.dtype)
    return Transform(count % 2 == 0, turn, cosine, sine, before, after)


@jit
def make_filter(transform):
    """Filter without factors yet."""
    shape, kind = transform.sine.shape, transform.turn.real.dtype
    return Filter(np.empty(shape, kind), np.empty(shape, kind))


@kernel
def set_filter(team, transform, filtering, geometry, shift, inverted):
    """Give a filter the stiffness of the line plus a shift, or the inverse of that."""
    rows, columns = transform.sine.shape
    half = rows * columns
    for block in range(*my_blocks(team)):
        for column in range(*bounds(team, block, columns)):
            for row in range(rows):
                k = row + rows * column
                one = mode_stiffness(geometry, k if transform.paired else min(k, half - k)) + shift
                other = mode_stiffness(geometry, half - k) + shift if transform.paired else one
                if inverted:
                    one, other = 1.0 / one, 1.0 / other
                difference = 0.5 * (one - other)
                filtering.straight[row, column] = (
                    0.5 * (one + other) - difference * transform.sine[row, column]
                )
                filtering.crossed[row, column] = difference * transform.cosine[row, column]
    wait(team)


_AXIS = np.zeros(1, np.int64)


def _to_modes(row: Any, modes: Any) -> None:
    """Modes of a row."""
    modes[:] = scipy.fft.fft(row)


def _from_modes(modes: Any, row: Any, count: int) -> None:
    """Row of the modes of a number of sites or pairs."""
    row[:] = scipy.fft.ifft(modes, norm="forward") / count


@overload(_to_modes)
def _to_modes_compiled(row, modes):
    """Into memory that is there; scipy's functions ask for new memory every time."""
    return lambda row, modes: lowlevel.c2c(row, modes, _AXIS, True, 1.0, 1)


@overload(_from_modes)
def _from_modes_compiled(modes, row, count):
    """The same backward."""
    return lambda modes, row, count: lowlevel.c2c(modes, row, _AXIS, False, 1.0 / count, 1)


@kernel
def apply_filter(team, transform, filtering, vector, result):
    """Fill in what a filter makes of a vector; return the product of the two."""
    rows, columns = transform.sine.shape
    before, after = transform.before, transform.after
    if transform.paired:
        source = vector.view(before.dtype).reshape((rows, columns))
        target = result.view(before.dtype).reshape((rows, columns))
    else:
        source, target = before, after
        for i in range(vector.size):
            before[0, i] = vector[i]
    if rows > 1:
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, columns)
            _scatter(source, transform.turn, before, low, high)
        wait(team)
    for block in range(*my_blocks(team)):
        for row in range(*bounds(team, block, rows)):
            _to_modes(before[row] if rows > 1 else source[row], before[row])
    wait(team)
    for block in range(*my_blocks(team)):
        product = 0.0
        for row in range(*bounds(team, block, rows)):
            straight, crossed = filtering.straight[row], filtering.crossed[row]
            here, there = before[row].view(straight.dtype), before[-row].view(straight.dtype)
            mixed = after[row].view(straight.dtype)
            first = 0
            if row == 0:
                # The partner of the first mode is itself.
                first = 1
                product += _mix(here[:2], here[:2], straight[:1], crossed[:1], mixed[:2])
            product += _mix(
                here[2 * first :], there[2 * first :], straight[first:], crossed[first:],
                mixed[2 * first :],
            )  # fmt: skip
            _from_modes(after[row], after[row] if rows > 1 else target[row], rows * columns)
        tell(team, 0, block, product / (rows * columns))
    product = summed(team, hear(team), 0)
    if rows > 1:
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, columns)
            _gather(after, transform.turn, target, low, high)
        wait(team)
    elif not transform.paired:
        for i in range(result.size):
            result[i] = target[0, i].real
    return product


@kernel(fastmath={"contract"})
def _scatter(source, turn, parts, low, high):
    """Transform columns of four entries and turn them."""
    for column in range(low, high):
        a, b, c, d = source[0, column], source[1, column], source[2, column], source[3, column]
        even, odd = a + c, b + d
        parts[0, column] = even + odd
        parts[2, column] = turn[2, column] * (even - odd)
        even, odd = a - c, b - d
        odd = complex(odd.imag, -odd.real)
        parts[1, column] = turn[1, column] * (even + odd)
        parts[3, column] = turn[3, column] * (even - odd)


@kernel(fastmath={"contract"})
def _gather(parts, turn, target, low, high):
    """Turn columns of four entries back and invert their transform."""
    for column in range(low, high):
        a, b = parts[0, column], np.conj(turn[1, column]) * parts[1, column]
        c = np.conj(turn[2, column]) * parts[2, column]
        d = np.conj(turn[3, column]) * parts[3, column]
        even, odd = a + c, b + d
        target[0, column], target[2, column] = even + odd, even - odd
        even, odd = a - c, b - d
        odd = complex(-odd.imag, odd.real)
        target[1, column], target[3, column] = even + odd, even - odd


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _mix(here, there, straight, crossed, mixed):
    """Filter a row of modes with their partners in reverse; return the product of the rows.

    Modes are given as real and imaginary parts in turn.
    """
    total, last = straight.dtype.type(0.0), np.uint64(there.size - 1)
    for column in range(straight.size):
        # Numbers without a sign, as those that may count from the end are no loop for vectors.
        k = np.uint64(2) * np.uint64(column)
        real, imaginary = here[k], here[k + np.uint64(1)]
        mixed[k] = straight[column] * real + crossed[column] * there[last - k]
        mixed[k + np.uint64(1)] = (
            straight[column] * imaginary + crossed[column] * there[last - k - np.uint64(1)]
        )
        total += real * mixed[k] + imaginary * mixed[k + np.uint64(1)]
    return total
