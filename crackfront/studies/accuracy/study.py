"""What numerics cost and how wrong they are, on the same surfaces at the same loads."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample

from crackfront.core import jkr
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.steady import forward_circle
from crackfront.core.field.fields import TileField
from crackfront.core.outcome import Direction
from crackfront.core.records import ADHESION, FORCE, variable
from crackfront.core.solver.relax import Solver
from crackfront.simulate.contact import simulation_field
from crackfront.simulate.laws import Knobs
from crackfront.studies.accuracy.scenes import Scene

Array = NDArray[np.float64]

_RUN, _BRANCH = "realisation", "branch"


@dataclass(frozen=True, slots=True)
class Branches:
    """States of both branches at the loads of a scene, the approach first.

    Attributes
    ----------
    apparent_work_of_adhesion : (2, n_state) array
        At the same loads in both. (Units: w_int)
    force : (2, n_state) array
        Normal force. (Units: pi w_int R)
    radius : (2, n_state, n_angle) array
        Fronts. (Units: reduced lateral length)
    seconds : float
        Processor time, synthesis of the surface included. (Units: s)
    """

    apparent_work_of_adhesion: Array
    force: Array
    radius: Array
    seconds: float


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of one setting against the reference on the same surfaces at the same loads.

    Attributes
    ----------
    numerics : Numerics
        All of them.
    knob : str
        What is varied: a knob of :data:`crackfront.simulate.laws.KNOBS`, `finer` or `asked`.
    value : float
        Its value; of `asked` the error of k.
    seconds : (n_realisation,) array
        Processor time of both branches. (Units: s)
    adhesion : (n_realisation, 2) array
        Error of w_appr and w_retr, means over the loads. (Units: w_int)
    state : (n_realisation, 2) array
        Rms over the loads of the error of one state's apparent work of adhesion. (Units: w_int)
    force : (n_realisation,) array
        Rms over all states of the error of the force. (Units: pi w_int R)
    front_rms, front_max : (n_realisation,) array
        Rms and largest error of the radius over all sites and states. (Units: short cutoff)
    """

    knobs: Knobs
    knob: str = variable("what is varied", "1")
    value: float = variable("its value; of asked the error of k", "1")
    seconds: Array = variable("processor time of both branches, synthesis included", "s", _RUN)
    adhesion: Array = variable("error of w_appr and w_retr", ADHESION, _RUN, _BRANCH)
    state: Array = variable("rms error of one state's w", ADHESION, _RUN, _BRANCH)
    force: Array = variable("rms error of the normal force", FORCE, _RUN)
    front_rms: Array = variable("rms error of the radius", "short cutoff", _RUN)
    front_max: Array = variable("largest error of the radius", "short cutoff", _RUN)


@dataclass(frozen=True, slots=True)
class SceneErrors:
    """All settings of a scene.

    Attributes
    ----------
    scene : Scene
        What was simulated.
    adhesion : (n_realisation, 2) array
        w_appr and w_retr of the reference. (Units: w_int)
    seconds : (n_realisation,) array
        Processor time of the reference. (Units: s)
    errors : tuple of Errors
        Those of all settings.
    """

    scene: Scene
    adhesion: Array
    seconds: Array
    errors: tuple[Errors, ...]


def scene_errors(
    scene: Scene,
    settings: list[tuple[str, float, Knobs]],
    realisations: range,
    progress: Callable[[str], None] | None = None,
) -> SceneErrors:
    """Errors of settings of the numerics on a scene.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    settings : list of tuple
        What is varied, its value, and the numerics; :attr:`Scene.single_settings` or
        :attr:`Scene.asked_settings`.
    realisations : range
        Numbers of the surfaces.
    progress : callable, optional
        Called with a line for the reference and every setting.
    """
    tell = progress or (lambda line: None)
    exact = [measured_branches(scene, scene.reference, number) for number in realisations]
    adhesion = np.array([item.apparent_work_of_adhesion.mean(axis=1) for item in exact])
    mean = np.mean(adhesion[:, 1] - adhesion[:, 0])
    seconds = np.array([item.seconds for item in exact])
    tell(f"reference: hysteresis {mean:.5g} w_int, {seconds.mean():.2f} s")
    errors = []
    for knob, value, knobs in settings:
        found = [measured_branches(scene, knobs, number) for number in realisations]
        errors.append(_errors(scene, knob, value, knobs, found, exact))
        rms = np.sqrt(np.mean(errors[-1].adhesion ** 2)) / scene.elastic_energy
        tell(f"{knob} {value:g}: rms error of k {rms:.2g}, {errors[-1].seconds.mean():.2f} s")
    return SceneErrors(scene, adhesion, seconds, tuple(errors))


def joined(*studies: SceneErrors) -> SceneErrors:
    """Studies of one scene, on the same surfaces, as one.

    Parameters
    ----------
    *studies : SceneErrors
        One or more.
    """
    errors = tuple(errors for study in studies for errors in study.errors)
    return replace(studies[0], errors=errors)


def _errors(
    scene: Scene,
    knob: str,
    value: float,
    knobs: Knobs,
    found: list[Branches],
    exact: list[Branches],
) -> Errors:
    """Differences of the found branches from the exact ones, surface by surface."""
    pairs = list(zip(found, exact, strict=True))
    adhesion = np.array(
        [one.apparent_work_of_adhesion - other.apparent_work_of_adhesion for one, other in pairs]
    )
    force = np.array([one.force - other.force for one, other in pairs])
    fronts = [
        front_difference(one.radius, other.radius) / scene.spectrum.short_cutoff
        for one, other in pairs
    ]
    return Errors(
        knob=knob,
        value=value,
        knobs=knobs,
        seconds=np.array([one.seconds for one in found]),
        adhesion=adhesion.mean(axis=2),
        state=np.sqrt(np.mean(adhesion**2, axis=2)),
        force=np.sqrt(np.mean(force**2, axis=(1, 2))),
        front_rms=np.array([np.sqrt(np.mean(front**2)) for front in fronts]),
        front_max=np.array([np.max(np.abs(front)) for front in fronts]),
    )


def measured_branches(scene: Scene, knobs: Knobs, realisation: int) -> Branches:
    """Both branches of a scene, each begun at a circle that moves forward.

    Raises
    ------
    RuntimeError
        If there is a load without a state.
    """
    start = time.process_time()
    simulation = scene.simulation(knobs, realisation)
    field = simulation_field(simulation)
    approach = _branch(field, scene.penetrations, 1, simulation.solver)
    retraction = _branch(field, scene.penetrations[::-1], -1, simulation.solver)
    fronts = []
    for record in (approach, retraction):
        if record.fronts is None or len(record.fronts) != scene.penetrations.size:
            raise RuntimeError(f"{simulation.label}: {record.status.value}")
        fronts.append(record.fronts)
    return Branches(
        apparent_work_of_adhesion=np.array(
            [
                approach.states.apparent_work_of_adhesion,
                retraction.states.apparent_work_of_adhesion[::-1],
            ]
        ),
        force=np.array([approach.states.force, retraction.states.force[::-1]]),
        radius=np.array([fronts[0], fronts[1][::-1]]),
        seconds=time.process_time() - start,
    )


def _branch(
    field: TileField, penetrations: Array, direction: Direction, solver: Solver
) -> CycleRecord:
    """One branch over given loads."""
    first = float(penetrations[0])
    circle = forward_circle(field, first, direction, jkr.equilibrium_radius(first))
    recorder = Recorder(fronts=True)
    loads = [Load(float(penetration), direction) for penetration in penetrations]
    recorder.run(field, circle, loads, solver)
    return recorder.record()


def front_difference(fronts: Array, exact: Array) -> Array:
    """Difference of fronts at the sites of finer ones.

    Parameters
    ----------
    fronts : (..., n_angle) array
        Fronts; between the sites they are trigonometric. (Units: reduced lateral length)
    exact : (..., n_fine) array
        Fronts on other sites. (Units: reduced lateral length)

    Returns
    -------
    (..., n_fine) array
        Difference. (Units: reduced lateral length)
    """
    return resample(fronts, exact.shape[-1], axis=-1) - exact
