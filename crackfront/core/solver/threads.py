"""The threads of one simulation: how many, and how they start."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.core.solver.forces import BLOCKED
from crackfront.core.solver.monotone import make_work, relax_together
from crackfront.core.solver.reference import rosso_krauth
from crackfront.core.solver.team import LARGE, MOST
from crackfront.core.solver.window import HALF_BAND

_given = 1


def set_threads(number: int) -> None:
    """Give every simulation of this process a number of threads; results do not depend on it.

    Parameters
    ----------
    number : int
        Threads of a front of at least :data:`crackfront.core.solver.team.LARGE` sites; 1 before
        this is called. Smaller fronts have one.

    Raises
    ------
    ValueError
        If the number is not from 1 to :data:`crackfront.core.solver.team.MOST`.
    """
    global _given
    if not 1 <= number <= MOST:
        raise ValueError(f"number of threads is {number}; give one from 1 to {MOST}")
    _given = number


def monotone_newton(
    place: NDArray[np.float64],
    load: float,
    direction: int,
    field: Any,
    memory: Any,
    tolerance: float,
    max_sweeps: int,
) -> tuple[int, int, int, float]:
    """First metastable front in the direction of motion; the front is changed in place.

    Returns a code, the number of FFT pairs, that of updates of a site, and the largest drive left.
    """
    problem = (load, direction, field, memory, tolerance)
    if place.size <= 2 * HALF_BAND:
        return rosso_krauth(place, *problem, max_sweeps)
    size = _given if place.size >= LARGE else 1
    work = make_work(place)
    others = [
        threading.Thread(target=relax_together, args=(work, rank, size, *problem, max_sweeps))
        for rank in range(1, size)
    ]
    for other in others:
        other.start()
    code, pairs, updates, residual = relax_together(work, 0, size, *problem, max_sweeps)
    for other in others:
        other.join()
    if code == BLOCKED:
        # The field is too steep for the digits of a radius: the reference knows how to stop there.
        code, sweeps, more, residual = rosso_krauth(place, *problem, max_sweeps - pairs)
        pairs, updates = pairs + sweeps, updates + more
    return code, pairs, updates, residual
