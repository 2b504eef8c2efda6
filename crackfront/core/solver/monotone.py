r"""The fast solver: safe steps that never pass a barrier, on windows and on the whole front.

Let K be the line stiffness (no positive off-diagonal entry) and f_i the own drive of site i, so
that its drive is r_i = f_i - (K u)_i for a front u along the motion. If a step s >= 0 satisfies

.. math:: (K + D) s \le r, \qquad f_i(u_i + t s_i) \ge f_i(u_i) - D_i t s_i, \quad 0 \le t \le 1,

at every site that moves, then r(u + t s) >= (1 - t) r >= 0 there on the whole way: no site passes
a position where it would rest, so that the front stays behind the first metastable state. The
iteration increases, stays below that state and stops only where no drive is left: it ends in it.
Leaving out couplings (windows) or lowering the right-hand side (inexact solves) only shortens s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.rays import front_products
from crackfront.core.field.samples import distance_ahead, sample_place
from crackfront.core.geometry.base import weight
from crackfront.core.solver.filters import apply_filter, set_filter
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    LIMIT,
    STILL,
    TURNED,
    Front,
    drive_sites,
    harden,
    place_sites,
    resting_place,
    touch_samples,
)
from crackfront.core.solver.newton import Newton, make_newton, newton_step
from crackfront.core.solver.team import (
    Team,
    another,
    bounds,
    greatest,
    hear,
    make_team,
    my_blocks,
    offer,
    summed,
    take,
    tell,
    wait,
)
from crackfront.core.solver.window import HALF_BAND, LONGEST, make_window, relax_window
from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

_CALM = 2e-3
"""Drive, relative to w_int, below which only Newton steps of the whole front are taken."""

_LEVEL = 0.1
"""Windows hold the sites above this share of the largest drive, and relax them to it."""

_LEAST = 0.01
"""Smallest share, to which it falls while windows hold less than :data:`_FEW` of the front."""

_FEW = 0.1
"""Part of a front that windows are to hold at a look."""

_DOUBT = 200
"""Pairs of FFTs after which it is asked anew whether the line outweighs the field."""

_MARGIN = 13
"""Sites added on each side of those with a drive; what then touches shares a window."""

_ROUNDS = 12
"""Steps of one window before the whole front is looked at again."""

_EQUILIBRIUM = 0.3
"""Part of the tolerance to which a window of the whole front is relaxed."""

_ROUND_OFF = 1e-9
"""Backward drive, relative to w_int, that round-off may cause."""


class Work(NamedTuple):
    """What the threads that relax a front share.

    Attributes
    ----------
    team : Team
        The first of the threads.
    front : Front
        The front.
    before : (n_site,) array
        Its places at the last look.
    drive, line : (n_site,) array
        Forces along the motion, and of the line.
    active : (n_site,) bool array
        Sites that windows hold.
    newton : Newton
        Work space of steps of the whole front.
    """

    team: Team
    front: Front
    before: Array
    drive: Array
    line: Array
    active: NDArray[np.bool_]
    newton: Newton


@jit
def make_work(place):
    """What is shared to relax a front, which is changed in place."""
    count = place.size
    return Work(
        make_team(count),
        Front(place, np.zeros(count, np.int64), np.zeros(count)),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count, np.bool_),
        make_newton(count),
    )


@jit(nogil=True)
def relax_together(work, rank, size, load, direction, field, memory, tolerance, max_sweeps):
    """Alternate between windows around the largest drives and steps of the whole front.

    Every one of `size` threads calls this with its rank, and all return the same.
    """
    team = another(work.team, rank, size)
    front, newton, drive = work.front, work.newton, work.drive
    count, geometry = drive.size, field.geometry
    drive[0] = 1.0
    set_filter(team, newton.transform, newton.line, geometry, 0.0, False)
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        tell(team, 0, block, place_sites(front, field, memory, direction, low, high))
        tell(team, 1, block, -np.min(front.place[low:high]))
    told = hear(team)
    code, innermost = int(greatest(team, told, 0)), -greatest(team, told, 1)
    # The drives are zero but for one, and so the forces of the line are those of one site.
    apply_filter(team, newton.transform, newton.line, drive, work.line)
    window = make_window(work.line)
    wait(team)
    furthest = distance_ahead(field)
    # A backward force within the tolerance counts as equilibrium.
    slack = tolerance * WORK_OF_ADHESION * weight(geometry, innermost)
    residual, first_least, pairs, updates = np.inf, 0.0, 0, 0
    share, collective, doubted = _LEVEL, False, 0
    lowest = resting_place(field, load, direction)
    while code == CONVERGED:
        residual, least, moved = _look(team, work, geometry, load, direction, lowest)
        if pairs == 0:
            first_least = least
        pairs += 1
        if residual <= tolerance:
            return CONVERGED, pairs, updates, residual
        if least < first_least - _ROUND_OFF:
            excused = _is_round_off(front.place, field, drive, first_least - _ROUND_OFF)
            return BLOCKED if excused else TURNED, pairs, updates, residual
        if pairs >= max_sweeps:
            return LIMIT, pairs, updates, residual
        if not moved:
            return STILL, pairs, updates, residual
        if count <= LONGEST:
            # Sums over pairs of sites cost no more than transforms.
            code, used = relax_window(
                window, field, memory, front, drive, np.argmin(drive), count, load, direction,
                _EQUILIBRIUM * tolerance, furthest, slack, _ROUNDS,
            )  # fmt: skip
            updates += used
            continue
        calm, level = residual <= _CALM, share * residual
        n_active = 0 if calm else _mark(team, geometry, work, level)
        share = max(0.5 * share, _LEAST) if n_active < _FEW * count else min(2 * share, _LEVEL)
        widespread = n_active > 0.3 * count
        if widespread and pairs >= doubted:
            # A front that grows far comes to other places; to look costs as much as a step.
            doubted = pairs + _DOUBT
            collective = _line_outweighs_field(
                team, newton, field, memory, front, window, load, direction
            )
        if calm or (widespread and collective):
            code, used = newton_step(
                team, newton, field, memory, front, drive, load, direction, furthest, slack
            )  # fmt: skip
            pairs += used
            updates += count
            if code != BLOCKED:
                continue
            n_active = _mark(team, geometry, work, level)
        code, used = _relax_active(
            team, work, window, field, memory, load, direction, level, furthest, slack,
            n_active == count,
        )  # fmt: skip
        updates += used
    return code, pairs, updates, residual


@kernel
def _look(team, work, geometry, load, direction, lowest):
    """Bring the drives up to date.

    Returns the largest and the least relative to w_int, and whether a site moved since the last
    look.
    """
    front, drive, before, newton = work.front, work.drive, work.before, work.newton
    apply_filter(team, newton.transform, newton.line, front.place, work.line)
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, drive.size)
        most, least = drive_sites(
            geometry, front, work.line, load, direction, lowest, drive, low, high
        )
        tell(team, 0, block, most)
        tell(team, 1, block, -least)
        tell(team, 2, block, _remember(front.place, before, low, high))
    told = hear(team)
    return greatest(team, told, 0), -greatest(team, told, 1), greatest(team, told, 2) > 0.0


@kernel
def _remember(place, before, low, high):
    """Note where some sites are; return how many of them moved."""
    moved = 0
    for i in range(np.uint64(low), np.uint64(high)):
        moved += place[i] != before[i]
        before[i] = place[i]
    return moved


@jit
def _is_round_off(place, field, drive, least):
    """Whether the last digits of the places explain every relative drive below a value."""
    outer = front_products(np.nextafter(place, np.inf), field)
    inner = front_products(np.nextafter(place, -np.inf), field)
    for i in range(place.size):
        backward = drive[i] < least * weight(field.geometry, place[i]) * WORK_OF_ADHESION
        # A site at rest at the lowest place is driven back without bound.
        if backward and np.inf > -drive[i] > 4 * abs(outer[i] - inner[i]):
            return False
    return True


@kernel
def _line_outweighs_field(team, newton, field, memory, front, window, load, direction):
    """Whether the coupling that windows leave out is stiffer than the field.

    Then large parts of the front move together, and steps of the whole front pay.
    """
    count = front.place.size
    left_out = np.sum(window.coupling[LONGEST - HALF_BAND : LONGEST + HALF_BAND + 1])
    reach = abs(sample_place(field, 1) - sample_place(field, 0))
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        ahead = newton.ahead[low:high]
        touch_samples(field, memory, front, low, ahead)
        newton.step[low:high], newton.right[low:high], ahead[:] = reach, 0.0, -np.inf
        harden(
            field, memory, front, low, newton.step[low:high], 1.0, newton.right[low:high], ahead,
            load, direction,
        )  # fmt: skip
        total = 0.0
        for stiffness in ahead:
            total += max(stiffness, 0.0)
        tell(team, 0, block, total)
    return summed(team, hear(team), 0) / count < 0.5 * left_out


@kernel
def _mark(team, geometry, work, level):
    """Mark the sites with a drive above a level and their neighbours; return their number."""
    offer(team)
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, work.drive.size)
        tell(team, 0, block, _mark_sites(geometry, work, level, low, high))
    return int(summed(team, hear(team), 0))


@kernel
def _mark_sites(geometry, work, level, low, high):
    """Mark those of some sites that have a drive above a level, or a neighbour of such a site."""
    place, drive, active, count = work.front.place, work.drive, work.active, work.drive.size
    marked, until = 0, low
    for i in range(low, high):
        active[i] = False
    for i in range(low - _MARGIN, high + _MARGIN):
        site = i + count if i < 0 else i - count if i >= count else i
        if drive[site] > level * weight(geometry, place[site]) * WORK_OF_ADHESION:
            start, end = max(i - _MARGIN, until), min(i + _MARGIN + 1, high)
            for j in range(start, end):
                active[j] = True
            marked += max(end - start, 0)
            until = max(until, end)
    return marked


@kernel
def _relax_active(
    team, work, window, field, memory, b, direction, level, furthest, slack, everywhere
):
    """Relax every run of active sites, in pieces that fit a window; return code and updates.

    The pieces do not know of one another: threads take them as they come.
    """
    drive, active = work.drive, work.active
    updates, offset, code, passed = 0, 0, CONVERGED, 0
    start = np.argmin(drive) if everywhere else np.argmin(active)
    mine = take(team)
    while True:
        offset, length = _next_run(active, start, offset)
        if length == 0:
            break
        if passed == mine:
            first = (start + offset) % drive.size
            end, used = relax_window(
                window, field, memory, work.front, drive, first, length, b, direction,
                level, furthest, slack, _ROUNDS,
            )  # fmt: skip
            code, updates = max(code, end), updates + used
            mine = take(team)
        passed += 1
        offset += length
    own, end = my_blocks(team)
    for block in range(own, end):
        tell(team, 0, block, code)
        tell(team, 1, block, updates if block == own else 0)
    told = hear(team)
    return int(greatest(team, told, 0)), int(summed(team, told, 1))


@kernel
def _next_run(active, start, offset):
    """Offset from the start and length of the next run of active sites that fits a window."""
    count, length = active.size, 0
    i = (start + offset) % count
    while offset + length < count and length < LONGEST:
        if active[i]:
            length += 1
        elif length > 0:
            break
        else:
            offset += 1
        i = i + 1 if i + 1 < count else 0
    return offset, length
