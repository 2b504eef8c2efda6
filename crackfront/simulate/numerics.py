"""How simulations are resolved and solved."""

from __future__ import annotations

from dataclasses import dataclass

from crackfront.core.adhesion import FieldKind
from crackfront.core.solver import DEFAULT_MAX_SWEEPS
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.settings import Settings, chosen_settings


@dataclass(frozen=True, slots=True)
class Numerics:
    """How simulations are resolved and solved."""

    settings: Settings | float
    """Resolution and tolerance, or the standard error of the factor k of either branch that they
    may leave: measured laws then choose them for every spectrum and amplitude."""
    tile_roll_offs: float = 4.0
    tile_cutoffs: float = 200.0
    """Side of the tile in roll-off wavelengths, of other spectra in the longest wavelengths that
    matter, and at least so many short cutoffs."""
    max_sweeps: int = DEFAULT_MAX_SWEEPS
    """Limit on the sweeps of one load step."""
    solver: str = "newton"
    """A name in :data:`crackfront.core.solver.relax.SOLVERS`."""

    def settings_of(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        usual_size: float | None = None,
    ) -> Settings:
        """Settings for one spectrum and amplitude.

        The size is as of :func:`crackfront.simulate.settings.chosen_settings`.
        """
        if isinstance(self.settings, Settings):
            return self.settings
        return chosen_settings(self.settings, kind, spectrum, elastic_energy, usual_size)

    def tile_side(self, spectrum: Spectrum) -> float:
        """Least side of a tile (Units: as the spectrum)."""
        return max(
            self.tile_roll_offs * spectrum.longest_feature,
            self.tile_cutoffs * spectrum.short_cutoff,
        )
