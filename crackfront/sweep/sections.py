"""Sections of the configuration of a sweep: what each accepts, and what it stands for."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from crackfront.analysis.sweep_fit import FEWEST_BOOTSTRAP
from crackfront.core.bounds import (
    PIXELS,
    SI,
    SITES,
    TOLERANCE,
    Range,
)
from crackfront.core.field.fields import Interpolation
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.solver.relax import named_solver
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum
from crackfront.measured.options import ReadingOptions, reading_options
from crackfront.measured.spectrum.measured_surface import MeasuredSurface, read_surface
from crackfront.simulate.contact import SweepLoad
from crackfront.simulate.line.line_loads import LAW_LENGTH, LineLoad, SpringUnit
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.sweep.section import (
    ConfigurationError,
    Count,
    Density,
    Energy,
    InputFile,
    Positive,
    Section,
    bounds_validator,
    refusal,
    resolved_path,
)
from crackfront.sweep.sweep import NamedSpectrum

Rms = Annotated[float, Field(gt=0, lt=2, allow_inf_nan=False)]


class ScalesSection(Section):
    """Scene in SI units."""

    radius: Annotated[float, bounds_validator(SI["m"])]
    work_of_adhesion: Annotated[float, bounds_validator(SI["J/m^2"])]
    contact_modulus: Annotated[float, bounds_validator(SI["Pa"])]


_READING_KEYS: Any = {
    name: (Any, Field(field.default, description=field.description))
    for name, field in ReadingOptions.model_fields.items()
}

_ReadingSection = create_model("_ReadingSection", __base__=Section, **_READING_KEYS)


def _listed(value: Any) -> Any:
    """A list, of one entry where a single text or number stands for it."""
    return (value,) if isinstance(value, (str, int)) else value


class SurfaceSection(_ReadingSection):
    """Measurements of a surface, and the options by which they are read."""

    file: Annotated[tuple[InputFile, ...], BeforeValidator(_listed), Field(min_length=1)]

    @field_validator("mask")
    @classmethod
    def _resolved_masks(cls, given: Any, info: ValidationInfo) -> Any:
        """Parts of a scan as they are, and files relative to the configuration."""
        masks = given if isinstance(given, tuple) else (given,)
        return tuple(
            str(resolved_path(Path(one), info)) if isinstance(one, str) and ":" not in one else one
            for one in masks
        )

    @functools.cached_property
    def measured(self) -> MeasuredSurface:
        """What the files hold."""
        given = self.model_dump(exclude={"file"})
        try:
            options = reading_options(given, len(self.file))
        except TypeError as error:
            raise ValueError(str(error)) from error
        return read_surface(self.file, options)

    def shape(self) -> tuple[TabulatedSpectrum, str]:
        """Spectrum in metres, and eight digits that change with any of the files.

        Five digits of each number, so that simulations keep their names whatever the round-off.
        """
        table = self.measured.joint.spectrum
        lengths, densities = (
            tuple(float(f"{value:.5g}") for value in values)
            for values in (table.wavelengths, table.identity[1])
        )
        return TabulatedSpectrum(lengths, densities), self.measured.checksum


class TableSection(Section):
    """Spectral densities at wavelengths, as in `TabulatedSpectrum`; amplitudes scale them."""

    wavelengths: Annotated[tuple[Positive, ...], Field(min_length=2)]
    densities: Annotated[tuple[Positive, ...], Field(min_length=2)]

    def shape(self) -> tuple[TabulatedSpectrum, str]:
        """Spectrum in the unit of length of the configuration; no ending of its name."""
        return TabulatedSpectrum(self.wavelengths, self.densities), ""


class SpectrumSection(Section):
    """Shape of one spectrum: self-affine by its parameters, or another by its own section.

    The method `shape` of such a section returns the spectrum and what its name ends with.
    """

    # Names of files have up to 255 letters, of which those of checkpoints add some hundred.
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]
    short_cutoff: Positive | None = None
    roll_off: Positive | None = None
    hurst: float | None = None
    surface: SurfaceSection | None = None
    table: TableSection | None = None

    @model_validator(mode="after")
    def _complete(self) -> SpectrumSection:
        if sections := self._sections():
            others = "short_cutoff", "roll_off", "hurst", *sections[1:]
            _refuse_overruled(self, sections[0], others)
            return self
        if self.short_cutoff is not None:
            _refuse_unless_made(self._self_affine)
        if missing := _missing(self, ("short_cutoff", *(() if self._is_flat else ("hurst",)))):
            raise refusal(f"key {', '.join(missing)} is missing; add it, or a table or surface")
        return self

    def named(self, position: int, lateral: float) -> NamedSpectrum:
        """Spectrum at a position of the list, with its lengths divided by a unit."""
        for key in self._sections():
            try:
                spectrum, ending = getattr(self, key).shape()
            except (OSError, ValueError) as error:
                reason = str(error)
                if isinstance(error, OSError):
                    reason = f"{error.filename} cannot be read: {error.strerror}"
                raise ConfigurationError(f"spectra[{position}].{key}: {reason}") from error
            name = f"{self.name}-{ending}" if ending else self.name
            return NamedSpectrum(name, spectrum.in_units(lateral))
        return NamedSpectrum(self.name, self._self_affine().in_units(lateral))

    def _self_affine(self) -> SelfAffineSpectrum:
        """Spectrum of the parameters, in the unit of length of the configuration."""
        given: Any = self
        long = given.short_cutoff if given.roll_off is None else given.roll_off
        hurst = 1.0 if given.hurst is None else given.hurst  # without effect if flat
        return SelfAffineSpectrum(given.short_cutoff, long, hurst)

    @property
    def _is_flat(self) -> bool:
        """Whether there is a short cutoff, and no longer roll-off."""
        return self.short_cutoff is not None and self.roll_off in (None, self.short_cutoff)

    def _sections(self) -> list[str]:
        """Keys of the sections that are given: shapes other than self-affine ones."""
        return [key for key, value in self if isinstance(value, Section)]


class AmplitudesSection(Section):
    """Amplitudes relative to w_int, or to the heights of a measured surface, in one measure."""

    elastic_energy: Annotated[tuple[Energy, ...], Field(min_length=1)] | None = None
    work_of_adhesion_rms: Annotated[tuple[Rms, ...], Field(min_length=1)] | None = None
    measured: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _one_measure(self) -> AmplitudesSection:
        given = [value for _, value in self if value is not None]
        if len(given) != 1:
            raise refusal(
                "amplitudes need exactly one of elastic_energy, work_of_adhesion_rms and measured; "
                + ("remove one" if given else "give one")
            )
        # Texts have six digits.
        refuse_repeated("amplitude", [float(f"{value:g}") for value in given[0]])
        return self

    def elastic_energies(self, measured: float) -> tuple[float, ...]:
        """e_el / w_int, from w_rms^2 = 4 e_el w_int where the rms is given.

        Multiples of measured heights are those of its root; four digits, which names state.
        """
        if self.elastic_energy is not None:
            return self.elastic_energy
        if self.work_of_adhesion_rms is not None:
            return tuple(rms**2 / 4 for rms in self.work_of_adhesion_rms)
        found = tuple(float(f"{factor**2 * measured:.4g}") for factor in self.measured or ())
        if max(found) >= 1:
            raise ConfigurationError(
                f"amplitudes.measured: {max(self.measured or ()):g} times the heights have an "
                f"energy of full conformity of {max(found):g} w_int; it must be below w_int"
            )
        return found


class TileSection(Section):
    """Side of the periodic tile."""

    roll_offs: Positive
    cutoffs: Annotated[Positive, Field(ge=1)]


class NumericsSection(Section):
    """An error or a resolution, and the solver, as in `Numerics`."""

    error: Annotated[float, Field(gt=0, lt=1)] | None = None
    angles: Annotated[int, bounds_validator(SITES)] | None = None
    angles_per_cutoff: Density | None = None
    samples_per_cutoff: Density | None = None
    interpolation: Interpolation | None = None
    pixels_per_cutoff: Annotated[float, bounds_validator(PIXELS)] | None = None
    tile: TileSection
    tolerance: Annotated[float, bounds_validator(TOLERANCE)] | None = None
    max_sweeps: Count
    solver: str

    @model_validator(mode="after")
    def _usable(self) -> NumericsSection:
        if self.error is not None:
            _refuse_overruled(self, "error", [item.name for item in fields(Settings)])
        else:
            needed = ("samples_per_cutoff", "interpolation", "pixels_per_cutoff", "tolerance")
            if missing := _missing(self, needed):
                raise refusal(
                    f"{', '.join(missing)} missing; add what is missing or ask for an error"
                )
            _refuse_unless_one(
                "numerics need exactly one of angles and angles_per_cutoff",
                (self.angles, self.angles_per_cutoff),
                otherwise="give one, or ask for an error",
            )
        _refuse_unless_made(lambda: named_solver(self.solver, DEFAULT_TOLERANCE, self.max_sweeps))
        return self

    def numerics(self) -> Numerics:
        """Numerics with an error, or with a resolution and a tolerance."""
        given = {item.name: getattr(self, item.name) for item in fields(Settings)}
        if self.angles is not None:
            given["angles_per_cutoff"] = 1.0  # without effect
        return Numerics(
            settings=Settings(**given) if self.error is None else self.error,
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
        refuse_repeated("spring", self.springs)
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
            _refuse_overruled(self, "line", ("max_penetration", "step", "steady"))
            return self
        if self.max_penetration is None:
            raise refusal("key max_penetration is missing; add it, or a section line")
        _refuse_unless_one(
            "load needs exactly one of step (full cycles) and steady (parts of them)",
            (self.step, self.steady),
        )
        _refuse_unless_made(lambda: self.schedule(1.0))
        return self

    def schedule(self, vertical: float) -> SweepLoad:
        """Penetrations to visit, lengths divided by a unit, or straight fronts."""
        if self.line is not None:
            return LineLoad(**self.line.model_dump(exclude={"springs"}))
        given: Any = self
        deepest, steady = given.max_penetration / vertical, given.steady
        if steady is None:
            return FullCycle(deepest, given.step / vertical)
        return SteadySchedule(steady.start / vertical, deepest, steady.travel, steady.error)


class FitSection(Section):
    """Range of the fit."""

    lowest_elastic_energy: Positive
    highest_elastic_energy: Energy
    bootstrap: Annotated[int, bounds_validator(Range(FEWEST_BOOTSTRAP, 10**7))]

    @model_validator(mode="after")
    def _ordered(self) -> FitSection:
        if self.lowest_elastic_energy > self.highest_elastic_energy:
            raise refusal(
                f"lowest_elastic_energy {self.lowest_elastic_energy:g} is above "
                f"highest_elastic_energy {self.highest_elastic_energy:g}; swap them"
            )
        return self


def _refuse_unless_made(make: Callable[[], object]) -> None:
    """Raise if what a section stands for refuses its values."""
    try:
        make()
    except ValueError as error:
        raise refusal(str(error)) from error


def refuse_repeated(what: str, values: Any) -> None:
    """Raise if a value occurs twice."""
    known = set()
    for value in values:
        if value in known:
            raise refusal(f"{what} {value!r} stands twice; remove or change one")
        known.add(value)


def _refuse_overruled(section: Section, decider: str, keys: Iterable[str]) -> None:
    """Raise if a key is given that another one decides."""
    if given := [key for key in keys if getattr(section, key) is not None]:
        raise refusal(f"{decider} already decides {', '.join(given)}; remove one or the other")


def _refuse_unless_one(what: str, values: tuple[Any, Any], otherwise: str = "give one") -> None:
    """Raise if both of two values are given, or none."""
    given = [value is not None for value in values]
    if all(given) or not any(given):
        raise refusal(f"{what}; {'remove one' if all(given) else otherwise}")


def _missing(section: Section, keys: Iterable[str]) -> list[str]:
    """Keys of a section, of some names, that are not given."""
    return [key for key in keys if getattr(section, key) is None]
