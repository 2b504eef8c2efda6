"""What numerics cost and how wrong they are, on the same surfaces at the same loads."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import Recorder
from crackfront.core.outcome import Direction
from crackfront.core.variables import ADHESION, FORCE, variable
from crackfront.simulate.costs import run_cost
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import simulation_field
from crackfront.simulate.sphere.steady_branches import forward_circle
from studies.accuracy.scenes import Scene, Trial
from studies.progress import Progress, silent

_RUN, _BRANCH, _PER_CUTOFF = "realisation", "branch", "1 / short cutoff"


@dataclass(frozen=True, slots=True)
class Branches:
    """States of both branches at the same loads, the approach first: (2, n_state, ...) arrays.

    The processor time includes the synthesis of the surface.
    (Units: w_int, pi w_int R, reduced lateral length, s)
    """

    apparent_work_of_adhesion: Array
    force: Array
    radius: Array
    seconds: float

    @property
    def adhesion(self) -> Array:
        """Means over the loads, w_appr and w_retr (Units: w_int)."""
        return self.apparent_work_of_adhesion.mean(axis=1)


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of one setting against the reference on the same surfaces at the same loads.

    What is varied is one of :data:`crackfront.simulate.laws.SETTINGS`, `finer` or `requested`.
    """

    setting: str = variable("what is varied", "1")
    value: float = variable("its value; of requested the error of k", "1")
    seconds: Array = variable("processor time of both branches, synthesis included", "s", _RUN)
    adhesion: Array = variable("error of w_appr and w_retr", ADHESION, _RUN, _BRANCH)
    force: Array = variable("rms error of the normal force", FORCE, _RUN)
    front_rms: Array = variable("rms error of the radius", "short cutoff", _RUN)
    front_max: Array = variable("largest error of the radius", "short cutoff", _RUN)
    angles_per_cutoff: float = variable("sites of the front", _PER_CUTOFF)
    samples_per_cutoff: float = variable("samples along a ray", _PER_CUTOFF)
    interpolation: str = variable("pieces between samples", "1")
    pixels_per_cutoff: float = variable("points of the tile", _PER_CUTOFF)
    tolerance: float = variable("force that may be left, per front length", ADHESION)


@dataclass(frozen=True, slots=True)
class SceneErrors:
    """Errors of all settings of a scene, and the results of its reference."""

    scene: Scene
    errors: tuple[Errors, ...]
    reference_adhesion: Array = variable("w_appr and w_retr", ADHESION, _RUN, _BRANCH)
    reference_seconds: Array = variable("processor time of the reference", "s", _RUN)

    @property
    def hysteresis(self) -> float:
        """Mean hysteresis of the reference (Units: w_int)."""
        return float(np.mean(self.reference_adhesion[:, 1] - self.reference_adhesion[:, 0]))

    def hysteresis_errors(self, errors: Errors) -> Array:
        """Errors of the hysteresis of all realisations, relative to the mean of the reference."""
        return (errors.adhesion[:, 1] - errors.adhesion[:, 0]) / self.hysteresis

    def work_and_precision(self) -> tuple[Array, Array]:
        """Mean processor time and rms relative error of the hysteresis of every setting."""
        seconds = [errors.seconds.mean() for errors in self.errors]
        return np.array(seconds), np.array([rms(self.hysteresis_errors(e)) for e in self.errors])


def branches_seconds(scene: Scene, settings: Settings) -> float:
    """Processor time that both branches of a surface are expected to take (Units: s)."""
    simulation = scene.simulation(settings, 0)
    n_point, n_state = math.prod(simulation.tile[0]), 2.0 * scene.penetrations.size
    return run_cost(n_site=simulation.resolution.n_angle, n_point=n_point, n_state=n_state).seconds


def trial_seconds(scene: Scene, trials: list[Trial]) -> float:
    """Processor time that a surface is expected to take in `scene_errors` (Units: s)."""
    tried = [scene.reference, *(trial.settings for trial in trials)]
    return sum(branches_seconds(scene, settings) for settings in tried)


def scene_errors(
    scene: Scene, trials: list[Trial], surfaces: range, progress: Progress = silent
) -> SceneErrors:
    """Errors of trials of the numerics on numbered surfaces of a scene."""
    exact = [measured_branches(scene, scene.reference, number) for number in surfaces]
    study = SceneErrors(
        scene=scene,
        errors=(),
        reference_adhesion=np.array([item.adhesion for item in exact]),
        reference_seconds=np.array([item.seconds for item in exact]),
    )
    seconds = study.reference_seconds.mean()
    progress(f"reference: hysteresis {study.hysteresis:.5g} w_int, {seconds:.2f} s")
    errors = []
    for trial in trials:
        branches = [measured_branches(scene, trial.settings, number) for number in surfaces]
        errors.append(_errors(scene, trial, branches, exact))
        error, seconds = rms(errors[-1].adhesion) / scene.elastic_energy, errors[-1].seconds.mean()
        progress(f"{trial.setting} {trial.value:g}: rms error of k {error:.2g}, {seconds:.2f} s")
    return replace(study, errors=tuple(errors))


def _errors(scene: Scene, trial: Trial, measured: list[Branches], exact: list[Branches]) -> Errors:
    """Differences of measured branches from the exact ones, surface by surface."""
    pairs = list(zip(measured, exact, strict=True))
    adhesion = np.array(
        [a.apparent_work_of_adhesion - b.apparent_work_of_adhesion for a, b in pairs]
    )
    force, cutoff = np.array([a.force - b.force for a, b in pairs]), scene.spectrum.short_cutoff
    fronts = [front_difference(a.radius, b.radius) / cutoff for a, b in pairs]
    numerics = asdict(trial.settings)
    del numerics["angles"]  # None in all settings: they count sites per cutoff
    return Errors(
        setting=trial.setting,
        value=trial.value,
        seconds=np.array([branches.seconds for branches in measured]),
        adhesion=np.mean(adhesion, axis=2),
        force=np.sqrt(np.mean(force**2, axis=(1, 2))),
        front_rms=np.array([rms(front) for front in fronts]),
        front_max=np.array([np.max(np.abs(front)) for front in fronts]),
        **numerics,
    )


def measured_branches(scene: Scene, settings: Settings, realisation: int) -> Branches:
    """Both branches of a scene, each begun at a circle that moves forward.

    A load without a state is a RuntimeError.
    """
    begun = time.process_time()
    simulation = scene.simulation(settings, realisation)
    field = simulation_field(simulation)
    length = simulation.correlation_length
    adhesion, force, radius = [], [], []
    for direction in get_args(Direction):
        loads = scene.penetrations[::direction]
        first = float(loads[0])
        start = forward_circle(field, first, direction, jkr.equilibrium_radius(first), length)
        recorder = Recorder(fronts=True)
        steps = [Load(float(penetration), direction) for penetration in loads]
        recorder.run(field, start, steps, simulation.solver)
        record = recorder.record()
        if record.fronts is None or len(record.fronts) != scene.penetrations.size:
            raise RuntimeError(f"{simulation.label}: {record.status.value}")
        adhesion.append(record.states.apparent_work_of_adhesion[::direction])
        force.append(record.states.force[::direction])
        radius.append(record.fronts[::direction])
    seconds = time.process_time() - begun
    return Branches(np.array(adhesion), np.array(force), np.array(radius), seconds)


def front_difference(fronts: Array, exact: Array) -> Array:
    """Difference of fronts from finer ones, interpolated by a trigonometric polynomial.

    Arrays are of the shapes (..., n_angle) and (..., n_fine), the difference of the latter.
    """
    return resample(fronts, exact.shape[-1], axis=-1) - exact


def rms(values: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def pareto_front(seconds: Array, error: Array) -> NDArray[np.intp]:
    """Indices of settings that no other one beats in time and in error, the fastest first."""
    order = np.lexsort((error, seconds))
    best = np.minimum.accumulate(error[order])
    first = np.concatenate([[True], error[order][1:] < best[:-1]])
    return order[first]
