"""Configurations of sweeps: the keys of the file, read and validated.

Reading does not open scans and predicts neither errors nor costs. Three more steps lead from a
configuration to its costs: :func:`crackfront.sweep.parameters.configured_sweep` makes the
parameters, :meth:`crackfront.sweep.sweep.Sweep.simulation` chooses the settings of each simulation,
and :func:`crackfront.simulate.costs.expected_cost` predicts time and memory.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, get_args

from pydantic import BeforeValidator, Field, model_validator

from crackfront.core.adhesion import FieldKind
from crackfront.simulate.simulation import Recorded
from crackfront.sweep.section import Section, section_error, validated, yaml_mapping
from crackfront.sweep.section_checks import check_distinct
from crackfront.sweep.sections import (
    AmplitudesSection,
    FitSection,
    LoadSection,
    NumericsSection,
    ScalesSection,
)
from crackfront.sweep.spectrum_sections import SpectrumSection
from crackfront.validation import Count, Seed


def _listed(record: Any) -> Any:
    """What to record; an error with all that may be in the list if it is a word instead."""
    if isinstance(record, str):
        names = ", ".join(get_args(Recorded))
        raise section_error(f"{record!r} is not a list; give one or more of {names}, as in [jumps]")
    return record


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
    record: Annotated[tuple[Recorded, ...], BeforeValidator(_listed)] = ()
    failed_fraction: Annotated[float, Field(ge=0, le=1)] = 0.1
    fit: FitSection = FitSection()

    @model_validator(mode="after")
    def _names_differ(self) -> Configuration:
        check_distinct("spectrum name", [spectrum.name for spectrum in self.spectra])
        return self

    @model_validator(mode="after")
    def _field_suits_amplitudes(self) -> Configuration:
        if self.field == "chemical" and self.amplitudes.elastic_energy is not None:
            raise section_error(
                "amplitudes.elastic_energy is meaningless for a chemical field; give "
                "amplitudes.work_of_adhesion_rms"
            )
        return self

    @model_validator(mode="after")
    def _measured_surfaces_have_scales(self) -> Configuration:
        measured = self._measured
        if measured and self.scales is None:
            raise section_error(
                f"spectrum {measured[0]!r} describes a surface in metres; give the section scales"
            )
        if measured and self.field == "chemical":
            raise section_error(
                f"spectrum {measured[0]!r} is the spectrum of heights; field must be roughness"
            )
        return self

    @model_validator(mode="after")
    def _line_suits_spectra(self) -> Configuration:
        if self.load.line is None:
            return self
        for item in self.spectra:
            if item.anisotropy is not None:
                raise section_error(
                    f"spectrum {item.name!r} is anisotropic, and load.line chooses its tiles and "
                    "loads by laws of isotropic spectra; remove anisotropy, or simulate spheres"
                )
        for item in self.spectra:
            if item.tiles is not None:
                raise section_error(
                    f"spectrum {item.name!r} has tiles of files, and load.line chooses the sides "
                    "of its tiles; simulate spheres, or describe the files by surface"
                )
        return self

    @model_validator(mode="after")
    def _tiles_suffice(self) -> Configuration:
        for item in self.spectra:
            n_file = math.inf if item.tiles is None else len(item.tiles.file)
            if self.realisations > n_file:
                raise section_error(
                    f"realisations is {self.realisations}, and spectrum {item.name!r} has tiles of "
                    f"{n_file} files; lower realisations, or name more files"
                )
        return self

    @model_validator(mode="after")
    def _sites_suit_uncorrelated_line(self) -> Configuration:
        if self.load.line is None or not self.load.line.uncorrelated:
            return self
        for item in self.spectra:
            if item.marginal is not None:
                raise section_error(
                    f"spectrum {item.name!r} has a marginal, and the sites of "
                    "load.line.uncorrelated are independent and Gaussian; remove marginal or "
                    "uncorrelated"
                )
        if self.numerics.error is not None:
            raise section_error(
                f"numerics.error is {self.numerics.error:g}, which chooses other pixels for each "
                "amplitude, and the disorder of load.line.uncorrelated sites depends on them; give "
                "angles_per_cutoff, samples_per_cutoff, interpolation, pixels_per_cutoff and "
                "tolerance"
            )
        return self

    @model_validator(mode="after")
    def _measured_amplitudes_have_one_surface(self) -> Configuration:
        if self.amplitudes.measured and not len(self._measured) == len(self.spectra) == 1:
            raise section_error(
                "amplitudes.measured are multiples of the heights of one surface; give one "
                "spectrum with a section surface, density or tiles"
            )
        return self

    @property
    def _measured(self) -> list[str]:
        """Names of the spectra of surfaces in metres."""
        return [item.name for item in self.spectra if item.in_metres is not None]


def load_configuration(path: Path) -> Configuration:
    """Configuration of a sweep, read from a YAML file and validated.

    ConfigurationError if the file cannot be read, is not a YAML mapping, or anything in it is
    unknown, missing or out of range; one sentence for each.
    """
    return validated(path, yaml_mapping(path), Configuration)
