"""Sections of the spectra of a configuration: self-affine, a table, or a measured surface."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)

from crackfront.core.arguments import nearest_name
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum
from crackfront.sweep.section import (
    ConfigurationError,
    InputFile,
    Section,
    resolved_path,
    section_error,
)
from crackfront.sweep.section_checks import check_makes, check_not_overruled, missing_keys
from crackfront.sweep.sweep import NamedSpectrum
from crackfront.validation import Positive

# Imported where a configuration names a measured surface.
if TYPE_CHECKING:
    from crackfront.measured.options import ReadingOptions
    from crackfront.measured.spectrum.measured_surface import MeasuredSurface


def _as_tuple(value: Any) -> Any:
    """A tuple as it is; a single text or number as a tuple of one."""
    return (value,) if isinstance(value, (str, int)) else value


class SurfaceSection(Section):
    """Measurements of a surface, and the options by which they are read."""

    # The other keys are the fields of `ReadingOptions`.
    model_config = ConfigDict(extra="allow")

    file: Annotated[tuple[InputFile, ...], BeforeValidator(_as_tuple), Field(min_length=1)]
    _options: tuple[ReadingOptions, ...] = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> SurfaceSection:
        from crackfront.measured.options import ReadingOptions, reading_options

        options, keys = self.model_extra or {}, ReadingOptions.model_fields
        for key in options:
            if key not in keys:
                hint = nearest_name(key, keys, "the keys here are")
                raise section_error(f"unknown key {key}; {hint}")
        masks = _located_masks(options.get("mask"), info)
        try:
            self._options = tuple(reading_options(options | {"mask": masks}, len(self.file)))
        except (TypeError, ValueError) as error:
            raise section_error(str(error)) from error
        return self

    @functools.cached_property
    def measured(self) -> MeasuredSurface:
        """The surface; its files are read when it is first used."""
        from crackfront.measured.spectrum.measured_surface import read_surface

        return read_surface(self.file, self._options)

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


def _located_masks(masks: Any, info: ValidationInfo) -> Any:
    """Parts of a scan as they are, and files relative to the configuration; None without masks."""
    if masks is None:
        return None
    return tuple(
        str(resolved_path(Path(mask), info)) if isinstance(mask, str) and ":" not in mask else mask
        for mask in (masks if isinstance(masks, tuple) else (masks,))
    )


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

    # Names of files have up to 255 letters, and names of checkpoints add about a hundred.
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]
    short_cutoff: Positive | None = None
    roll_off: Positive | None = None
    hurst: float | None = None
    surface: SurfaceSection | None = None
    table: TableSection | None = None

    @model_validator(mode="after")
    def _complete(self) -> SpectrumSection:
        if sections := self._sections():
            overruled = "short_cutoff", "roll_off", "hurst", *sections[1:]
            check_not_overruled(self, sections[0], overruled)
            return self
        if self.short_cutoff is not None:
            check_makes(self._self_affine)
        needed = ("short_cutoff",) if self._is_flat else ("short_cutoff", "hurst")
        if missing := missing_keys(self, needed):
            raise section_error(
                f"key {', '.join(missing)} is missing; add it, or a table or surface"
            )
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
        short_cutoff: Any = self.short_cutoff
        roll_off = short_cutoff if self.roll_off is None else self.roll_off
        hurst = 1.0 if self.hurst is None else self.hurst  # without effect if flat
        return SelfAffineSpectrum(short_cutoff, roll_off, hurst)

    @property
    def _is_flat(self) -> bool:
        """Whether there is a short cutoff, and no longer roll-off."""
        return self.short_cutoff is not None and self.roll_off in (None, self.short_cutoff)

    def _sections(self) -> list[str]:
        """Keys of the sections that are given: shapes other than self-affine ones."""
        return [key for key, value in self if isinstance(value, Section)]
