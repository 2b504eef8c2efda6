"""Scenes of fronts that a solver brings to rest, and of forces and energies of given fronts."""

from collections.abc import Callable, Iterable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from crackfront.core.adhesion import chemical_adhesion, rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import contact_energy, dissipated_energy
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.load_schedule import LoadSchedule, protocol
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.touch import first_touch
from crackfront.core.field.fields import Field, Interpolation, RayField
from crackfront.core.field.rays import front_adhesion, sampled_on_rays, swept_adhesion
from crackfront.core.geometry.line import initial_front, line_field
from crackfront.core.geometry.sphere import contact_field, polar_field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Solver, front_force
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.tiles import Resolution
from tests.golden.closed_forms import FLAT, FRACTAL, TABLE
from tests.golden.golden import Values

TIGHT = 1e-12
"""Tolerance of the forces with which the golden states are solved."""

_MOST_SITES = 16
"""Sites of a front that are compared."""

_SOLVER_COUNTS = ("iterations", "updates", "residual")
"""Entries of a state that say how a solver found it, not what it found."""


def recorded(record: CycleRecord) -> Values:
    """States, energies and some fronts of a record."""
    values: Values = {
        "status": np.array(float([*Status].index(record.status))),
        "end load": np.array(record.end_load),
    }
    for item in fields(record.states):
        if item.name not in _SOLVER_COUNTS:
            values[item.name] = np.asarray(getattr(record.states, item.name), float)
    if record.dissipated_energy is not None:
        values["dissipated energy"] = record.dissipated_energy
    if record.pull_off_energy is not None:
        values["pull-off energy"] = np.array(record.pull_off_energy)
    if record.fronts is not None:
        n_state, n_site = record.fronts.shape
        group_size = -(-n_site // _MOST_SITES)
        values["fronts"] = record.fronts[[n_state // 3, n_state - 2], ::group_size]
    return values


# Simulations of tiles.

_SPHERE = Simulation(
    spectrum_name="golden",
    kind="roughness",
    spectrum=FRACTAL,
    elastic_energy=0.05,
    realisation=0,
    sweep_seed=71,
    resolution=Resolution(
        n_angle=48, spacing=0.04, interpolation="cubic", tile_side=3.0, n_point=36
    ),
    schedule=FullCycle(0.7, 0.15),
    solver=None,  # type: ignore[arg-type]  # each scene is solved by every solver
    record_fronts=True,
    record_energy=True,
)

_LINE = replace(
    _SPHERE,
    spectrum=FRACTAL,
    resolution=Resolution(
        n_angle=40, spacing=0.05, interpolation="cubic", tile_side=4.0, n_point=48
    ),
    schedule=LineSchedule(spring=1.5, length=4.0, period=3.0, lead_in=1.5, step=0.5),
)

_STEADY = SteadySchedule(start=0.3, max_penetration=3.0, travel=0.2, standard_error=0.4)


def _resolved(simulation: Simulation, **sizes: Any) -> Resolution:
    """Sizes of a simulation with some replaced."""
    return replace(simulation.resolution, **sizes)


_SIMULATIONS: dict[str, Simulation] = {
    "rough sphere, cubic": _SPHERE,
    "rough sphere, linear, odd front": replace(
        _SPHERE,
        elastic_energy=0.02,
        resolution=_resolved(_SPHERE, n_angle=45, interpolation="linear"),
    ),
    "chemical sphere, strong": replace(
        _SPHERE, kind="chemical", elastic_energy=0.25, realisation=1
    ),
    "chemical sphere, linear, weak": replace(
        _SPHERE,
        kind="chemical",
        spectrum=FLAT,
        elastic_energy=0.004,
        resolution=_resolved(_SPHERE, interpolation="linear"),
    ),
    "rough sphere, tabulated spectrum": replace(_SPHERE, spectrum=TABLE, realisation=2),
    "rough sphere, steady branches": replace(_SPHERE, schedule=_STEADY),
    "chemical sphere, steady branches, strong": replace(
        _SPHERE, kind="chemical", spectrum=FLAT, elastic_energy=0.2, schedule=_STEADY
    ),
    "chemical sphere, long front": replace(
        _SPHERE,
        kind="chemical",
        elastic_energy=0.1,
        schedule=FullCycle(0.4, 0.4),
        resolution=_resolved(_SPHERE, n_angle=288),
    ),
    "rough line": _LINE,
    "rough line, strong, odd front": replace(
        _LINE, elastic_energy=0.3, resolution=_resolved(_LINE, n_angle=45), realisation=3
    ),
    "chemical line, linear": replace(
        _LINE,
        kind="chemical",
        spectrum=TABLE,
        elastic_energy=0.1,
        resolution=_resolved(_LINE, interpolation="linear"),
    ),
    "chemical line, long front": replace(
        _LINE,
        kind="chemical",
        elastic_energy=0.1,
        schedule=LineSchedule(spring=1.5, length=4.0, period=3.0, lead_in=1.0, step=1.0),
        resolution=_resolved(_LINE, n_angle=288),
    ),
    "line of independent sites": replace(
        _LINE,
        schedule=LineSchedule(
            spring=1.5, length=4.0, period=3.0, lead_in=1.5, step=0.5, uncorrelated=True
        ),
        resolution=_resolved(_LINE, n_angle=48),
    ),
}
"""Simulations as of a sweep, by the names of their scenes."""


def _simulated(simulation: Simulation, solver: Solver) -> Values:
    """States of a simulation, its seed and what is measured on its tile."""
    result = run_simulation(replace(simulation, solver=solver))
    measures = result.measures
    # A float would round the seed.
    high, low = divmod(simulation.seed, 2**32)
    return recorded(result.record) | {
        "seed": np.array([high, low], float),
        "measures": np.array([measures.e_el, measures.w_rms, measures.negative_share]),
    }


# Fields that are given.


def _waves(n_x: int, n_y: int, amplitude: float) -> Array:
    """A smooth periodic pattern without symmetry, of zero mean."""
    x = 2 * np.pi * np.arange(n_x)[:, np.newaxis] / n_x
    y = 2 * np.pi * np.arange(n_y) / n_y
    pattern = (
        np.sin(x + 0.3) * np.cos(2 * y) + 0.7 * np.sin(2 * x - y) + 0.4 * np.cos(3 * x + 2 * y)
    )
    return amplitude * pattern


def _rays(n_angle: int, amplitude: float, interpolation: Interpolation) -> RayField:
    """Independent noise at every sample of every ray."""
    radii = 0.06 * np.arange(1, 45, dtype=float)
    noise = np.random.default_rng(74).standard_normal((radii.size, n_angle))
    return polar_field(radii, WORK_OF_ADHESION * (1 + amplitude * noise), interpolation)


def _cycle(field: Field, solver: Solver, depth: float = 0.6, step: float = 0.15) -> Values:
    """Full cycle of a sphere with its fronts and energies."""
    recorder = Recorder(fronts=True, energy=True)
    return recorded(run_cycle(field, LoadSchedule(depth, step), solver, recorder))


def _followed(field: Field, front: Array, loads: Iterable[Load], solver: Solver) -> Values:
    """States of a front under given loads with its fronts and energies."""
    recorder = Recorder(fronts=True, energy=True)
    recorder.run(field, front, loads, solver)
    return recorded(recorder.record())


def smooth_circle(solver: Solver) -> Values:
    """A circle without line elasticity on a uniform surface, the curve of JKR."""
    radii = 0.05 * np.arange(1, 60, dtype=float)
    return _cycle(polar_field(radii, np.full(radii.size, WORK_OF_ADHESION)), solver)


def circle_that_jumps(solver: Solver) -> Values:
    """A circle over rings of strong and weak adhesion, which it crosses in jumps."""
    radii = 0.05 * np.arange(1, 60, dtype=float)
    rings = 1 + 0.6 * np.cos(2 * np.pi * radii / 0.55)
    return _cycle(polar_field(radii, WORK_OF_ADHESION * rings, "cubic"), solver, 0.8, 0.2)


def front_that_jumps(solver: Solver) -> Values:
    """A front held by two strong patches, from which it tears off."""
    angle = 2 * np.pi * np.arange(32, dtype=float) / 32
    radii = 0.05 * np.arange(1, 56, dtype=float)[:, np.newaxis]
    ring = np.exp(-(((radii - 1.2) / 0.15) ** 2))
    patches = np.exp(6 * (np.cos(angle) - 1)) + 0.7 * np.exp(9 * (np.cos(angle - 2.2) - 1))
    adhesion = WORK_OF_ADHESION * (1 + 1.5 * ring * patches)
    return _cycle(polar_field(radii[:, 0], adhesion, "cubic"), solver, 0.6, 0.2)


def edge_in_compression(solver: Solver) -> Values:
    """A front over a repelling patch, at which its edge retracts until it is in compression."""
    angle = 2 * np.pi * np.arange(28, dtype=float) / 28
    radii = 0.05 * np.arange(1, 56, dtype=float)[:, np.newaxis]
    patch = np.exp(5 * (np.cos(angle - 1) - 1)) / (1 + np.exp(-(radii - 0.6) / 0.05))
    adhesion = WORK_OF_ADHESION * (1 - 6 * patch)
    return _cycle(polar_field(radii[:, 0], adhesion, "cubic"), solver, 1.5, 0.25)


def noisy_rays(solver: Solver) -> Values:
    """Straight pieces between samples of noise on 24 rays."""
    return _cycle(_rays(24, 0.3, "linear"), solver)


def noisy_cubic_rays(solver: Solver) -> Values:
    """Cubic pieces between samples of noise on 23 rays."""
    return _cycle(_rays(23, 0.3, "cubic"), solver)


def needles(solver: Solver) -> Values:
    """Noise so strong and short that single sites are pinned, on a front longer than a window."""
    return _cycle(_rays(264, 1.5, "linear"), solver, 0.3, 0.3)


def sphere_on_a_map(solver: Solver) -> Values:
    """A sphere on a given chemical map, under loads that turn several times."""
    adhesion = chemical_adhesion(_waves(20, 20, 0.25), 0.1)
    field = contact_field(adhesion, 1.0, 40)
    loads = protocol([0.0, 0.8, 0.2, 0.6, -0.4], 0.2)
    return _followed(field, first_touch(field), loads, solver)


def line_on_a_map(solver: Solver) -> Values:
    """A straight front on a given rough map, under loads that turn several times."""
    adhesion = replace(rough_adhesion(_waves(24, 16, 0.4), 0.125), corner=(-0.4, 0.3))
    field = line_field(adhesion, 0.8, (0.0, 1.5), n_site=36, spacing=0.05)
    # The pinning must be strong: a weak one is the small difference of large places.
    loads = protocol([0.0, 1.5, 0.3, 0.9, 0.0], 0.3)
    return _followed(field, initial_front(field, adhesion, 0.0), loads, solver)


def _simulation_scene(simulation: Simulation) -> Callable[[Solver], Values]:
    """Scene of a simulation."""
    return lambda solver: _simulated(simulation, solver)


FRONTS: dict[str, Callable[[Solver], Values]] = {
    "smooth circle": smooth_circle,
    "circle that jumps": circle_that_jumps,
    "front that jumps": front_that_jumps,
    "edge in compression": edge_in_compression,
    "noisy rays": noisy_rays,
    "noisy rays, cubic": noisy_cubic_rays,
    "needles": needles,
    "sphere on a map": sphere_on_a_map,
    "line on a map": line_on_a_map,
} | {name: _simulation_scene(simulation) for name, simulation in _SIMULATIONS.items()}
"""Scenes that a solver solves, by their names in the file."""


def forces_and_energies() -> Values:
    """Forces, works of adhesion and energies of given fronts, without a solver."""
    tile = chemical_adhesion(_waves(20, 20, 0.25), 0.1)
    corner = replace(tile, corner=(-0.35, 0.2))
    linear = contact_field(tile, 1.0, 20, interpolation="linear")
    spheres: dict[str, Field] = {
        "cubic tile": contact_field(tile, 1.0, 20, band_limited=True),
        "linear tile": linear,
        "sampled tile": sampled_on_rays(linear),
        "cubic rays": _rays(21, 0.3, "cubic"),
    }
    lines = {
        "line": line_field(corner, 0.8, (0.0, 1.5), n_site=21, spacing=0.07),
        "linear line": line_field(tile, 0.8, (0.0, 1.5), n_site=20, interpolation="linear"),
    }
    values: Values = {}
    for name, field in (spheres | lines).items():
        n_site = field.geometry.n_site
        angle = 2 * np.pi * np.arange(n_site) / n_site
        before = 0.9 + 0.2 * np.sin(2 * angle) + 0.1 * np.cos(5 * angle)
        after = 1.1 + 0.3 * np.cos(angle) + 0.05 * np.sin(7 * angle)
        values[f"{name} force"] = np.array(
            [front_force(front, load, field) for front in (before, after) for load in (0.2, 1.0)]
        )
        values[f"{name} adhesion"] = front_adhesion(before, field)
        values[f"{name} energies"] = np.array(
            [
                swept_adhesion(before, after, field),
                dissipated_energy(before, after, 0.5, field),
                field.geometry.stored_energy(before, 0.2),
                field.geometry.stored_energy(after, 1.3),
            ]
        )
        values[f"{name} sites"] = field.geometry.sites
        if name in spheres:
            values[f"{name} contact energy"] = np.array(contact_energy(after, 0.5, field))
    return values
