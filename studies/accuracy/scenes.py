"""The scenes on which numerical errors are measured, and the numerics that are tried on them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import MEASURED, SETTINGS, SettingName
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings, chosen_settings
from crackfront.simulate.simulation import Simulation, simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle

REQUESTED = (0.1, 0.03, 0.02, 0.01, 0.003)
"""Errors of k for which the laws choose numerics that are then tried."""

HELD_OUT = 2000
"""Number of the first surface to which no law was fitted."""

_SEED = 20241121
"""Seed of the surfaces of all scenes."""

FINER = Settings(
    angles=None,
    angles_per_cutoff=8,
    samples_per_cutoff=12,
    interpolation="cubic",
    pixels_per_cutoff=10,
    tolerance=1e-9,
)
"""Settings that show that the references have converged."""

FINEST = replace(FINER, samples_per_cutoff=24)
"""Reference on many surfaces: on 1 of 576, cubics between 12 samples are wrong by 0.17 of k."""

_REFERENCE = replace(
    FINER, angles_per_cutoff=6, samples_per_cutoff=8, pixels_per_cutoff=8, tolerance=1e-8
)
_LARGE_REFERENCE = replace(_REFERENCE, angles_per_cutoff=4, samples_per_cutoff=6)
_STRONG_REFERENCE = replace(_REFERENCE, angles_per_cutoff=12, samples_per_cutoff=12)
_STRONG_FINER = replace(FINER, angles_per_cutoff=16, samples_per_cutoff=16)

_STRONG = 0.2
"""Largest e_el / w_int where the numerics of moderate disorder have converged."""

_VALUES: dict[SettingName, tuple[float, ...]] = {
    "sites": (1.4, 1.8, 2.2, 2.7, 3.6),
    "cubic": (2, 3, 4, 5, 6),
    "linear": (4, 8, 16, 32),
    "pixels": (2.5, 3, 4, 5),
    "tolerance": (1e-2, 1e-3, 1e-4, 1e-5),
}
"""Values that are tried of each setting; the others are taken from the reference."""

_STRONG_VALUES: dict[SettingName, tuple[float, ...]] = _VALUES | {
    "sites": (2.2, 2.7, 3.6, 5, 7),
    "cubic": (3, 4, 5, 6, 8),
}
"""The same at strong disorder, which bends fronts more sharply."""

_FEW_SITES = 2.2
"""Sites per short cutoff, among the tried ones, where other settings are varied.

Images of coarse pixels are short waves: many sites resolve them, few sites see long waves.
"""

_FEW_STRONG_SITES = 5.0
"""The same at strong disorder."""


class Trial(NamedTuple):
    """What is varied, its value, and all numerics."""

    setting: str
    value: float
    settings: Settings


@dataclass(frozen=True, slots=True)
class Scene:
    """Surfaces, and the penetrations at which both branches are measured.

    The name is shape and amplitude, the tile has so many short cutoffs a side. Errors are measured
    against the reference, at eight penetrations a step apart up to 1; laws are fitted to the
    errors of single settings. The authors' seconds: their code for a full cycle, where known.
    """

    name: str
    kind: FieldKind
    spectrum: SelfAffineSpectrum
    elastic_energy: float
    tile_cutoffs: float
    step: float = 0.1
    reference: Settings = _REFERENCE
    varies_single: bool = True
    authors_seconds: float | None = None

    @property
    def shape(self) -> str:
        """The name without the amplitude."""
        return self.name.rpartition("-")[0]

    @property
    def penetrations(self) -> Array:
        """Loads of the approach; the retraction has them in reverse."""
        return 1.0 - self.step * np.arange(7, -1, -1.0)

    @property
    def single_trials(self) -> list[Trial]:
        """The finer numerics, other numbers of sites, and few sites with another setting varied."""
        finer, values, n_few = FINER, _VALUES, _FEW_SITES
        if self.elastic_energy > _STRONG:
            finer, values, n_few = _STRONG_FINER, _STRONG_VALUES, _FEW_STRONG_SITES
        few = with_setting(self.reference, "sites", n_few)
        return [
            Trial("finer", 0.0, finer),
            *(
                Trial(setting, value, with_setting(few, setting, value))
                for setting in SETTINGS
                for value in values[setting]
            ),
        ]

    def requested_trials(self, requested: Iterable[float] = REQUESTED) -> list[Trial]:
        """Numerics that the laws choose for errors of k."""
        return [Trial("requested", error, self.chosen_settings(error)) for error in requested]

    def chosen_settings(self, error: float) -> Settings:
        """Numerics that the laws choose for an error of k."""
        return chosen_settings(error, self.kind, self.spectrum, self.elastic_energy)

    def simulation(self, settings: Settings, realisation: int) -> Simulation:
        """One realisation; its surface is the same for all settings."""
        return simulation_of(
            self.kind,
            self.spectrum,
            self.elastic_energy,
            FullCycle(1.0, self.step),
            Numerics(settings=settings, tile_roll_offs=1.0, tile_cutoffs=self.tile_cutoffs),
            seed=_SEED,
            realisation=realisation,
            name=self.name,
        )


def with_setting(settings: Settings, setting: SettingName, value: float) -> Settings:
    """Settings with one of them at another value."""
    if setting == "sites":
        return replace(settings, angles_per_cutoff=value)
    if setting == "pixels":
        return replace(settings, pixels_per_cutoff=value)
    if setting == "tolerance":
        return replace(settings, tolerance=value)
    return replace(settings, samples_per_cutoff=value, interpolation=setting)


def _measured_shapes() -> list[Scene]:
    """Every shape of the laws at six amplitudes."""
    sides = {"chemical": 64, "flat": 64, "h08": 96, "h03": 120}
    authors = {"chemical-0.04": 100.0, "chemical-0.0025": 160.0}
    return [
        Scene(
            f"{shape}-{energy:g}",
            *MEASURED[shape],
            energy,
            cutoffs,
            reference=_reference(energy),
            authors_seconds=authors.get(f"{shape}-{energy:g}"),
        )
        for shape, cutoffs in sides.items()
        for energy in (0.001, 0.0025, 0.01, 0.04, 0.16, 0.4)
    ]


def _reference(energy: float) -> Settings:
    """Numerics that have converged at an e_el / w_int."""
    return _STRONG_REFERENCE if energy > _STRONG else _REFERENCE


def _unseen() -> list[Scene]:
    """Spectra between the fitted ones, and weak disorder under shorter cutoffs."""
    wide = (0.0015, 0.003, 0.01, 0.06, 0.14, 0.25, 0.4)
    shapes: tuple[tuple[str, FieldKind, tuple[float, float, float], float, tuple[float, ...]], ...]
    shapes = (
        ("c015", "chemical", (0.015, 0.015, 1.0), 64, (0.005, 0.02, 0.08, 0.25)),
        ("f013", "roughness", (0.013, 0.013, 1.0), 64, wide),
        ("band", "roughness", (0.02, 0.05, 0.7), 64, (0.005, 0.03, 0.1)),
        ("h02", "roughness", (0.012, 0.1, 0.2), 80, (0.005, 0.02, 0.4)),
        ("h05", "roughness", (0.008, 0.08, 0.5), 80, wide),
        ("h09", "roughness", (0.01, 0.16, 0.9), 96, (0.02, 0.06, 0.25)),
        ("octaves", "roughness", (0.02, 0.08, 0.8), 64, (0.01, 0.02, 0.05, 0.1, 0.2)),
    )
    return [
        Scene(
            f"{name}-{energy:g}", kind, SelfAffineSpectrum(*spectrum), energy, cutoffs,
            reference=_reference(energy), varies_single=False,
        )
        for name, kind, spectrum, cutoffs, energies in shapes
        for energy in energies
    ]  # fmt: skip


SCENES: dict[str, Scene] = {
    scene.name: scene
    for scene in (
        *_measured_shapes(),
        Scene(
            "small-0.04", "roughness", SelfAffineSpectrum(0.1, 0.1, 1.0), 0.04, 64,
            varies_single=False,
        ),
        Scene(
            "large-0.04", "roughness", SelfAffineSpectrum(0.005, 0.1, 0.3), 0.04, 200,
            step=0.03, reference=_LARGE_REFERENCE, varies_single=False,
        ),
        Scene(
            "paper-0.05", "roughness", SelfAffineSpectrum(0.000625, 0.01, 0.8), 0.05, 256,
            step=0.004,
            reference=replace(
                _REFERENCE, angles_per_cutoff=2.7, samples_per_cutoff=5, pixels_per_cutoff=4,
                tolerance=1e-5,
            ),
            varies_single=False,
        ),
        *_unseen(),
    )
}  # fmt: skip
"""All scenes by name. The first twenty-four give the laws, those behind `paper` test them; `paper`,
the finest spectrum of the paper, takes most of an hour by itself."""
