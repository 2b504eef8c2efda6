"""What determines one simulation of a sweep: its parameters, sizes, key and seed."""

from __future__ import annotations

import functools
import hashlib
import json
import math
from dataclasses import astuple, dataclass
from typing import Any, Literal

import numpy as np
from scipy.fft import next_fast_len

from crackfront.core import jkr
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.field.kinds import Interpolation
from crackfront.core.fingerprint import NO_PART, SOLVER, fingerprint
from crackfront.core.spectrum import SelfAffineSpectrum

_SOURCES = ("simulate/simulation.py", "simulate/contact.py", "simulate/run.py")
"""What determines a simulation beside the solver."""

FieldKind = Literal["roughness", "chemical"]


@dataclass(frozen=True, slots=True)
class Numerics:
    """Resolution relative to the short cutoff, and the solver.

    Attributes
    ----------
    angles : int or None
        Number of sites of the front; where None, `angles_per_cutoff` decides.
    angles_per_cutoff : float
        Sites per short cutoff on the smooth contact's largest circle, rounded up to an even
        product of 2, 3 and 5.
    samples_per_cutoff : float
        Samples per short cutoff along a ray.
    interpolation : {"cubic", "linear"}
        Pieces between samples.
    pixels_per_cutoff : float
        Points of the tile per short cutoff, 2 or more.
    tile_roll_offs, tile_cutoffs : float
        Side of the tile in roll-off wavelengths, and at least so many short cutoffs.
    tolerance : float
        Largest force along the motion that may be left, relative to w_int per front length.
    max_sweeps : int
        Limit on the sweeps of one load step.
    solver : str
        A name in :data:`crackfront.core.solver.relax.SOLVERS`.
    """

    angles: int | None
    angles_per_cutoff: float
    samples_per_cutoff: float
    interpolation: Interpolation
    pixels_per_cutoff: float
    tile_roll_offs: float
    tile_cutoffs: float
    tolerance: float
    max_sweeps: int
    solver: str


@dataclass(frozen=True, slots=True)
class Resolution:
    """Sizes that the numerics give to one spectrum.

    Attributes
    ----------
    n_angle : int
        Sites of the front.
    spacing : float
        Distance of samples along a ray. (Units: reduced lateral length)
    interpolation : {"cubic", "linear"}
        Pieces between samples.
    tile_side : float
        Side of the periodic tile. (Units: reduced lateral length)
    n_point : int
        Points along a side of the tile.
    """

    n_angle: int
    spacing: float
    interpolation: Interpolation
    tile_side: float
    n_point: int


def resolution(
    spectrum: SelfAffineSpectrum, numerics: Numerics, max_penetration: float
) -> Resolution:
    """Sizes of the front and of the tile for one spectrum.

    Parameters
    ----------
    spectrum : SelfAffineSpectrum
        Spectrum of the surface. (Units: reduced lateral length)
    numerics : Numerics
        Resolution relative to the short cutoff.
    max_penetration : float
        Largest penetration. (Units: reduced vertical length)

    Examples
    --------
    >>> flat = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=1.0)
    >>> numerics = Numerics(None, 2, 4, "cubic", 4, 10, 20, 1e-6, 1000, "reference")
    >>> resolution(flat, numerics, max_penetration=1.0)
    Resolution(n_angle=240, spacing=0.025, interpolation='cubic', tile_side=2.0, n_point=80)
    """
    cutoff = spectrum.short_cutoff
    circle = 2 * math.pi * jkr.equilibrium_radius(max_penetration)
    sites = circle / cutoff * numerics.angles_per_cutoff
    side = max(numerics.tile_roll_offs * spectrum.roll_off, numerics.tile_cutoffs * cutoff)
    points = math.ceil(side / cutoff * numerics.pixels_per_cutoff * (1 - 1e-12))
    return Resolution(
        n_angle=numerics.angles or n_site(sites),
        spacing=cutoff / numerics.samples_per_cutoff,
        interpolation=numerics.interpolation,
        tile_side=side,
        n_point=next_fast_len(points, real=True),
    )


@dataclass(frozen=True, slots=True)
class Simulation:
    """Everything that determines one cycle, and the name of its spectrum.

    Attributes
    ----------
    spectrum_name : str
        Name of the spectrum in the configuration; the only item without effect on the result.
    kind : {"roughness", "chemical"}
        What the spectrum describes: heights, or the work of adhesion itself.
    spectrum : SelfAffineSpectrum
        Shape of the spectrum; its plateau has no effect. (Units: reduced lateral length)
    elastic_energy : float
        Requested e_el / w_int; for a chemical field the equivalent (w_rms / w_int)^2 / 4.
    realisation : int
        Number of the realisation of the noise.
    sweep_seed : int
        Seed of the sweep.
    resolution : Resolution
        Sizes of the front and of the tile.
    schedule : LoadSchedule or SteadySchedule
        Penetrations to visit: a full cycle, or the steady parts of its branches.
    tolerance, max_sweeps, solver
        As in :class:`Numerics`.
    record_fronts, record_energy : bool
        What to record beside the curves.
    """

    spectrum_name: str
    kind: FieldKind
    spectrum: SelfAffineSpectrum
    elastic_energy: float
    realisation: int
    sweep_seed: int
    resolution: Resolution
    schedule: LoadSchedule | SteadySchedule
    tolerance: float
    max_sweeps: int
    solver: str
    record_fronts: bool
    record_energy: bool

    @property
    def key(self) -> str:
        """Sixteen hexadecimal digits that change with anything that determines the result."""
        return _digest(self._content())[:16]

    @property
    def parts(self) -> dict[str, str]:
        """Eight hexadecimal digits for each part of the key, to tell which of them has changed."""
        return {name: _digest(part)[:8] for name, part in self._content().items()}

    def _content(self) -> dict[str, Any]:
        """What determines the result, part by part."""
        spectrum = self.spectrum
        return {
            "kind": self.kind,
            "spectrum": (spectrum.short_cutoff, spectrum.roll_off, spectrum.hurst),
            "elastic_energy": self.elastic_energy,
            "realisation": self.realisation,
            "seed": self.sweep_seed,
            "resolution": astuple(self.resolution),
            "load": astuple(self.schedule),
            "numerics": (self.tolerance, self.max_sweeps, self.solver),
            "record": (self.record_fronts, self.record_energy),
            "sources": scene_fingerprint(),
        }

    @property
    def label(self) -> str:
        """What a person calls this simulation."""
        return f"{self.spectrum_name} e_el={self.elastic_energy:g} r={self.realisation}"

    @property
    def stem(self) -> str:
        """Name of its file, without a suffix."""
        return f"{self.spectrum_name}-e{self.elastic_energy:g}-r{self.realisation}-{self.key}"

    @property
    def seed(self) -> int:
        """Seed of the surface: `numpy.random.default_rng(seed)` gives its noise.

        It follows from the seed of the sweep, the spectrum, the tile's side and the number of
        the realisation, never from a position in a list. All amplitudes and all grids share it.
        """
        spectrum = self.spectrum
        lengths = (spectrum.short_cutoff, spectrum.roll_off, self.resolution.tile_side)
        # Ten digits: the same surface whether lengths were given in metres or reduced.
        text = " ".join(f"{value:.10g}" for value in (*lengths, spectrum.hurst))
        words = np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4")
        sequence = np.random.SeedSequence(
            self.sweep_seed, spawn_key=(*(int(word) for word in words), self.realisation)
        )
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))


def _digest(content: Any) -> str:
    """Hexadecimal digits that change with what is given."""
    text = json.dumps(content, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


@functools.cache
def scene_fingerprint() -> str:
    """Twelve hexadecimal digits that change with what determines a simulation."""
    return fingerprint(*SOLVER, *_SOURCES, without=NO_PART)


def correlation_length(kind: FieldKind, spectrum: SelfAffineSpectrum) -> float:
    """Wavelength of the mean wavevector of w_loc, weighted by its variance.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : SelfAffineSpectrum
        Its shape. (Units: length)

    Returns
    -------
    float
        Correlation length. (Units: length)
    """
    if kind == "roughness":
        return spectrum.correlation_length
    return 2 * math.pi * spectrum.mean_square(0.0) / spectrum.mean_square(0.5)


def n_site(least: float) -> int:
    """Even number of sites, 4 or more and not below a number, whose transforms are fast."""
    return 2 * int(next_fast_len(math.ceil(max(4.0, least * (1 - 1e-12)) / 2), real=True))
