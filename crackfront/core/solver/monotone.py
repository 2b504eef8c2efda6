r"""The fast solver: steps that never pass a barrier, in windows and of the whole front.

Let Q be the line stiffness (no positive off-diagonal entry) and f_i the force on site i
without the line, so that its drive is r_i = f_i - (Q u)_i for a front u along the motion. If a step
v >= 0 satisfies

.. math:: (Q + D) v \le r, \qquad f_i(u_i + t v_i) \ge f_i(u_i) - D_i t v_i, \quad 0 \le t \le 1,

at every site that moves, then r(u + t v) >= (1 - t) r >= 0 there on the whole way: no site passes
a position where it would rest, so that the front stays behind the first metastable state. The
iteration increases, stays below that state and stops only where no drive is left: it ends in it.
Leaving out couplings (windows) or lowering the right-hand side (inexact solves) only shortens v.

A needle is a site under which the field is so much stiffer than the line that it rests whatever its
neighbours do. Steps of the whole front are short among needles.
"""

from __future__ import annotations

import numpy as np

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.rays import front_products
from crackfront.core.field.samples import sample_place
from crackfront.core.geometry.base import weight
from crackfront.core.solver.codes import Code
from crackfront.core.solver.filters import apply_filter, make_filter, set_stiffness
from crackfront.core.solver.forces import (
    RIGID,
    Front,
    drive_sites,
    largest_entry,
    place_sites,
    touch_samples,
)
from crackfront.core.solver.hardening import harden
from crackfront.core.solver.newton import make_workspace, newton_step
from crackfront.core.solver.reference import rosso_krauth, sweep_from
from crackfront.core.solver.window import HALF_BAND, LONGEST, make_window, relax_window
from crackfront.core.units import WORK_OF_ADHESION

_CALM = 2e-3
"""Largest drive, relative to w_int, below which all steps are Newton steps of the whole front.

Near equilibrium these converge fast; far from it many of their sites would not move.
"""

_LEVEL = 0.1
"""Sites above this share of the largest drive are active: windows relax them to it.

A lower share takes fewer transforms of the whole front, but more steps of the windows.
"""

_LEAST_LEVEL = 0.01
"""Smallest share, to which it falls while less than :data:`_FEW` of the front are active."""

_FEW = 0.1
"""Part of a front that is to be active.

Windows on fewer sites would cost less than the transforms of the front between them.
"""

_MANY = 0.3
"""Part of a front above which steps of the whole front may pay.

Below it they would move sites that are at rest.
"""

_COMPARISON_PAIRS = 200
"""Pairs of FFTs after which the line and the field are compared again.

A front that grows far comes to other places, but a comparison costs as much as a step.
"""

_FIRST_SWEEPS = 30
"""Sweeps among needles before the first step of the whole front.

They show how far sweeps move the front, with which the step is then compared.
"""

_WASTE = 0.5
"""Largest ratio of wasted pairs of FFTs to sweeps.

Pairs of a step are wasted if it moves the front less than as many sweeps do. The ratio limits what
trying costs.
"""

_SLOW_STEP = 0.1
"""Distance that a step moves the front, over the distance of as many sweeps without a field.

A step below it is stopped by needles, if some site is as stiff as :data:`_STIFF_SITE`.
"""

_STIFF_SITE = 8.0
"""Stiffness of a site's own force, over the line's against it, above which a slow step is blocked.

Where no site is as stiff, the line itself makes a step slow.
"""

_BETWEEN = 13
"""Sites added on each side of the active ones; those that then touch share a window.

Windows that are closer would stop each other.
"""

_EQUILIBRIUM = 0.3
"""Part of the tolerance to which a window of the whole front is relaxed.

It is below 1, since the drives are computed again by transforms, with another round-off.
"""

_ROUND_OFF = 1e-9
"""Backward drive, relative to w_int, that round-off may cause.

A larger one is checked against the last digit of the places.
"""


@jit
def monotone_newton(place, task, max_sweeps):
    """First metastable front in the direction of motion; the places are changed.

    Returns a code, the numbers of FFT pairs and of updates of a site, and the largest drive left.
    """
    if place.size <= 2 * HALF_BAND:
        return rosso_krauth(place, task, max_sweeps)
    if place.size <= LONGEST:
        code, pairs, updates, residual = _relax_in_one_window(place, task, max_sweeps)
    else:
        code, pairs, updates, residual = _relax_in_parts(place, task, max_sweeps)
    if code == Code.FIELD_TOO_STEEP:
        code, sweeps, more, residual = rosso_krauth(place, task, max_sweeps - pairs)
        pairs, updates = pairs + sweeps, updates + more
    return code, pairs, updates, residual


@jit
def _make_front(place):
    """Front at some places, with room for what the solver computes under them."""
    n_site = place.size
    return Front(
        place=place,
        segment=np.zeros(n_site, np.int64),
        product=np.zeros(n_site),
        drive=np.zeros(n_site),
    )


@jit
def _window_of_line(stiff_line, n_site):
    """Work space of windows, from the forces of the line against a single site that advances."""
    advance, line = np.zeros(n_site), np.zeros(n_site)
    advance[0] = 1.0
    apply_filter(stiff_line, advance, line)
    return make_window(line)


@jit
def _relax_in_one_window(place, task, max_sweeps):
    """Relax a front that fits a window; returns as :func:`monotone_newton`.

    Sums over all pairs of its sites cost no more than transforms.
    """
    n_site = place.size
    stiff_line = make_filter(n_site, np.empty(0, np.complex128))
    set_stiffness(stiff_line, task.field.geometry)
    window = _window_of_line(stiff_line, n_site)
    front = _make_front(place)
    line, before = np.zeros(n_site), np.zeros(n_site)
    level = _EQUILIBRIUM * task.tolerance
    residual, first_least, pairs, updates = np.inf, 0.0, 0, 0
    code = place_sites(task, front)
    while code == Code.MOVING:
        apply_filter(stiff_line, place, line)
        residual, least = drive_sites(task, front, line)
        if pairs == 0:
            first_least = least
        pairs += 1
        code = _verdict(task, front, before, residual, least, first_least, max_sweeps - pairs)
        if code == Code.MOVING:
            first = np.argmin(front.drive)
            code, used, _ = relax_window(window, task, front, first, n_site, level)
            updates += used
    return code, pairs, updates, residual


@jit
def _relax_in_parts(place, task, max_sweeps):
    """Alternate between windows around the largest drives and steps of the whole front.

    Once needles are met, every site also moves by its own force after the windows, at least as far
    as in a sweep of the reference: no transform then brings the front less far than one there.
    Returns as :func:`monotone_newton`.
    """
    n_site = place.size
    work = make_workspace(n_site, task.field.geometry)
    window = _window_of_line(work.stiff_line, n_site)
    site_stiffness = window.coupling[LONGEST]
    front = _make_front(place)
    line, before = np.zeros(n_site), np.zeros(n_site)
    runs = np.zeros((n_site // (2 * _BETWEEN + 1) + 2, 2), np.int64)
    residual, first_least, pairs, updates = np.inf, 0.0, 0, 0
    # Share of the largest drive above which sites are active.
    share = _LEVEL
    # Whether the line was stiffer than the field when they were compared, and when to do it again.
    line_outweighs = False
    next_comparison = 0
    # Whether needles have been met, and the largest stiffness of a site's own force so far.
    among_needles = False
    stiffest = 0.0
    # Pairs of FFTs in steps of the whole front, and in steps that moved it less than sweeps do.
    pairs_in_steps = 0
    wasted_pairs = 0
    # How far the last sweep moved the front.
    sweep_distance = np.inf
    code = place_sites(task, front)
    while code == Code.MOVING:
        apply_filter(work.stiff_line, place, line)
        residual, least = drive_sites(task, front, line)
        if pairs == 0:
            first_least = least
        pairs += 1
        code = _verdict(task, front, before, residual, least, first_least, max_sweeps - pairs)
        if code != Code.MOVING:
            break
        may_step = not among_needles or _front_steps_pay(pairs - pairs_in_steps, wasted_pairs)
        is_calm = may_step and residual <= _CALM
        level = share * residual
        n_run, n_active = (0, 0) if is_calm else _list_runs(task, front, level, runs)
        share = _next_share(share, n_active, n_site)
        is_widespread = n_active > _MANY * n_site
        if is_widespread and pairs >= next_comparison:
            next_comparison = pairs + _COMPARISON_PAIRS
            line_outweighs = _line_outweighs_field(work, task, front, window)
        if is_calm or (may_step and is_widespread and line_outweighs):
            code, pairs_used = newton_step(work, task, front, among_needles)
            pairs += pairs_used
            pairs_in_steps += pairs_used
            updates += n_site
            distance, drive = _distance_and_drive(front, before)
            if among_needles and distance < pairs_used * sweep_distance:
                wasted_pairs += pairs_used
            stiffest = max(stiffest, largest_entry(work.hardening))
            is_blocked = _meets_needles(distance, pairs_used, drive, stiffest, site_stiffness)
            among_needles |= code == Code.MET_NEEDLES or (is_blocked and not is_calm)
            if code != Code.PASSES_LOWEST and code != Code.MET_NEEDLES:
                continue
            n_run, _ = _list_runs(task, front, level, runs)
        code, used, stiffest_run = _relax_runs(window, task, front, runs[:n_run], level)
        updates += used
        stiffest = max(stiffest, stiffest_run)
        among_needles |= stiffest > RIGID * site_stiffness
        if among_needles and code == Code.MOVING:
            code, sweep_distance = sweep_from(task, front, before, site_stiffness)
            updates += n_site
    return code, pairs, updates, residual


@jit
def _verdict(task, front, before, residual, least, first_least, sweeps_left):
    """Code if the solver ends at this front, otherwise MOVING; the places before are replaced."""
    if residual <= task.tolerance:
        return Code.CONVERGED
    if least < first_least - _ROUND_OFF:
        if _is_round_off(task, front, first_least - _ROUND_OFF):
            return Code.FIELD_TOO_STEEP
        return Code.PASSED_EQUILIBRIUM
    if sweeps_left <= 0:
        return Code.SWEEP_LIMIT
    if not _remember(front.place, before):
        return Code.STANDS_STILL
    return Code.MOVING


@kernel
def _front_steps_pay(sweeps, wasted_pairs):
    """Whether to try a step of the whole front among needles."""
    return sweeps > _FIRST_SWEEPS and wasted_pairs <= _WASTE * sweeps


@kernel
def _next_share(share, n_active, n_site):
    """Share of the largest drive above which sites are active next time."""
    if n_active < _FEW * n_site:
        return max(0.5 * share, _LEAST_LEVEL)
    return min(2 * share, _LEVEL)


@kernel
def _meets_needles(distance, pairs_used, drive, stiffest, site_stiffness):
    """Whether a step moved the front so little for its drive that needles must have stopped it."""
    is_slow = distance < _SLOW_STEP * pairs_used * drive / site_stiffness
    return is_slow and stiffest > _STIFF_SITE * site_stiffness


@kernel
def _remember(place, before):
    """Store the places; return whether one has changed."""
    moved = 0
    for i in range(np.uint64(place.size)):
        moved += place[i] != before[i]
        before[i] = place[i]
    return moved > 0


@kernel
def _distance_and_drive(front, before):
    """Sums of the distances of sites from the places before, and of the forward drives there."""
    distance, drive = 0.0, 0.0
    for i in range(np.uint64(before.size)):
        distance += abs(front.place[i] - before[i])
        drive += max(front.drive[i], 0.0)
    return distance, drive


@jit
def _is_round_off(task, front, least):
    """Whether the last digits of the places explain every relative drive below a value."""
    place, field = front.place, task.field
    outer = front_products(np.nextafter(place, np.inf), field)
    inner = front_products(np.nextafter(place, -np.inf), field)
    for i in range(place.size):
        backward = front.drive[i] < least * weight(field.geometry, place[i]) * WORK_OF_ADHESION
        # A site at rest at the lowest place has a drive of -inf.
        if backward and np.inf > -front.drive[i] > 4 * abs(outer[i] - inner[i]):
            return False
    return True


@kernel
def _line_outweighs_field(work, task, front, window):
    """Whether the coupling that windows leave out is stiffer than the field.

    Then large parts of the front move together, and steps of the whole front pay.
    """
    left_out = np.sum(window.coupling[LONGEST - HALF_BAND : LONGEST + HALF_BAND + 1])
    hardening, reach = work.hardening, work.right
    touch_samples(task, front, 0, hardening)
    work.step[:] = abs(sample_place(task.field, 1) - sample_place(task.field, 0))
    reach[:], hardening[:] = 0.0, -np.inf
    harden(task, front, 0, work.step, 1.0, reach, hardening)
    total = 0.0
    for stiffness in hardening:
        total += max(stiffness, 0.0)
    return total / hardening.size < left_out


@kernel
def _list_runs(task, front, level, runs):
    """List the runs of active sites: the first site of each and the first after it.

    A run may pass the ends of the front. Returns the numbers of runs and of their sites.
    """
    geometry, count = task.field.geometry, front.drive.size
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
def _relax_runs(window, task, front, runs, level):
    """Relax every run, in pieces that fit a window, by the same drives.

    Returns a code, the number of updates of a site and the largest stiffness of its own force.
    """
    updates, code, stiffest = 0, Code.MOVING, 0.0
    for run in range(len(runs)):
        for first in range(runs[run, 0], runs[run, 1], LONGEST):
            count = min(runs[run, 1] - first, LONGEST)
            end, used, stiffest_window = relax_window(
                window, task, front, first % front.drive.size, count, level
            )
            updates += used
            stiffest = max(stiffest, stiffest_window)
            if end != Code.MOVING:
                code = end
    return code, updates, stiffest
