"""Parameters of a sweep, from its configuration."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from crackfront.core.units import Scales
from crackfront.sweep.configuration import Configuration, load_configuration
from crackfront.sweep.section import ConfigurationError
from crackfront.sweep.section_checks import check_distinct
from crackfront.sweep.sections import FitSection
from crackfront.sweep.sweep import FitRange, NamedSpectrum, Sweep


def load_sweep(path: Path) -> Sweep:
    """Parameters of the sweep of a configuration file.

    ConfigurationError, with a sentence that names the file, if the file or a scan that it names
    cannot be used.
    """
    configuration = load_configuration(path)
    try:
        return configured_sweep(configuration)
    except ValueError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def configured_sweep(configuration: Configuration) -> Sweep:
    """Parameters of the sweep of a configuration, in reduced units.

    The scans of a measured surface are read here, because names and keys of simulations depend on
    them. ValueError if they cannot be used, or the amplitudes and lengths do not fit together.
    """
    scales = None if configuration.scales is None else Scales(**dict(configuration.scales))
    lateral, vertical = (scales.lateral, scales.vertical) if scales else (1.0, 1.0)
    spectra = tuple(_named_spectra(configuration, lateral))
    check_distinct("the name of a spectrum and its spring,", [item.name for item in spectra])
    if scales is not None and configuration.load.line is None:
        _check_lengths(configuration, scales, spectra)
    elastic_energies = _elastic_energies(configuration, scales)
    return Sweep(
        seed=configuration.seed,
        kind=configuration.field,
        scales=scales,
        spectra=spectra,
        elastic_energies=elastic_energies,
        n_realisation=configuration.realisations,
        numerics=configuration.numerics.numerics(),
        schedule=configuration.load.schedule(vertical),
        record=configuration.record,
        failed_fraction=configuration.failed_fraction,
        fit=_fit_range(configuration.fit, elastic_energies),
    )


def _named_spectra(configuration: Configuration, lateral: float) -> Iterator[NamedSpectrum]:
    """Spectra of the sweep; of straight fronts each spectrum with each spring."""
    line = configuration.load.line
    for position, section in enumerate(configuration.spectra):
        item = section.named(position, lateral)
        if line is None:
            yield item
            continue
        for spring in line.springs:
            # A name is part of the names of files.
            ending = f"{spring:g}".replace(".", "p").replace("+", "")
            yield replace(item, name=f"{item.name}-L{ending}", spring=spring)


def _elastic_energies(configuration: Configuration, scales: Scales | None) -> tuple[float, ...]:
    """Requested e_el / w_int."""
    measured, section = math.nan, configuration.spectra[0].in_metres
    if configuration.amplitudes.measured and section and scales:
        energy = section.measured.conformity_energy(scales.contact_modulus).value
        measured = energy / scales.work_of_adhesion
    return configuration.amplitudes.elastic_energies(measured)


def _fit_range(section: FitSection, elastic_energies: Sequence[float]) -> FitRange:
    """Range of the fit, which must contain an amplitude; by default it contains all."""
    lowest, highest = section.lowest_elastic_energy, section.highest_elastic_energy
    fit = FitRange(
        min(elastic_energies) if lowest is None else lowest,
        max(elastic_energies) if highest is None else highest,
        section.bootstrap,
    )
    if not fit.chosen(elastic_energies):
        raise ConfigurationError(
            "no amplitude lies in the range of the fit, e_el from "
            f"{fit.lowest_elastic_energy:g} to {fit.highest_elastic_energy:g}; widen the range"
        )
    return fit


def _check_lengths(
    configuration: Configuration, scales: Scales, spectra: Iterable[NamedSpectrum]
) -> None:
    """Raise ConfigurationError if a length in metres is not below the radius of the sphere."""
    max_penetration = configuration.load.max_penetration or 0.0
    lengths = [("load.max_penetration", abs(max_penetration), scales.vertical)]
    for item in spectra:
        short_cutoff = scales.lateral * item.spectrum.short_cutoff
        lengths.append((f"short_cutoff of {item.name}", short_cutoff, scales.lateral))
    for name, length, unit in lengths:
        if length >= scales.radius:
            raise ConfigurationError(
                f"{name} is {length:g} m, and the radius of the sphere {scales.radius:g} m; "
                "with a section scales all lengths are in metres; "
                f"{length:g} in reduced units is {length * unit:.4g} m"
            )
