"""What determines one simulation: its parameters, sizes, key and seed; and its field.

How the sizes are chosen stands in :mod:`crackfront.simulate.sizing`: it may change without any
simulation of known sizes being another one.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass, fields
from operator import attrgetter
from typing import Any, cast

import numpy as np

from crackfront.core.adhesion import (
    AdhesionMap,
    FieldKind,
    correlation_length,
)
from crackfront.core.field.fields import Interpolation, TileField
from crackfront.core.fingerprint import fingerprint
from crackfront.core.geometry.base import Geometry
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.schedule import Schedule
from crackfront.simulate.tiles import RandomSurface


@dataclass(frozen=True, slots=True)
class Resolution:
    """Sizes that the numerics give to one spectrum: sites, samples along a ray, points of the tile.

    `spacing` is the distance of samples, `tile_side` the side. (Units: reduced lateral length)
    """

    n_angle: int
    spacing: float
    interpolation: Interpolation
    tile_side: float
    n_point: int


@dataclass(frozen=True, slots=True)
class Simulation:
    """Everything that determines one cycle, and the name of its spectrum."""

    spectrum_name: str
    """Name of the spectrum in the configuration; the only item without effect on the result."""
    kind: FieldKind
    """What the spectrum describes: heights, or the work of adhesion itself."""
    spectrum: Spectrum
    """Shape of the spectrum; its plateau has no effect. (Units: reduced lateral length)"""
    elastic_energy: float
    """Requested e_el / w_int; for a chemical field the equivalent (w_rms / w_int)^2 / 4."""
    realisation: int
    """Number of the realisation of the noise."""
    sweep_seed: int
    """Seed of the sweep."""
    resolution: Resolution
    """Sizes of the front and of the tile."""
    schedule: Schedule
    """Loads of a kind, such as penetrations of a full cycle, or those of a straight front."""
    solver: Solver
    """How its fronts are found."""
    record_fronts: bool = False
    record_energy: bool = False
    """What to record beside the curves."""

    @property
    def key(self) -> str:
        """Sixteen hexadecimal digits that change with anything that determines the result."""
        return self.stem.rpartition("-")[2]

    @property
    def parts(self) -> dict[str, str]:
        """Eight hexadecimal digits for each part of the key, which show what has changed."""
        return {name: _digest(part)[:8] for name, part in self._content().items()}

    def _content(self) -> dict[str, Any]:
        """What determines the result, part by part."""
        lengths, numbers = self.spectrum.identity
        return {
            "kind": self.kind,
            "spectrum": (*lengths, *numbers),
            "elastic_energy": self.elastic_energy,
            "realisation": self.realisation,
            "seed": self.sweep_seed,
            "resolution": astuple(self.resolution),
            "load": astuple(cast(Any, self.schedule)),
            "numerics": (self.solver.tolerance, self.solver.max_sweeps, self.solver.name),
            "record": (self.record_fronts, self.record_energy),
            "sources": simulation_fingerprint(type(self.schedule)),
        }

    @property
    def correlation_length(self) -> float:
        """Wavelength of the mean wavevector of w_loc (Units: reduced lateral length)."""
        return correlation_length(self.kind, self.spectrum)

    @property
    def geometry(self) -> Geometry:
        """The contact, whose springs do not pull at w_int."""
        return self.schedule.geometry(self.resolution.n_angle)

    @property
    def tile(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """Points and sides of the tile, along x and y (Units: reduced lateral length)."""
        return self.schedule.tile(self.resolution.n_point, self.resolution.tile_side)

    @property
    def surface(self) -> RandomSurface:
        """The surface on the tile."""
        return RandomSurface(self.kind, self.spectrum, self.elastic_energy, self.seed, *self.tile)

    @property
    def label(self) -> str:
        """Name of this simulation in messages."""
        return f"{self.spectrum_name} e_el={self.elastic_energy:g} r={self.realisation}"

    @property
    def stem(self) -> str:
        """Name of its file, without a suffix; the key ends it."""
        return next(stems([self]))

    @property
    def seed(self) -> int:
        """Seed of the surface: `numpy.random.default_rng(seed)` gives its noise.

        It follows from the seed of the sweep, the spectrum, the tile's side and the number of
        the realisation, never from a position in a list. All amplitudes and all grids share it.
        """
        lengths, numbers = self.spectrum.identity
        sizes = (*lengths, self.resolution.tile_side, *numbers)
        # Ten digits: the same surface whether lengths were given in metres or reduced.
        text = " ".join(f"{value:.10g}" for value in sizes)
        words = np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4")
        sequence = np.random.SeedSequence(
            self.sweep_seed, spawn_key=(*(int(word) for word in words), self.realisation)
        )
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))


def stems(simulations: Iterable[Simulation]) -> Iterator[str]:
    """Names of files as :attr:`Simulation.stem`.

    What realisations in sequence have in common is digested once: all but their number.
    """
    for _, alike in itertools.groupby(simulations, _WITHOUT_NUMBER):
        first = next(alike)
        text = _text(first._content() | {"realisation": None})
        before, number, after = text.partition('"realisation": ')
        common = hashlib.sha256((before + number).encode())
        rest = after.removeprefix("null")
        name = f"{first.spectrum_name}-e{first.elastic_energy:g}-r"
        for one in itertools.chain([first], alike):
            digest = common.copy()
            digest.update(f"{one.realisation}{rest}".encode())
            yield f"{name}{one.realisation}-{digest.hexdigest()[:16]}"


_WITHOUT_NUMBER = attrgetter(
    *(item.name for item in fields(Simulation) if item.name != "realisation")
)
"""All fields of a simulation but the number of its realisation."""


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation."""
    return simulation.schedule.adhesion(simulation.surface)


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    sizes = simulation.resolution
    return simulation.schedule.field(adhesion, sizes.n_angle, sizes.spacing, sizes.interpolation)


def _digest(content: Any) -> str:
    """Hexadecimal digits that change with the content."""
    return hashlib.sha256(_text(content).encode()).hexdigest()


def _text(content: Any) -> str:
    """Content as JSON, in one way."""
    return json.dumps(content, sort_keys=True, allow_nan=False)


@functools.cache
def simulation_fingerprint(kind: type[Schedule]) -> str:
    """Twelve hexadecimal digits that change with what determines a simulation of a kind of load."""
    return fingerprint("crackfront.simulate.run", kind.__module__)
