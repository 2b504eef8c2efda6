"""What a validation compares: cases of one rough sphere, by boundary elements and by the front."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.fingerprint import fingerprint
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.data.bounds import NUMBER, Range, refuse_beyond_memory
from crackfront.data.section import (
    Count,
    Energy,
    Positive,
    Section,
    Seed,
    content_of,
    refusal,
    validated,
    within,
)
from crackfront.studies.boundary_elements.contact import (
    HalfSpaceContact,
    half_space_contact,
    refuse_unresolved,
)

Array = NDArray[np.float64]


_POINT_BYTES = 500.0
"""Memory of a point of a grid, twice as wide in both directions, with some fifteen arrays."""


class CaseSection(Section):
    """One cycle by boundary elements, and the same by the front.

    Attributes
    ----------
    n_point : int
        Points along a side of the grid.
    interaction_range, step : float
        Range of the attraction, and a load step of its own. (Units: reduced vertical length)
    elastic_energy : float
        Energy of full conformity, 0 for a smooth sphere. (Units: w_int)
    """

    n_point: Annotated[Count, Field(ge=16)]
    interaction_range: Positive
    elastic_energy: Annotated[float, Field(ge=0, lt=1)]
    step: Positive | None = None


class FrontSection(Section):
    """Resolution of the front model."""

    n_angle: Annotated[Count, Field(ge=4)]
    spacing: Positive


class StatisticsSection(Section):
    """Surfaces on which the front is run with and without the rotation of the crack."""

    surfaces: Annotated[Count, Field(ge=2)]
    n_point: Annotated[Count, Field(ge=16)]
    elastic_energy: Energy


class ValidationParameters(Section):
    """The whole file: a surface that all cases share, its load, and the cases.

    Attributes
    ----------
    short_cutoff, side : float
        Shortest wavelength of the flat spectrum; side of the domain and of the periodic roughness.
        (Units: reduced lateral length)
    max_penetration, step, shown_penetration : float
        Load, and the penetration at which perimeters are compared. (Units: reduced vertical length)
    tolerance : float
        Largest pressure out of balance, relative to the largest tension.
    """

    seed: Seed
    short_cutoff: Positive
    side: Positive
    max_penetration: Positive
    step: Positive
    shown_penetration: Annotated[float, within(Range(-NUMBER.most, NUMBER.most))]
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    front: FrontSection
    statistics: StatisticsSection | None = None
    cases: Annotated[tuple[CaseSection, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _usable(self) -> ValidationParameters:
        for number, case in enumerate(self.cases):
            if case in self.cases[:number]:
                raise refusal(f"cases[{number}] stands twice; remove one")
            pixel, step = self.side / case.n_point, case.step or self.step
            if self.short_cutoff < 2 * pixel:
                needed = math.ceil(2 * self.side / self.short_cutoff)
                raise refusal(
                    f"cases[{number}]: short_cutoff {self.short_cutoff:g} is below two pixels "
                    f"({2 * pixel:.4g}); take n_point {needed} or more"
                )
            try:
                refuse_beyond_memory(
                    f"a grid of {case.n_point} x {case.n_point} points",
                    _POINT_BYTES * float(case.n_point) ** 2,
                    "lower n_point",
                )
                refuse_unresolved(pixel, case.n_point, case.interaction_range, self.max_penetration)
            except ValueError as error:
                raise refusal(f"cases[{number}]: {error}") from error
            shown = self.shown_penetration / step
            if not (
                abs(shown - round(shown)) < 1e-9 and self.shown_penetration < self.max_penetration
            ):
                raise refusal(
                    f"shown_penetration {self.shown_penetration:g} is no state of cases[{number}]; "
                    f"it must be a multiple of the step {step:g} and below max_penetration "
                    f"{self.max_penetration:g}"
                )
        return self


def load_validation(path: Path) -> ValidationParameters:
    """Parameters of a YAML file like config/validation.yaml.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, or anything in it is unknown, missing or out of range; one
        sentence for each.
    """
    return validated(path, content_of(path), ValidationParameters)


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that determines one cycle by boundary elements.

    The fields are those of :class:`ValidationParameters` and :class:`CaseSection`.
    """

    seed: int
    short_cutoff: float
    side: float
    shown_penetration: float
    tolerance: float
    n_point: int
    interaction_range: float
    elastic_energy: float
    schedule: LoadSchedule

    @property
    def pixel(self) -> float:
        """Grid spacing (Units: reduced lateral length)."""
        return self.side / self.n_point

    @property
    def label(self) -> str:
        """What a person calls this case, and the stem of its file before the key."""
        return f"n{self.n_point}-g{self.interaction_range:g}-e{self.elastic_energy:g}"

    @property
    def stem(self) -> str:
        """Name of its file, which changes with anything that determines the result."""
        sources = ("studies/boundary_elements/contact.py", "studies/boundary_elements/cycle.py")
        digest = fingerprint(*sources, "core/synthesis.py", "core/spectrum.py")
        text = json.dumps([asdict(self), digest], sort_keys=True, allow_nan=False)
        return f"{self.label}-{hashlib.sha256(text.encode()).hexdigest()[:12]}"

    def heights(self) -> Array:
        """Roughness of the sphere, the same surface for all grids and amplitudes of a seed.

        The noise belongs to wavevectors, not to the points of a grid. (Units: reduced vertical
        length)
        """
        flat = SelfAffineSpectrum(self.short_cutoff, self.short_cutoff, hurst=1.0)
        rng = np.random.default_rng(np.random.SeedSequence(self.seed))
        unit = gaussian_field(flat.with_elastic_energy(1.0), self.n_point, self.side, rng)
        return unit * math.sqrt(self.elastic_energy)

    def contact(self) -> HalfSpaceContact:
        """Contact of the sphere with the half-space, on a grid that resolves its attraction."""
        return half_space_contact(
            self.heights(), self.pixel, self.interaction_range, self.schedule.max_penetration
        )


def validation_cases(parameters: ValidationParameters) -> tuple[Case, ...]:
    """Cases of a validation, in their order."""
    names = {item.name for item in fields(Case)}
    return tuple(
        Case(
            **parameters.model_dump(include=names),
            **case.model_dump(include=names),
            schedule=LoadSchedule(parameters.max_penetration, case.step or parameters.step),
        )
        for case in parameters.cases
    )
