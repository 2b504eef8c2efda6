"""What a validation compares: cases of one rough sphere, by boundary elements and by the front."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.core.cycle.follow import Load
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
from studies.boundary_elements.contact import (
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
            _refuse_grid(f"cases[{number}]", self, case.n_point, case.interaction_range, self)
            step = case.step or self.step
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


def _refuse_grid(
    place: str,
    surface: ValidationParameters | AmplitudeParameters,
    n_point: int,
    interaction_range: float,
    load: ValidationParameters | BranchSection,
) -> None:
    """Refuse a grid that resolves neither the roughness nor the attraction, or is too small."""
    pixel = surface.side / n_point
    if surface.short_cutoff < 2 * pixel:
        needed = math.ceil(2 * surface.side / surface.short_cutoff)
        raise refusal(
            f"{place}: short_cutoff {surface.short_cutoff:g} is below two pixels "
            f"({2 * pixel:.4g}); take n_point {needed} or more"
        )
    try:
        refuse_beyond_memory(
            f"a grid of {n_point} x {n_point} points",
            _POINT_BYTES * float(n_point) ** 2,
            "lower n_point",
        )
        refuse_unresolved(pixel, n_point, interaction_range, load.max_penetration)
    except ValueError as error:
        raise refusal(f"{place}: {error}") from error


class BranchSection(Section):
    """Load of the steady parts of both branches, as of :class:`BranchSchedule`."""

    first: Positive
    last: Positive
    max_penetration: Positive
    turned: Positive
    end: Positive

    @model_validator(mode="after")
    def _in_order(self) -> BranchSection:
        if not max(self.first, self.end) < min(self.last, self.turned):
            raise refusal(
                f"loads go from first {self.first:g} to last {self.last:g} and from turned "
                f"{self.turned:g} to end {self.end:g}; first must be below last, end below turned, "
                "and the branches must share penetrations"
            )
        if not max(self.last, self.turned) < self.max_penetration:
            raise refusal(
                f"max_penetration {self.max_penetration:g} must be above last {self.last:g} and "
                f"turned {self.turned:g}; between them the contact turns"
            )
        return self


class SpectrumSection(Section):
    """Shape of the surfaces' spectrum; flat where the roll-off is the short cutoff."""

    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]


class GridSection(Section):
    """Grid, range of the attraction and load step, on the first surfaces.

    Of `roll_offs` and `elastic_energies` alone; of all by default, and then the smooth sphere too.
    """

    n_point: Annotated[int, Field(ge=16)]
    interaction_range: Positive
    step: Positive
    surfaces: Count
    roll_offs: tuple[Positive, ...] | None = None
    elastic_energies: tuple[Energy, ...] | None = None


class AmplitudeParameters(Section):
    """The whole file of a validation over amplitudes, spectra, surfaces and grids.

    Attributes
    ----------
    short_cutoff, side, tolerance
        As of :class:`ValidationParameters`.
    elastic_energies : tuple of float
        Amplitudes of the roughness; a smooth sphere is run once on every grid. (Units: w_int)
    """

    seed: Annotated[int, Field(ge=0)]
    short_cutoff: Positive
    side: Positive
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    loads: BranchSection
    front: FrontSection
    elastic_energies: Annotated[tuple[Energy, ...], Field(min_length=1)]
    spectra: Annotated[tuple[SpectrumSection, ...], Field(min_length=1)]
    grids: Annotated[tuple[GridSection, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _usable(self) -> AmplitudeParameters:
        for number, spectrum in enumerate(self.spectra):
            if spectrum.roll_off < self.short_cutoff:
                raise refusal(
                    f"spectra[{number}]: roll_off {spectrum.roll_off:g} is shorter than "
                    f"short_cutoff {self.short_cutoff:g}; raise it"
                )
        for number, grid in enumerate(self.grids):
            place = f"grids[{number}]"
            if grid in self.grids[:number]:
                raise refusal(f"{place} stands twice; remove one")
            for name, known in (
                ("roll_offs", tuple(spectrum.roll_off for spectrum in self.spectra)),
                ("elastic_energies", self.elastic_energies),
            ):
                for value in getattr(grid, name) or ():
                    if value not in known:
                        raise refusal(f"{place}: {name} holds {value:g}; there is none such")
            _refuse_grid(place, self, grid.n_point, grid.interaction_range, self.loads)
            for name in ("first", "last", "turned", "end"):
                count = getattr(self.loads, name) / grid.step
                if abs(count - round(count)) > 1e-9:
                    raise refusal(
                        f"{place}: step {grid.step:g} does not lead to {name} "
                        f"{getattr(self.loads, name):g}; take a whole part of it"
                    )
        return self


def load_validation(path: Path) -> ValidationParameters | AmplitudeParameters:
    """Parameters of a YAML file like config/validation.yaml or config/validation-strong.yaml.

    The latter have `elastic_energies` of all their surfaces, where the former have `cases`.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, or anything in it is unknown, missing or out of range; one
        sentence for each.
    """
    content = content_of(path)
    if "elastic_energies" in content:
        return validated(path, content, AmplitudeParameters)
    return validated(path, content, ValidationParameters)


@dataclass(frozen=True, slots=True)
class BranchSchedule:
    """Penetrations of the steady parts of both branches, each from a state far behind it.

    The approach makes contact at its first penetration, far from the apex. Between the branches the
    contact is pressed further, and back in one step, so that its edge has turned everywhere.

    Parameters
    ----------
    first, last, max_penetration, turned, end : float
        First and last of the approach, that at which the contact turns, and first and last of the
        retraction. (Units: reduced vertical length)
    step : float
        Difference of penetrations. (Units: reduced vertical length)

    Examples
    --------
    >>> schedule = BranchSchedule(0.5, 1.0, 2.0, 0.5, 0.0, 0.5)
    >>> [(load.value, load.direction) for load in schedule.loads()]
    [(0.5, 1), (1.0, 1), (2.0, 1), (0.5, -1), (0.0, -1)]
    """

    first: float
    last: float
    max_penetration: float
    turned: float
    end: float
    step: float

    def loads(self) -> Iterator[Load]:
        """Penetrations in their order, whole multiples of the step but for the turn."""
        first, last, turned, end = (
            round(b / self.step) for b in (self.first, self.last, self.turned, self.end)
        )
        yield from (Load(count * self.step, 1) for count in range(first, last + 1))
        yield Load(self.max_penetration, 1)
        yield from (Load(count * self.step, -1) for count in range(turned, end - 1, -1))


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that determines one cycle by boundary elements.

    The fields are those of :class:`ValidationParameters` and :class:`CaseSection`, and the shape of
    the spectrum, which is flat where its roll-off is the short cutoff.
    """

    seed: int
    short_cutoff: float
    side: float
    shown_penetration: float
    tolerance: float
    n_point: int
    interaction_range: float
    elastic_energy: float
    schedule: LoadSchedule | BranchSchedule
    roll_off: float | None = None
    hurst: float = 1.0

    @property
    def pixel(self) -> float:
        """Grid spacing (Units: reduced lateral length)."""
        return self.side / self.n_point

    @property
    def label(self) -> str:
        """What a person calls this case, and the stem of its file before the key."""
        shape = "" if self.roll_off is None else f"-r{self.roll_off:g}"
        return f"n{self.n_point}-g{self.interaction_range:g}-e{self.elastic_energy:g}{shape}"

    @property
    def stem(self) -> str:
        """Name of its file, which changes with anything that determines the result."""
        here = "studies.boundary_elements"
        digest = fingerprint(f"{here}.contact", f"{here}.cycle")
        text = json.dumps([asdict(self), digest], sort_keys=True, allow_nan=False)
        return f"{self.label}-{hashlib.sha256(text.encode()).hexdigest()[:12]}"

    def heights(self) -> Array:
        """Roughness of the sphere, the same surface for all grids and amplitudes of a seed.

        The noise belongs to wavevectors, not to the points of a grid. (Units: reduced vertical
        length)
        """
        roll_off = self.roll_off or self.short_cutoff
        spectrum = SelfAffineSpectrum(self.short_cutoff, roll_off, self.hurst)
        rng = np.random.default_rng(np.random.SeedSequence(self.seed))
        unit = gaussian_field(spectrum.with_elastic_energy(1.0), self.n_point, self.side, rng)
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


def amplitude_cases(parameters: AmplitudeParameters) -> tuple[Case, ...]:
    """Cases of a validation over amplitudes, those of the first surface before all others.

    The smooth sphere of every grid comes first.
    """
    cases = []
    scenes = [(shape, e) for shape in parameters.spectra for e in parameters.elastic_energies]
    smooth = [
        (0, grid, scenes[0][0], 0.0)
        for grid in parameters.grids
        if grid.roll_offs is None and grid.elastic_energies is None
    ]
    rough = [
        (surface, grid, spectrum, energy)
        for surface in range(max(grid.surfaces for grid in parameters.grids))
        for grid in parameters.grids
        for spectrum, energy in scenes
        if surface < grid.surfaces
        and spectrum.roll_off in (grid.roll_offs or (spectrum.roll_off,))
        and energy in (grid.elastic_energies or (energy,))
    ]
    for surface, grid, spectrum, energy in [*smooth, *rough]:
        cases.append(
            Case(
                seed=surface_seed(parameters.seed, surface),
                short_cutoff=parameters.short_cutoff,
                side=parameters.side,
                shown_penetration=parameters.loads.last,
                tolerance=parameters.tolerance,
                n_point=grid.n_point,
                interaction_range=grid.interaction_range,
                elastic_energy=energy,
                schedule=BranchSchedule(**parameters.loads.model_dump(), step=grid.step),
                roll_off=spectrum.roll_off,
                hurst=spectrum.hurst,
            )
        )
    return tuple(dict.fromkeys(cases))


def surface_seed(seed: int, surface: int) -> int:
    """Seed of one of the surfaces of a seed."""
    sequence = np.random.SeedSequence(seed, spawn_key=(surface,))
    return int(sequence.generate_state(1)[0])
