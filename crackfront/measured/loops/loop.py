"""Works of adhesion of a measured loop, by the definition of simulations, with their intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import stdtrit

from crackfront.analysis.estimate import REACH, Estimate
from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import (
    Branches,
    Rows,
    branch_means,
    shared_window,
    within,
)
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.core.variables import variable
from crackfront.measured.loops.contact import force_at, penetration_at, radius_at
from crackfront.measured.loops.recording import Recording
from crackfront.surfaces.written_units import prefixed

_BLOCKS = 10
"""Parts of a branch, each of which is left out once to find the errors of noise."""

_AFTER_JUMP, _AFTER_TURN = 0.02, 0.1
"""Parts of the largest radius that the edge travels before a branch counts as steady.

A jump into contact leaves nothing behind. After the turn the edge has to leave what pinned it in
approach; `python -m studies accuracy loops` holds the intervals against simulated spheres.
"""

_ZEROS, _NO_FIT = 151, 1e6
"""Displacements among which the zero is looked for first, and what stands for no curve at one."""

_FEWEST_BASELINE = 5
"""Rows out of contact from which the zero of the force is found."""

_UNLIKELY, _LEAST_PULL = 1e-4, 0.15
"""Probability with which noise alone makes a row depart from those out of contact, two of which in
succession are of a contact; and the least departure over the largest pulling force."""

_SIGMAS = 4.5
"""Distance from those out of contact over the noise of a row, two of which make a contact."""

_STEEP, _CERTAIN = 0.1, 0.9995
"""Slope of the force over the displacement, relative to that of the whole loop, and the certainty
that there is one, from which rows are of a contact: out of it the force hardly changes."""

_SPIKE = 12.0
"""Distance from the median of the rows around it, over that of all rows, that makes a spike."""

_FITS = 1.5
"""Variance that a parabola leaves over that of the noise, up to which it fits."""

_NOISES = 4.0
"""Pull-off force over the noise of the force, below which no contact is found without radii."""

_NO_MEANS = math.nan, math.nan
"""Works of adhesion where no row has one."""

_TINY = np.finfo(float).tiny
"""Smallest force that divides another."""

_APART = 1.5
"""Ratio of a pull-off force to that of the work of adhesion, beyond which the loop says so."""

_MOST_LOST = 0.1
"""Part of the rows in contact that noise may leave without a work of adhesion."""

_LARGE = 0.3
"""Contact radius over that of the sphere, whose profile a paraboloid misses by 3%."""

_RETURN = 0.2
"""Part of the largest travel by which mount or edge may come back within a branch."""


@dataclass(frozen=True, slots=True)
class Rig:
    """What is known of the sphere and of the machine, in SI units."""

    radius: float
    """Radius of the sphere. (Units: m)"""
    contact_modulus: float | None = None
    """Contact modulus E' = E / (1 - nu^2); None to fit it. (Units: Pa)"""
    modulus_error: float = 0.0
    """Standard error of the modulus, relative."""
    radius_error: float = 0.0
    """Standard error of the radius of the sphere, relative."""
    stiffness: float | None = None
    """Stiffness of the machine, where force or radius was not measured. (Units: N/m)"""
    window: tuple[float, float] | None = None
    """Contact radii that both works are averaged over; None to find them. (Units: m)"""

    def __post_init__(self) -> None:
        for name in ("radius", "contact_modulus", "stiffness"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive and finite")
        for name in ("modulus_error", "radius_error"):
            if not 0 <= getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it is relative, 0 to 1")
        if self.modulus_error > 0 and self.contact_modulus is None:
            raise ValueError(
                f"the error of the modulus is {self.modulus_error:g}, and no modulus is given; a "
                "fitted one has the error of its fit, so give a modulus or leave the error out"
            )
        if self.window is not None and not 0 <= self.window[0] < self.window[1] < math.inf:
            ends = " to ".join(prefixed("m", end) for end in self.window)
            raise ValueError(f"window is {ends}; give a smaller and a larger contact radius")


@dataclass(frozen=True, slots=True)
class MeasuredLoop:
    """What a loop measures, in SI units; printed, it is a page.

    Arrays have an entry for each row of the recording. A simulated cycle in reduced units stays in
    them, its works of adhesion in w_int.
    """

    force: Array = variable("normal force, its zero corrected", "N", "row")
    contact_radius: Array = variable("contact radius", "m", "row")
    work_of_adhesion: Array = variable("apparent work of adhesion", "J m-2", "row")
    direction: Array = variable("1 in approach, -1 in retraction, 0 out of contact", "1", "row")
    in_window: Array = variable("whether a row is averaged", "1", "row")
    w_appr: Estimate[float] = variable("work of adhesion of the approach", "J m-2")
    w_retr: Estimate[float] = variable("work of adhesion of the retraction", "J m-2")
    hysteresis: Estimate[float] = variable("w_retr - w_appr", "J m-2")
    contact_modulus: Estimate[float] = variable("contact modulus E', given or fitted", "Pa")
    fitted_modulus: Estimate[float] = variable("contact modulus E' that fits the loop", "Pa")
    stiffness: Estimate[float] = variable("stiffness of the machine", "N m-1")
    lost_energy: float = variable("energy lost in the loop per largest contact area", "J m-2")
    pull_off_force: Estimate[float] = variable("largest pulling force of the retraction", "N")
    sphere_radius: float = variable("radius of the sphere", "m")
    window: tuple[float, float] = (math.nan, math.nan)
    """Contact radii that both works are averaged over (Units: m)."""
    remarks: tuple[str, ...] = ()
    """What was corrected or taken for granted, and what could not be found."""
    reduced: bool = False
    """Whether the numbers are in reduced units instead of SI."""

    def __repr__(self) -> str:
        """The page that the command `crackfront loop` prints."""
        return "\n".join(_page(self))


def analyse_loop(recording: Recording, rig: Rig) -> MeasuredLoop:
    """Works of adhesion of approach and retraction of a measured loop.

    Every row has the apparent work of adhesion of a JKR contact of its force and radius. The works
    of adhesion are means over the rows of each branch within one window of contact radii, as those
    of simulations are; the window leaves out what the edge travels before it is steady.

    Parameters
    ----------
    recording : Recording
        Two of force, contact radius and displacement, or all three.
    rig : Rig
        The sphere and the machine.

    Returns
    -------
    MeasuredLoop
        Works of adhesion, modulus and more, with 95% intervals. These hold the noise of the rows
        (one of ten blocks of each branch is left out in turn), the errors of modulus and radius
        that are given or fitted, those of the zeros of force and displacement, and what half of the
        window changes.

    Raises
    ------
    ValueError
        If the branches share too few rows, the loop turns more than once, a column has the wrong
        sign, noise hides the pull-off of a loop without radii, or no modulus is given and none can
        be fitted.
    """
    recording, zero_errors, remarks = _with_zero_force(recording)
    _refuse_wrong_sign(recording)
    branches = _branches(recording)
    is_fitted = recording.force is not None and recording.radius is not None
    if rig.contact_modulus is None and not is_fitted:
        raise ValueError(
            "without a contact radius and a force in each row no modulus is fitted; give --modulus"
        )
    # A force of the wrong sign is refused here, where the modulus is given, too.
    fit = _fit(recording, rig, branches) if is_fitted else math.nan
    known, fitted = rig.contact_modulus or fit, _NO_ESTIMATE
    zero = _zero_displacement(recording, rig, known, branches)
    touching = branches
    first, branches, averaged, window = _placed(recording, rig, known, zero, branches)
    if zero != 0.0:
        # What precedes the steady parts has no part in the zero.
        zero = _zero_displacement(recording, rig, known, averaged, near=zero)
        first, branches, averaged, window = _placed(recording, rig, known, zero, branches)
        remarks.append(
            "The zero of the displacement was fitted, with one work of adhesion for each branch. "
            "Its drift is not known, and no interval includes it."
        )
    remarks += _size_remark(first.radius, rig)

    def found(rows: Branches, rig: Rig, recording: Recording = recording) -> Array:
        """Both works, the hysteresis and the modulus from some rows of each branch."""
        modulus = rig.contact_modulus or _fit(recording, rig, rows)
        place = _zero_displacement(recording, rig, modulus, rows, near=zero)
        appr, retr = _means(_contact(recording, rig, modulus, place), rows)
        return np.array([appr, retr, retr - appr, modulus])

    shifted = [replace(recording, force=np.asarray(recording.force) + one) for one in zero_errors]
    alone: list[Array] = []
    if zero != 0.0:
        # A true trend of either branch moves the zero; one branch alone says by how much.
        alone += [_by_zero_of_one(recording, rig, known, zero, averaged, one) for one in averaged]
    estimates = _estimates(found, averaged, first.radius, rig, shifted, alone)
    _refuse_no_interval(estimates[:3])
    if is_fitted:
        free = Rig(rig.radius, None, 0.0, rig.radius_error)
        fitted = _estimates(found, averaged, first.radius, free, shifted)[3]
    lost, lost_remark = _lost_energy(recording, first, branches)
    direction = np.zeros(first.radius.size)
    for sign, rows in zip((1, -1), branches, strict=True):
        direction[rows] = sign
    inside = np.zeros(first.radius.size, bool)
    inside[np.concatenate(averaged)] = True
    remarks += [lost_remark] if lost_remark else []
    if estimates[2].high < 0:
        remarks.append(
            "The hysteresis is negative, as in a loop whose rows are not in the order of time: "
            "check the order and the sign of the columns."
        )
    if math.isfinite(fitted.low) and rig.contact_modulus is not None:
        remarks += _modulus_remark(rig, fitted)
    if rig.stiffness is not None and (is_fitted or recording.displacement is None):
        remarks.append(
            "The given stiffness of the machine has no part in the works of adhesion: they follow "
            "from force and contact radius."
        )
    _refuse_no_adhesion(estimates[1].value)
    remarks += _stiff_remark(recording, rig)
    errors = zero_errors
    if recording.force is None:
        # Forces that follow from radii err as their work of adhesion does.
        errors = [first.force * (estimates[1].standard_error / estimates[1].value)]
    pull_off, noise = _pull_off(first.force, branches[1], errors)
    if recording.radius is None:
        _refuse_hidden(pull_off.value, noise)
        in_contact = np.concatenate(touching)
        measured = in_contact[np.isfinite((first.force + first.penetration)[in_contact])]
        if rig.window is None:
            _refuse_lost_rows(first.work[measured])
    remarks += _pull_off_remark(rig, pull_off, estimates[1].value, lost)
    return MeasuredLoop(
        force=first.force,
        contact_radius=first.radius,
        work_of_adhesion=first.work,
        direction=direction,
        in_window=inside,
        w_appr=estimates[0],
        w_retr=estimates[1],
        hysteresis=estimates[2],
        contact_modulus=estimates[3],
        fitted_modulus=fitted,
        stiffness=_stiffness(recording, rig, estimates[3], averaged),
        lost_energy=lost,
        pull_off_force=pull_off,
        sphere_radius=rig.radius,
        window=window,
        remarks=tuple(remarks),
    )


@dataclass(frozen=True, slots=True)
class _Contact:
    """The contact of each row, in SI units."""

    force: Array
    radius: Array
    penetration: Array
    work: Array


def _contact(recording: Recording, rig: Rig, modulus: float, zero: float = 0.0) -> _Contact:
    """Force, radius, penetration and apparent work of adhesion of each row.

    The zero is the displacement of no penetration, where force or radius is not recorded.
    """
    # Works of adhesion in units of 1 J/m^2.
    scales = Scales(rig.radius, 1.0, modulus)
    force, radius = recording.force, recording.radius
    if force is not None and radius is not None:
        force_, radius_ = force / scales.force, _touching(radius) / scales.lateral
        penetration = penetration_at(radius_, force_)
    else:
        displacement = recording.displacement
        if displacement is None:
            raise ValueError("a loop needs two of force, radius and displacement")
        moved = (displacement - zero) / scales.vertical
        soft = 0.0 if rig.stiffness is None else scales.force / (rig.stiffness * scales.vertical)
        if force is not None:
            force_ = force / scales.force
            penetration = moved - soft * force_
            radius_ = radius_at(force_, penetration)
        else:
            radius_ = _touching(np.asarray(radius)) / scales.lateral
            # The force of the penetration b is a^3 + 3/2 a (b - a^2), and bends the machine.
            force_ = jkr.force(radius_, moved) / (1 + 1.5 * soft * radius_)
            penetration = moved - soft * force_
    with np.errstate(divide="ignore", invalid="ignore"):
        work = jkr.apparent_work_of_adhesion(radius_, penetration)
    return _Contact(
        force_ * scales.force, radius_ * scales.lateral, penetration * scales.vertical, work
    )


def _zero_displacement(
    recording: Recording,
    rig: Rig,
    modulus: float,
    branches: Sequence[Rows],
    near: float | None = None,
) -> float:
    """Displacement of no penetration, at which JKR curves of one work a branch fit best.

    It is looked for near a known one, or anywhere. 0 where force and radius are recorded, which
    need none.
    """
    displacement, force, radius = recording.displacement, recording.force, recording.radius
    if displacement is None or (force is not None and radius is not None):
        return 0.0
    if radius is not None:
        return _zero_by_radius(displacement, radius, rig, modulus, branches)
    scales = Scales(rig.radius, 1.0, modulus)
    # Rows out of contact may be many more, and have no part in it.
    parts = [Recording(np.asarray(force)[rows], None, displacement[rows]) for rows in branches]
    spread = [float(np.nanvar(np.asarray(part.force))) for part in parts]

    def misfit(zero: float) -> float:
        """Variance of the force that the curves leave, over that of the force."""
        total = 0.0
        for part, variance in zip(parts, spread, strict=True):
            contact = _contact(part, rig, modulus, zero)
            known = contact.work[np.isfinite(contact.work)]
            if known.size < FEWEST_STATES:
                return _NO_FIT
            curve = force_at(contact.penetration / scales.vertical, float(np.mean(known)))
            apart = contact.force - scales.force * curve
            total += float(np.nanmean(apart**2)) / max(variance, _TINY)
        return total

    moved = displacement[np.concatenate(branches)]
    low, high = float(np.nanmin(moved)), float(np.nanmax(moved))
    if near is None:
        grid = np.linspace(low - (high - low), high + (high - low), _ZEROS)
        near = float(grid[np.argmin([misfit(zero) for zero in grid])])
    step = 3 * (high - low) / (_ZEROS - 1)
    around = near - step, near + step
    tight = {"xatol": 1e-7 * (high - low)}
    return float(
        scipy.optimize.minimize_scalar(misfit, bounds=around, method="bounded", options=tight).x
    )


def _zero_by_radius(
    displacement: Array, radius: Array, rig: Rig, modulus: float, branches: Sequence[Rows]
) -> float:
    """Displacement of no penetration from contact radii.

    The displacement is linear in it and in the root of the work of adhesion of each branch, also
    with what bends in the machine: b = a^2 - sqrt(8 w a / 3) and F = a^3 - sqrt(6 w a^3).
    """
    scales = Scales(rig.radius, 1.0, modulus)
    soft = 0.0 if rig.stiffness is None else scales.force / (rig.stiffness * scales.vertical)
    rows = np.concatenate(branches)
    a, moved = radius[rows] / scales.lateral, displacement[rows] / scales.vertical
    number = np.repeat(np.arange(len(branches)), [one.size for one in branches])
    pulled = np.sqrt(8 * a / 3) + soft * np.sqrt(6 * a**3)
    columns = [np.ones(a.size), *(-pulled * (number == one) for one in range(len(branches)))]
    known = np.isfinite(moved) & (a > 0)
    matrix = np.stack(columns, axis=1)[known]
    found, *_ = np.linalg.lstsq(matrix, (moved - a**2 - soft * a**3)[known], rcond=None)
    return float(found[0]) * scales.vertical


def _touching(radius: Array) -> Array:
    """Contact radii, NaN out of contact."""
    return np.where(radius > 0, radius, np.nan)


def _with_zero_force(recording: Recording) -> tuple[Recording, list[Array], list[str]]:
    """Recording with its zero force subtracted, errors of this zero, and a remark on it.

    A line through the rows before and after the contact, or their mean on one side alone.
    """
    force, touches = recording.force, _touches(recording)
    if force is None:
        return recording, [], []
    rows, touching = _usual_rows(force), np.flatnonzero(touches)
    rows = rows[~touches[rows]]
    sides = [rows[rows < touching[0]], rows[rows > touching[-1]]]
    enough = [side.size >= _FEWEST_BASELINE for side in sides]
    if not any(enough):
        return (
            recording,
            [],
            ["The zero of the force is that of the file, as no rows are out of contact."],
        )
    order = 1 if all(enough) else 0
    chosen = np.concatenate([side for side, use in zip(sides, enough, strict=True) if use])
    line, covariance = np.polyfit(chosen / force.size, force[chosen], order, cov=True)
    powers = np.vander(np.arange(force.size) / force.size, order + 1)
    zero = powers @ line
    # Independent errors of the line, each of one standard error; a baseline may have no noise.
    squares, directions = np.linalg.eigh(covariance)
    errors = list((powers @ (directions * np.sqrt(np.maximum(squares, 0.0)))).T)
    if order == 1:
        errors += _bend(chosen / force.size, force[chosen], powers)
    largest = prefixed("N", float(np.max(np.abs(zero[touching]))))
    kind = "a drift and a zero" if order else "a zero"
    sentence = f"{chosen.size} rows out of contact give {kind} of the force, up to {largest}."
    if not order:
        sentence += " Its drift is unknown, as no rows are out of contact on the other side."
    return replace(recording, force=force - zero), errors, [sentence]


def _bend(place: Array, force: Array, powers: Array) -> list[Array]:
    """Error of a line of the force at all rows, where a parabola fits it significantly better."""
    bent, covariance = np.polyfit(place, force, 2, cov=True)
    if abs(bent[0]) <= _SIGMAS * math.sqrt(max(covariance[0, 0], 0.0)):
        return []
    time = powers[:, 0]
    return [np.polyval(bent, time) - np.polyval(np.polyfit(place, force, 1), time)]


def _touches(recording: Recording) -> NDArray[np.bool_]:
    """Whether each row is in contact: its radius is positive, or, without radii, a force acts.

    A force acts from the first to the last row that departs from the line of the rows before or
    after it.
    """
    if recording.radius is not None:
        touches = recording.radius > 0
    else:
        force, moved = np.array(recording.force), np.asarray(recording.displacement)
        known = _usual_rows(force)
        known = known[np.isfinite(moved[known])]
        touches = np.zeros(force.size, bool)
        turn = int(np.argmax(moved[known])) if known.size else 0
        after = _rows_apart(recording, force, known[turn:][::-1])
        if after >= _FEWEST_BASELINE:
            # The drift after the contact is also that before it.
            last = known[-after:]
            force -= np.polyfit(last, force[last], 1)[0] * np.arange(force.size)
        before = _rows_apart(recording, force, known[: turn + 1])
        inside = known[before : known.size - after]
        if inside.size and np.ptp(force[known]) > 0:
            last = inside[-1]
            # The last row before a sharp pull-off is far from those around it, as a spike is.
            if last + 1 < force.size and force[last + 1] < force[last]:
                last += 0 if np.isin(last + 1, known) else 1
            touches[inside[0] : last + 1] = True
    if not np.any(touches):
        raise ValueError(
            "no row is in contact: no contact radius is above zero, or no force beyond its noise; "
            "check the columns"
        )
    return touches


def _usual_rows(force: Array) -> Rows:
    """Rows with a force that is no spike: not far from the median of five rows around it."""
    rows = np.flatnonzero(np.isfinite(force))
    apart = np.abs(force[rows] - scipy.ndimage.median_filter(force[rows], 5, mode="nearest"))
    # Rows of a smooth rise are medians themselves, and say nothing of the noise.
    noisy = apart[apart > 0]
    return rows[apart <= _SPIKE * np.median(noisy)] if noisy.size else rows


def _largest_pull(force: Array) -> float:
    """Largest force below the line from the first to the last rows."""
    if force.size < 2 * _FEWEST_BASELINE:
        return 0.0
    ends = np.median(force[:_FEWEST_BASELINE]), np.median(force[-_FEWEST_BASELINE:])
    return float(max(np.max(np.linspace(*ends, force.size) - force), 0.0))


def _rows_apart(recording: Recording, force: Array, rows: Rows) -> int:
    """Number of the first of some rows, in time or against it, that are out of contact.

    They end where rows depart from the line of those before them by a pulling force, with which
    contact begins and ends. Rows before the turn that depart by a pushing force alone were out of
    contact, too, if their force does not change with the displacement as in a contact: noise hides
    the jump into contact.
    """
    if rows.size < 2 * _FEWEST_BASELINE:
        return 0
    values = force[rows] - force[rows[0]]
    usual = force[_usual_rows(force)]
    departure = _departures(values, _LEAST_PULL * _largest_pull(usual), _row_noise(usual))
    pulled, pushed = (_first_two(sign * departure > 1) for sign in (-1, 1))
    if pulled is not None:
        return pulled
    first = rows.size if pushed is None else pushed
    if rows[0] > rows[-1] or _is_contact(recording, force, rows, first):
        return 0
    # The force rises slowly from where it became positive.
    others = np.flatnonzero(departure[:first] < 0)
    return int(others[-1]) + 1 if others.size and pushed is not None else first


def _row_noise(force: Array) -> float:
    """Noise of the rows, of those fifth whose second differences are smallest.

    These have 6 times its variance; a fifth of squares of normal numbers is below 0.0642.
    """
    return math.sqrt(float(np.quantile(np.diff(force, 2) ** 2, 0.2)) / (6 * 0.0642))


def _first_two(found: NDArray[np.bool_]) -> int | None:
    """Place of the first two entries after each other that are true; a single one is a spike."""
    both = np.flatnonzero(found[:-1] & found[1:])
    return int(both[0]) if both.size else None


def _departures(force: Array, least: float, noise: float) -> Array:
    """Distance of each row from the line of the first two thirds of those before it.

    It is over what their scatter explains, or a known noise if that is less, and over a least
    force. 0 for the first rows, from which no line is found.
    """
    sums = np.zeros((5, force.size + 1))
    place = np.arange(force.size, dtype=float)
    sums[:, 1:] = np.cumsum([place, place**2, force, place * force, force**2], axis=1)
    x, y = place[_FEWEST_BASELINE:], force[_FEWEST_BASELINE:]
    number = np.maximum(2 * x // 3, _FEWEST_BASELINE)
    mean_x, square_x, mean_y, product, square_y = sums[:, number.astype(int)] / number
    spread = square_x - mean_x**2
    slope = (product - mean_x * mean_y) / spread
    left = np.maximum(square_y - mean_y**2 - slope**2 * spread, 0.0) * number / (number - 2)
    likely = np.minimum(stdtrit(number - 2, 1 - _UNLIKELY) * np.sqrt(left), _SIGMAS * noise)
    likely *= np.sqrt(1 + (1 + (x - mean_x) ** 2 / spread) / number)
    apart = (y - mean_y - slope * (x - mean_x)) / np.maximum(np.maximum(likely, least), _TINY)
    return np.concatenate([np.zeros(_FEWEST_BASELINE), apart])


def _is_contact(recording: Recording, force: Array, rows: Rows, count: int) -> bool:
    """Whether the force of the first of some rows changes with the displacement as in a contact.

    The slope must be steep in the first half of them, and go on in the other: the last rows of
    those out of contact may be in contact without a sign of it.
    """
    moved = np.asarray(recording.displacement)
    stiffness = np.nanmax(force) - np.nanmin(force)
    stiffness /= np.nanmax(moved) - np.nanmin(moved)
    slopes = []
    half = max(count // 2, _FEWEST_BASELINE)
    for chosen, certainty in ((rows[:half], 0.99), (rows[: 2 * half], _CERTAIN)):
        x, y = moved[chosen], force[chosen]
        x, y = x[np.isfinite(x)], y[np.isfinite(x)]
        if x.size < _FEWEST_BASELINE or np.ptp(x) == 0:
            return False
        (slope, _), covariance = np.polyfit(x - x[0], y, 1, cov=True)
        errors = float(stdtrit(x.size - 2, certainty)) * math.sqrt(covariance[0, 0])
        slopes.append(slope if abs(slope) > errors else 0.0)
    return bool(abs(slopes[0]) > _STEEP * stiffness and slopes[0] * slopes[1] > 0)


def _refuse_wrong_sign(recording: Recording) -> None:
    """Raise if the force pulls where the sphere is pushed furthest into the surface."""
    force, moved = recording.force, recording.displacement
    if force is None or moved is None or not np.any(np.isfinite(force + moved)):
        return
    turn = int(np.nanargmax(np.where(np.isfinite(force), moved, np.nan)))
    if force[turn] < min(0.5 * np.nanmin(force), 0.0):
        raise ValueError(
            f"the force is {prefixed('N', float(force[turn]))} at the largest displacement, and "
            "has the wrong sign there; displacement and force are positive where they press"
        )


def _branches(recording: Recording) -> Branches:
    """Rows of approach and of retraction: before and after the largest displacement, or force."""
    driven = recording.displacement if recording.displacement is not None else recording.force
    if driven is None:
        raise ValueError("a loop needs two of force, radius and displacement")
    rows = np.flatnonzero(_touches(recording) & np.isfinite(driven))
    turn = int(np.argmax(driven[rows]))
    branches = rows[: turn + 1], rows[turn:]
    # Jumps are no return: the force changes at a constant displacement, the radius goes on.
    moved = driven if recording.displacement is not None else np.asarray(recording.radius)
    span = float(np.ptp(moved[rows]))
    for sign, one in zip((1, -1), branches, strict=True):
        # The median of five rows is free of their noise.
        way = sign * scipy.ndimage.median_filter(moved[one], 5, mode="nearest")
        if way.size and float(np.max(np.maximum.accumulate(way) - way)) > _RETURN * span:
            raise ValueError(
                "the loop turns more than once, or a column has the wrong sign; displacement and "
                "force are positive where they press. Cut the table to one approach and one "
                "retraction"
            )
    return branches


def _means(contact: _Contact, branches: Branches) -> tuple[float, float]:
    """Works of adhesion of both branches, of the rows whose noise leaves them one."""
    appr, retr = (rows[np.isfinite(contact.work[rows])] for rows in branches)
    return branch_means(contact.work, (appr, retr)) if min(appr.size, retr.size) else _NO_MEANS


def _by_zero_of_one(
    recording: Recording, rig: Rig, modulus: float, zero: float, averaged: Branches, alone: Rows
) -> Array:
    """Both works, hysteresis and modulus with the zero of the displacement that one branch has.

    Where both branches have no works there, it is that which the branch has near a zero of both.
    """
    found = np.full(4, math.nan)
    for near in (None, zero):
        if not np.all(np.isfinite(found)):
            place = _zero_displacement(recording, rig, modulus, [alone], near=near)
            appr, retr = _means(_contact(recording, rig, modulus, place), averaged)
            found = np.array([appr, retr, retr - appr, modulus])
    return found


def _placed(
    recording: Recording, rig: Rig, modulus: float, zero: float, branches: Branches
) -> tuple[_Contact, Branches, Branches, tuple[float, float]]:
    """Contact of each row at a zero of the displacement, both branches, and what is averaged."""
    contact = _contact(recording, rig, modulus, zero)
    appr, retr = (rows[np.isfinite(contact.work[rows])] for rows in branches)
    largest = max((np.max(contact.radius[rows]) for rows in (appr, retr) if rows.size), default=0)
    if largest > rig.radius:
        raise ValueError(
            f"the contact radius reaches {prefixed('m', float(largest))} on a sphere of "
            f"{prefixed('m', rig.radius)}; check the units of both"
        )
    return contact, (appr, retr), *_averaged(contact.radius, (appr, retr), rig.window)


def _averaged(
    radius: Array, branches: Branches, window: tuple[float, float] | None
) -> tuple[Branches, tuple[float, float]]:
    """Rows of either branch that are averaged, and their contact radii.

    These are a given window, or what both branches pass when the edge has travelled since each
    began.
    """
    # The row of the turn belongs to both branches.
    if min(rows.size for rows in branches) <= 1:
        raise ValueError("the loop has no approach or no retraction in contact; record both")
    if window is None:
        appr, retr = branches
        largest = max(float(radius[rows].max()) for rows in branches)
        steady = (
            appr[radius[appr] >= radius[appr].min() + _AFTER_JUMP * largest],
            retr[radius[retr] <= radius[retr].max() - _AFTER_TURN * largest],
        )
        if min(rows.size for rows in steady) == 0:
            averaged, window = steady, (math.nan, math.nan)
        else:
            averaged, window = shared_window(radius, steady)
        where = "that both pass after the edge has travelled"
        advice = "retract further, record more rows, check the modulus, or name a --window"
    else:
        averaged = within(radius, branches, window)
        where = "within the window"
        known = radius[np.concatenate(branches)]
        low, high = (prefixed("m", float(end)) for end in (np.min(known), np.max(known)))
        advice = f"choose another one; the radii are {low} to {high}"
    if min(rows.size for rows in averaged) < 2 * FEWEST_STATES:
        counts = " and ".join(str(rows.size) for rows in averaged)
        raise ValueError(
            f"approach and retraction have {counts} rows at contact radii {where}; "
            f"{2 * FEWEST_STATES} each are needed, so {advice}"
        )
    return averaged, window


def _fit(recording: Recording, rig: Rig, branches: Branches) -> float:
    """Contact modulus of the JKR curves, one work of adhesion a branch, that fit the force best.

    The force is linear in E' and in the roots of E' w: F = 4/3 E' a^3 / R - sqrt(8 pi E' w a^3).
    """
    force, radius = recording.force, recording.radius
    if force is None or radius is None:
        raise ValueError("a modulus is fitted to force and contact radius alone")
    rows = np.concatenate(branches)
    a, known = radius[rows], np.isfinite(force[rows]) & (radius[rows] > 0)
    is_approach = np.arange(rows.size) < branches[0].size
    root = -(a**1.5)
    matrix = np.stack([a**3, root * is_approach, root * ~is_approach], axis=1)[known]
    scale = np.max(np.abs(matrix), axis=0)
    found, *_ = np.linalg.lstsq(matrix / scale, force[rows][known], rcond=None)
    modulus = 0.75 * rig.radius * float(found[0] / scale[0])
    if not modulus > 0:
        raise ValueError(
            "no positive modulus fits force and contact radius; the force must be positive where "
            "it pushes, so check its sign"
        )
    return modulus


_NO_ESTIMATE = Estimate(math.nan, math.nan, math.nan, math.nan)


def _estimates(
    found: Callable[..., Array],
    averaged: Branches,
    radius: Array,
    rig: Rig,
    shifted: Iterable[Recording],
    apart: Iterable[Array] = (),
) -> list[Estimate[float]]:
    """Estimates, with 95% intervals, of numbers that a function finds from rows of both branches.

    Each recording of `shifted` has its force shifted by a standard error of the zero. Each entry of
    `apart` has the numbers changed by a standard error of another cause.
    """
    value = found(averaged, rig)
    count = min(_BLOCKS, min(rows.size for rows in averaged) // 2)
    parts = [np.array_split(rows, count) for rows in averaged]
    left_out = np.array(
        [
            found(tuple(np.concatenate(part[:i] + part[i + 1 :]) for part in parts), rig)
            for i in range(count)
        ]
    )
    noise = np.sqrt((count - 1) / count * np.sum((left_out - left_out.mean(axis=0)) ** 2, axis=0))
    others = np.zeros_like(value)
    for recording in shifted:
        others += (found(averaged, rig, recording) - value) ** 2
    for numbers in apart:
        others += (numbers - value) ** 2
    for error, changed in _scene_errors(rig):
        others += (error * (found(averaged, changed) - value) / 1e-4) ** 2
    middle = float(np.median(radius[np.concatenate(averaged)]))
    halves = within(radius, averaged, (0.0, middle)), within(radius, averaged, (middle, math.inf))
    if min(rows.size for half in halves for rows in half) >= FEWEST_STATES:
        low, high = (found(half, rig) for half in halves)
        # A trend along the window, beyond what noise makes of two halves.
        others += np.maximum(((high - low) / 2) ** 2 - noise**2, 0.0)
    reach = np.sqrt((float(stdtrit(count - 1, 0.975)) * noise) ** 2 + REACH**2 * others)
    error = np.sqrt(noise**2 + others)
    return [
        Estimate(float(one), float(sigma), float(one - half), float(one + half))
        for one, sigma, half in zip(value, error, reach, strict=True)
    ]


def _scene_errors(rig: Rig) -> Iterator[tuple[float, Rig]]:
    """Relative standard errors of the scene, each with the scene that is larger by 1e-4."""
    more = 1 + 1e-4
    if rig.contact_modulus is not None and rig.modulus_error > 0:
        modulus = rig.contact_modulus * more
        yield rig.modulus_error, Rig(rig.radius, modulus, stiffness=rig.stiffness)
    if rig.radius_error > 0:
        larger = rig.radius * more
        yield rig.radius_error, Rig(larger, rig.contact_modulus, stiffness=rig.stiffness)


def _refuse_no_adhesion(w_retr: float) -> None:
    """Raise if the work of adhesion of the retraction (Units: J/m^2) is not positive."""
    if w_retr <= 0:
        raise ValueError(
            "the work of adhesion of the retraction is not positive; give --stiffness if the "
            "machine is not far stiffer than the contact, and check the displacement, the modulus "
            "and the radius of the sphere"
        )


def _stiff_remark(recording: Recording, rig: Rig) -> list[str]:
    """A sentence where the displacement of the mount is taken as that of the sphere."""
    is_whole = recording.radius is not None and recording.force is not None
    if rig.stiffness is not None or is_whole:
        return []
    return [
        "The machine is taken as infinitely stiff; give --stiffness unless it is far stiffer than "
        "the contact, 2 E' a."
    ]


def _modulus_remark(rig: Rig, fitted: Estimate[float]) -> list[str]:
    """A sentence where the loop's own modulus departs from the given one."""
    given = rig.contact_modulus or math.nan
    least, most = (given * (1 + sign * REACH * rig.modulus_error) for sign in (-1, 1))
    if least <= fitted.high and most >= fitted.low:
        return []
    shown = prefixed("Pa", fitted.value, fitted.low, fitted.high)
    return [
        f"Force and contact radius fit a contact modulus of {shown}, not {prefixed('Pa', given)}: "
        "leave out --modulus, or check the radius of the sphere and the zero of the force."
    ]


def _pull_off(
    force: Array, retraction: Rows, errors: Iterable[Array]
) -> tuple[Estimate[float], float]:
    """Largest pulling force of the retraction, by parabolas through some rows, and their noise.

    They are as many as a parabola fits within the noise. The interval holds the noise, and some
    errors of the forces of all rows.
    """
    pulled = retraction[np.isfinite(force[retraction])]
    values = force[pulled]
    rough = np.diff(values, 2, prepend=values[:1], append=values[-1:]) ** 2
    width = max(5, values.size // 20 * 2 + 1)
    while True:
        smooth = scipy.signal.savgol_filter(values, width, 2)
        place = int(np.argmin(smooth))
        near = slice(max(place - width, 0), place + width)
        squares = float(np.mean((values - smooth)[near] ** 2)) * width / (width - 3)
        # Second differences of noise have 6 times its variance, and the median of their squares
        # is 0.455 of the mean.
        noise = float(np.median(rough[near])) / (6 * 0.455)
        if width == 5 or squares <= _FITS * noise:
            break
        width = max(5, width // 4 * 2 + 1)
    # A parabola knows its ends to 9 times the variance of the mean, and its lowest place no better.
    variance = 9.0 * squares / width
    variance += sum(float(one[pulled[place]]) ** 2 for one in errors)
    value, reach = -float(smooth[place]), REACH * math.sqrt(variance)
    return Estimate(value, math.sqrt(variance), value - reach, value + reach), math.sqrt(noise)


def _refuse_lost_rows(work: Array) -> None:
    """Raise if many rows in contact have no work of adhesion, of which others are no fair part."""
    lost = float(np.mean(~np.isfinite(work)))
    if lost > _MOST_LOST:
        raise ValueError(
            f"{lost:.0%} of the rows in contact have no work of adhesion, as noise presses more "
            "than the contact of Hertz; check the units, the modulus and --stiffness, average "
            "rows, use a stiffer machine, or record the contact radius"
        )


def _size_remark(radius: Array, rig: Rig) -> list[str]:
    """A sentence where a contact is not small against the sphere."""
    ratio = float(np.nanmax(radius)) / rig.radius
    if ratio <= _LARGE:
        return []
    return [
        f"The contact radius reaches {ratio:.2g} of that of the sphere, whose profile a paraboloid "
        "misses there; the works of adhesion and the modulus are those of a paraboloid."
    ]


def _refuse_no_interval(works: Sequence[Estimate[float]]) -> None:
    """Raise if works of adhesion have no interval."""
    if not all(math.isfinite(one.high) for one in works):
        raise ValueError(
            "the works of adhesion have no interval: the noise of the force, or the error of its "
            "zero, is as large as the adhesion in some rows; check the units and the modulus, "
            "press less, or record the contact radius"
        )


def _refuse_hidden(pull_off: float, noise: float) -> None:
    """Raise if noise hides a pull-off force (Units: N), by which contact is found."""
    if 0 < pull_off < _NOISES * noise:
        raise ValueError(
            f"the pull-off force, {prefixed('N', pull_off)}, is hardly beyond the noise of the "
            f"force, {prefixed('N', noise)}; press less, average rows, or record the contact radius"
        )


def _pull_off_remark(rig: Rig, pull_off: Estimate[float], work: float, lost: float) -> list[str]:
    """A sentence where the pull-off force is not that of the work of adhesion of the retraction.

    A retraction that does not end out of contact, whose lost energy is NaN, may end before it.
    """
    if pull_off.high <= 0:
        return [
            "No force pulls in the retraction: check the zero of the force, the modulus and the "
            "stiffness of the machine."
        ]
    value = 1.5 * math.pi * rig.radius * work
    is_less = value > _APART * pull_off.high and math.isfinite(lost)
    if not (is_less or pull_off.low > _APART * value):
        return []
    return [
        f"A work of adhesion of {prefixed('J/m2', work)} pulls with up to {prefixed('N', value)}, "
        f"and the loop with {prefixed('N', pull_off.value)}: check the units, the modulus, the "
        "radius of the sphere and the stiffness of the machine."
    ]


def _stiffness(
    recording: Recording, rig: Rig, modulus: Estimate[float], averaged: Branches
) -> Estimate[float]:
    """Stiffness of the machine: displacement beyond the penetration that force and radius have."""
    displacement, force = recording.displacement, recording.force
    if displacement is None or force is None or recording.radius is None:
        return _NO_ESTIMATE
    rows = np.concatenate(averaged)

    def compliance(modulus: float, chosen: Rows) -> float:
        bent = displacement - _contact(recording, rig, modulus).penetration
        return float(np.polyfit(force[chosen], bent[chosen], 1)[0])

    value = compliance(modulus.value, rows)
    blocks = np.array_split(rows, _BLOCKS)
    left_out = [
        compliance(modulus.value, np.concatenate(blocks[:i] + blocks[i + 1 :]))
        for i in range(_BLOCKS)
    ]
    noise = math.sqrt((_BLOCKS - 1) * float(np.var(left_out)))
    other = REACH * (compliance(modulus.value + modulus.standard_error, rows) - value)
    reach = math.hypot(float(stdtrit(_BLOCKS - 1, 0.975)) * noise, other)
    low, high = value - reach, value + reach
    if not high > 0:
        return _NO_ESTIMATE
    least, most = 1 / high, 1 / low if low > 0 else math.inf
    return Estimate(1 / value if value > 0 else math.inf, math.nan, least, most)


def _lost_energy(recording: Recording, contact: _Contact, branches: Branches) -> tuple[float, str]:
    """Energy lost in a whole loop per largest contact area, or why it is not known.

    The work of the force along the displacement of the mount: what bends in the machine comes back.
    """
    rows = np.concatenate([branches[0], branches[1][1:]])
    moved = recording.displacement
    if moved is None:
        moved = contact.penetration
    touches = _touches(recording)
    if touches[0] or touches[-1]:
        which = "approach does not begin" if touches[0] else "retraction does not end"
        return math.nan, f"The energy lost is not known: the {which} out of contact."
    # The largest of noisy radii would be too large.
    radius = scipy.ndimage.median_filter(contact.radius[rows], 5, mode="nearest")
    return work_per_area(moved[rows], contact.force[rows], radius), ""


def work_per_area(displacement: Array, force: Array, radius: Array) -> float:
    """Work of the force over all states of a loop, per largest contact area.

    The loop is closed by the jumps, at the displacements of the first and the last contact.
    """
    work = float(np.sum(np.diff(displacement) * (force[1:] + force[:-1]) / 2))
    return work / (math.pi * float(np.max(radius)) ** 2)


_REDUCED_UNITS = {"J/m2": " w_int", "N": " pi w_int R", "Pa": "", "m": ""}
"""What stands behind numbers in reduced units, by the unit of SI."""


def _page(loop: MeasuredLoop) -> Iterator[str]:
    """Lines of what a reader wants first."""

    def text(unit: str, *values: float) -> str:
        if not loop.reduced:
            return prefixed(unit, *values)
        value, *ends = (f"{one:.4g}" for one in values)
        interval = f" ({ends[0]} to {ends[1]})" if ends else ""
        return f"{value}{_REDUCED_UNITS[unit]}{interval}"

    for name, found in (
        ("hysteresis", loop.hysteresis),
        ("w_appr", loop.w_appr),
        ("w_retr", loop.w_retr),
    ):
        yield f"{name:18}{text('J/m2', found.value, found.low, found.high)}"
    pull = loop.pull_off_force
    yield f"{'pull-off force':18}{text('N', pull.value, pull.low, pull.high)}"
    if math.isfinite(loop.lost_energy):
        yield f"{'energy lost':18}{text('J/m2', loop.lost_energy)} of the largest contact area"
    yield f"{'contact modulus':18}{text('Pa', loop.contact_modulus.value)}"
    for name, known, unit in (
        ("modulus by fit", loop.fitted_modulus, "Pa"),
        ("machine", loop.stiffness, "N/m"),
    ):
        if math.isfinite(known.value):
            yield f"{name:18}{text(unit, known.value, known.low, known.high)}"
    low, high = loop.window
    counts = [int(np.sum(loop.in_window & (loop.direction == sign))) for sign in (1, -1)]
    yield (
        f"{'averaged over':18}contact radii of {text('m', low)} to {text('m', high)}: "
        f"{counts[0]} rows of approach, {counts[1]} of retraction"
    )
    yield from loop.remarks
    yield "Intervals are 95% intervals."
