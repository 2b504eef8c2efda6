"""Configuration files of sweeps: the schema of their sections, and the sweep that they become."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, create_model, model_validator

from crackfront.analysis.sweep import FEWEST_BOOTSTRAP
from crackfront.core.adhesion import FieldKind, larkin_length
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import Interpolation
from crackfront.core.solver.relax import SOLVERS
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.data.bounds import (
    SI,
    Range,
    refuse_beyond_memory,
    refuse_beyond_time,
)
from crackfront.data.section import (
    ConfigurationError,
    Count,
    Density,
    Energy,
    InputFile,
    Positive,
    Section,
    Seed,
    content_of,
    refusal,
    validated,
    within,
)
from crackfront.simulate.costs import expected_cost, refuse_oversized
from crackfront.simulate.laws import Knobs
from crackfront.simulate.lines import LineLoad, SpringUnit
from crackfront.simulate.simulation import Numerics, Simulation, missed_error
from crackfront.simulate.steady import SteadySchedule
from crackfront.sweep.sweep import FitRange, NamedSpectrum, Sweep
from crackfront.topography.measures import read_surface
from crackfront.topography.options import ReadingOptions, declared, options_for_each

Rms = Annotated[float, Field(gt=0, lt=2, allow_inf_nan=False)]


class ScalesSection(Section):
    """Scene in SI units."""

    radius: Annotated[float, within(SI["m"])]
    work_of_adhesion: Annotated[float, within(SI["J/m^2"])]
    contact_modulus: Annotated[float, within(SI["Pa"])]


def _several(value: Any) -> Any:
    """The list that a single text or number stands for."""
    return (value,) if isinstance(value, (str, int)) else value


_READING_KEYS: Any = {item.name: (Any, item.default) for item in declared(ReadingOptions)}

_ReadingSection = create_model("_ReadingSection", __base__=Section, **_READING_KEYS)


class SurfaceSection(_ReadingSection):
    """Measurements of a surface, and the options by which they are read."""

    file: Annotated[tuple[InputFile, ...], BeforeValidator(_several), Field(min_length=1)]

    def shape(self) -> tuple[TabulatedSpectrum, str]:
        """Spectrum in metres, and eight digits that change with any of the files.

        Five digits of each number, so that simulations keep their names whatever the round-off.
        """
        given = self.model_dump(exclude={"file"})
        try:
            options = options_for_each(ReadingOptions, given, len(self.file))
        except TypeError as error:
            raise ValueError(str(error)) from error
        surface = read_surface(self.file, options)
        table = surface.joint.spectrum
        lengths, densities = (
            tuple(float(f"{value:.5g}") for value in values)
            for values in (table.wavelengths, table.identity[1])
        )
        return TabulatedSpectrum(lengths, densities), surface.checksum


_SELF_AFFINE = ("short_cutoff", "roll_off", "hurst")


class SpectrumSection(Section):
    """Shape of one spectrum: self-affine by its parameters, or another by its own section.

    The method `shape` of such a section returns the spectrum and what its name ends with.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
    short_cutoff: Positive | None = None
    roll_off: Positive | None = None
    hurst: Annotated[float, Field(gt=0, le=1)] | None = None
    surface: SurfaceSection | None = None

    @model_validator(mode="after")
    def _complete(self) -> SpectrumSection:
        sections = self._sections()
        if sections:
            _refuse_overruled(self, sections[0], (*_SELF_AFFINE, *sections[1:]))
        elif missing := _missing(self, ("short_cutoff", "hurst")):
            raise refusal(f"key {', '.join(missing)} is missing; add it, or name a surface")
        if self.roll_off and self.short_cutoff and self.roll_off < self.short_cutoff:
            raise refusal(
                f"roll_off {self.roll_off:g} is shorter than short_cutoff {self.short_cutoff:g}; "
                "lower the cutoff or raise the roll-off (equal values give a flat spectrum)"
            )
        return self

    def named(self, position: int, lateral: float) -> NamedSpectrum:
        """Spectrum that stands at a position of the list, lengths divided by a unit."""
        for key in self._sections():
            try:
                spectrum, ending = getattr(self, key).shape()
            except OSError as error:
                raise ConfigurationError(
                    f"spectra[{position}].{key}: {error.filename} cannot be read: {error.strerror}"
                ) from error
            except ValueError as error:
                raise ConfigurationError(f"spectra[{position}].{key}: {error}") from error
            name = f"{self.name}-{ending}" if ending else self.name
            return NamedSpectrum(name, spectrum.in_units(lateral))
        assert self.short_cutoff is not None, "the schema asks for it"
        assert self.hurst is not None, "the schema asks for it"
        long = self.roll_off or self.short_cutoff
        fractal = SelfAffineSpectrum(self.short_cutoff, long, self.hurst)
        return NamedSpectrum(self.name, fractal.in_units(lateral))

    def _sections(self) -> list[str]:
        """Keys of the sections that are given: shapes other than self-affine ones."""
        return [key for key, value in self if isinstance(value, Section)]


class AmplitudesSection(Section):
    """Amplitudes relative to w_int, in one of two measures."""

    elastic_energy: Annotated[tuple[Energy, ...], Field(min_length=1)] | None = None
    work_of_adhesion_rms: Annotated[tuple[Rms, ...], Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _one_measure(self) -> AmplitudesSection:
        _refuse_unless_one(
            "amplitudes need exactly one of elastic_energy and work_of_adhesion_rms",
            (self.elastic_energy, self.work_of_adhesion_rms),
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
    cutoffs: Annotated[Positive, Field(ge=1)]


class NumericsSection(Section):
    """An error or a resolution, and the solver, as in `Numerics`."""

    error: Annotated[float, Field(gt=0, lt=1)] | None = None
    angles: Annotated[Count, Field(ge=4)] | None = None
    angles_per_cutoff: Density | None = None
    samples_per_cutoff: Density | None = None
    interpolation: Interpolation | None = None
    pixels_per_cutoff: Density | None = None
    tile: TileSection
    tolerance: Annotated[float, Field(gt=0, lt=1)] | None = None
    max_sweeps: Count
    solver: str

    @model_validator(mode="after")
    def _usable(self) -> NumericsSection:
        knobs = [item.name for item in fields(Knobs)]
        if self.error is not None:
            _refuse_overruled(self, "error", knobs)
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

    def numerics(self) -> Numerics:
        """Numerics with an error or all knobs."""
        given = {item.name: getattr(self, item.name) for item in fields(Knobs)}
        if self.angles is not None:
            given["angles_per_cutoff"] = 1.0  # without effect
        return Numerics(
            knobs=Knobs(**given) if self.error is None else self.error,
            tile_roll_offs=self.tile.roll_offs,
            tile_cutoffs=self.tile.cutoffs,
            max_sweeps=self.max_sweeps,
            solver=self.solver,
        )


class SteadySection(Section):
    """Steady parts of the branches only, as in `SteadySchedule`.

    States nearer than a hundredth of the correlation length are no further samples.
    """

    start: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    travel: Annotated[Positive, Field(ge=0.01)]
    error: Positive


class LineSection(Section):
    """Straight fronts instead of spheres, as in `LineLoad`."""

    springs: Annotated[tuple[Positive, ...], Field(min_length=1)]
    spring_unit: SpringUnit = "correlation_length"
    length: Annotated[Positive, Field(ge=8)]
    period: Annotated[Positive, Field(ge=20)]
    transient: Annotated[Positive, Field(ge=3)]
    step: Positive
    uncorrelated: bool = False

    @model_validator(mode="after")
    def _distinct(self) -> LineSection:
        _refuse_repeated("spring", self.springs)
        return self

    def load(self) -> LineLoad:
        """How all fronts of the sweep are held."""
        given = {item.name: getattr(self, item.name) for item in fields(LineLoad)}
        return LineLoad(**given)


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
        if self.max_penetration < 0:
            raise refusal(
                f"max_penetration is {self.max_penetration:g}, which never makes contact; the "
                "sphere touches at 0, so it must be 0 or more"
            )
        _refuse_unless_one(
            "load needs exactly one of step (full cycles) and steady (parts of them)",
            (self.step, self.steady),
        )
        if self.steady is not None and self.steady.start >= self.max_penetration:
            raise refusal(
                f"steady.start {self.steady.start:g} is not below max_penetration "
                f"{self.max_penetration:g}; lower it or penetrate deeper"
            )
        return self

    def schedule(self, vertical: float) -> LoadSchedule | SteadySchedule | LineLoad:
        """Penetrations to visit, lengths divided by a unit, or straight fronts."""
        if self.line is not None:
            return self.line.load()
        assert self.max_penetration is not None, "the schema asks for it"
        deepest, steady = self.max_penetration / vertical, self.steady
        if self.step is not None:
            return LoadSchedule(deepest, self.step / vertical)
        assert steady is not None, "the schema asks for one of the two"
        return SteadySchedule(steady.start / vertical, deepest, steady.travel, steady.error)


class FitSection(Section):
    """Range of the fit."""

    lowest_elastic_energy: Positive
    highest_elastic_energy: Energy
    bootstrap: Annotated[int, within(Range(FEWEST_BOOTSTRAP, 10**7))]

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

    seed: Seed
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

    def sweep(self) -> Sweep:
        """The sweep, in reduced units."""
        scales = None if self.scales is None else Scales(**dict(self.scales))
        lateral, vertical = (scales.lateral, scales.vertical) if scales else (1.0, 1.0)
        fit = self.fit
        return Sweep(
            seed=self.seed,
            kind=self.field,
            scales=scales,
            spectra=tuple(self._spectra(lateral)),
            elastic_energies=self.amplitudes.elastic_energies,
            n_realisation=self.realisations,
            numerics=self.numerics.numerics(),
            schedule=self.load.schedule(vertical),
            record=self.record,
            failed_fraction=self.failed_fraction,
            fit=FitRange(fit.lowest_elastic_energy, fit.highest_elastic_energy, fit.bootstrap),
        )

    def _spectra(self, lateral: float) -> Iterator[NamedSpectrum]:
        """Spectra of the sweep, those of straight fronts once for each spring."""
        for place, item in enumerate(self.spectra):
            named = item.named(place, lateral)
            if self.load.line is None:
                yield named
                continue
            for spring in self.load.line.springs:
                # A name is part of the names of files.
                ending = f"{spring:g}".replace(".", "p").replace("+", "")
                yield NamedSpectrum(f"{named.name}-L{ending}", named.spectrum, spring)


def _refuse_repeated(what: str, values: Any) -> None:
    """Raise if a value stands twice."""
    known = set()
    for value in values:
        if value in known:
            raise refusal(f"{what} {value!r} stands twice; remove or change one")
        known.add(value)


def _refuse_overruled(section: Section, decider: str, keys: Iterable[str]) -> None:
    """Raise if a key is given that another one decides."""
    missing = _missing(section, keys)
    if given := [key for key in keys if key not in missing]:
        raise refusal(f"{decider} already decides {', '.join(given)}; remove one or the other")


def _refuse_unless_one(what: str, values: tuple[Any, Any], otherwise: str = "give one") -> None:
    """Raise if both of two values are given, or none."""
    given = [value is not None for value in values]
    if all(given) or not any(given):
        raise refusal(f"{what}; {'remove one' if all(given) else otherwise}")


def _missing(section: Section, keys: Iterable[str]) -> list[str]:
    """Those of some keys that are not given."""
    return [key for key in keys if getattr(section, key) is None]


def load_configuration(path: Path) -> Sweep:
    """Sweep of a configuration file.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, is no YAML mapping, or anything in it is unknown, missing or
        out of range; one sentence for each.
    """
    configuration = validated(path, content_of(path), Configuration)
    try:
        sweep = configuration.sweep()
        _refuse_endless(sweep)
        _refuse_unreachable(sweep)
    except ValueError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    return sweep


_LISTED_BYTES = 500.0
"""Memory of a simulation in a list."""


def _refuse_endless(sweep: Sweep) -> None:
    """Raise if a sweep is larger than can be listed, fitted or run."""
    refuse_beyond_memory(
        f"realisations: {sweep.n_simulation:.3g} simulations",
        _LISTED_BYTES * sweep.n_simulation,
        "lower their number",
    )
    refuse_beyond_memory(
        f"fit: {sweep.fit.n_bootstrap} bootstrap samples of {sweep.n_realisation} realisations",
        16.0 * sweep.fit.n_bootstrap * sweep.n_realisation,
        "lower bootstrap",
    )
    seconds, straight = 0.0, sweep.schedule.straight
    for item in sweep.spectra:
        for energy in sweep.elastic_energies:
            knobs = sweep.numerics.knobs_of(sweep.kind, item.spectrum, energy, straight=straight)
            refuse_oversized(item.spectrum, sweep.numerics, knobs, sweep.schedule.max_penetration)
            cost = expected_cost(sweep.simulation(item, energy, 0))
            coarser = "use fewer, coarser or larger load steps, or smaller tiles"
            refuse_beyond_memory(f"simulations of {item.name}", cost.memory, coarser, anywhere=True)
            seconds += sweep.n_realisation * cost.seconds
    refuse_beyond_time("the simulations", seconds, coarser)


def _refuse_unreachable(sweep: Sweep) -> None:
    """Raise if numerics leave more than the asked error, or round-off exceeds their tolerance."""
    asked = sweep.numerics.knobs
    for item in sweep.spectra:
        for energy in sweep.elastic_energies:
            simulation = sweep.simulation(item, energy, 0)
            _refuse_unresolved(simulation, item.name)
            n_angle, tolerance = simulation.resolution.n_angle, simulation.solver.tolerance
            round_off = sys.float_info.epsilon * n_angle
            if tolerance < round_off:
                raise ConfigurationError(
                    f"numerics: tolerance is {tolerance}, below the round-off of the {n_angle} "
                    f"sites of {item.name} ({round_off:.1e}); raise it"
                )
            if isinstance(asked, float) and (left := missed_error(simulation, asked)):
                raise ConfigurationError(
                    f"numerics: error is {asked:g}, but the finest numerics leave {left:.2g} for "
                    f"{item.name} at e_el {energy:g}; allow that, or give the knobs"
                )


def _refuse_unresolved(simulation: Simulation, name: str) -> None:
    """Raise if a straight front has fewer than two sites on the length over which it bends."""
    sizes, energy = simulation.resolution, simulation.elastic_energy
    larkin = larkin_length(simulation.kind, simulation.spectrum, 2 * math.sqrt(energy))
    site = sizes.tile_side / sizes.n_angle
    if simulation.schedule.straight and larkin < 2 * site:
        raise ConfigurationError(
            f"numerics: the Larkin length of {name} at e_el {energy:g} is {larkin:.3g}, below two "
            f"sites ({2 * site:.3g}); lower the amplitude or use more sites"
        )


def results_folder(path: Path) -> Path:
    """Folder for the results of a configuration file, named after it.

    Raises
    ------
    ConfigurationError
        If the name is not one for a folder and a command line.
    """
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", path.stem):
        raise ConfigurationError(
            f"the results are named after {path.name!r}, which must consist of letters, digits, "
            "_, - and dots; rename it"
        )
    return Path("results") / path.stem
