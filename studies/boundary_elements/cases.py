"""Cases of a validation: a surface, its loads, its grid and the range of attraction."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from crackfront.core.arrays import Array
from crackfront.core.bounds import NUMBER, Range
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.sweep.section import Section, section_error
from crackfront.validation import Positive, within
from studies.boundary_elements.contact import HalfSpaceContact, half_space_contact

VERSION = 1
"""Version of the boundary elements: another one makes their cycles, which take hours, run again.

- 1: the first release.
"""

_STEADY = (0.25, 0.75)
"""Ends of the steady part of a whole loop, relative to the largest penetration."""


class SteadyBranches(Section):
    """First and last penetration of the approach, and of the retraction, where they are steady."""

    first: Positive
    last: Positive
    turned: Positive
    end: Positive


class Loads(Section):
    """Approach and retraction: a whole loop, or the steady parts of both branches alone.

    A whole loop begins where the surfaces do not attract each other yet and ends with pull-off. An
    approach that is steady from its start makes contact there, far from the apex; the contact is
    then pressed to the largest penetration, and back in one step, so that its edge has turned
    everywhere.

    Contacts are compared and drawn at the shown penetration. (Units: reduced vertical length)

    Examples
    --------
    >>> steady = SteadyBranches(first=0.5, last=1.0, turned=1.0, end=0.5)
    >>> branches = Loads(max_penetration=2.0, step=0.5, shown_penetration=0.5, steady=steady)
    >>> [(load.value, load.direction) for load in branches.loads(interaction_range=0.3)]
    [(0.5, 1), (1.0, 1), (2.0, 1), (1.0, -1), (0.5, -1)]
    """

    max_penetration: Positive
    step: Positive
    shown_penetration: Annotated[float, within(Range(-NUMBER.most, NUMBER.most))]
    steady: SteadyBranches | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Loads:
        low, high, most = -math.inf, math.inf, self.max_penetration
        if self.steady is not None:
            low = max(self.steady.first, self.steady.end)
            high = min(self.steady.last, self.steady.turned)
            if not low < high <= max(self.steady.last, self.steady.turned) < most:
                raise section_error(
                    f"the steady parts are {self.steady}; first must be below last, end below "
                    f"turned, all below max_penetration {most:g}, and both parts must overlap"
                )
        if not (low <= self.shown_penetration <= high and self.shown_penetration < most):
            raise section_error(
                f"shown_penetration {self.shown_penetration:g} is not on both branches; it must "
                f"be below max_penetration {most:g}, and on both steady parts if there are any"
            )
        return self

    def check_step(self) -> None:
        """Raise if the step is too large, or leads past penetrations that are compared."""
        steady = self.steady.model_dump() if self.steady else {}
        if self.steady is None and self.step > self.max_penetration / 3 * (1 + 1e-9):
            raise ValueError(
                f"step {self.step:g} is above a third of max_penetration "
                f"{self.max_penetration:g}; lower it, so that branches have steady parts"
            )
        for name, value in {"shown_penetration": self.shown_penetration, **steady}.items():
            if abs(value / self.step - round(value / self.step)) > 1e-9:
                raise ValueError(
                    f"{name} {value:g} is not a multiple of the step {self.step:g}; take a step "
                    "that leads to it"
                )

    def loads(self, interaction_range: float) -> Iterator[Load]:
        """Penetrations in their order; a whole loop has infinitely many."""
        if self.steady is None:
            for count in range(math.ceil(interaction_range / self.step), 0, -1):
                yield Load(-count * self.step, 1)
            yield from LoadSchedule(self.max_penetration, self.step).loads()
        else:
            counts = {name: round(b / self.step) for name, b in self.steady.model_dump().items()}
            for count in range(counts["first"], counts["last"] + 1):
                yield Load(count * self.step, 1)
            yield Load(self.max_penetration, 1)
            for count in range(counts["turned"], counts["end"] - 1, -1):
                yield Load(count * self.step, -1)

    def are_steady(self, penetration: Array) -> NDArray[np.bool_]:
        """Whether states at these penetrations are on the steady part of their branch."""
        if self.steady is not None:
            return penetration < self.max_penetration - 1e-9
        low, high = (part * self.max_penetration for part in _STEADY)
        return (penetration > low - 1e-9) & (penetration < high + 1e-9)


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that determines one cycle by boundary elements."""

    seed: int  # of the surface
    short_cutoff: float  # of its spectrum, flat where the roll-off is as long (reduced lateral)
    roll_off: float
    hurst: float
    side: float  # of the periodic domain (reduced lateral length)
    n_point: int  # along it
    interaction_range: float  # gap at which the attraction ends (reduced vertical length)
    elastic_energy: float  # of full conformity, 0 for a smooth sphere (w_int)
    tolerance: float  # largest pressure out of balance, relative to the largest tension
    loads: Loads

    @property
    def pixel(self) -> float:
        """Grid spacing (Units: reduced lateral length)."""
        return self.side / self.n_point

    @property
    def surface(self) -> tuple[object, ...]:
        """What determines the front: not the grid, as the noise belongs to wavevectors."""
        return self.seed, self.roll_off, self.hurst, self.elastic_energy, self.loads

    @property
    def label(self) -> str:
        """Name of the case in messages, and of its file before the key."""
        shape = "" if self.roll_off == self.short_cutoff else f"-r{self.roll_off:g}"
        return f"n{self.n_point}-g{self.interaction_range:g}-e{self.elastic_energy:g}{shape}"

    @property
    def stem(self) -> str:
        """Name of its file, which changes with anything that determines the result."""
        identity = asdict(self) | {"loads": self.loads.model_dump()}
        text = json.dumps([identity, VERSION], sort_keys=True, allow_nan=False)
        return f"{self.label}-{hashlib.sha256(text.encode()).hexdigest()[:12]}"

    def heights(self) -> Array:
        """Roughness of the sphere, (n_point, n_point) (Units: reduced vertical length)."""
        spectrum = SelfAffineSpectrum(self.short_cutoff, self.roll_off, self.hurst)
        rng = np.random.default_rng(np.random.SeedSequence(self.seed))
        unit = gaussian_field(spectrum.with_elastic_energy(1.0), self.n_point, self.side, rng)
        return unit * math.sqrt(self.elastic_energy)

    def contact(self) -> HalfSpaceContact:
        """Contact of the sphere with the half-space, on a grid that resolves its attraction."""
        return half_space_contact(
            self.heights(), self.pixel, self.interaction_range, self.loads.max_penetration
        )
