"""Sections of the configuration of a sweep but its spectra: their keys and what they stand for."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated

from pydantic import Field, model_validator

from crackfront.analysis.sweep_fit import FEWEST_BOOTSTRAP
from crackfront.core.bounds import (
    PIXELS,
    SI,
    SITES,
    TOLERANCE,
    Range,
)
from crackfront.core.field.fields import Interpolation
from crackfront.core.solver.relax import SOLVERS
from crackfront.simulate.contact import SweepLoad
from crackfront.simulate.line.line_loads import LAW_LENGTH, LineLoad, SpringUnit
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.sweep.section import ConfigurationError, Section, section_error
from crackfront.sweep.section_checks import (
    check_distinct,
    check_exactly_one,
    check_makes,
    check_not_overruled,
    missing_keys,
)
from crackfront.validation import Count, Density, Fraction, Positive, one_of, within

Rms = Annotated[float, Field(gt=0, lt=2, allow_inf_nan=False)]


class ScalesSection(Section):
    """Scene in SI units."""

    radius: Annotated[float, within(SI["m"])]
    work_of_adhesion: Annotated[float, within(SI["J/m^2"])]
    contact_modulus: Annotated[float, within(SI["Pa"])]


class AmplitudesSection(Section):
    """Amplitudes relative to w_int, or to the heights of a measured surface, in one measure."""

    elastic_energy: Annotated[tuple[Fraction, ...], Field(min_length=1)] | None = None
    work_of_adhesion_rms: Annotated[tuple[Rms, ...], Field(min_length=1)] | None = None
    measured: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _one_measure(self) -> AmplitudesSection:
        measures = (self.elastic_energy, self.work_of_adhesion_rms, self.measured)
        check_exactly_one(
            "amplitudes need exactly one of elastic_energy, work_of_adhesion_rms and measured",
            measures,
        )
        for values in filter(None, measures):
            # Texts have six digits.
            check_distinct("amplitude", [float(f"{value:g}") for value in values])
        return self

    def elastic_energies(self, measured: float) -> tuple[float, ...]:
        """e_el / w_int, from w_rms^2 = 4 e_el w_int where the rms is given.

        Multiples of measured heights are multiples of its root; four digits, which names state.
        """
        if self.elastic_energy is not None:
            return self.elastic_energy
        if self.work_of_adhesion_rms is not None:
            return tuple(rms**2 / 4 for rms in self.work_of_adhesion_rms)
        factors = self.measured or ()
        energies = tuple(float(f"{factor**2 * measured:.4g}") for factor in factors)
        if max(energies) >= 1:
            raise ConfigurationError(
                f"amplitudes.measured: {max(factors):g} times the heights have an "
                f"energy of full conformity of {max(energies):g} w_int; it must be below w_int"
            )
        return energies


class TileSection(Section):
    """Side of the periodic tile."""

    roll_offs: Positive
    cutoffs: Annotated[Positive, Field(ge=1)]


class NumericsSection(Section):
    """An error or a resolution, and the solver, as in `Numerics`."""

    error: Annotated[float, Field(gt=0, lt=1)] | None = None
    angles: Annotated[int, within(SITES)] | None = None
    angles_per_cutoff: Density | None = None
    samples_per_cutoff: Density | None = None
    interpolation: Interpolation | None = None
    pixels_per_cutoff: Annotated[float, within(PIXELS)] | None = None
    tile: TileSection
    tolerance: Annotated[float, within(TOLERANCE)] | None = None
    max_sweeps: Count
    solver: Annotated[str, one_of(SOLVERS)]

    @model_validator(mode="after")
    def _usable(self) -> NumericsSection:
        if self.error is not None:
            check_not_overruled(self, "error", [item.name for item in fields(Settings)])
        else:
            needed = ("samples_per_cutoff", "interpolation", "pixels_per_cutoff", "tolerance")
            if missing := missing_keys(self, needed):
                raise section_error(
                    f"{', '.join(missing)} missing; add what is missing or ask for an error"
                )
            check_exactly_one(
                "numerics need exactly one of angles and angles_per_cutoff",
                (self.angles, self.angles_per_cutoff),
                otherwise="give one, or ask for an error",
            )
        return self

    def numerics(self) -> Numerics:
        """Numerics with an error, or with a resolution and a tolerance."""
        settings = {field.name: getattr(self, field.name) for field in fields(Settings)}
        if self.angles is not None:
            settings["angles_per_cutoff"] = 1.0  # without effect
        return Numerics(
            settings=Settings(**settings) if self.error is None else None,
            error=self.error,
            tile_roll_offs=self.tile.roll_offs,
            tile_cutoffs=self.tile.cutoffs,
            max_sweeps=self.max_sweeps,
            solver=self.solver,
        )


class SteadySection(Section):
    """Steady parts of the branches only, as in `SteadySchedule`.

    States nearer than a hundredth of the correlation length are no further samples.
    """

    start: float
    travel: Annotated[Positive, Field(ge=0.01)]
    error: Positive


class LineSection(Section):
    """Straight fronts instead of spheres, as in `LineLoad`."""

    springs: Annotated[tuple[Positive, ...], Field(min_length=1)]
    spring_unit: SpringUnit = "correlation_length"
    length: Annotated[Positive, Field(ge=LAW_LENGTH)]
    period: Annotated[Positive, Field(ge=20)]
    transient: Annotated[Positive, Field(ge=3)]
    step: Positive
    uncorrelated: bool = False

    @model_validator(mode="after")
    def _distinct(self) -> LineSection:
        check_distinct("spring", self.springs)
        return self


class LoadSection(Section):
    """Penetrations to visit, or straight fronts."""

    max_penetration: Annotated[float, Field(allow_inf_nan=False)] | None = None
    step: Positive | None = None
    steady: SteadySection | None = None
    line: LineSection | None = None

    @model_validator(mode="after")
    def _makes_contact(self) -> LoadSection:
        if self.line is not None:
            check_not_overruled(self, "line", ("max_penetration", "step", "steady"))
            return self
        if self.max_penetration is None:
            raise section_error("key max_penetration is missing; add it, or a section line")
        check_exactly_one(
            "load needs exactly one of step (full cycles) and steady (parts of them)",
            (self.step, self.steady),
        )
        check_makes(lambda: self.schedule(1.0))
        return self

    def schedule(self, vertical: float) -> SweepLoad:
        """Penetrations to visit, lengths divided by a unit, or straight fronts."""
        if self.line is not None:
            return LineLoad(**self.line.model_dump(exclude={"springs"}))
        assert self.max_penetration is not None, "required without a section line"
        max_penetration = self.max_penetration / vertical
        if self.steady is not None:
            start, travel = self.steady.start / vertical, self.steady.travel
            return SteadySchedule(start, max_penetration, travel, self.steady.error)
        assert self.step is not None, "required without a section steady"
        return FullCycle(max_penetration, self.step / vertical)


class FitSection(Section):
    """Range of the fit; an end that is left out leaves out no amplitude."""

    lowest_elastic_energy: Positive | None = None
    highest_elastic_energy: Fraction | None = None
    bootstrap: Annotated[int, within(Range(FEWEST_BOOTSTRAP, 10**7))] = 4000

    @model_validator(mode="after")
    def _ordered(self) -> FitSection:
        lowest, highest = self.lowest_elastic_energy, self.highest_elastic_energy
        if lowest is not None and highest is not None and lowest > highest:
            raise section_error(
                f"lowest_elastic_energy {lowest:g} is above highest_elastic_energy {highest:g}; "
                "swap them"
            )
        return self
