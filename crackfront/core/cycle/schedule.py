"""The loads of a cycle, in order."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from crackfront.core.cycle.follow import Load

DEFAULT_STEP = 0.004
"""Load step that leaves the dissipated energies of a full cycle within 1% of the quasi-static loop.

docs/hard-cases.md has the measure. (Units: reduced vertical length)
"""


@dataclass(frozen=True, slots=True)
class LoadSchedule:
    """Penetrations 0, step, 2 step ... max, and back until contact is lost.

    Parameters
    ----------
    max_penetration : float
        Largest penetration; it is visited even where it is no multiple of the step.
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
        if not (math.isfinite(self.step) and self.step > 0):
            raise ValueError(f"load step is {self.step}; it must be positive")
        if not (math.isfinite(self.max_penetration) and self.max_penetration >= 0):
            raise ValueError(
                f"max penetration {self.max_penetration} never makes contact; the sphere touches "
                "at 0, so ask for 0 or more"
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


def there_and_back(first: float, last: float, step: float) -> list[Load]:
    """Loads from one to a higher one, and back to the first.

    Parameters
    ----------
    first, last : float
        The two ends; the last is visited even where it is no whole number of steps away.
    step : float
        Difference of loads.

    Raises
    ------
    ValueError
        If the step is not positive, or the ends are not in order.

    Examples
    --------
    >>> [load.value for load in there_and_back(1.0, 3.5, 1.0)]
    [1.0, 2.0, 3.0, 3.5, 3.0, 2.0, 1.0]
    """
    if not -math.inf < first < last < math.inf:
        raise ValueError(
            f"loads go from {first} to {last}; the second must be above the first, both finite"
        )
    way = [first + load for load in LoadSchedule(last - first, step).approach()]
    return [*(Load(load, 1) for load in way), *(Load(load, -1) for load in way[-2::-1])]


def loads(schedule: LoadSchedule) -> Iterator[Load]:
    """Penetrations of a whole cycle, without end, with the direction in which each is reached."""
    for penetration in schedule.approach():
        yield Load(penetration, 1)
    for penetration in schedule.retraction():
        yield Load(penetration, -1)
