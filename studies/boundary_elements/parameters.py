"""Configuration of a validation, and the cases that it stands for."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from crackfront.core.resources import check_memory
from crackfront.sweep.section import Section, section_error, validated, yaml_mapping
from crackfront.validation import Count, Positive, Seed
from studies.boundary_elements.cases import Case, Loads
from studies.boundary_elements.contact import check_resolution

_POINT_BYTES = 500.0
"""Memory of a point of a grid, twice as wide in both directions, with some fifteen arrays."""

_LARGEST_TOLERANCE = 0.01
"""Pressure out of balance, relative to the largest tension; 0.03 raises the work of a loop by 4 to
8%, 0.1 by 35 to 60%."""

_LONGEST_RANGE = 1.0
"""Range of attraction beyond which it is not short against the contact, whose radius is
1.5 or more. (Units: reduced vertical length)"""

_FEWEST_SAMPLES = 2.0
"""Samples of the front's field per short cutoff, below which they miss waves."""


class FrontSection(Section):
    """Resolution of the front model."""

    n_angle: Annotated[Count, Field(ge=4)]
    spacing: Positive


class CaseSection(Section):
    """Cases of one grid, range, load step and spectrum, flat by default, as of :class:`Case`."""

    n_point: Annotated[Count, Field(ge=16)]
    interaction_range: Annotated[Positive, Field(le=_LONGEST_RANGE)]
    elastic_energies: Annotated[
        tuple[Annotated[float, Field(ge=0, lt=1)], ...], Field(min_length=1)
    ]  # amplitudes, 0 for a smooth sphere (w_int)
    step: Positive | None = None  # by default the step of `loads` (reduced vertical length)
    roll_off: Positive | None = None
    hurst: Annotated[float, Field(gt=0, le=1)] = 1.0
    # Their seeds are drawn from the seed of the file; by default one surface with this seed.
    surfaces: Count | None = None
    skipped: Annotated[int, Field(ge=0)] = 0  # surfaces before the first


class ValidationParameters(Section):
    """The whole file; all cases share cutoff, side, tolerance and loads."""

    seed: Seed
    short_cutoff: Positive
    side: Positive
    tolerance: Annotated[float, Field(gt=0, le=_LARGEST_TOLERANCE)]
    loads: Loads
    front: FrontSection
    cases: Annotated[tuple[CaseSection, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _usable(self) -> ValidationParameters:
        spacing, finest = self.front.spacing, self.short_cutoff / _FEWEST_SAMPLES
        if spacing > finest * (1 + 1e-12):
            raise section_error(
                f"front: spacing {spacing:g} misses waves of short_cutoff {self.short_cutoff:g}; "
                f"take {finest:g} or less"
            )
        if self.loads.steady is None and self.loads.shown_penetration < 0:
            raise section_error(
                f"loads: shown_penetration {self.loads.shown_penetration:g} is before contact in "
                "approach; take 0 or more"
            )
        for number, case in enumerate(self.cases):
            try:
                self._check_case(case)
            except ValueError as error:
                raise section_error(f"cases[{number}]: {error}") from error
        return self

    def _check_case(self, case: CaseSection) -> None:
        """Raise if a case is too small, too large, or too coarse for roughness and attraction."""
        n_point, pixel, cutoff = case.n_point, self.side / case.n_point, self.short_cutoff
        if case.roll_off is not None and case.roll_off < cutoff:
            raise ValueError(
                f"roll_off {case.roll_off:g} is shorter than short_cutoff {cutoff:g}; raise it"
            )
        if (longest := case.roll_off or cutoff) > self.side:
            raise ValueError(
                f"waves of {longest:g}, the roll_off or else the short_cutoff, do not fit in a "
                f"domain of side {self.side:g}; shorten them or raise side"
            )
        if cutoff <= 2 * pixel:
            raise ValueError(
                f"short_cutoff {cutoff:g} is not above two pixels ({2 * pixel:.4g}); take n_point "
                f"{1 + math.floor(2 * self.side / cutoff)} or more"
            )
        memory = _POINT_BYTES * float(n_point) ** 2
        check_memory(f"a grid of {n_point} x {n_point} points", memory, "lower n_point")
        check_resolution(pixel, n_point, case.interaction_range, self.loads.max_penetration)
        self.case_loads(case).check_step()

    def case_loads(self, case: CaseSection) -> Loads:
        """Loads of all cases, in the steps of this one."""
        return self.loads.model_copy(update={"step": case.step or self.loads.step})


def load_validation(path: Path) -> ValidationParameters:
    """Parameters of a YAML file like config/validation.yaml.

    A ConfigurationError has a sentence for whatever is unknown, missing or out of range.
    """
    return validated(path, yaml_mapping(path), ValidationParameters)


def validation_cases(parameters: ValidationParameters) -> tuple[Case, ...]:
    """Cases in the order in which they are run: smooth spheres, then surface after surface."""
    listed = []
    for group in parameters.cases:
        for energy in group.elastic_energies:
            count = (group.surfaces if energy else None) or 1
            for surface in range(group.skipped, group.skipped + count):
                seeds = np.random.SeedSequence(parameters.seed, spawn_key=(surface,))
                drawn = int(seeds.generate_state(1)[0])
                case = Case(
                    seed=parameters.seed if group.surfaces is None else drawn,
                    short_cutoff=parameters.short_cutoff,
                    roll_off=group.roll_off or parameters.short_cutoff,
                    hurst=group.hurst,
                    side=parameters.side,
                    n_point=group.n_point,
                    interaction_range=group.interaction_range,
                    elastic_energy=energy,
                    tolerance=parameters.tolerance,
                    loads=parameters.case_loads(group),
                )
                listed.append((surface, energy > 0, case))
    listed.sort(key=lambda entry: entry[:2])
    return tuple(dict.fromkeys(case for *_, case in listed))
