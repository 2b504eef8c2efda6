"""The registry of benchmark problems: a field, a load schedule and a tolerance each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.field.fields import Interpolation, RayField, TileField, tile_field
from crackfront.core.field.rays import sampled_on_rays
from crackfront.core.geometry.sphere import sphere
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field

Group = Literal["disorder", "scaling", "smoke"]
"""Tables of problems; `smoke` is for tests."""

LARGEST_RADIUS = 2.6
"""Radius at which the fields end. (Units: reduced lateral length)"""

PIXELS_PER_CUTOFF = 8
"""Resolution of the tiles."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One cycle from penetration 0 to 1 and back to pull-off, at a tolerance of 1e-8.

    The rms belongs to the work of adhesion, in w_int. A flat spectrum describes the work of
    adhesion, any other spectrum the heights. (Units: reduced lateral length) On its tile a field
    is evaluated where the front is, else sampled on all rays first.
    """

    group: Group
    rms: float
    spectrum: SelfAffineSpectrum
    n_angle: int
    step: float = 0.1
    samples_per_cutoff: int = 16
    interpolation: Interpolation = "linear"
    on_tile: bool = False

    @property
    def schedule(self) -> LoadSchedule:
        """Loads of the cycle."""
        return LoadSchedule(1.0, self.step)

    @property
    def label(self) -> str:
        """What the tables call it."""
        spectrum = self.spectrum
        shape = f"flat {spectrum.short_cutoff:g}"
        if spectrum.roll_off > spectrum.short_cutoff:
            shape = f"({spectrum.short_cutoff:g}, {spectrum.roll_off:g}, {spectrum.hurst:g})"
        pieces = f", {self.samples_per_cutoff} cubic" if self.interpolation == "cubic" else ""
        storage = pieces + (", on tile" if self.on_tile else "")
        return f"{shape}, w_rms {self.rms:g}, N {self.n_angle}, step {self.step:g}{storage}"

    def smallest(self) -> Problem:
        """A problem of the same kind that takes no time, to compile by."""
        return replace(self, spectrum=_flat(0.16), n_angle=256)

    def field(self, seed: int) -> RayField | TileField:
        """Field of a realisation."""
        cutoff = self.spectrum.short_cutoff
        pixel = cutoff / PIXELS_PER_CUTOFF
        n_point = PIXELS_PER_CUTOFF * max(64, round(8 * self.spectrum.roll_off / cutoff))
        adhesion = self._adhesion(n_point, pixel, seed)
        spacing = cutoff / self.samples_per_cutoff
        tile = tile_field(
            adhesion, sphere(self.n_angle), spacing, LARGEST_RADIUS, self.interpolation
        )
        return tile if self.on_tile else sampled_on_rays(tile)

    def _adhesion(self, n_point: int, pixel: float, seed: int) -> AdhesionMap:
        """Work of adhesion on a tile."""
        rng = np.random.default_rng(np.random.SeedSequence(entropy=seed))
        if self.spectrum.roll_off > self.spectrum.short_cutoff:
            spectrum = self.spectrum.with_elastic_energy(self.rms**2 / 4)
            return rough_adhesion(gaussian_field(spectrum, n_point, n_point * pixel, rng), pixel)
        noise = gaussian_field(self.spectrum, n_point, n_point * pixel, rng)
        return chemical_adhesion(self.rms * noise / np.std(noise), pixel)


def _flat(cutoff: float) -> SelfAffineSpectrum:
    """Flat spectrum."""
    return SelfAffineSpectrum(cutoff, cutoff, 1.0)


def _cubic(group: Group, rms: float, cutoff: float, n_angle: int) -> Problem:
    """Problem on its tile, with five samples a cutoff and cubic pieces between them."""
    plain = Problem(group, rms, _flat(cutoff), n_angle, samples_per_cutoff=5, on_tile=True)
    return replace(plain, interpolation="cubic")


PROBLEMS = (
    *(Problem("disorder", rms, _flat(0.02), 4096) for rms in (0.05, 0.1, 0.2, 0.4, 0.84, 2.0)),
    Problem("disorder", 0.4, _flat(0.02), 4096, on_tile=True),
    *(_cubic("disorder", rms, 0.02, 4096) for rms in (0.1, 0.4)),
    Problem("disorder", 0.4, _flat(0.02), 4096, step=0.002),
    Problem("disorder", 0.45, SelfAffineSpectrum(0.02, 0.4, 0.3), 4096),
    Problem("disorder", 0.45, SelfAffineSpectrum(0.02, 0.32, 0.8), 4096),
    *(
        _cubic("scaling", rms, cutoff, round(81.92 / cutoff))
        for rms in (0.1, 0.4)
        for cutoff in (0.08, 0.04, 0.02, 0.01, 0.005)
    ),
    Problem("smoke", 0.4, _flat(0.16), 256, step=0.5),
)
"""All problems."""
