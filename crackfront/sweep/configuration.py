"""Configuration files of sweeps, and the sweeps that they become."""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Iterable, Iterator
from itertools import product
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from crackfront.core.adhesion import FieldKind
from crackfront.core.resources import refuse_beyond_memory, refuse_beyond_time
from crackfront.core.units import Scales
from crackfront.simulate.contact import Pressed, SurfaceLoads
from crackfront.simulate.costs import expected_cost, refuse_oversized
from crackfront.simulate.laws import Settings
from crackfront.simulate.numerical_errors import missed_error
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.section import (
    ConfigurationError,
    Count,
    Section,
    Seed,
    refusal,
    validated,
    yaml_mapping,
)
from crackfront.sweep.sections import (
    AmplitudesSection,
    FitSection,
    LoadSection,
    NumericsSection,
    ScalesSection,
    SpectrumSection,
    refuse_repeated,
)
from crackfront.sweep.sweep import FitRange, NamedSpectrum, Sweep


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
        refuse_repeated("spectrum name", [spectrum.name for spectrum in self.spectra])
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
        line = self.load.line
        if line is not None and line.uncorrelated and self.numerics.error is not None:
            raise refusal(
                f"numerics.error is {self.numerics.error:g}, which chooses other pixels for each "
                "amplitude, and the disorder of load.line.uncorrelated sites depends on them; give "
                "angles_per_cutoff, samples_per_cutoff, interpolation, pixels_per_cutoff and "
                "tolerance"
            )
        if self.amplitudes.measured and not len(measured) == len(self.spectra) == 1:
            raise refusal(
                "amplitudes.measured are multiples of the heights of one surface; give one "
                "spectrum with a section surface"
            )
        return self

    def sweep(self) -> Sweep:
        """The sweep, in reduced units."""
        scales = None if self.scales is None else Scales(**dict(self.scales))
        lateral, vertical = (scales.lateral, scales.vertical) if scales else (1.0, 1.0)
        spectra, measured = tuple(self._spectra(lateral)), math.nan
        refuse_repeated("the name of a spectrum and its spring,", [one.name for one in spectra])
        if scales is not None and self.load.line is None:
            self._refuse_beyond_sphere(scales, spectra)
        surface = self.spectra[0].surface
        if self.amplitudes.measured and surface and scales:
            energy = surface.measured.conformity_energy(scales.contact_modulus).value
            measured = energy / scales.work_of_adhesion
        energies, fit = self.amplitudes.elastic_energies(measured), self.fit
        lowest = fit.lowest_elastic_energy * (1 - _ROUND_OFF)
        highest = fit.highest_elastic_energy * (1 + _ROUND_OFF)
        if not any(lowest <= energy <= highest for energy in energies):
            raise ConfigurationError(
                f"no amplitude lies in the range of the fit, e_el from "
                f"{fit.lowest_elastic_energy:g} to {fit.highest_elastic_energy:g}; widen the range"
            )
        return Sweep(
            seed=self.seed,
            kind=self.field,
            scales=scales,
            spectra=spectra,
            elastic_energies=energies,
            n_realisation=self.realisations,
            numerics=self.numerics.numerics(),
            schedule=self.load.schedule(vertical),
            record=self.record,
            failed_fraction=self.failed_fraction,
            fit=FitRange(*(value for _, value in self.fit)),
        )

    def _refuse_beyond_sphere(self, scales: Scales, spectra: Iterable[NamedSpectrum]) -> None:
        """Raise a ValueError if a length is none in metres: not below the radius of the sphere."""
        deepest = self.load.max_penetration or 0.0
        lengths = [("load.max_penetration", abs(deepest))]
        lengths += [
            (f"short_cutoff of {one.name}", scales.lateral * one.spectrum.short_cutoff)
            for one in spectra
        ]
        for name, length in lengths:
            if length >= scales.radius:
                raise ConfigurationError(
                    f"{name} is {length:g} m, and the radius of the sphere {scales.radius:g} m; "
                    "with a section scales all lengths are in metres"
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


def load_configuration(path: Path) -> Sweep:
    """Sweep of a configuration file.

    ConfigurationError if the file cannot be read, is no YAML mapping, or anything in it is unknown,
    missing or out of range; one sentence for each.
    """
    configuration = validated(path, yaml_mapping(path), Configuration)
    try:
        sweep = configuration.sweep()
        _refuse_infeasible(sweep)
    except ValueError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    return sweep


_LISTED_BYTES, _SAMPLE_BYTES = 500.0, 100.0
"""Memory of a simulation in a list, and of the means of a bootstrap sample at an amplitude."""


def _refuse_infeasible(sweep: Sweep) -> None:
    """Raise a ValueError if no machine can run a sweep, or its numerics are too coarse."""
    refuse_beyond_memory(
        f"realisations: {sweep.n_simulation:.3g} simulations",
        _LISTED_BYTES * sweep.n_simulation,
        "lower their number",
    )
    refuse_beyond_memory(
        f"fit: {sweep.fit.n_bootstrap} bootstrap samples",
        _SAMPLE_BYTES * sweep.fit.n_bootstrap * len(sweep.elastic_energies),
        "lower bootstrap",
    )
    seconds, numerics, schedule = 0.0, sweep.numerics, sweep.schedule
    deepest = schedule.max_penetration if isinstance(schedule, Pressed) else 0.0
    coarser = "use fewer, coarser or larger load steps, or smaller tiles"
    for item, energy in product(sweep.spectra, sweep.elastic_energies):
        size = schedule.usual_size(item.spectrum)
        settings = numerics.settings_of(sweep.kind, item.spectrum, energy, size)
        refuse_oversized(item.spectrum, numerics, settings, deepest)
        simulation = sweep.simulation(item, energy, 0)
        cost = expected_cost(simulation)
        refuse_beyond_memory(f"simulations of {item.name}", cost.memory, coarser, anywhere=True)
        seconds += sweep.n_realisation * cost.seconds
        if isinstance(schedule, SurfaceLoads):
            schedule.refuse_unresolved(simulation)
        _refuse_too_coarse(simulation, numerics.settings)
    refuse_beyond_time("the simulations", seconds, coarser)


_ROUND_OFF = 1e-9

_FEWEST_SITES = 0.7
"""Sites per short cutoff below which k is several times too large, and its bias not known."""

_FEWEST_SAMPLES = {"cubic": 2.0, "linear": 3.0}
"""Samples per short cutoff along a ray below which they miss waves: with 1, k of straight fronts at
w_rms 0.1 to 0.8 is 0 to 0.7 of its value with cubic pieces, and 0 to 0.3 with linear ones."""


def _refuse_too_coarse(simulation: Simulation, requested: Settings | float) -> None:
    """Raise if sites, tolerance or the error that the numerics leave are not as they must be."""
    sizes, tolerance = simulation.resolution, simulation.solver.tolerance
    name, energy = simulation.spectrum_name, simulation.elastic_energy
    length, cutoff = simulation.schedule.front_length, simulation.spectrum.short_cutoff
    if (density := sizes.n_angle * cutoff / length) < _FEWEST_SITES:
        raise ValueError(
            f"numerics: {sizes.n_angle} sites of a front are {density:.2g} per short cutoff of "
            f"{name}, with which k comes out too large; use {math.ceil(2 * length / cutoff)} or "
            "more, as angles_per_cutoff: 2 does"
        )
    fewest, density = _FEWEST_SAMPLES[sizes.interpolation], cutoff / sizes.spacing
    if density < fewest * (1 - _ROUND_OFF):
        raise ValueError(
            f"numerics: samples_per_cutoff is {density:.3g}, with which {sizes.interpolation} "
            f"pieces miss waves of {name} and k comes out too small; use {fewest:g} or more"
        )
    round_off = sys.float_info.epsilon * sizes.n_angle
    if tolerance < round_off:
        raise ValueError(
            f"numerics: tolerance is {tolerance}, below the round-off of the {sizes.n_angle} "
            f"sites of {name} ({round_off:.1e}); raise it"
        )
    if isinstance(requested, Settings) and tolerance > energy:
        raise ValueError(
            f"numerics: tolerance is {tolerance:g}, above e_el {energy:.3g} of {name}, to which "
            "forces of pinning are proportional, so that k comes out too large; use "
            f"{energy / 10:.1g} or less"
        )
    if isinstance(requested, float) and (left := missed_error(simulation, requested)):
        raise ValueError(
            f"numerics: error is {requested:g}, but the finest numerics leave {left:.2g} for "
            f"{name} at e_el {energy:g}; allow that, or give the settings"
        )


def results_folder(path: Path) -> Path:
    """Folder for the results of a configuration file, named after it.

    ConfigurationError if the name is not one for a folder and a command line.
    """
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", path.stem):
        raise ConfigurationError(
            f"the results are named after {path.name!r}, which must consist of letters, digits, "
            "_, - and dots; rename it"
        )
    return Path("results") / path.stem


SOURCE = "configuration.path"
"""File of a results folder that states the path of its configuration, relative to the folder."""


def refuse_older_layout(results: Path) -> None:
    """Raise ConfigurationError if results are of a version that kept curves in tar files."""
    if any((results / "curves").glob("*.tar")):
        raise ConfigurationError(
            f"{results} has results in the layout of an older version, which this one does not "
            "read; start a new folder: rename this one, or name another by --output"
        )


def refuse_other_configuration(path: Path, results: Path) -> None:
    """Raise ConfigurationError if results are those of another configuration that is still there.

    Two configurations of one name in two folders would share one folder of results.
    """
    source = results / SOURCE
    if not source.is_file():
        return
    other = results / source.read_text(encoding="utf-8").strip()
    if other.is_file() and not other.samefile(path) and other.read_bytes() != path.read_bytes():
        raise ConfigurationError(
            f"{results} has the results of {os.path.relpath(other)}, another configuration than "
            f"{path}; rename one of them, or name another folder by --output"
        )
