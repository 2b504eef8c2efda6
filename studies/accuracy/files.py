"""The six studies of a scene, and the files that they write."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import xarray as xr

from crackfront.core.variables import Variable, variables
from crackfront.simulate.labels import labelled, labelled_fields
from crackfront.simulate.settings import Settings
from crackfront.simulate.storage import UnreadableFileError, read_dataset
from studies.accuracy import averages
from studies.accuracy.scenes import FINEST, HELD_OUT, SCENES, Scene, Trial
from studies.accuracy.study import Errors, SceneErrors, scene_errors, trial_seconds
from studies.progress import Progress
from studies.records import read_records, stacked

Record = TypeVar("Record")

_SETTING, _BRANCH = "setting", "branch"

_COVERED = (0.1, 0.03, 0.01)
"""Errors of k whose coverage is measured."""

_UNSEEN = (0.03, 0.01)
"""Errors of k that are requested on surfaces to which no law was fitted."""

_EXPECTED = (0.1, 0.03, 0.01, 0.003)
"""Errors of k that are requested where rare avalanches are counted on many such surfaces."""


class Study(NamedTuple):
    """What is measured on a number of surfaces of a scene, and the time that one takes in s."""

    measured: Callable[[Scene, int, Progress], xr.Dataset]
    seconds: Callable[[Scene], float]


def _of_trials(
    trials: Callable[[Scene], list[Trial]], first: int = 0, reference: Settings | None = None
) -> Study:
    """Study of the errors of trials, on surfaces from a number on.

    They are compared with the reference of their scene unless another one is named.
    """

    def compared(scene: Scene) -> Scene:
        return scene if reference is None else replace(scene, reference=reference)

    def measured(scene: Scene, n_realisation: int, progress: Progress) -> xr.Dataset:
        surfaces = range(first, first + n_realisation)
        return errors_dataset(scene_errors(compared(scene), trials(scene), surfaces, progress))

    return Study(measured, lambda scene: trial_seconds(compared(scene), trials(scene)))


def _averages(scene: Scene, n_realisation: int, progress: Progress) -> xr.Dataset:
    """Errors of schedules and tiles."""
    samples = averages.sampling_errors(scene, range(n_realisation), progress)
    return records_dataset("errors of averaging", scene, samples)


def _coverage(scene: Scene, n_realisation: int, progress: Progress) -> xr.Dataset:
    """True and stated errors."""
    coverages = averages.held_out_coverage(scene, _COVERED, n_realisation, progress)
    return records_dataset("true and stated errors", scene, coverages)


STUDIES = {
    "settings": _of_trials(lambda scene: scene.single_trials),
    "requested": _of_trials(lambda scene: scene.requested_trials()),
    "unseen": _of_trials(lambda scene: scene.requested_trials(_UNSEEN), HELD_OUT),
    "expected": _of_trials(lambda scene: scene.requested_trials(_EXPECTED), HELD_OUT, FINEST),
    "averages": Study(_averages, averages.sampling_seconds),
    "coverage": Study(_coverage, lambda scene: averages.coverage_seconds(scene, _COVERED)),
}
"""The studies of a scene, by the first part of the names of their files."""


def records_dataset(title: str, scene: Scene, records: tuple[Any, ...]) -> xr.Dataset:
    """Dataset of records of a scene, one a setting."""
    attributes = {"title": f"{title}, {scene.name}", "scene": scene.name}
    return xr.Dataset(stacked(records, _SETTING), attrs=attributes)


def errors_dataset(study: SceneErrors) -> xr.Dataset:
    """Dataset of the errors of all settings of a scene."""
    scene, branches = study.scene, Variable(_BRANCH, (_BRANCH,), "1", "approach or retraction")
    return (
        records_dataset("numerical errors", scene, study.errors)
        .assign(labelled_fields(study))
        .assign_coords({_BRANCH: labelled(branches, np.array(["approach", "retraction"]))})
        .assign_attrs(elastic_energy=scene.elastic_energy, penetrations=scene.penetrations)
    )


def read_study(path: Path, kind: type[Record]) -> tuple[Scene, tuple[Record, ...]]:
    """Scene and records of the file of a study.

    A ValueError says if it is missing, truncated, or of a scene that is not known.
    """
    scene = SCENES.get(str(read_dataset(path).attrs.get("scene")))
    if scene is None:
        raise UnreadableFileError(f"{path} contains no errors of a known scene; measure them again")
    return scene, read_records(path, kind, _SETTING)


def read_errors(path: Path) -> SceneErrors:
    """Errors of all settings of a scene, as of :func:`read_study`."""
    scene, errors = read_study(path, Errors)
    dataset = read_dataset(path)
    references = (np.asarray(dataset[item.name]) for item in variables(SceneErrors))
    return SceneErrors(scene, errors, *references)
