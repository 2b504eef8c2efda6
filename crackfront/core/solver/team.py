"""Threads that relax one front together.

All run the same code, each on its blocks of the front, and wait for one another where one needs
what others find. What is summed is summed by blocks in a fixed order, so that the number of threads
has no say in any bit. A front of fewer than :data:`LARGE` sites is one block.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel

LARGE = 16384
"""Sites from which a front is cut into blocks."""

MOST = 16
"""Blocks of a large front, and the most threads."""

_VALUES = 4
"""Values that a block may tell the others at once."""

_PATIENCE = 200
"""Looks at the others before a thread that waits leaves its core to somebody else."""


class Team(NamedTuple):
    """One thread and what it shares with the others.

    Attributes
    ----------
    rank, size : int
        Place of the thread among the threads, and their number.
    own : (2,) int array
        Times that this thread has waited, and which half of `told` is in use.
    told : (2, 4, n_block) array
        What blocks tell, shared; one half is read while the other is filled in.
    counters : (32,) int array
        Arrivals of threads, shared, and in another cache line the windows that were taken.
    """

    rank: int
    size: int
    own: NDArray[np.int64]
    told: NDArray[np.float64]
    counters: NDArray[np.int64]


_ARRIVED, _TAKEN = 0, 16


@jit
def make_team(count):
    """The only thread of a front of a number of sites."""
    n_block = MOST if count >= LARGE else 1
    return Team(
        0, 1, np.zeros(2, np.int64), np.zeros((2, _VALUES, n_block)), np.zeros(32, np.int64)
    )


@jit
def another(team, rank, size):
    """The thread of a rank that shares all with another."""
    return Team(rank, size, np.zeros(2, np.int64), team.told, team.counters)


@intrinsic
def _add(context, array, index, value):
    """Add to an entry that threads share; return what it was."""

    def code(context, builder, signature, arguments):
        kind = signature.args[0]
        shared = context.make_array(kind)(context, builder, arguments[0])
        place = cgutils.get_item_pointer(context, builder, kind, shared, [arguments[1]])
        return builder.atomic_rmw("add", place, arguments[2], "seq_cst")

    return types.int64(array, types.int64, types.int64), code


@intrinsic
def _read(context, array, index):
    """Entry that threads share, as it is now."""

    def code(context, builder, signature, arguments):
        kind = signature.args[0]
        shared = context.make_array(kind)(context, builder, arguments[0])
        place = cgutils.get_item_pointer(context, builder, kind, shared, [arguments[1]])
        return builder.load_atomic(place, "seq_cst", 8)

    return types.int64(array, types.int64), code


_leave_core = types.ExternalFunction("sched_yield", types.int32())
"""Of the system: lets another thread or process run."""


@kernel
def wait(team):
    """Go on when all threads are here."""
    if team.size > 1:
        team.own[0] += 1
        awaited, looks = team.own[0] * team.size, 0
        _add(team.counters, _ARRIVED, 1)
        while _read(team.counters, _ARRIVED) < awaited:
            looks += 1
            if looks > _PATIENCE:
                _leave_core()


@kernel
def my_blocks(team):
    """First block of this thread and the first that is not."""
    n_block = team.told.shape[2]
    return n_block * team.rank // team.size, n_block * (team.rank + 1) // team.size


@kernel
def bounds(team, block, count):
    """First of a number of things that belongs to a block, and the first that does not."""
    n_block = team.told.shape[2]
    return count * block // n_block, count * (block + 1) // n_block


@kernel
def tell(team, value, block, number):
    """Have all threads know a number of a block."""
    team.told[team.own[1], value, block] = number


@kernel
def hear(team):
    """Wait for what all blocks tell; return where it stands until as much was told again."""
    half = team.own[1]
    wait(team)
    team.own[1] = 1 - half
    return half


@kernel
def greatest(team, half, value):
    """Greatest of the numbers that blocks told."""
    told = team.told[half, value]
    most = told[0]
    for block in range(1, told.size):
        most = max(most, told[block])
    return most


@kernel
def summed(team, half, value):
    """Sum of the numbers that blocks told."""
    told = team.told[half, value]
    total = 0.0
    for block in range(told.size):
        total += told[block]
    return total


@kernel
def offer(team):
    """Before a wait: nothing is taken."""
    if team.rank == 0:
        team.counters[_TAKEN] = 0


@kernel
def take(team):
    """Number of what this thread is to do next; nobody else does it."""
    if team.size == 1:
        team.counters[_TAKEN] += 1
        return team.counters[_TAKEN] - 1
    return _add(team.counters, _TAKEN, 1)
