"""The interface of a kind of contact with a user's surface, and how to add a kind.

`run_loop` and `crackfront cycle` run a :class:`LoopContact`. A new kind must provide:

1. A frozen dataclass that derives from :class:`LoopContact`, with the surface and what else
   determines the contact. Its method `setup` raises a ValueError for what the kind cannot do.
2. A frozen dataclass that derives from :class:`LoopSetup`: what `setup` returns, and how the states
   of a run are averaged.
3. A function for users that checks its arguments, such as
   :func:`crackfront.surfaces.straight_front.straight_front`, and its options in
   `cli/cycle_command.py`.
4. If its states have variables of their own, their class in `_LOOP_STATES` of
   `simulate/cycle_files.py`, by which files are read.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from crackfront.analysis.steady_adhesion import SteadyAdhesion
from crackfront.core.arrays import Array
from crackfront.core.bounds import NUMBER, Range, check_within
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.field.fields import TileField
from crackfront.surfaces.tile_measures import TileMeasures


@dataclass(frozen=True, slots=True)
class LoopSetup(ABC):
    """Field, first front and loads of a run, with what is known of it beforehand."""

    field: TileField
    front: Array
    """First front, (n_site,). (Units: reduced lateral length)"""
    loads: Iterable[Load]
    """As of :func:`crackfront.core.cycle.follow.follow`."""
    expected: int
    """States that it will have, roughly."""
    seconds: float
    """Processor time that they will take, roughly."""
    tolerance: float
    """Tolerance of the solver."""
    measures: TileMeasures
    """Measures of the tile."""
    remark: str
    """A reservation about the result, as a sentence; empty if there is none."""

    @abstractmethod
    def steady_adhesion(self, record: CycleRecord) -> SteadyAdhesion:
        """Apparent works of adhesion of both branches, or a sentence that says why not."""

    def numerical_errors(self, steady: SteadyAdhesion) -> tuple[float, float]:
        """Standard errors of w_appr and w_retr by the numerics (Units: w_int); NaN if unknown."""
        return math.nan, math.nan

    def comment_on_energy(self, record: CycleRecord, dissipated: Array) -> str:
        """Which part of the dissipated energies the loads cause, as a sentence, or nothing."""
        return ""


@dataclass(frozen=True, slots=True)
class LoopNumerics:
    """How a run on a user's surface is resolved.

    ValueError if an error is given together with sites or samples.
    """

    error: float | None = None
    """Standard error of the factor k that the numerics may leave, by the laws of its spectrum."""
    sites: int | None = None
    """Sites of the front."""
    samples: float | None = None
    """Samples a pixel along a ray."""
    usual_error: float = 0.03
    """Error where neither is given and the surface states its spectrum."""

    def __post_init__(self) -> None:
        if self.error is not None and self.by_pixels:
            raise ValueError(
                f"error is {self.error:g}, which decides sites and samples; leave these out, "
                "or the error"
            )

    @property
    def by_pixels(self) -> bool:
        """Whether sites or samples are given, so that no law of errors decides them."""
        return self.sites is not None or self.samples is not None


class LoopContact(ABC):
    """A contact of some kind with a user's surface, which `run_loop` and `crackfront cycle` run."""

    @abstractmethod
    def setup(
        self, loads: tuple[float, ...] | None, step: float, numerics: LoopNumerics
    ) -> LoopSetup:
        """What a run begins with.

        If loads is None, a full cycle is run, if the kind has one. The step is the largest
        difference of loads; infinity leaves them as they are.
        """


_SITES_PER_WAVE = 3.0
"""Sites per correlation length of w_loc from which on hysteresis departs by less than a tenth; with
2 it is a third too large, with 1 two to four times, on straight fronts at w_rms 0.6 and 0.8."""


def remark_on_sites(n_site: int, length: float, measures: TileMeasures) -> str:
    """Sentence on a front of a length whose sites are too few for a tile; else empty."""
    density = n_site * measures.correlation_length / length
    if measures.w_rms == 0 or density >= _SITES_PER_WAVE:
        return ""
    needed = math.ceil(_SITES_PER_WAVE * n_site / density)
    return (
        f"the front has {n_site} sites, {density:.2g} per correlation length of w_loc, with which "
        f"the hysteresis comes out too large; use {needed} or more"
    )


_LARGEST_MEAN = 0.05
"""Difference between the mean work of adhesion and the theory, beyond which the stiffness of the
line, which the theory takes at w_int, makes hysteresis wrong. (Units: w_int)"""


def remark_on_mean(measures: TileMeasures) -> str:
    """Sentence on a tile whose mean work of adhesion is not w_int; else empty."""
    expected = 1 - measures.e_el if measures.kind == "roughness" else 1.0
    if abs(measures.mean - expected) <= _LARGEST_MEAN:
        return ""
    return (
        f"the mean work of adhesion is {measures.mean:.3g} w_int, but the line is as stiff as at "
        "w_int, so that the hysteresis is wrong; divide the values by their mean, and take the "
        "mean for the work of adhesion of the sphere"
    )


_SAMPLES_PER_WAVE = 2.0
"""Samples per correlation length of w_loc below which they miss its waves."""


def check_samples(
    numerics: LoopNumerics, pixel: float, measures: TileMeasures, least: float = 0.0
) -> None:
    """Raise if the given samples a pixel miss waves of a tile, or are below the least.

    `pixel` is the grid spacing of the tile. (Units: reduced lateral length)
    """
    waves = 0.0 if measures.w_rms == 0 else _SAMPLES_PER_WAVE * pixel / measures.correlation_length
    needed = math.ceil(1000 * max(waves, least)) / 1000
    if numerics.samples is not None and numerics.samples < needed:
        raise ValueError(
            f"samples is {numerics.samples:g} a pixel along a ray, too few for this surface; use "
            f"{needed:g} or more"
        )


def load_values(loads: Iterable[float | str]) -> tuple[float, ...]:
    """Loads to visit as numbers.

    ValueError if there are none or one is not a number, TypeError if they are not several values.
    """
    if isinstance(loads, str) or not isinstance(loads, Iterable):
        raise TypeError(f"loads is {loads!r}; give the loads to visit, as in [0, 1, 0.5]")
    values = []
    for load in loads:
        try:
            values.append(float(load))
        except (TypeError, ValueError):
            raise ValueError(f"a load is {load!r}; write numbers alone") from None
        check_within("a load", values[-1], Range(-NUMBER.most, NUMBER.most))
    if not values:
        raise ValueError("there are no loads; give one or more")
    return tuple(values)


def state_count(loads: tuple[float, ...], step: float) -> float:
    """About how many loads are visited, with steps between those that are further apart."""
    return len(loads) + sum(abs(end - start) for start, end in pairwise(loads)) / step
