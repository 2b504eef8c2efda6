r"""The fast solver: steps that never pass a barrier, in windows and of the whole front.

Let Q be the line stiffness (no positive off-diagonal entry) and f_i the force on site i
without the line, so that its drive is r_i = f_i - (Q u)_i for a front u along the motion. If a step
v >= 0 satisfies

.. math:: (Q + D) v \le r, \qquad f_i(u_i + t v_i) \ge f_i(u_i) - D_i t v_i, \quad 0 \le t \le 1,

at every site that moves, then r(u + t v) >= (1 - t) r >= 0 there on the whole way: no site passes
a position where it would rest, so that the front stays behind the first metastable state. The
iteration increases, stays below that state and stops only where no drive is left: it ends in it.
Leaving out couplings (windows) or lowering the right-hand side (inexact solves) only shortens v.
"""

from __future__ import annotations

import numpy as np

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.rays import front_products
from crackfront.core.field.samples import sample_place
from crackfront.core.geometry.base import weight
from crackfront.core.solver.filters import apply_filter
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    LIMIT,
    NEEDLES,
    RIGID,
    STILL,
    TURNED,
    Front,
    drive_sites,
    harden,
    largest_entry,
    place_sites,
    touch_samples,
)
from crackfront.core.solver.newton import make_workspace, newton_step
from crackfront.core.solver.reference import rosso_krauth, sweep_from
from crackfront.core.solver.window import HALF_BAND, LONGEST, make_window, relax_window
from crackfront.core.units import WORK_OF_ADHESION

_CALM = 2e-3
"""Drive, relative to w_int, below which all steps are Newton steps of the whole front."""

_LEVEL = 0.1
"""Sites above this share of the largest drive are active: windows relax them to it."""

_LEAST_LEVEL = 0.01
"""Smallest share, to which it falls while less than :data:`_FEW` of the front are active."""

_FEW = 0.1
"""Part of a front that is to be active."""

_MANY = 0.3
"""Part of a front above which steps of the whole front may pay."""

_DOUBT = 200
"""Pairs of FFTs after which the line and the field are compared again."""

_SWEEPS = 30
"""Sweeps among needles before the first step of the whole front."""

_WASTE = 0.5
"""Largest ratio of wasted pairs of FFTs to sweeps.

Pairs of a step are wasted if it moves the front less than as many sweeps do.
"""

_SLOW, _STIFF = 0.1, 8.0
"""Way of a step over the way of as many sweeps without a field, below which needles stop it.

They do where a site's own force is so many times as stiff as the line against it; elsewhere the
line itself is slow.
"""

_BETWEEN = 13
"""Sites added on each side of the active ones; those that then touch share a window."""

_EQUILIBRIUM = 0.3
"""Part of the tolerance to which a window of the whole front is relaxed."""

_ROUND_OFF = 1e-9
"""Backward drive, relative to w_int, that round-off may cause."""


@jit
def monotone_newton(place, problem, max_sweeps):
    """First metastable front in the direction of motion; the places are changed.

    Returns a code, the numbers of FFT pairs and of updates of a site, and the largest drive left.
    """
    if place.size <= 2 * HALF_BAND:
        return rosso_krauth(place, problem, max_sweeps)
    code, pairs, updates, residual = _relax(place, problem, max_sweeps)
    if code == BLOCKED:
        # The field is too steep for the digits of a radius: the reference ends there.
        code, sweeps, more, residual = rosso_krauth(place, problem, max_sweeps - pairs)
        pairs, updates = pairs + sweeps, updates + more
    return code, pairs, updates, residual


@jit
def _relax(place, problem, max_sweeps):
    """Alternate between windows around the largest drives and steps of the whole front.

    Once needles are met, every site also moves by its own force after the windows, at least as far
    as in a sweep of the reference: no transform then brings the front less far than one there.
    """
    count, tolerance = place.size, problem.tolerance
    work = make_workspace(count, problem.field.geometry)
    front = Front(place, np.zeros(count, np.int64), np.zeros(count), np.zeros(count))
    line, before = np.zeros(count), np.zeros(count)
    runs = np.zeros((count // (2 * _BETWEEN + 1) + 2, 2), np.int64)
    # Forces of the line against one site alone.
    front.drive[0] = 1.0
    apply_filter(work.stiff_line, front.drive, line)
    window = make_window(line)
    residual, first_least, pairs, updates = np.inf, 0.0, 0, 0
    share, collective, doubted = _LEVEL, False, 0
    site_stiffness, needles, swept, stepped, wasted = window.coupling[LONGEST], False, np.inf, 0, 0
    hardest = 0.0
    code = place_sites(problem, front)
    while code == CONVERGED:
        apply_filter(work.stiff_line, place, line)
        residual, least = drive_sites(problem, front, line)
        if pairs == 0:
            first_least = least
        pairs += 1
        if residual <= tolerance:
            return CONVERGED, pairs, updates, residual
        if least < first_least - _ROUND_OFF:
            excused = _is_round_off(problem, front, first_least - _ROUND_OFF)
            return BLOCKED if excused else TURNED, pairs, updates, residual
        if pairs >= max_sweeps:
            return LIMIT, pairs, updates, residual
        if not _remember(place, before):
            return STILL, pairs, updates, residual
        if count <= LONGEST:
            # Sums over pairs of sites cost no more than transforms.
            level = _EQUILIBRIUM * tolerance
            code, used, _ = relax_window(
                window, problem, front, np.argmin(front.drive), count, level
            )
            updates += used
            continue
        sweeps = pairs - stepped
        may_step = not needles or (sweeps > _SWEEPS and wasted <= _WASTE * sweeps)
        calm, level = residual <= _CALM and may_step, share * residual
        n_run, n_active = (0, 0) if calm else _list_runs(problem, front, level, runs)
        share = (
            max(0.5 * share, _LEAST_LEVEL) if n_active < _FEW * count else min(2 * share, _LEVEL)
        )
        widespread = n_active > _MANY * count
        if widespread and pairs >= doubted:
            # A front that grows far comes to other places; a comparison costs as much as a step.
            doubted = pairs + _DOUBT
            collective = _line_outweighs_field(work, problem, front, window)
        if calm or (may_step and widespread and collective):
            code, used = newton_step(work, problem, front, needles)
            pairs += used
            stepped += used
            updates += count
            moved, drive = _sums(front, before)
            if needles and moved < used * swept:
                wasted += used
            hardest = max(hardest, largest_entry(work.hardening))
            is_held = (
                hardest > _STIFF * site_stiffness and moved < _SLOW * used * drive / site_stiffness
            )
            needles |= code == NEEDLES or (not calm and is_held)
            if code != BLOCKED and code != NEEDLES:
                continue
            n_run, _ = _list_runs(problem, front, level, runs)
        code, used, stiffest = _relax_runs(window, problem, front, runs[:n_run], level)
        updates += used
        hardest = max(hardest, stiffest)
        needles |= hardest > RIGID * site_stiffness
        if needles and code == CONVERGED:
            code, swept = sweep_from(problem, front, before, site_stiffness)
            updates += count
    return code, pairs, updates, residual


@kernel
def _remember(place, before):
    """Store the places; return whether any has changed."""
    moved = 0
    for i in range(np.uint64(place.size)):
        moved += place[i] != before[i]
        before[i] = place[i]
    return moved > 0


@kernel
def _sums(front, before):
    """Sums of the ways of the sites from the places before, and of the forward drives there."""
    moved, drive = 0.0, 0.0
    for i in range(np.uint64(before.size)):
        moved += abs(front.place[i] - before[i])
        drive += max(front.drive[i], 0.0)
    return moved, drive


@jit
def _is_round_off(problem, front, least):
    """Whether the last digits of the places explain every relative drive below a value."""
    place, field = front.place, problem.field
    outer = front_products(np.nextafter(place, np.inf), field)
    inner = front_products(np.nextafter(place, -np.inf), field)
    for i in range(place.size):
        backward = front.drive[i] < least * weight(field.geometry, place[i]) * WORK_OF_ADHESION
        # A site at rest at the lowest place has a drive of -inf.
        if backward and np.inf > -front.drive[i] > 4 * abs(outer[i] - inner[i]):
            return False
    return True


@kernel
def _line_outweighs_field(work, problem, front, window):
    """Whether the coupling that windows leave out is stiffer than the field.

    Then large parts of the front move together, and steps of the whole front pay.
    """
    left_out = np.sum(window.coupling[LONGEST - HALF_BAND : LONGEST + HALF_BAND + 1])
    hardening, reach = work.hardening, work.right
    touch_samples(problem, front, 0, hardening)
    work.step[:] = abs(sample_place(problem.field, 1) - sample_place(problem.field, 0))
    reach[:], hardening[:] = 0.0, -np.inf
    harden(problem, front, 0, work.step, 1.0, reach, hardening)
    total = 0.0
    for stiffness in hardening:
        total += max(stiffness, 0.0)
    return total / hardening.size < left_out


@kernel
def _list_runs(problem, front, level, runs):
    """List the runs of active sites: the first site of each and the first after it.

    A run may pass the ends of the front. Returns the numbers of runs and of their sites.
    """
    geometry, count = problem.field.geometry, front.drive.size
    n_run, n_active, site = 0, 0, _next_active(geometry, front, level, 0)
    while site < count:
        if n_run == 0 or site - _BETWEEN > runs[n_run - 1, 1]:
            runs[n_run, 0] = site - _BETWEEN
            n_run += 1
        runs[n_run - 1, 1] = site + _BETWEEN + 1
        site = _next_active(geometry, front, level, site + 1)
    if n_run > 0 and runs[n_run - 1, 1] - count >= runs[0, 0]:
        # The last touches the first.
        if n_run > 1:
            n_run -= 1
            runs[0, 0] = runs[n_run, 0] - count
        else:
            runs[0, 0] = np.argmin(front.drive)
            runs[0, 1] = runs[0, 0] + count
    for run in range(n_run):
        n_active += runs[run, 1] - runs[run, 0]
    return n_run, n_active


@kernel
def _next_active(geometry, front, level, site):
    """First site from one on with a drive above a level relative to w_int; their number if none."""
    place, drive = front.place, front.drive
    while site < drive.size:
        if site + 8 <= drive.size:
            active = False
            for i in range(np.uint64(site), np.uint64(site + 8)):
                active |= drive[i] > level * weight(geometry, place[i]) * WORK_OF_ADHESION
            if not active:
                site += 8
                continue
        if drive[site] > level * weight(geometry, place[site]) * WORK_OF_ADHESION:
            break
        site += 1
    return site


@kernel
def _relax_runs(window, problem, front, runs, level):
    """Relax every run, in pieces that fit a window, by the same drives.

    Returns a code, the number of updates of a site and the largest stiffness of its own force.
    """
    updates, code, stiffest = 0, CONVERGED, 0.0
    for run in range(len(runs)):
        for first in range(runs[run, 0], runs[run, 1], LONGEST):
            count = min(runs[run, 1] - first, LONGEST)
            end, used, most = relax_window(
                window, problem, front, first % front.drive.size, count, level
            )
            code, updates, stiffest = max(code, end), updates + used, max(stiffest, most)
    return code, updates, stiffest
