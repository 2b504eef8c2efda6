"""Whether steady branches have forgotten the circle at which they began.

python -m studies.accuracy.forgetting

Fronts that begin at the circle of `core.cycle.steady.forward_circle` are compared, load by load,
with those that begin as far behind as the field allows.
"""

from __future__ import annotations

from dataclasses import replace

import click
import numpy as np

from crackfront.core import jkr
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import forward_circle
from crackfront.core.field.fields import TileField, first_place, last_place
from crackfront.core.outcome import Direction
from crackfront.core.solver.relax import Newton
from crackfront.simulate.contact import simulation_field
from studies.accuracy.scenes import SCENES, Scene

_CHEMICAL, _H03, _H08, _LARGE = (
    SCENES[f"{shape}-0.04"] for shape in ("chemical", "h03", "h08", "large")
)
KNOBS = replace(
    _CHEMICAL.reference,
    angles_per_cutoff=2.2,
    samples_per_cutoff=4,
    pixels_per_cutoff=4,
    tolerance=1e-7,
)
N_REALISATION = 8
N_LOAD = 10
SAME = 1e-4
"""Largest difference of equal fronts, in short cutoffs."""

SURFACES = tuple(
    replace(scene, name=f"{scene.shape}, w_rms {rms:g}", elastic_energy=rms**2 / 4)
    for scene, amplitudes in (
        (_CHEMICAL, (0.1, 0.4, 0.84, 1.5)),
        (_H03, (0.45, 0.77)),
        (_H08, (0.45,)),
        (SCENES["f013-0.14"], (0.2, 0.77)),
        (_LARGE, (0.4,)),
    )
    for rms in amplitudes
)


def branch(field: TileField, start: np.ndarray, loads: np.ndarray, sign: Direction) -> CycleRecord:
    """States of one branch from a start."""
    recorder = Recorder(fronts=True)
    loads_of_branch = (Load(float(penetration), sign) for penetration in loads)
    recorder.run(field, start, loads_of_branch, Newton(KNOBS.tolerance))
    return recorder.record()


def differing(scene: Scene, sign: Direction) -> tuple[int, int]:
    """Number of states that differ in any site, and of all that count as steady."""
    length = correlation_length(scene.kind, scene.spectrum)
    loads = 1.0 + sign * 6 * length * np.arange(N_LOAD)
    schedule = LoadSchedule(float(loads.max()), 0.1)
    count = total = 0
    for number in range(N_REALISATION):
        field = simulation_field(replace(scene.simulation(KNOBS, number), schedule=schedule))
        furthest = first_place(field) if sign > 0 else last_place(field)
        behind = branch(field, np.full(field.geometry.n_site, furthest), loads, sign)
        begin = jkr.equilibrium_radius(1.0) - sign * length
        near = branch(field, forward_circle(field, 1.0, sign, begin, length), loads, sign)
        if near.fronts is None or behind.fronts is None:
            raise RuntimeError("fronts were not recorded")
        steady = near.states.least_travel >= length
        difference = np.max(np.abs(near.fronts - behind.fronts), axis=1)
        count += int(np.count_nonzero(difference[steady] > SAME * scene.spectrum.short_cutoff))
        total += int(np.count_nonzero(steady))
    return count, total


def main() -> None:
    """Compare on all surfaces in both directions."""
    for scene in SURFACES:
        for sign, name in ((1, "approach"), (-1, "retraction")):
            count, total = differing(scene, 1 if sign > 0 else -1)
            click.echo(f"{scene.name}, {name}: {count} of {total} steady states differ")


if __name__ == "__main__":
    main()
