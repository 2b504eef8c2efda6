"""Loads of a full cycle of a sphere, and loads in any order."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from crackfront.core.arguments import check_positive
from crackfront.core.cycle.follow import Load
from crackfront.core.outcome import Direction

DEFAULT_STEP = 0.004
"""Load step that leaves the dissipated energies of a full cycle within 1% of the quasi-static loop.

docs/experiments/hard-cases.md has the measure. (Units: reduced vertical length)
"""


@dataclass(frozen=True, slots=True)
class LoadSchedule:
    """Penetrations 0, step, 2 step ... max, and back until contact is lost.

    Parameters
    ----------
    max_penetration : float
        Largest penetration; it is visited even if it is not a multiple of the step.
        (Units: reduced vertical length)
    step : float
        Difference of penetrations. (Units: reduced vertical length)

    Raises
    ------
    ValueError
        If the step is not positive, or the largest penetration is negative: the sphere makes
        contact at 0.

    Examples
    --------
    >>> list(LoadSchedule(0.5, 0.25).approach())
    [0.0, 0.25, 0.5]
    """

    max_penetration: float
    step: float

    def __post_init__(self) -> None:
        check_positive(step=self.step)
        if not (math.isfinite(self.max_penetration) and self.max_penetration >= 0):
            raise ValueError(
                f"max penetration {self.max_penetration} never makes contact; the sphere touches "
                "at 0, so set it to 0 or more"
            )

    @property
    def _whole_steps(self) -> int:
        """Number of whole steps that fit under the largest penetration."""
        return math.floor(self.max_penetration / self.step * (1 + 1e-12))

    def approach(self) -> Iterator[float]:
        """Penetrations of the approach, increasing."""
        for k in range(self._whole_steps + 1):
            yield k * self.step
        if self._whole_steps * self.step < self.max_penetration * (1 - 1e-12):
            yield self.max_penetration

    def retraction(self) -> Iterator[float]:
        """Penetrations below the largest one, decreasing without end."""
        k = self._whole_steps
        if k * self.step >= self.max_penetration * (1 - 1e-12):
            k -= 1
        while True:
            yield k * self.step
            k -= 1

    def loads(self) -> Iterator[Load]:
        """Penetrations of a whole cycle, without end, each with its direction."""
        yield from (Load(penetration, 1) for penetration in self.approach())
        yield from (Load(penetration, -1) for penetration in self.retraction())


def protocol(loads: Sequence[float], step: float = math.inf) -> Iterator[Load]:
    """Loads in their order, each with its direction; a load given twice in a row is a pause.

    Equal steps lead from a load to the next if they are further apart than a step.

    Raises
    ------
    ValueError
        Without loads, or if the step is not positive.

    Examples
    --------
    >>> [load.value for load in protocol([1.0, 2.0, 0.5], 1.0)]
    [1.0, 2.0, 1.25, 0.5]
    """
    if not step > 0:
        raise ValueError(f"step is {step}; it must be positive")
    if not len(loads):
        raise ValueError("there are no loads; give one or more")
    return _protocol_loads(loads, step)


def _protocol_loads(loads: Sequence[float], step: float) -> Iterator[Load]:
    """Loads of a protocol, one after the other."""
    direction: Direction = 1
    yield Load(float(loads[0]), direction)
    for before, after in pairwise(map(float, loads)):
        direction = direction if after == before else 1 if after > before else -1
        count = max(1, math.ceil(abs(after - before) / step * (1 - 1e-12)))
        for k in range(1, count):
            yield Load(before + (after - before) * (k / count), direction)
        yield Load(after, direction)
