"""Which rows of a recording are in contact, by their contact radius or by their force."""

from __future__ import annotations

import math

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import stdtrit

from crackfront.analysis.steady_adhesion import Rows
from crackfront.core.arrays import Array
from crackfront.measured.loops.recording import UNITS, Recording

FEWEST_FREE_ROWS = 5
"""Rows out of contact that determine a zero of the force; a line through fewer lacks an error."""

_SPIKE = 12.0
"""Distance of a spike from the median of five rows, over the median of this distance.

Of normal noise one row in 10^8 is that far away.
"""

_CHANCE = 1e-4
"""Probability with which noise makes one row depart from those out of contact.

Two rows in succession are a contact, so that chance makes one in 10^8 rows.
"""

_NOISE_LIMIT = 4.5
"""Departure over the noise of the force beyond which rows are in contact.

It replaces the limit by chance where few rows precede, whose scatter is badly known.
"""

_LEAST_PULL = 0.15
"""Departure over the largest pull below which rows are out of contact, as waves of a drift are."""

_FEWEST_LATE = 2
"""Rows with a radius and without a force next to the contact, from which the radius is late."""

_STEEP = 0.1
"""Slope of force over displacement in contact, relative to the slope of the whole loop.

Out of contact the force hardly changes with the displacement.
"""

_CERTAINTY = 0.99
"""Certainty of the slope in the first half of the rows."""

_CERTAINTY_OF_ALL = 0.9995
"""Certainty of the slope of all rows, whose last ones may be in contact."""

_TINY = np.finfo(float).tiny
"""Smallest number that divides another."""


def rows_in_contact(recording: Recording) -> NDArray[np.bool_]:
    """Whether each row is in contact: from the first to the last with a radius or a force.

    A force acts in rows that depart from the line through the rows before or after them. Next to a
    jump of the force it decides, not the radius, which may be missing or late there. Raises
    ValueError if no row is in contact, or a column lacks values in contact.
    """
    force, radius = recording.force, recording.radius
    if radius is not None:
        touches = _filled(radius > 0)
        if force is not None and np.any(touches):
            touches = _cut_by_force(force, touches)
    else:
        touches = _rows_with_force(np.array(force), np.asarray(recording.displacement))
    if not np.any(touches):
        raise ValueError(
            "no row is in contact: no contact radius is above zero, or no force beyond its noise; "
            "check the columns"
        )
    for name in UNITS:
        column = getattr(recording, name)
        if column is not None and not np.any(np.isfinite(column[touches])):
            raise ValueError(
                f"the {name} lacks values in contact; leave its column out, or check the file"
            )
    return touches


def rows_without_spikes(force: Array) -> Rows:
    """Rows with a force that is not far from the median of the five rows around it."""
    rows = np.flatnonzero(np.isfinite(force))
    distance = np.abs(force[rows] - scipy.ndimage.median_filter(force[rows], 5, mode="nearest"))
    # Rows of a smooth rise are medians themselves, and say nothing about the noise.
    noisy = distance[distance > 0]
    return rows[distance <= _SPIKE * np.median(noisy)] if noisy.size else rows


def _filled(condition: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """True from the first to the last row with a condition."""
    after = np.logical_or.accumulate(condition)
    before = np.logical_or.accumulate(condition[::-1])[::-1]
    return np.asarray(after & before)


def _cut_by_force(force: Array, by_radius: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows in contact, from the jump into contact to the pull-off where the force shows them.

    Radii may be missing there, or recorded late. `by_radius` are the rows from the first to the
    last radius.
    """
    first, last = np.flatnonzero(by_radius)[[0, -1]]
    finite = np.flatnonzero(np.isfinite(force))
    middle = (first + last) // 2
    begin = _jump(force, finite[finite <= middle], int(np.sum(finite < first)))
    end = _jump(force, finite[finite >= middle][::-1], int(np.sum(finite > last)))
    rows = np.arange(force.size)
    return (rows >= (first if begin is None else begin)) & (rows <= (last if end is None else end))


def _jump(force: Array, rows: Rows, n_outside: int) -> int | None:
    """First of some rows in which a force acts, from out of contact towards the contact.

    The first `n_outside` of the rows lack a radius. None if too few do, if the radius says the
    same, or if the force does not jump: contact begins and ends with a jump, a wave of a drift does
    not.
    """
    if n_outside <= FEWEST_FREE_ROWS:
        return None
    smooth = force[rows_without_spikes(force)]
    least, noise = _LEAST_PULL * _largest_pull(smooth), _noise(smooth)
    values = force[rows] - force[rows[0]]
    place = _first_pair(np.abs(_departures(values, least, noise)) > 1)
    if place is None:
        return None
    step = abs(values[place] - values[place - 1])
    agrees = 0 <= place - n_outside < _FEWEST_LATE
    if agrees or step <= max(least, _NOISE_LIMIT * noise):
        return None
    return int(rows[place])


def _rows_with_force(force: Array, displacement: Array) -> NDArray[np.bool_]:
    """Whether a force acts in each row."""
    touches = np.zeros(force.size, bool)
    rows = rows_without_spikes(force)
    rows = rows[np.isfinite(displacement[rows])]
    turn = int(np.argmax(displacement[rows])) if rows.size else 0
    after = _free_rows(force, displacement, rows[turn:][::-1])
    if after >= FEWEST_FREE_ROWS:
        # The drift after the contact is also the drift before it.
        last_rows = rows[-after:]
        drift = np.polyfit(last_rows, force[last_rows], 1)[0]
        force = force - drift * np.arange(force.size)
    before = _free_rows(force, displacement, rows[: turn + 1])
    inside = rows[before : rows.size - after]
    if inside.size and np.ptp(force[rows]) > 0:
        last = inside[-1]
        # The last row before a sharp pull-off is as far from those around it as a spike.
        is_pull = last + 1 < force.size and force[last + 1] < force[last]
        if is_pull and not np.isin(last + 1, rows):
            last += 1
        touches[inside[0] : last + 1] = True
    return touches


def _free_rows(force: Array, displacement: Array, rows: Rows) -> int:
    """Number of the first of some rows, in time or against it, that are out of contact.

    They end where rows depart from the line through the rows before them by a pulling force, with
    which contact begins and ends. Rows before the turn that depart only by a pushing force were out
    of contact too if their force does not change with the displacement as in a contact: noise hides
    the jump into contact.
    """
    if rows.size < 2 * FEWEST_FREE_ROWS:
        return 0
    values = force[rows] - force[rows[0]]
    smooth = force[rows_without_spikes(force)]
    departure = _departures(values, _LEAST_PULL * _largest_pull(smooth), _noise(smooth))
    pulled, pushed = (_first_pair(sign * departure > 1) for sign in (-1, 1))
    if pulled is not None:
        return pulled
    count = rows.size if pushed is None else pushed
    if rows[0] > rows[-1] or _is_contact(force, displacement, rows, count):
        return 0
    # The force rises slowly from where it became positive.
    negative = np.flatnonzero(departure[:count] < 0)
    return int(negative[-1]) + 1 if negative.size and pushed is not None else count


def _departures(force: Array, least: float, noise: float) -> Array:
    """Distance of each row from the line through the first two thirds of the rows before it.

    It is relative to what the scatter of these rows explains, or to the noise if that is less, and
    at least to the least force. The first rows, which have no line, have 0.
    """
    place = np.arange(force.size, dtype=float)
    sums = np.zeros((5, force.size + 1))
    sums[:, 1:] = np.cumsum([place, place**2, force, place * force, force**2], axis=1)
    x, y = place[FEWEST_FREE_ROWS:], force[FEWEST_FREE_ROWS:]
    number = np.maximum(2 * x // 3, FEWEST_FREE_ROWS)
    mean_x, square_x, mean_y, product, square_y = sums[:, number.astype(int)] / number
    spread = square_x - mean_x**2
    slope = (product - mean_x * mean_y) / spread
    variance = np.maximum(square_y - mean_y**2 - slope**2 * spread, 0.0) * number / (number - 2)
    by_scatter = stdtrit(number - 2, 1 - _CHANCE) * np.sqrt(variance)
    likely = np.minimum(by_scatter, _NOISE_LIMIT * noise)
    # The line itself has an error, which grows with the distance from its rows.
    likely *= np.sqrt(1 + (1 + (x - mean_x) ** 2 / spread) / number)
    departure = (y - mean_y - slope * (x - mean_x)) / np.maximum(np.maximum(likely, least), _TINY)
    return np.concatenate([np.zeros(FEWEST_FREE_ROWS), departure])


def _largest_pull(force: Array) -> float:
    """Largest force below the line from the first to the last rows."""
    if force.size < 2 * FEWEST_FREE_ROWS:
        return 0.0
    ends = np.median(force[:FEWEST_FREE_ROWS]), np.median(force[-FEWEST_FREE_ROWS:])
    return float(max(np.max(np.linspace(*ends, force.size) - force), 0.0))


def _noise(force: Array) -> float:
    """Noise of the force, from the fifth of the rows with the smallest second differences.

    These have 6 times its variance; a fifth of squared normal numbers is below 0.0642.
    """
    return math.sqrt(float(np.quantile(np.diff(force, 2) ** 2, 0.2)) / (6 * 0.0642))


def _first_pair(condition: NDArray[np.bool_]) -> int | None:
    """Place of the first two successive entries that are true; a single one is a spike."""
    pairs = np.flatnonzero(condition[:-1] & condition[1:])
    return int(pairs[0]) if pairs.size else None


def _is_contact(force: Array, displacement: Array, rows: Rows, count: int) -> bool:
    """Whether the force of the first rows changes with the displacement as in a contact.

    The slope must be steep in the first half of them, and have the same sign in all: the last of
    the rows out of contact may be in contact without a sign of it.
    """
    stiffness = np.nanmax(force) - np.nanmin(force)
    stiffness /= np.nanmax(displacement) - np.nanmin(displacement)
    half = max(count // 2, FEWEST_FREE_ROWS)
    first = _slope(displacement[rows[:half]], force[rows[:half]], _CERTAINTY)
    whole_slope = _slope(displacement[rows[: 2 * half]], force[rows[: 2 * half]], _CERTAINTY_OF_ALL)
    return bool(abs(first) > _STEEP * stiffness and first * whole_slope > 0)


def _slope(displacement: Array, force: Array, certainty: float) -> float:
    """Slope of a line through rows; 0 if they are too few, or it is not certain that it has one."""
    moved = np.isfinite(displacement)
    x, y = displacement[moved], force[moved]
    if x.size < FEWEST_FREE_ROWS or np.ptp(x) == 0:
        return 0.0
    (slope, _), covariance = np.polyfit(x - x[0], y, 1, cov=True)
    error = float(stdtrit(x.size - 2, certainty)) * math.sqrt(covariance[0, 0])
    return float(slope) if abs(slope) > error else 0.0
