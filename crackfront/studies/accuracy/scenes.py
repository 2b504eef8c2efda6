"""The scenes on which numerical errors are measured, and the numerics that are tried on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import FieldKind
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import KNOBS, Knob, Knobs, chosen_knobs
from crackfront.simulate.simulation import Numerics, Simulation, simulation_of

Array = NDArray[np.float64]
Progress = Callable[[str], None]
"""What is called with a line when a part of a study is done."""

ASKED = (0.1, 0.03, 0.02, 0.01, 0.003)
"""Errors of k for which the laws choose numerics that are then tried."""

_SEED = 20241121
"""Seed of the surfaces of all scenes."""

_FINER = Knobs(
    angles=None,
    angles_per_cutoff=8,
    samples_per_cutoff=12,
    interpolation="cubic",
    pixels_per_cutoff=8,
    tolerance=1e-8,
)
"""What shows that the reference has converged, where single knobs are varied."""

_REFERENCE = replace(
    _FINER, angles_per_cutoff=6, samples_per_cutoff=8, pixels_per_cutoff=6, tolerance=1e-7
)
_LARGE_REFERENCE = replace(_REFERENCE, angles_per_cutoff=4, samples_per_cutoff=6)

_VALUES: dict[Knob, tuple[float, ...]] = {
    "sites": (1.4, 1.8, 2.2, 2.7, 3.6),
    "cubic": (2, 3, 4, 5, 6),
    "linear": (4, 8, 16, 32),
    "pixels": (2.5, 3, 4),
    "tolerance": (1e-2, 1e-3, 1e-4, 1e-5),
}
"""What is tried of each knob while the others are those of the reference."""


class Setting(NamedTuple):
    """What is varied, its value, and all numerics."""

    knob: str
    value: float
    knobs: Knobs


@dataclass(frozen=True, slots=True)
class Scene:
    """Surfaces, and the penetrations at which both branches are measured.

    Attributes
    ----------
    name : str
        What the tables call it: shape and amplitude.
    kind, spectrum, elastic_energy
        As of :class:`crackfront.simulate.simulation.Simulation`.
    tile_cutoffs : float
        Side of the tile in short cutoffs.
    step : float
        Difference of the eight penetrations, the largest of which is 1.
        (Units: reduced vertical length)
    reference : Knobs
        What errors are measured against.
    single_knobs : bool
        Whether laws are fitted to the errors of single knobs.
    authors_seconds : float or None
        CPU time of the authors' code for its full cycle, where it is known. (Units: s)
    """

    name: str
    kind: FieldKind
    spectrum: SelfAffineSpectrum
    elastic_energy: float
    tile_cutoffs: float
    step: float = 0.1
    reference: Knobs = _REFERENCE
    single_knobs: bool = True
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
    def single_settings(self) -> list[Setting]:
        """The finer numerics, and those that differ from the reference in one knob."""
        return [
            Setting("finer", 0.0, _FINER),
            *(
                Setting(knob, value, with_knob(self.reference, knob, value))
                for knob in KNOBS
                for value in _VALUES[knob]
            ),
        ]

    @property
    def asked_settings(self) -> list[Setting]:
        """Numerics that the laws choose for errors of k."""
        return [Setting("asked", error, self.chosen_knobs(error)) for error in ASKED]

    def chosen_knobs(self, error: float) -> Knobs:
        """Numerics that the laws choose for an error of k."""
        return chosen_knobs(error, self.kind, self.spectrum, self.elastic_energy)

    def simulation(self, knobs: Knobs, realisation: int) -> Simulation:
        """One realisation; its surface is the same for all knobs."""
        return simulation_of(
            self.kind,
            self.spectrum,
            self.elastic_energy,
            LoadSchedule(1.0, self.step),
            Numerics(knobs, tile_roll_offs=1.0, tile_cutoffs=self.tile_cutoffs),
            seed=_SEED,
            realisation=realisation,
            name=self.name,
        )


def with_knob(knobs: Knobs, knob: Knob, value: float) -> Knobs:
    """Knobs with one of them at another value."""
    if knob == "sites":
        return replace(knobs, angles_per_cutoff=value)
    if knob == "pixels":
        return replace(knobs, pixels_per_cutoff=value)
    if knob == "tolerance":
        return replace(knobs, tolerance=value)
    return replace(knobs, samples_per_cutoff=value, interpolation=knob)


def _measured_shapes() -> list[Scene]:
    """Every shape of the laws at four amplitudes."""
    flat = SelfAffineSpectrum(0.02, 0.02, 1.0)
    shapes: tuple[tuple[str, FieldKind, SelfAffineSpectrum, float], ...] = (
        ("chemical", "chemical", flat, 64),
        ("flat", "roughness", flat, 64),
        ("h08", "roughness", SelfAffineSpectrum(0.02, 0.32, 0.8), 96),
        ("h03", "roughness", SelfAffineSpectrum(0.02, 0.4, 0.3), 120),
    )
    authors = {"chemical-0.04": 100.0, "chemical-0.0025": 160.0}
    return [
        Scene(
            f"{shape}-{energy:g}",
            kind,
            spectrum,
            energy,
            cutoffs,
            authors_seconds=authors.get(f"{shape}-{energy:g}"),
        )
        for shape, kind, spectrum, cutoffs in shapes
        for energy in (0.0025, 0.01, 0.04, 0.16)
    ]


SCENES: dict[str, Scene] = {
    scene.name: scene
    for scene in (
        *_measured_shapes(),
        Scene(
            "small-0.04", "roughness", SelfAffineSpectrum(0.1, 0.1, 1.0), 0.04, 64,
            single_knobs=False,
        ),
        Scene(
            "large-0.04", "roughness", SelfAffineSpectrum(0.005, 0.1, 0.3), 0.04, 200,
            step=0.03, reference=_LARGE_REFERENCE, single_knobs=False,
        ),
        Scene(
            "paper-0.05", "roughness", SelfAffineSpectrum(0.000625, 0.01, 0.8), 0.05, 256,
            step=0.004,
            reference=replace(
                _REFERENCE, angles_per_cutoff=2.7, samples_per_cutoff=5, pixels_per_cutoff=4,
                tolerance=1e-5,
            ),
            single_knobs=False,
        ),
    )
}  # fmt: skip
"""All scenes by name. The first sixteen give the laws; `paper`, the finest spectrum of the paper,
takes most of an hour by itself."""
