"""Sections of the spectra of a configuration: self-affine, a table, or from files."""

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
from crackfront.core.marginal import Marginal
from crackfront.core.spectrum import (
    AnisotropicSpectrum,
    SelfAffineSpectrum,
    Spectrum,
    TabulatedSpectrum,
)
from crackfront.simulate.ensembles import GAUSSIAN, Ensemble, MarginalEnsemble
from crackfront.sweep.section import (
    ConfigurationError,
    InputFile,
    Section,
    resolved_path,
    section_error,
)
from crackfront.sweep.section_checks import (
    check_distinct,
    check_makes,
    check_not_overruled,
    missing_keys,
)
from crackfront.sweep.sweep import NamedSpectrum
from crackfront.validation import Finite, Positive

# Imported where a configuration names a measured surface.
if TYPE_CHECKING:
    from crackfront.measured.options import Options, PsdOptions, ReadingOptions
    from crackfront.measured.scan.psd import Psd
    from crackfront.measured.spectrum.measured_surface import MeasuredSurface, RoughSurface
    from crackfront.measured.spectrum.stated import StatedSurface
    from crackfront.measured.tile_ensemble import TileFiles


def _as_tuple(value: Any) -> Any:
    """A tuple as it is; a single text or number as a tuple of one."""
    return (value,) if isinstance(value, (str, int)) else value


class FileSection(Section):
    """Files that state a surface in metres, and the options by which they are read."""

    # The other keys are options of the reader.
    model_config = ConfigDict(extra="allow")

    @property
    def measured(self) -> RoughSurface:
        """The surface; its files are read when it is first used."""
        raise NotImplementedError

    @property
    def checksum(self) -> str:
        """Eight digits that change with any of the files."""
        raise NotImplementedError

    def table(self) -> TabulatedSpectrum:
        """Spectrum of the surface (Units: m)."""
        raise NotImplementedError

    def shape(self) -> tuple[TabulatedSpectrum, str]:
        """Spectrum in metres, and eight digits that change with any of the files.

        Five digits of each number, so that simulations keep their names whatever the round-off.
        """
        table = self.table()
        lengths, densities = (
            tuple(float(f"{value:.5g}") for value in values)
            for values in (table.wavelengths, table.identity[1])
        )
        return TabulatedSpectrum(lengths, densities), self.checksum

    def _check_names(self, options: type[Options]) -> None:
        """Raise if a key is not an option of the reader."""
        for key in self.model_extra or {}:
            if key not in options.model_fields:
                hint = nearest_name(key, options.model_fields, "the keys here are")
                raise section_error(f"unknown key {key}; {hint}")


class ScansSection(FileSection):
    """Files of scans, and the options by which they are read."""

    file: Annotated[tuple[InputFile, ...], BeforeValidator(_as_tuple), Field(min_length=1)]
    _options: tuple[ReadingOptions, ...] = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> ScansSection:
        from crackfront.measured.options import ReadingOptions, reading_options

        self._check_names(ReadingOptions)
        options = self.model_extra or {}
        masks = _located_masks(options.get("mask"), info)
        try:
            self._options = tuple(reading_options(options | {"mask": masks}, len(self.file)))
        except (TypeError, ValueError) as error:
            raise section_error(str(error)) from error
        return self


class SurfaceSection(ScansSection):
    """Measurements of a surface, and the options by which they are read."""

    @functools.cached_property
    def measured(self) -> MeasuredSurface:
        """The surface; its files are read when it is first used."""
        from crackfront.measured.spectrum.measured_surface import read_surface

        return read_surface(self.file, self._options)

    @property
    def checksum(self) -> str:
        """Eight digits that change with any of the files."""
        return self.measured.checksum

    def table(self) -> TabulatedSpectrum:
        """Joint spectrum of all files (Units: m)."""
        return self.measured.spectrum


class DensitySection(FileSection):
    """A spectral density that another program exported, and the options by which it is read."""

    file: InputFile
    _options: PsdOptions = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self) -> DensitySection:
        from crackfront.measured.options import PsdOptions, checked_options

        self._check_names(PsdOptions)
        try:
            self._options = checked_options(PsdOptions, self.model_extra or {})
        except (TypeError, ValueError) as error:
            raise section_error(str(error)) from error
        return self

    @functools.cached_property
    def _psd(self) -> Psd:
        """Density of the file, which is read when it is first used."""
        from crackfront.measured.scan.psd import read_psd_file

        return read_psd_file(self.file, self._options)

    @functools.cached_property
    def measured(self) -> StatedSurface:
        """A surface of this density."""
        from crackfront.measured.spectrum.stated import density_surface

        return density_surface(self._psd)

    @property
    def checksum(self) -> str:
        """Eight digits that change with the file."""
        return self._psd.checksum

    def table(self) -> TabulatedSpectrum:
        """Isotropic density (Units: m)."""
        return self.measured.spectrum


def _located_masks(masks: Any, info: ValidationInfo) -> Any:
    """Parts of a scan as they are, and files relative to the configuration; None without masks."""
    if masks is None:
        return None
    return tuple(
        str(resolved_path(Path(mask), info)) if isinstance(mask, str) and ":" not in mask else mask
        for mask in (masks if isinstance(masks, tuple) else (masks,))
    )


class TilesSection(ScansSection):
    """Maps that are the surfaces themselves, one for each realisation, and how they are read."""

    @model_validator(mode="after")
    def _usable(self) -> TilesSection:
        check_distinct("file", [str(path) for path in self.file])
        if "mask" in (self.model_extra or {}):
            raise section_error("tiles lack the key mask; level the maps before, and remove it")
        return self

    @functools.cached_property
    def files(self) -> TileFiles:
        """The maps; their files are read when they are first used."""
        from crackfront.measured.tile_ensemble import tile_files

        return tile_files(self.file, self._options)

    @property
    def measured(self) -> RoughSurface:
        """Measures of all maps together."""
        return self.files.surface

    @property
    def checksum(self) -> str:
        """Eight digits that change with any of the files."""
        return self.files.checksum

    def table(self) -> TabulatedSpectrum:
        """Mean density of the maps (Units: m)."""
        return self.files.spectrum


class TableSection(Section):
    """Spectral densities at wavelengths, as in `TabulatedSpectrum`; amplitudes scale them."""

    wavelengths: Annotated[tuple[Positive, ...], Field(min_length=2)]
    densities: Annotated[tuple[Positive, ...], Field(min_length=2)]

    def shape(self) -> tuple[TabulatedSpectrum, str]:
        """Spectrum in the unit of length of the configuration; no ending of its name."""
        return TabulatedSpectrum(self.wavelengths, self.densities), ""


class AnisotropySection(Section):
    """Stretch of a spectrum, as in `AnisotropicSpectrum`."""

    ratio: Annotated[float, Field(gt=1, le=100)]
    angle: Finite = 0.0


class MarginalSection(Section):
    """Distribution of heights, or of w_loc if the field is chemical, as in `Marginal`."""

    # The other keys are shape parameters of the distribution.
    model_config = ConfigDict(extra="allow")

    distribution: str

    @model_validator(mode="after")
    def _exists(self) -> MarginalSection:
        for name, value in (self.model_extra or {}).items():
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise section_error(f"{name} is {value!r}; it must be a number")
        check_makes(self.ensemble)
        return self

    def ensemble(self) -> MarginalEnsemble:
        """Surfaces of this distribution."""
        parameters = {name: float(value) for name, value in (self.model_extra or {}).items()}
        return MarginalEnsemble(Marginal(self.distribution, tuple(sorted(parameters.items()))))


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
    density: DensitySection | None = None
    tiles: TilesSection | None = None
    table: TableSection | None = None
    anisotropy: AnisotropySection | None = None
    marginal: MarginalSection | None = None

    @model_validator(mode="after")
    def _complete(self) -> SpectrumSection:
        if sections := self._shape_sections():
            overruled = "short_cutoff", "roll_off", "hurst", *[*sections][1:]
            check_not_overruled(self, next(iter(sections)), overruled)
            if self.tiles is not None:
                check_not_overruled(self, "tiles", ("anisotropy", "marginal"))
            return self
        needed = ("short_cutoff",) if self._is_flat else ("short_cutoff", "hurst")
        if missing := missing_keys(self, needed):
            raise section_error(
                f"key {', '.join(missing)} is missing; add it, or one of {', '.join(_SHAPES)}"
            )
        check_makes(self._self_affine)
        return self

    @property
    def in_metres(self) -> FileSection | None:
        """The section that states a surface in metres, if there is one."""
        return self.surface or self.density or self.tiles

    def named(self, position: int, lateral: float) -> NamedSpectrum:
        """Spectrum at a position of the list, with its lengths divided by a unit."""
        spectrum, ending = self._shape(position)
        name = f"{self.name}-{ending}" if ending else self.name
        if self.anisotropy is not None:
            spectrum = AnisotropicSpectrum(spectrum, self.anisotropy.ratio, self.anisotropy.angle)
        return NamedSpectrum(name, spectrum.in_units(lateral), self._ensemble(lateral))

    def _ensemble(self, lateral: float) -> Ensemble:
        """Surfaces of the spectrum, with lengths divided by a unit."""
        if self.tiles is not None:
            return self.tiles.files.ensemble.in_units(lateral)
        return GAUSSIAN if self.marginal is None else self.marginal.ensemble()

    def _shape(self, position: int) -> tuple[Spectrum, str]:
        """Spectrum in the unit of length of the configuration, and what its name ends with."""
        for key, section in self._shape_sections().items():
            try:
                return section.shape()
            except (OSError, ValueError) as error:
                reason = str(error)
                if isinstance(error, OSError):
                    reason = f"{error.filename} cannot be read: {error.strerror}"
                raise ConfigurationError(f"spectra[{position}].{key}: {reason}") from error
        return self._self_affine(), ""

    def _self_affine(self) -> SelfAffineSpectrum:
        """Spectrum of the parameters, in the unit of length of the configuration."""
        assert self.short_cutoff is not None, "required where no section states the shape"
        roll_off = self.short_cutoff if self.roll_off is None else self.roll_off
        hurst = 1.0 if self.hurst is None else self.hurst  # without effect if flat
        return SelfAffineSpectrum(self.short_cutoff, roll_off, hurst)

    @property
    def _is_flat(self) -> bool:
        """Whether there is a short cutoff, and no longer roll-off."""
        return self.short_cutoff is not None and self.roll_off in (None, self.short_cutoff)

    def _shape_sections(self) -> dict[str, FileSection | TableSection]:
        """Sections that are given, by their keys: shapes other than self-affine ones."""
        sections = {key: getattr(self, key) for key in _SHAPES}
        return {key: section for key, section in sections.items() if section is not None}


_SHAPES = "surface", "density", "tiles", "table"
"""Keys of the sections of shapes other than self-affine ones."""
