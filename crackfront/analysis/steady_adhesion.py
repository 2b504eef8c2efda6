"""The apparent work of adhesion of approach and of retraction, defined once."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.standard_error import FEWEST_STATES, standard_error
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.base import State
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.variables import ADHESION, LATERAL, variable

Rows = NDArray[np.int64]

Branches = tuple[Rows, Rows]
"""Indices of the states of the approach and of the retraction in a record."""

_ROUND_OFF = 1e-5
"""Relative difference below which two positions are equal. (Units: period of the tile)"""

STEADY_DEFINITION = (
    "w_appr and w_retr are means of the apparent work of adhesion, <a G> / <a> with the mean over "
    "the front, over the steady states of a branch. A state is steady if every site of the front "
    "has travelled at least one correlation length of w_loc since the branch began; this leaves "
    "out the start and the transient after reversal. An approach begins at first contact, so that "
    "the jump into contact counts as travel. Both branches are averaged over the same window of "
    "mean radii, the overlap of the ranges of their steady states. Under loads that turn several "
    "times a branch is a part of the loop without a turn. All states of the load schedule in the "
    f"window have equal weight; each branch needs at least {FEWEST_STATES}. An experimenter's "
    "estimate is the work of adhesion of the JKR curve F = a^3 - sqrt(6 w a^3) (reduced units) "
    "that fits force against mean radius best, by least squares of the force over the same states. "
    "Standard errors are errors of the means over the states of one realisation. States count as "
    "independent if they are at least one distance d apart; d is the correlation length of w_loc "
    "or three times the rms deviation of the front from its mean radius, whichever is larger. The "
    "standard error of the hysteresis of a sphere comes from the differences between each state of "
    "the approach and the state of the retraction with the closest mean radius: variations that "
    "both branches share do not add to it."
)
"""What `w_appr` and `w_retr` mean; an attribute of every file with these variables."""


@dataclass(frozen=True)
class SteadyMeasures:
    """Apparent work of adhesion of the two branches, as :data:`STEADY_DEFINITION` says.

    NaN for a record without a steady window.
    """

    w_appr: float = variable("apparent work of adhesion in steady approach", ADHESION)
    w_retr: float = variable("apparent work of adhesion in steady retraction", ADHESION)
    w_appr_error: float = variable("standard error of w_appr over its states", ADHESION)
    w_retr_error: float = variable("standard error of w_retr over its states", ADHESION)
    hysteresis: float = variable("w_retr - w_appr", ADHESION)
    hysteresis_error: float = variable("standard error of w_retr - w_appr", ADHESION)
    midpoint: float = variable("(w_retr + w_appr) / 2", ADHESION)
    w_appr_from_force: float = variable("w of the JKR curve fitted to the approach", ADHESION)
    w_retr_from_force: float = variable("w of the JKR curve fitted to the retraction", ADHESION)
    hysteresis_from_force: float = variable("difference of the two JKR curves' w", ADHESION)
    n_approach: int = variable("states that w_appr averages", "1")
    n_retraction: int = variable("states that w_retr averages", "1")
    lowest_radius: float = variable("smallest mean radius of the steady window", LATERAL)
    highest_radius: float = variable("largest mean radius of the steady window", LATERAL)
    front_rms: float = variable("rms deviation of the steady front from its mean", LATERAL)


@dataclass(frozen=True)
class SteadyAdhesion(SteadyMeasures):
    """The measures of one record, and a sentence that says why they are NaN, else empty."""

    sentence: str = ""
    averaged: Branches | None = field(default=None, compare=False)
    """States that they average; None without a value."""


DEEPER = "penetrate deeper or use a smaller load step"
"""What gives a sphere more steady states, if its loads are steps."""

_FURTHER = "load further or use a smaller load step"
"""What gives a straight front more steady states."""


def steady_adhesion(
    record: CycleRecord, correlation_length: float, remedy: str = DEEPER
) -> SteadyAdhesion:
    """Mean apparent work of adhesion over the steady part of each branch of a sphere.

    A branch is steady once every site has travelled the correlation length of w_loc (Units:
    reduced lateral length). The remedy says what gives more steady states if there are too few.
    """
    states, radius = record.states, record.states.mean_radius
    branches, window, sentence = steady_branches(
        states, radius, "radii", correlation_length, remedy=remedy
    )
    if sentence:
        return _no_value(branches, sentence)
    lowest_radius, highest_radius = window
    from_force = [_adhesion_from_force(radius[branch], states.force[branch]) for branch in branches]
    columns = states.apparent_work_of_adhesion, radius, states.rms_radius
    return replace(
        _measures(columns, branches, correlation_length, from_force),
        hysteresis_error=_error_of_difference(states, branches, correlation_length),
        lowest_radius=lowest_radius,
        highest_radius=highest_radius,
    )


class SteadyStates(NamedTuple):
    """Steady states of both branches."""

    branches: Branches
    """States at the positions that both branches share; all of them if one branch has too few."""
    window: tuple[float, float]
    """Ends of the range of these positions; NaN if a branch has too few states."""
    sentence: str
    """Why there are too few states; else empty."""


def steady_branches(
    states: State,
    place: Array,
    name: str,
    correlation_length: float,
    period: float = math.inf,
    remedy: str = _FURTHER,
) -> SteadyStates:
    """Steady states of both branches at the positions that they share.

    `place` has the position of each state, `name` its name in the plural. If the load turns several
    times, a branch is one passage without a turn: the pair of passages that share the most states.
    """
    needed = f"{FEWEST_STATES} each are needed, so {remedy}"
    approach, retraction = _passages_with_most_states(states, place, correlation_length, period)
    if min(approach.size, retraction.size) < FEWEST_STATES:
        counts = f"{approach.size} steady states in approach and {retraction.size} in retraction"
        return SteadyStates((approach, retraction), (math.nan, math.nan), f"{counts}; {needed}")
    branches, window = shared_window(place, (approach, retraction), period)
    approach, retraction = branches
    if min(approach.size, retraction.size) < FEWEST_STATES:
        counts = f"{approach.size} states of approach and {retraction.size} of retraction"
        sentence = f"the steady branches share {counts} at equal mean {name}; {needed}"
        return SteadyStates(branches, window, sentence)
    return SteadyStates(branches, window, "")


def _passages_with_most_states(
    states: State, place: Array, correlation_length: float, period: float
) -> Branches:
    """Steady states of the passage forward and the passage back that share the most states."""
    steady = states.least_travel >= correlation_length
    forward = _passages(np.flatnonzero(steady & (states.direction > 0)))
    back = _passages(np.flatnonzero(steady & (states.direction < 0)))
    pairs: list[Branches] = list(itertools.product(forward, back))
    if len(pairs) == 1:  # its passages may be empty
        return pairs[0]

    def n_shared(pair: Branches) -> int:
        (approach, retraction), _ = shared_window(place, pair, period)
        return min(approach.size, retraction.size)

    return max(pairs, key=n_shared)


def _passages(states: Rows) -> list[Rows]:
    """Split the states of one direction at every turn of the load."""
    return np.split(states, np.flatnonzero(np.diff(states) > 1) + 1)


def shared_window(
    place: Array, steady: Branches, period: float = math.inf
) -> tuple[Branches, tuple[float, float]]:
    """States of both branches in the overlap of their steady ranges, and the ends of the overlap.

    Parameters
    ----------
    place : (n_state,) array
        Mean radius or position of the front. (Units: length)
    steady : two arrays of int
        Steady states of approach and of retraction, one or more each.
    period : float, optional
        Largest width of the overlap, which is cut at smaller positions. (Units: as `place`)
    """
    highest = float(min(place[branch].max() for branch in steady))
    lowest = float(max(place[branch].min() for branch in steady))
    # At most one period, so that each position of the tile counts once.
    lowest = max(lowest, highest - (1 - _ROUND_OFF) * period)
    return within(place, steady, (lowest, highest)), (lowest, highest)


def within(place: Array, branches: Branches, window: tuple[float, float]) -> Branches:
    """States of both branches at positions in a window, its ends included."""
    inside = (place >= window[0]) & (place <= window[1])
    approach, retraction = branches
    return approach[inside[approach]], retraction[inside[retraction]]


def branch_means(values: Array, branches: Branches) -> tuple[float, float]:
    """Means over the states of both branches, with equal weights."""
    approach, retraction = branches
    return float(np.mean(values[approach])), float(np.mean(values[retraction]))


def passing_adhesion(
    record: CycleRecord, correlation_length: float, mean: float, period: float
) -> SteadyAdhesion:
    """As :func:`steady_adhesion`, for a straight front under any loads and over at most a period.

    The mean of w_loc is in w_int; the period is the side of the tile along the motion.
    """
    states = record.states
    columns = mean - states.pinning_force, states.mean_position, states.rms_position
    return steady_means(states, columns, "places", correlation_length, period)


def steady_means(
    states: State,
    columns: tuple[Array, Array, Array],
    name: str,
    correlation_length: float,
    period: float = math.inf,
) -> SteadyAdhesion:
    """Mean apparent work of adhesion over the steady states of both branches at equal places.

    Parameters
    ----------
    states : State
        States of any kind of contact.
    columns : three (n_state,) arrays
        Apparent work of adhesion (Units: w_int), mean place of the front, and rms deviation from
        it. (Units: length)
    name : str
        Plural noun of the places, for the sentence.
    correlation_length : float
        Travel of every site after which a state is steady. (Units: length)
    period : float, optional
        Largest range of places. (Units: length)

    Returns
    -------
    SteadyAdhesion
        NaN and a sentence if there are too few steady states.
    """
    branches, _, sentence = steady_branches(states, columns[1], name, correlation_length, period)
    if sentence:
        return _no_value(branches, sentence)
    return _measures(columns, branches, correlation_length)


def period_adhesion(
    record: CycleRecord, n_period: int, mean: float, correlation_length: float
) -> SteadyAdhesion:
    """Mean apparent work of adhesion of a straight front over one period of its tile.

    The last `n_period` states forward and back are a period. The mean of w_loc is in w_int, its
    correlation length in reduced lateral lengths.
    """
    states = record.states
    approach = np.flatnonzero(states.direction > 0)[-n_period:]
    retraction = np.flatnonzero(states.direction < 0)[-n_period:]
    branches = approach, retraction
    if min(approach.size, retraction.size) < n_period:
        counts = approach.size, retraction.size
        return _no_value(branches, f"the front was left before it had passed the tile: {counts}")
    columns = mean - states.pinning_force, states.mean_position, states.rms_position
    return _measures(columns, branches, correlation_length)


def _measures(
    columns: tuple[Array, Array, Array],
    branches: Branches,
    correlation_length: float,
    from_force: Sequence[float] | None = None,
) -> SteadyAdhesion:
    """Measures of a record from the states of both branches.

    The columns are work of adhesion, position and rms roughness of all states.
    """
    values, place, roughness = columns
    works = branch_means(values, branches)
    errors = [
        standard_error(values[branch], place[branch], roughness[branch], correlation_length)
        for branch in branches
    ]
    w_appr, w_retr = works
    w_appr_error, w_retr_error = errors
    # The force of a straight front's springs gives the same works of adhesion.
    w_appr_from_force, w_retr_from_force = from_force or works
    approach, retraction = branches
    return SteadyAdhesion(
        w_appr=w_appr,
        w_retr=w_retr,
        w_appr_error=w_appr_error,
        w_retr_error=w_retr_error,
        hysteresis=w_retr - w_appr,
        hysteresis_error=math.hypot(w_appr_error, w_retr_error),
        midpoint=(w_retr + w_appr) / 2,
        w_appr_from_force=w_appr_from_force,
        w_retr_from_force=w_retr_from_force,
        hysteresis_from_force=w_retr_from_force - w_appr_from_force,
        n_approach=approach.size,
        n_retraction=retraction.size,
        lowest_radius=math.nan,
        highest_radius=math.nan,
        front_rms=float(np.mean(roughness[np.concatenate(branches)])),
        averaged=branches,
    )


def _error_of_difference(
    states: ContactState[Array], branches: Branches, correlation_length: float
) -> float:
    """Standard error of the hysteresis, from differences of states at the closest radii."""
    approach, retraction = branches
    radius = states.mean_radius[approach]
    distances = np.abs(radius[:, np.newaxis] - states.mean_radius[retraction])
    closest = retraction[np.argmin(distances, axis=1)]
    works = states.apparent_work_of_adhesion
    differences = works[closest] - works[approach]
    return standard_error(differences, radius, states.rms_radius[approach], correlation_length)


def _adhesion_from_force(radius: Array, force: Array) -> float:
    """Work of adhesion of the JKR curve that fits best; the force is linear in its root."""
    repulsion = jkr.equilibrium_force(radius, 0.0)
    attraction = repulsion - jkr.equilibrium_force(radius, 1.0)
    root = np.sum((repulsion - force) * attraction) / np.sum(attraction**2)
    return float(root**2)


def _no_value(branches: Branches, sentence: str) -> SteadyAdhesion:
    """Measures that are NaN but for the numbers of states, with a sentence that says why."""
    approach, retraction = branches
    return SteadyAdhesion(
        w_appr=math.nan,
        w_retr=math.nan,
        w_appr_error=math.nan,
        w_retr_error=math.nan,
        hysteresis=math.nan,
        hysteresis_error=math.nan,
        midpoint=math.nan,
        w_appr_from_force=math.nan,
        w_retr_from_force=math.nan,
        hysteresis_from_force=math.nan,
        n_approach=approach.size,
        n_retraction=retraction.size,
        lowest_radius=math.nan,
        highest_radius=math.nan,
        front_rms=math.nan,
        sentence=sentence,
    )
