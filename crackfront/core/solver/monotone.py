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

import numpy as np

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.rays import front_products
from crackfront.core.field.samples import distance_ahead, sample_place
from crackfront.core.geometry.base import weight
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    LIMIT,
    STILL,
    TURNED,
    drive_sites,
    hardening,
    line_force,
    place_front,
    resting_place,
)
from crackfront.core.solver.newton import make_newton, newton_step
from crackfront.core.solver.reference import rosso_krauth
from crackfront.core.solver.window import HALF_BAND, LONGEST, make_window, relax_window
from crackfront.core.units import WORK_OF_ADHESION

_CALM = 2e-3
"""Drive, relative to w_int, below which only Newton steps of the whole front are taken."""

_LEVEL = 0.1
"""Windows hold the sites above this share of the largest drive, and relax them to it."""

_MARGIN = 10
"""Sites added on each side of a window."""

_ROUNDS = 12
"""Steps of one window before the whole front is looked at again."""

_EQUILIBRIUM = 0.3
"""Part of the tolerance to which a window of the whole front is relaxed."""

_ROUND_OFF = 1e-9
"""Backward drive, relative to w_int, that round-off may cause."""


@jit
def monotone_newton(place, load, direction, field, memory, tolerance, max_sweeps):
    """First metastable front in the direction of motion; the front is changed in place.

    Returns a code, the number of FFT pairs, that of updates of a site, and the largest drive left.
    """
    if place.size <= 2 * HALF_BAND:
        return rosso_krauth(place, load, direction, field, memory, tolerance, max_sweeps)
    code, pairs, updates, residual = _run(
        place, load, direction, field, memory, tolerance, max_sweeps
    )
    if code == BLOCKED:
        # The field is too steep for the digits of a radius: the reference knows how to stop there.
        code, sweeps, more, residual = rosso_krauth(
            place, load, direction, field, memory, tolerance, max_sweeps - pairs
        )
        pairs += sweeps
        updates += more
    return code, pairs, updates, residual


@jit
def _run(place, load, direction, field, memory, tolerance, max_sweeps):
    """Alternate between windows around the largest drives and steps of the whole front."""
    count, geometry = place.size, field.geometry
    front, code = place_front(place, field, memory, direction)
    unit = np.zeros(count)
    unit[0] = 1.0
    row = line_force(geometry, unit)
    window, newton = make_window(row), make_newton(count)
    drive, active = np.empty(count), np.empty(count, np.bool_)
    furthest = distance_ahead(field)
    collective = _line_outweighs_field(field, memory, front, row, load, direction)
    # A backward force within the tolerance counts as equilibrium.
    slack = tolerance * WORK_OF_ADHESION * weight(geometry, np.min(place))
    residual, first_least, pairs, updates = np.inf, 0.0, 0, 0
    before = np.zeros(count)
    lowest = resting_place(field, load, direction)
    while code == CONVERGED:
        residual, least = drive_sites(geometry, front, load, direction, lowest, drive)
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
        if np.array_equal(front.place, before):
            return STILL, pairs, updates, residual
        before[:] = front.place
        if count <= LONGEST:
            # Sums over pairs of sites cost no more than transforms.
            code, steps = relax_window(
                window, field, memory, front, drive, np.argmin(drive), count, load, direction,
                _EQUILIBRIUM * tolerance, furthest, slack, _ROUNDS,
            )  # fmt: skip
            updates += steps * count
            continue
        calm = residual <= _CALM
        n_active = 0 if calm else _mark(geometry, front, drive, _LEVEL * residual, active)
        if calm or (collective and n_active > 0.3 * count):
            accuracy = 0.02 if calm else 0.1
            code, used = newton_step(
                newton, field, memory, front, drive, load, direction, furthest, slack, accuracy
            )
            pairs += used
            updates += count
            if code != BLOCKED:
                continue
            _mark(geometry, front, drive, _LEVEL * residual, active)
        code, used = _relax_active(
            window, field, memory, front, drive, active, load, direction,
            _LEVEL * residual, furthest, slack,
        )  # fmt: skip
        updates += used
    return code, pairs, updates, residual


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


@jit
def _line_outweighs_field(field, memory, front, row, load, direction):
    """Whether the coupling that windows leave out is stiffer than the field.

    Then large parts of the front move together, and steps of the whole front pay.
    """
    count = front.place.size
    left_out = row[0]
    for lag in range(1, HALF_BAND + 1):
        left_out += 2 * row[lag]
    reach = abs(sample_place(field, 1) - sample_place(field, 0))
    total = 0.0
    for i in range(count):
        ahead = hardening(
            field, memory, i, front.place[i], front.product[i], front.segment[i], reach,
            load, direction,
        )  # fmt: skip
        total += max(ahead, 0.0)
    return total / count < 0.5 * left_out


@kernel
def _mark(geometry, front, drive, level, active):
    """Mark the sites with a drive above a level and their neighbours; return their number."""
    count = drive.size
    until, marked = -1, 0
    for i in range(count):
        active[i] = False
    for i in range(count):
        if drive[i] > level * weight(geometry, front.place[i]) * WORK_OF_ADHESION:
            for j in range(max(i - _MARGIN, until + 1), i + _MARGIN + 1):
                site = j - count if j >= count else j
                marked += 0 if active[site] else 1
                active[site] = True
            until = i + _MARGIN
    return marked


@jit
def _relax_active(
    window, field, memory, front, drive, active, b, direction, level, furthest, slack
):
    """Relax every run of active sites, in pieces that fit a window; return code and updates."""
    updates, offset = 0, 0
    start = np.argmin(active) if not np.all(active) else np.argmin(drive)
    while True:
        offset, length = _next_run(active, start, offset)
        if length == 0:
            return CONVERGED, updates
        first = (start + offset) % drive.size
        code, steps = relax_window(
            window, field, memory, front, drive, first, length, b, direction,
            level, furthest, slack, _ROUNDS,
        )  # fmt: skip
        updates += steps * length
        if code != CONVERGED:
            return code, updates
        offset += length


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
