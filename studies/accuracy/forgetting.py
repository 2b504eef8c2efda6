"""Whether steady branches have forgotten the circle at which they began.

Fronts that begin at the circle of `simulate.steady.forward_circle` are compared, load by load,
with those that begin as far behind as the field allows.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crackfront.core import jkr
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import first_place, last_place
from crackfront.core.outcome import Direction
from crackfront.simulate.simulation import simulation_field
from crackfront.simulate.steady import forward_circle
from studies.accuracy.scenes import SCENES, Scene
from studies.accuracy.study import BRANCHES, branch_record
from studies.pages import markdown_table

KNOBS = replace(
    SCENES["chemical-0.04"].reference,
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
    replace(SCENES[name], name=f"{SCENES[name].shape}, w_rms {rms:g}", elastic_energy=rms**2 / 4)
    for name, amplitudes in (
        ("chemical-0.04", (0.1, 0.4, 0.84, 1.5)),
        ("h03-0.04", (0.45, 0.77)),
        ("h08-0.04", (0.45,)),
        ("f013-0.14", (0.2, 0.77)),
        ("large-0.04", (0.4,)),
    )
    for rms in amplitudes
)


def differing(scene: Scene, direction: Direction, n_realisation: int) -> tuple[int, int]:
    """Number of states that differ in any site, and of all that count as steady."""
    count = total = 0
    for number in range(n_realisation):
        simulation = scene.simulation(KNOBS, number)
        length = simulation.correlation_length
        loads = 1.0 + direction * 6 * length * np.arange(float(N_LOAD))
        schedule = LoadSchedule(float(loads.max()), 0.1)
        field = simulation_field(replace(simulation, schedule=schedule))
        behind = first_place(field) if direction > 0 else last_place(field)
        begin = jkr.equilibrium_radius(1.0) - direction * length
        far, near = (
            branch_record(field, start, loads, direction, simulation.solver)
            for start in (
                np.full(field.geometry.n_site, behind),
                forward_circle(field, 1.0, direction, begin, length),
            )
        )
        assert near.fronts is not None, "the branches record fronts"
        assert far.fronts is not None, "the branches record fronts"
        steady = near.states.least_travel >= length
        difference = np.max(np.abs(near.fronts - far.fronts), axis=1)
        count += int(np.count_nonzero(difference[steady] > SAME * scene.spectrum.short_cutoff))
        total += int(np.count_nonzero(steady))
    return count, total


def forgetting_table() -> str:
    """Numbers of states that depend on their start, for every surface and branch."""
    rows = [
        (scene.name, name, *map(str, differing(scene, direction, N_REALISATION)))
        for scene in SURFACES
        for direction, name in BRANCHES
    ]
    return markdown_table("surface | branch | steady states that differ | steady states", rows)
