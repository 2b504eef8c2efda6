"""Jumps of a perimeter from one load step to the next, and which of them two models share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.core.records import LATERAL, VERTICAL, variable

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Jump:
    """An arc of the perimeter that moved far in one load step."""

    penetration: float = variable("penetration at which it had moved", VERTICAL)
    direction: int = variable("+1 in approach, -1 in retraction", "1")
    angle: float = variable("where it moved furthest", "rad")
    distance: float = variable("how far it moved there", LATERAL)


@dataclass(frozen=True, slots=True)
class SharedJumps:
    """Large jumps of two models.

    Attributes
    ----------
    pairs : tuple of (Jump, Jump)
        Large ones of the front, the second, with that of the boundary elements.
    n_boundary, n_front : int
        Numbers of large ones of both.
    """

    pairs: tuple[tuple[Jump, Jump], ...]
    n_boundary: int
    n_front: int


def jumps(
    penetration: Array, direction: NDArray[np.int64], radius: Array, least: float
) -> list[Jump]:
    """Jumps of a cycle.

    Parameters
    ----------
    penetration, direction : (n_step,) array
        States of the cycle; those of one branch follow each other.
    radius : (n_step, n_angle) array
        Perimeters. (Units: reduced lateral length)
    least : float
        Distance from which on a motion is a jump; arcs that move half of it belong to one.
        (Units: reduced lateral length)
    """
    found = []
    n_angle = radius.shape[1]
    for step in range(1, len(penetration)):
        if direction[step] != direction[step - 1]:
            continue
        moved = direction[step] * (radius[step] - radius[step - 1])
        # Begin where nothing moves, so that no arc is cut in two.
        start = int(np.argmin(moved))
        turned = np.roll(moved, -start)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], turned > least / 2, [0]])))
        for first, last in edges.reshape(-1, 2):
            place = first + int(np.argmax(turned[first:last]))
            if turned[place] >= least:
                angle = 2 * np.pi * ((place + start) % n_angle) / n_angle
                found.append(
                    Jump(
                        float(penetration[step]), int(direction[step]), angle, float(turned[place])
                    )
                )
    return found


def matched_jumps(
    ours: list[Jump], theirs: list[Jump], angle: float, penetration: float
) -> list[tuple[Jump, Jump]]:
    """Pairs of jumps at one place, those closest in penetration first.

    Parameters
    ----------
    ours, theirs : list of Jump
        Jumps of two models.
    angle : float
        Largest difference of their angles. (Units: rad)
    penetration : float
        Largest difference of their penetrations. (Units: reduced vertical length)
    """
    near = [
        (abs(one.penetration - other.penetration), i, j)
        for i, one in enumerate(ours)
        for j, other in enumerate(theirs)
        if one.direction == other.direction
        and abs(one.penetration - other.penetration) <= penetration
        and abs(np.angle(np.exp(1j * (one.angle - other.angle)))) <= angle
    ]
    pairs: list[tuple[Jump, Jump]] = []
    taken: tuple[set[int], set[int]] = (set(), set())
    for _, i, j in sorted(near):
        if i not in taken[0] and j not in taken[1]:
            pairs.append((ours[i], theirs[j]))
            taken[0].add(i)
            taken[1].add(j)
    return pairs
