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
    runs : (n_run, 2) int array
        First site of each run of driven sites, and the first after it.
    newton : Newton
        Work space of steps of the whole front.
    """

    team: Team
    front: Front
    before: Array
    drive: Array
    line: Array
    runs: NDArray[np.int64]
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
        np.zeros((count // (2 * _MARGIN + 1) + 2, 2), np.int64),
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
    set_filter(team, newton.coarse, newton.coarse_line, geometry, 0.0, False)
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
    share, softening, collective, doubted = _LEVEL, 1.0, False, 0
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
        n_run, n_active = (0, 0) if calm else _find_runs(team, geometry, work, level)
        share = max(0.5 * share, _LEAST) if n_active < _FEW * count else min(2 * share, _LEVEL)
        widespread = n_active > 0.3 * count
        if widespread and pairs >= doubted:
            # A front that grows far comes to other places; to look costs as much as a step.
            doubted = pairs + _DOUBT
            collective = _line_outweighs_field(
                team, newton, field, memory, front, window, load, direction
            )
        if calm or (widespread and collective):
            code, used, softening = newton_step(
                team, newton, field, memory, front, drive, load, direction, furthest, slack,
                softening,
            )  # fmt: skip
            pairs += used
            updates += count
            if code != BLOCKED:
                continue
            n_run, _ = _find_runs(team, geometry, work, level)
        code, used = _relax_runs(
            team, work, window, field, memory, n_run, load, direction, level, furthest, slack
        )
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
    return summed(team, hear(team), 0) / count < left_out


@kernel
def _find_runs(team, geometry, work, level):
    """Find the runs of sites with a drive above a level; return their number and that of sites."""
    offer(team)
    n_run, n_active = 0, 0
    if team.rank == 0:
        n_run = _list_runs(geometry, work, level)
        for run in range(n_run):
            n_active += work.runs[run, 1] - work.runs[run, 0]
    own, end = my_blocks(team)
    for block in range(own, end):
        tell(team, 0, block, n_run if block == 0 else 0)
        tell(team, 1, block, n_active if block == 0 else 0)
    told = hear(team)
    return int(summed(team, told, 0)), int(summed(team, told, 1))


@kernel
def _list_runs(geometry, work, level):
    """First site of each run and the first after it, which may pass the ends of the front."""
    runs, count = work.runs, work.drive.size
    n_run, site = 0, _next_driven(geometry, work, level, 0)
    while site < count:
        if n_run == 0 or site - _MARGIN > runs[n_run - 1, 1]:
            runs[n_run, 0] = site - _MARGIN
            n_run += 1
        runs[n_run - 1, 1] = site + _MARGIN + 1
        site = _next_driven(geometry, work, level, site + 1)
    if n_run > 0 and runs[n_run - 1, 1] - count >= runs[0, 0]:
        # The last touches the first.
        if n_run > 1:
            n_run -= 1
            runs[0, 0] = runs[n_run, 0] - count
        else:
            runs[0, 0] = np.argmin(work.drive)
            runs[0, 1] = runs[0, 0] + count
    return n_run


@kernel
def _next_driven(geometry, work, level, site):
    """First site from one on with a drive above a level relative to w_int; their number if none."""
    place, drive = work.front.place, work.drive
    while site < drive.size:
        if site + 8 <= drive.size:
            driven = False
            for i in range(np.uint64(site), np.uint64(site + 8)):
                driven |= drive[i] > level * weight(geometry, place[i]) * WORK_OF_ADHESION
            if not driven:
                site += 8
                continue
        if drive[site] > level * weight(geometry, place[site]) * WORK_OF_ADHESION:
            break
        site += 1
    return site


@kernel
def _relax_runs(team, work, window, field, memory, n_run, b, direction, level, furthest, slack):
    """Relax every run of driven sites, in pieces that fit a window; return code and updates.

    The pieces do not know of one another: threads take them as they come.
    """
    drive, runs = work.drive, work.runs
    updates, code, passed = 0, CONVERGED, 0
    mine = take(team)
    for run in range(n_run):
        for first in range(runs[run, 0], runs[run, 1], LONGEST):
            if passed == mine:
                end, used = relax_window(
                    window, field, memory, work.front, drive, first % drive.size,
                    min(runs[run, 1] - first, LONGEST), b, direction, level, furthest, slack,
                    _ROUNDS,
                )  # fmt: skip
                code, updates = max(code, end), updates + used
                mine = take(team)
            passed += 1
    own, end = my_blocks(team)
    for block in range(own, end):
        tell(team, 0, block, code)
        tell(team, 1, block, updates if block == own else 0)
    told = hear(team)
    return int(greatest(team, told, 0)), int(summed(team, told, 1))
