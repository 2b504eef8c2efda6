"""The schema of a configuration: its sections, what each key may be, and what must agree."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from crackfront.core.adhesion import FieldKind
from crackfront.core.field.fields import Interpolation
from crackfront.core.solver.relax import SOLVERS
from crackfront.data.section import Count, Energy, InputFile, Positive, Section, refusal
from crackfront.simulate.laws import Knobs
from crackfront.topography.reading import Detrend

Rms = Annotated[float, Field(gt=0, lt=2, allow_inf_nan=False)]


class ScalesSection(Section):
    """Scene in SI units."""

    radius: Positive
    work_of_adhesion: Positive
    contact_modulus: Positive


def _several(value: Any) -> Any:
    """The list that a single file stands for."""
    return (value,) if isinstance(value, str) else value


class SurfaceSection(Section):
    """Measurements of a surface, read as :class:`crackfront.topography.reading.Treatment` says."""

    file: Annotated[tuple[InputFile, ...], BeforeValidator(_several), Field(min_length=1)]
    detrend: Detrend = "curvature"
    unit: str | None = None
    size: tuple[Positive, ...] | None = None
    shortest: Positive | None = None


class SpectrumSection(Section):
    """Shape of one spectrum: its parameters, or the surface that it is fitted to."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
    short_cutoff: Positive | None = None
    roll_off: Positive | None = None
    hurst: Annotated[float, Field(gt=0, le=1)] | None = None
    surface: SurfaceSection | None = None

    @model_validator(mode="after")
    def _complete(self) -> SpectrumSection:
        own = {name: getattr(self, name) for name in ("short_cutoff", "roll_off", "hurst")}
        if self.surface is not None:
            given = [name for name, value in own.items() if value is not None]
            if given:
                raise refusal(
                    f"surface already decides {', '.join(given)}; remove one or the other"
                )
            return self
        missing = [name for name in ("short_cutoff", "hurst") if own[name] is None]
        if missing:
            raise refusal(f"key {', '.join(missing)} is missing; add it, or name a surface")
        return self

    @model_validator(mode="after")
    def _ordered(self) -> SpectrumSection:
        if self.roll_off and self.short_cutoff and self.roll_off < self.short_cutoff:
            raise refusal(
                f"roll_off {self.roll_off:g} is shorter than short_cutoff {self.short_cutoff:g}; "
                "lower the cutoff or raise the roll-off (equal values give a flat spectrum)"
            )
        return self


class AmplitudesSection(Section):
    """Amplitudes relative to w_int, in one of two measures."""

    elastic_energy: Annotated[tuple[Energy, ...], Field(min_length=1)] | None = None
    work_of_adhesion_rms: Annotated[tuple[Rms, ...], Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _one_measure(self) -> AmplitudesSection:
        if (self.elastic_energy is None) == (self.work_of_adhesion_rms is None):
            raise refusal(
                "amplitudes need exactly one of elastic_energy and work_of_adhesion_rms; "
                + ("remove one" if self.elastic_energy else "give one")
            )
        _refuse_repeated("amplitude", self.elastic_energy or self.work_of_adhesion_rms or ())
        return self

    @property
    def elastic_energies(self) -> tuple[float, ...]:
        """e_el / w_int, from w_rms^2 = 4 e_el w_int where the rms is given."""
        if self.elastic_energy is not None:
            return self.elastic_energy
        return tuple(rms**2 / 4 for rms in self.work_of_adhesion_rms or ())


class TileSection(Section):
    """Side of the periodic tile."""

    roll_offs: Positive
    cutoffs: Annotated[float, Field(ge=1, allow_inf_nan=False)]


class NumericsSection(Section):
    """An error or a resolution, and the solver, as in `Numerics`."""

    error: Annotated[float, Field(gt=0, lt=1)] | None = None
    angles: Annotated[int, Field(ge=4)] | None = None
    angles_per_cutoff: Positive | None = None
    samples_per_cutoff: Positive | None = None
    interpolation: Interpolation | None = None
    pixels_per_cutoff: Positive | None = None
    tile: TileSection
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None
    max_sweeps: Count
    solver: str

    @model_validator(mode="after")
    def _usable(self) -> NumericsSection:
        if self.error is None:
            self._refuse_incomplete()
        else:
            self._refuse_overruled()
        if self.pixels_per_cutoff is not None and self.pixels_per_cutoff < 2:
            raise refusal(
                f"pixels_per_cutoff is {self.pixels_per_cutoff:g}, so that short_cutoff is below "
                "two pixels; it must be 2 or more"
            )
        if self.solver not in SOLVERS:
            raise refusal(
                f"solver {self.solver!r} is unknown; choose one of {', '.join(sorted(SOLVERS))}"
            )
        return self

    def _refuse_incomplete(self) -> None:
        """Raise if a knob is missing, or the number of sites is given twice."""
        missing = [
            name
            for name in ("samples_per_cutoff", "interpolation", "pixels_per_cutoff", "tolerance")
            if getattr(self, name) is None
        ]
        if missing:
            raise refusal(f"{', '.join(missing)} missing; add what is missing or ask for an error")
        if (self.angles is None) == (self.angles_per_cutoff is None):
            raise refusal(
                "numerics need exactly one of angles and angles_per_cutoff; "
                + ("remove one" if self.angles else "give one, or ask for an error")
            )

    def _refuse_overruled(self) -> None:
        """Raise if a knob is given that the error decides."""
        names = [item.name for item in fields(Knobs)]
        given = [name for name in names if getattr(self, name) is not None]
        if given:
            raise refusal(f"error already decides {', '.join(given)}; remove one or the other")


class SteadySection(Section):
    """Steady parts of the branches only, as in `SteadySchedule`."""

    start: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    travel: Positive
    error: Positive


class LoadSection(Section):
    """Penetrations to visit."""

    max_penetration: Annotated[float, Field(allow_inf_nan=False)]
    step: Positive | None = None
    steady: SteadySection | None = None

    @model_validator(mode="after")
    def _makes_contact(self) -> LoadSection:
        if self.max_penetration < 0:
            raise refusal(
                f"max_penetration is {self.max_penetration:g}, which never makes contact; the "
                "sphere touches at 0, so it must be 0 or more"
            )
        if (self.steady is None) == (self.step is None):
            raise refusal(
                "load needs exactly one of step (full cycles) and steady (parts of them); "
                + ("give one" if self.step is None else "remove one")
            )
        if self.steady is not None and self.steady.start >= self.max_penetration:
            raise refusal(
                f"steady.start {self.steady.start:g} is not below max_penetration "
                f"{self.max_penetration:g}; lower it or penetrate deeper"
            )
        return self


class FitSection(Section):
    """Range of the fit."""

    lowest_elastic_energy: Positive
    highest_elastic_energy: Energy
    bootstrap: Count

    @model_validator(mode="after")
    def _ordered(self) -> FitSection:
        if self.lowest_elastic_energy > self.highest_elastic_energy:
            raise refusal(
                f"lowest_elastic_energy {self.lowest_elastic_energy:g} is above "
                f"highest_elastic_energy {self.highest_elastic_energy:g}; swap them"
            )
        return self


class Configuration(Section):
    """The whole file."""

    seed: Annotated[int, Field(ge=0)]
    field: FieldKind
    scales: ScalesSection | None = None
    spectra: Annotated[tuple[SpectrumSection, ...], Field(min_length=1)]
    amplitudes: AmplitudesSection
    realisations: Count
    numerics: NumericsSection
    load: LoadSection
    record: tuple[Literal["fronts", "energy"], ...] = ()
    failed_fraction: Annotated[float, Field(ge=0, le=1)] = 0.1
    fit: FitSection

    @model_validator(mode="after")
    def _consistent(self) -> Configuration:
        _refuse_repeated("spectrum name", [spectrum.name for spectrum in self.spectra])
        if self.field == "chemical" and self.amplitudes.elastic_energy is not None:
            raise refusal(
                "amplitudes.elastic_energy has no meaning for a chemical field; give "
                "amplitudes.work_of_adhesion_rms"
            )
        measured = [item.name for item in self.spectra if item.surface is not None]
        if measured and self.scales is None:
            raise refusal(
                f"spectrum {measured[0]!r} is that of a surface in metres; give the section scales"
            )
        if measured and self.field == "chemical":
            raise refusal(f"spectrum {measured[0]!r} is that of heights; field must be roughness")
        energies, fit = self.amplitudes.elastic_energies, self.fit
        if not any(
            fit.lowest_elastic_energy <= energy <= fit.highest_elastic_energy for energy in energies
        ):
            raise refusal(
                f"no amplitude lies in the range of the fit, e_el from "
                f"{fit.lowest_elastic_energy:g} to {fit.highest_elastic_energy:g}; widen the range"
            )
        return self


def _refuse_repeated(what: str, values: Any) -> None:
    """Raise if a value stands twice."""
    for position, value in enumerate(values):
        if value in values[:position]:
            raise refusal(f"{what} {value!r} stands twice; remove or change one")
