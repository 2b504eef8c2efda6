"""Coverage of the intervals of measured loops: simulated rough spheres as rigs would record them.

The truth of a loop is what the simulation of its sphere has, without an instrument between.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from crackfront.measured.loops.simulated_loop import simulated_loop
from crackfront.surfaces.loops import run_loop
from crackfront.surfaces.random_surface import random_surface
from crackfront.surfaces.scales import Scales
from crackfront.surfaces.si_units import in_si_units
from studies.accuracy.study import rms
from studies.tables import Table, make_table

SPHERE = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)

SURFACES = tuple(
    (spectrum, elastic_energy)
    for elastic_energy in (0.02, 0.1)
    for spectrum in (SelfAffineSpectrum(0.1, 0.1, 1.0), SelfAffineSpectrum(0.05, 0.2, 0.8))
)
"""Spectra of the spheres, in reduced lengths, and e_el in w_int."""

WORKS = ("w_appr", "w_retr", "hysteresis")


@dataclass(frozen=True, slots=True)
class Press:
    """How deep a sphere is pressed, in reduced units."""

    deepest: float
    """Largest penetration."""
    side: float
    """Side of the surface."""
    step: float
    """Step of the penetration."""


SHALLOW = Press(deepest=2.5, side=5.0, step=0.02)
"""To twice the pull-off force of the smooth sphere."""
DEEP = Press(deepest=9.2, side=8.0, step=0.05)
"""To 18 times the pull-off force of the smooth sphere."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """How a rig records a loop."""

    force_noise: float = 0.002
    """Standard deviation, relative to the largest force."""
    radius_noise: float = 0.003
    """Standard deviation, relative to the contact radius."""
    drift: float = 0.0
    """Drift of the force over the loop, relative to the largest force."""
    wave: float = 0.0
    """Amplitude of a wave of the force in time, relative to the largest force."""
    stiffness: float = 1e3
    """Stiffness of the machine. (Units: N/m)"""
    recorded: float = 0.7
    """Part of the states that is recorded, at random, so that steps are irregular."""
    free_rows: int = 30
    """Rows out of contact, before the contact and after it."""
    retraction: float = 1.0
    """Part of the way of the mount from the turn to pull-off that it goes back."""
    knows_modulus: bool = True
    """Whether the modulus is stated, not fitted."""
    sees_contact: bool = True
    """Whether the contact radius is recorded; else the stiffness of the machine is known."""


INSTRUMENTS: Mapping[str, Instrument] = {
    "usual": Instrument(),
    "modulus fitted": Instrument(knows_modulus=False),
    "noise of 1%": Instrument(force_noise=0.01, radius_noise=0.01),
    "noise of 1%, modulus fitted": Instrument(
        force_noise=0.01, radius_noise=0.01, knows_modulus=False
    ),
    "drift of 5%": Instrument(drift=0.05),
    "a quarter of the states": Instrument(recorded=0.25),
    "60% of the retraction": Instrument(retraction=0.6),
    "machine of 100 N/m": Instrument(stiffness=100.0),
    "machine of 1 MN/m": Instrument(stiffness=1e6),
    "no contact radius": Instrument(sees_contact=False),
    "no contact radius, drift of 30%": Instrument(sees_contact=False, drift=0.3),
    "no contact radius, wave of 1%": Instrument(sees_contact=False, wave=0.01),
    "no contact radius, 8 rows outside": Instrument(sees_contact=False, free_rows=8),
}
"""What the loops are recorded with."""

DEEP_INSTRUMENTS: Mapping[str, Instrument] = {
    "18 pull-off forces": Instrument(),
    "18 pull-off forces, no contact radius": Instrument(sees_contact=False),
    "18 pull-off forces, no contact radius, drift of 30%": Instrument(
        sees_contact=False, drift=0.3
    ),
}
"""What the loops of spheres that are pressed deep are recorded with."""

RECORDED = ((SHALLOW, INSTRUMENTS), (DEEP, DEEP_INSTRUMENTS))


@dataclass(frozen=True, slots=True)
class Coverage:
    """Errors and intervals of an instrument, a loop a row."""

    inside: Array
    """Whether w_appr, w_retr and hysteresis lie in their intervals. Shape (n_loop, 3)."""
    offset: Array
    """Measured minus true work, over the true hysteresis. Shape (n_loop, 3)."""
    reach: Array
    """Half of each interval over the true hysteresis. Shape (n_loop, 3)."""
    too_short: int = 0
    """Loops of too few rows for any number."""


def cycles(count: int, press: Press = SHALLOW) -> Iterator[Dataset]:
    """Simulated cycles of rough spheres in SI units, the spectra in turn."""
    for number in range(count):
        spectrum, energy = SURFACES[number % len(SURFACES)]
        surface = random_surface(spectrum, energy, side=press.side, seed=number)
        cycle = run_loop(surface, max_penetration=press.deepest, step=press.step, fronts=False)
        yield in_si_units(cycle, SPHERE)


def recording(cycle: Dataset, instrument: Instrument, rng: np.random.Generator) -> Recording:
    """Rows of a rig whose mount goes forth and back, with noise: only states that it meets."""
    force, penetration, radius = (
        np.asarray(cycle[name]) for name in ("force", "penetration", "mean_radius")
    )
    mount = penetration + force / instrument.stiffness
    rows = _recorded_states(mount, np.asarray(cycle["direction"]), instrument, rng)
    before = np.zeros(instrument.free_rows)
    after = before if instrument.retraction == 1 else np.zeros(0)
    free = np.linspace(1e-6, 0, before.size)
    way_back = free[::-1][: after.size]
    recorded_force = np.concatenate([before, force[rows], after])
    recorded_radius = np.concatenate([before, radius[rows], after])
    displacement = np.concatenate([mount[rows[0]] - free, mount[rows], mount[rows[-1]] - way_back])
    largest = float(np.max(np.abs(force)))
    recorded_force += largest * _force_noise(displacement.size, instrument, rng)
    recorded_radius *= 1 + instrument.radius_noise * rng.normal(size=displacement.size)
    return Recording(
        recorded_force, recorded_radius if instrument.sees_contact else None, displacement
    )


def _recorded_states(
    mount: Array, direction: Array, instrument: Instrument, rng: np.random.Generator
) -> NDArray[np.intp]:
    """Indices of the states that a rig records, at random, the turn in any case.

    If the force falls faster than the machine gives way, the edge jumps on until the mount has to
    move again: a soft machine does not meet the states between.
    """
    visited = np.flatnonzero(_first_visits(mount, direction))
    turn = int(np.argmax(mount[visited]))
    if instrument.retraction < 1:
        way = mount[visited[turn]] - mount[visited]
        is_approach = np.arange(visited.size) <= turn
        visited = visited[is_approach | (way <= instrument.retraction * way[-1])]
    is_recorded = rng.random(visited.size) < instrument.recorded
    is_recorded[turn] = True
    return visited[is_recorded]


def _force_noise(count: int, instrument: Instrument, rng: np.random.Generator) -> Array:
    """Noise, drift and wave of the force in rows of a rig, relative to the largest force."""
    noise = instrument.force_noise * rng.normal(size=count)
    noise += instrument.drift * np.linspace(-0.3, 0.7, count)
    noise += instrument.wave * np.sin(np.arange(count) / 7)
    return noise


def _first_visits(mount: Array, direction: Array) -> Array:
    """Whether the mount is at a state further than ever on its branch; contact is made at 0."""
    is_first = np.zeros(mount.size, bool)
    for sign, start in ((1, 0.0), (-1, -np.inf)):
        branch = np.flatnonzero(direction == sign)
        ahead = np.concatenate([[start], sign * mount[branch]])
        is_first[branch] = ahead[1:] > np.maximum.accumulate(ahead)[:-1]
    return is_first


def coverage(
    loops: Iterable[Dataset], instruments: Mapping[str, Instrument], seed: int = 0
) -> dict[str, Coverage]:
    """Coverage by the names of the instruments, each of which records every loop."""
    errors_by_rig: dict[str, list[tuple[Array, Array]]] = {name: [] for name in instruments}
    too_short = Counter[str]()
    for number, cycle in enumerate(loops):
        truth = simulated_loop(cycle)
        for place, (name, instrument) in enumerate(instruments.items()):
            rng = np.random.default_rng((seed, number, place))
            rig = Rig(
                SPHERE.radius,
                SPHERE.contact_modulus if instrument.knows_modulus else None,
                stiffness=None if instrument.sees_contact else instrument.stiffness,
            )
            try:
                measured = analyse_loop(recording(cycle, instrument, rng), rig)
            except ValueError:
                too_short[name] += 1
            else:
                errors_by_rig[name].append(_departures(measured, truth))
    return {name: _coverage(errors, too_short[name]) for name, errors in errors_by_rig.items()}


def _departures(measured: MeasuredLoop, truth: MeasuredLoop) -> tuple[Array, Array]:
    """Departures of the works and halves of their intervals, over the true hysteresis."""
    works = [(getattr(measured, name), getattr(truth, name).value) for name in WORKS]
    unit = truth.hysteresis.value
    offset = np.array([(work.value - value) / unit for work, value in works])
    return offset, np.array([(work.high - work.low) / 2 / unit for work, _ in works])


def _coverage(loops: list[tuple[Array, Array]], too_short: int) -> Coverage:
    """Coverage of an instrument from the departures of its loops."""
    offset, reach = (np.array(column) for column in zip(*loops, strict=True))
    return Coverage(np.abs(offset) <= reach, offset, reach, too_short)


def coverage_table(coverages: Mapping[str, Coverage]) -> Table:
    """Shares of intervals that contain the truth, an instrument a row, and of all."""
    rows = []
    for name, rig in coverages.items():
        error = f"{100 * rms(rig.offset[:, 2]):.0f}"
        half = f"{100 * np.median(rig.reach[:, 2]):.0f}"
        rows.append([name, *_coverage_cells(rig.inside, rig.too_short), error, half])
    inside = np.concatenate([rig.inside for rig in coverages.values()])
    too_short = sum(rig.too_short for rig in coverages.values())
    rows.append(["all", *_coverage_cells(inside, too_short), "", ""])
    return make_table(
        "rig | loops | rejected | w_appr % | w_retr % | hysteresis % | all three % "
        "| rms error of the hysteresis % | half of its interval %",
        rows,
    )


def _coverage_cells(inside: Array, too_short: int) -> list[str]:
    """Numbers of loops, and shares of intervals that contain each work, and of all intervals."""
    shares = (*np.mean(inside, axis=0), np.mean(inside))
    return [str(len(inside)), str(too_short), *(f"{100 * share:.0f}" for share in shares)]
