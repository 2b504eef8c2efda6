"""The product between two samples of a ray: one polynomial, whether straight or cubic.

A piece is described by its Bezier ordinates. The curve lies in the convex hull of its four control
points (t = 0, 1/3, 2/3, 1), which gives bounds on it. The points of a straight piece lie on it.
"""

from __future__ import annotations

from crackfront.core.compiled import kernel
from crackfront.core.field.samples import evaluate, is_cubic, peek, sample_place


@kernel(inline="always")
def ordinates(field, segment, start, end):
    """Bezier ordinates of a segment from the products and slopes at its ends."""
    width = sample_place(field, segment + 1) - sample_place(field, segment)
    if is_cubic(field):
        third = width / 3
        return start[0], start[0] + third * start[1], end[0] - third * end[1], end[0]
    rise = (end[0] - start[0]) / 3
    return start[0], start[0] + rise, end[0] - rise, end[0]


@kernel(inline="always")
def peek_piece(field, memory, ray, segment):
    """Bezier ordinates of a segment whose samples have been fetched."""
    return ordinates(
        field,
        segment,
        peek(field, memory, ray, segment),
        peek(field, memory, ray, segment + 1),
    )


@kernel(inline="always")
def evaluate_piece(field, ray, segment):
    """Bezier ordinates of a segment, evaluated anew."""
    return ordinates(
        field, segment, evaluate(field, ray, segment), evaluate(field, ray, segment + 1)
    )


@kernel(inline="always")
def blend(piece, t):
    """Value of a piece at 0 <= t <= 1."""
    first, second, third = differences(piece)
    return piece[0] + t * (3 * first + t * (3 * second + t * third))


@kernel(inline="always")
def differences(piece):
    """Forward differences of the ordinates: p(t) = c + 3 d1 t + 3 d2 t^2 + d3 t^3."""
    c0, c1, c2, c3 = piece
    return c1 - c0, c2 - 2 * c1 + c0, c3 - 3 * c2 + 3 * c1 - c0


@kernel(inline="always")
def polynomial(field, piece, width):
    """Coefficients of a piece in the distance from its inner end."""
    inverse = 1.0 / width
    if is_cubic(field):
        first, second, third = differences(piece)
        return (
            piece[0],
            3 * first * inverse,
            3 * second * inverse * inverse,
            third * inverse * inverse * inverse,
        )
    return piece[0], (piece[3] - piece[0]) * inverse, 0.0, 0.0


@kernel(inline="always")
def steepest_inside(coefficients, position, reach, direction):
    """Bound on d (p(x) - p(x + d s)) / s over 0 < s <= reach in the direction d of motion.

    The slope of a chord is a quadratic in s, nowhere above the largest of its Bezier ordinates.
    """
    _, first, second, third = coefficients
    linear = -(first + position * (2 * second + 3 * position * third))
    quadratic = -direction * (second + 3 * position * third)
    end = reach * (quadratic - reach * third)
    return linear + max(0.0, 0.5 * reach * quadratic, end)


@kernel(inline="always")
def hull_until(piece, part, direction):
    """Control points after the first of the part of a piece that is entered along the motion."""
    c0, c1, c2, c3 = piece
    if direction < 0:
        c0, c1, c2, c3 = c3, c2, c1, c0
    first, second, third = differences((c0, c1, c2, c3))
    return (
        c0 + part * first,
        c0 + part * (2 * first + part * second),
        c0 + part * (3 * first + part * (3 * second + part * third)),
    )
