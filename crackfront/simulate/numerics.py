"""How simulations are resolved and solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from crackfront.core.adhesion import FieldKind
from crackfront.core.solver import DEFAULT_MAX_SWEEPS
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.settings import Settings, chosen_settings


@dataclass(frozen=True, slots=True, kw_only=True)
class Numerics:
    """How simulations are resolved and solved.

    ValueError unless exactly one of `settings` and `error` is given.
    """

    settings: Settings | None = None
    """Resolution and tolerance; None where `error` is given."""
    error: float | None = None
    """Standard error of the factor k of either branch that resolution and tolerance may leave;
    measured laws choose them for every spectrum and amplitude."""
    tile_roll_offs: float = 4.0
    """Least side of the tile in roll-off wavelengths, of other spectra in the longest wavelengths
    that matter."""
    tile_cutoffs: float = 200.0
    """Least side of the tile in short cutoffs; the larger of both sides counts."""
    max_sweeps: int = DEFAULT_MAX_SWEEPS
    """Limit on the sweeps of one load step."""
    solver: str = "newton"
    """A name in :data:`crackfront.core.solver.relax.SOLVERS`."""

    def __post_init__(self) -> None:
        if (self.settings is None) == (self.error is None):
            number = "neither" if self.error is None else "both"
            raise ValueError(f"numerics have {number} of settings and error; give one of them")

    def settings_of(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        usual_cutoffs: float | None = None,
    ) -> Settings:
        """Settings for one spectrum and amplitude.

        `usual_cutoffs` is as of :func:`crackfront.simulate.settings.chosen_settings`.
        """
        if self.error is not None:
            return chosen_settings(self.error, kind, spectrum, elastic_energy, usual_cutoffs)
        return cast(Settings, self.settings)

    def tile_side(self, spectrum: Spectrum) -> float:
        """Least side of a tile (Units: as the spectrum)."""
        return max(
            self.tile_roll_offs * spectrum.longest_feature,
            self.tile_cutoffs * spectrum.short_cutoff,
        )
