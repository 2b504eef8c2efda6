"""Configuration files: read, validated in full, and turned into a sweep."""

from __future__ import annotations

import re
import sys
from dataclasses import fields
from pathlib import Path

from pydantic import ValidationError

from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.data.yaml import ConfigurationError, content_of, sentences
from crackfront.simulate.laws import Knobs
from crackfront.simulate.simulation import Numerics, missed_error
from crackfront.sweep.sections import (
    Configuration,
    LoadSection,
    NumericsSection,
    SpectrumSection,
    SurfaceSection,
)
from crackfront.sweep.sweep import FitRange, NamedSpectrum, Sweep
from crackfront.topography.measures import measured_surface
from crackfront.topography.reading import Treatment, read_measurements


def load_configuration(path: Path) -> Sweep:
    """Sweep of a configuration file.

    Parameters
    ----------
    path : Path
        YAML file.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, is no YAML mapping, or anything in it is unknown, missing or
        out of range; one sentence for each.
    """
    content = content_of(path)
    try:
        configuration = Configuration.model_validate(content)
    except ValidationError as error:
        raise ConfigurationError(
            "\n".join(f"{path}: {line}" for line in sentences(error.errors(), Configuration))
        ) from error
    try:
        sweep = _sweep(configuration)
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    _refuse_unreachable(path, sweep)
    return sweep


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


def _refuse_unreachable(path: Path, sweep: Sweep) -> None:
    """Raise if numerics leave more than the asked error, or round-off exceeds their tolerance."""
    asked = sweep.numerics.knobs
    for item in sweep.spectra:
        for energy in sweep.elastic_energies:
            simulation = sweep.simulation(item, energy, 0)
            n_angle, tolerance = simulation.resolution.n_angle, simulation.solver.tolerance
            round_off = sys.float_info.epsilon * n_angle
            if tolerance < round_off:
                raise ConfigurationError(
                    f"{path}: numerics: tolerance is {tolerance}, below the round-off of "
                    f"the {n_angle} sites of {item.name} ({round_off:.1e}); raise it"
                )
            if isinstance(asked, float) and (left := missed_error(simulation, asked)):
                raise ConfigurationError(
                    f"{path}: numerics: error is {asked:g}, but the finest numerics leave "
                    f"{left:.2g} for {item.name} at e_el {energy:g}; ask for that, or give the "
                    "knobs"
                )


def _sweep(configuration: Configuration) -> Sweep:
    """Frozen parameters in reduced units."""
    scales = None if configuration.scales is None else Scales(**dict(configuration.scales))
    lateral, vertical = (scales.lateral, scales.vertical) if scales else (1.0, 1.0)
    numerics, load, fit = configuration.numerics, configuration.load, configuration.fit
    return Sweep(
        seed=configuration.seed,
        kind=configuration.field,
        scales=scales,
        spectra=tuple(
            _named_spectrum(position, item, lateral)
            for position, item in enumerate(configuration.spectra)
        ),
        elastic_energies=configuration.amplitudes.elastic_energies,
        n_realisation=configuration.realisations,
        numerics=_numerics(numerics),
        schedule=_schedule(load, vertical),
        record=configuration.record,
        failed_fraction=configuration.failed_fraction,
        fit=FitRange(fit.lowest_elastic_energy, fit.highest_elastic_energy, fit.bootstrap),
    )


def _named_spectrum(position: int, section: SpectrumSection, lateral: float) -> NamedSpectrum:
    """Spectrum of a section, lengths divided by a unit."""
    if section.surface is None:
        short, hurst = section.short_cutoff, section.hurst
        assert short is not None, "the schema asks for it"
        assert hurst is not None, "the schema asks for it"
        return NamedSpectrum(
            section.name,
            SelfAffineSpectrum(short / lateral, (section.roll_off or short) / lateral, hurst),
        )
    try:
        spectrum, checksum = _fitted(section.surface)
    except OSError as error:
        raise ConfigurationError(
            f"spectra[{position}].surface: {error.filename} cannot be read: {error.strerror}"
        ) from error
    except ValueError as error:
        raise ConfigurationError(f"spectra[{position}].surface: {error}") from error
    return NamedSpectrum(
        f"{section.name}-{checksum}",
        SelfAffineSpectrum(
            spectrum.short_cutoff / lateral, spectrum.roll_off / lateral, spectrum.hurst
        ),
    )


def _fitted(section: SurfaceSection) -> tuple[SelfAffineSpectrum, str]:
    """Spectrum of a surface in metres, and eight digits that change with any of its files.

    Five digits of each parameter, so that simulations keep their names whatever the round-off.
    """
    treatment = Treatment(section.detrend, section.unit, section.size, section.shortest)
    surface = measured_surface(read_measurements(section.file, treatment))
    found = surface.fitted.spectrum
    short, long, hurst = (
        float(f"{value:.5g}") for value in (found.short_cutoff, found.roll_off, found.hurst)
    )
    return SelfAffineSpectrum(short, max(short, long), hurst), surface.checksum


def _numerics(section: NumericsSection) -> Numerics:
    """Numerics of a section, which has an error or all knobs."""
    names = [item.name for item in fields(Knobs)]
    given = {name: getattr(section, name) for name in names}
    if section.angles is not None:
        given["angles_per_cutoff"] = 1.0  # without effect
    return Numerics(
        knobs=Knobs(**given) if section.error is None else section.error,
        tile_roll_offs=section.tile.roll_offs,
        tile_cutoffs=section.tile.cutoffs,
        max_sweeps=section.max_sweeps,
        solver=section.solver,
    )


def _schedule(load: LoadSection, vertical: float) -> LoadSchedule | SteadySchedule:
    """Penetrations to visit, lengths divided by a unit."""
    deepest, steady = load.max_penetration / vertical, load.steady
    if load.step is not None:
        return LoadSchedule(deepest, load.step / vertical)
    assert steady is not None, "the schema asks for one of the two"
    return SteadySchedule(steady.start / vertical, deepest, steady.travel, steady.error)
