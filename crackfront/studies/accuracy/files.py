"""The files of measured numerical errors, and of the laws fitted to them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.analysis.table import REALISATION
from crackfront.core.records import ADHESION, Variable
from crackfront.data.files import UnreadableFileError, labelled, read_dataset, write_dataset
from crackfront.data.provenance import Provenance
from crackfront.data.records import stacked, unstacked
from crackfront.simulate.laws import Knobs, Law
from crackfront.studies.accuracy.coverage import Coverage
from crackfront.studies.accuracy.sampling import Sample
from crackfront.studies.accuracy.scenes import SCENES, Scene
from crackfront.studies.accuracy.study import Errors, SceneErrors

SETTING, BRANCH = "setting", "branch"
_PER_CUTOFF = "1 / short cutoff"
_setting = (SETTING,)
_NUMERICS = (
    Variable("angles_per_cutoff", _setting, _PER_CUTOFF, "sites of the front"),
    Variable("samples_per_cutoff", _setting, _PER_CUTOFF, "samples along a ray"),
    Variable("interpolation", _setting, "1", "pieces between samples"),
    Variable("pixels_per_cutoff", _setting, _PER_CUTOFF, "points of the tile"),
    Variable("tolerance", _setting, ADHESION, "force that may be left, per front length"),
)
_REFERENCE = (
    Variable("reference_adhesion", (REALISATION, BRANCH), ADHESION, "w_appr and w_retr"),
    Variable("reference_seconds", (REALISATION,), "s", "processor time of the reference"),
)


def write_errors(path: Path, study: SceneErrors, origin: Provenance) -> None:
    """Write the errors of all settings of a scene.

    Parameters
    ----------
    path : Path
        netCDF file.
    study : SceneErrors
        What was measured.
    origin : Provenance
        Where it comes from.
    """
    scene = study.scene
    branches = Variable(BRANCH, (BRANCH,), "1", "approach or retraction")
    values = stacked(study.errors, SETTING)
    values |= {
        item.name: labelled(item, np.array([getattr(one.knobs, item.name) for one in study.errors]))
        for item in _NUMERICS
    }
    references = zip(_REFERENCE, (study.adhesion, study.seconds), strict=True)
    values |= {item.name: labelled(item, value) for item, value in references}
    coordinates = {BRANCH: labelled(branches, np.array(["approach", "retraction"]))}
    attributes = {
        "title": f"numerical errors, {scene.name}",
        "scene": scene.name,
        "elastic_energy": scene.elastic_energy,
        "penetrations": scene.penetrations,
    }
    write_dataset(path, xr.Dataset(values, coords=coordinates, attrs=attributes), origin)


def read_errors(path: Path) -> SceneErrors:
    """Errors that :func:`write_errors` wrote.

    Parameters
    ----------
    path : Path
        File.

    Raises
    ------
    ValueError
        If the file is missing, truncated, or of a scene that is not known.
    """
    dataset = read_dataset(path)
    scene = _scene(path, dataset)
    own = {item.name for item in _NUMERICS}
    rows = unstacked(path, dataset, Errors, SETTING)
    errors = []
    for index, row in enumerate(rows):
        found = {name: dataset[name].values[index].item() for name in own}
        errors.append(Errors(knobs=Knobs(angles=None, **found), **row))
    adhesion, seconds = (np.asarray(dataset[item.name]) for item in _REFERENCE)
    return SceneErrors(scene, adhesion, seconds, tuple(errors))


def write_samples(
    path: Path, scene: Scene, samples: tuple[Sample, ...], origin: Provenance
) -> None:
    """Write what schedules and tiles do to the hysteresis of a scene.

    Parameters
    ----------
    path : Path
        netCDF file.
    scene : Scene
        What was simulated.
    samples : tuple of Sample
        What was measured.
    origin : Provenance
        Where it comes from.
    """
    _write(path, f"errors of averaging, {scene.name}", scene, samples, origin)


def read_samples(path: Path) -> tuple[Scene, tuple[Sample, ...]]:
    """Scene and samples that :func:`write_samples` wrote.

    Parameters
    ----------
    path : Path
        File.

    Raises
    ------
    ValueError
        If the file is missing, truncated, or of a scene that is not known.
    """
    dataset = read_dataset(path)
    rows = unstacked(path, dataset, Sample, SETTING)
    return _scene(path, dataset), tuple(Sample(**row) for row in rows)


def write_coverage(
    path: Path, scene: Scene, coverages: tuple[Coverage, ...], origin: Provenance
) -> None:
    """Write true and stated errors of a scene.

    Parameters
    ----------
    path : Path
        netCDF file.
    scene : Scene
        What was simulated.
    coverages : tuple of Coverage
        What was measured.
    origin : Provenance
        Where it comes from.
    """
    _write(path, f"true and stated errors, {scene.name}", scene, coverages, origin)


def read_coverage(path: Path) -> tuple[Scene, tuple[Coverage, ...]]:
    """Scene and errors that :func:`write_coverage` wrote.

    Parameters
    ----------
    path : Path
        File.

    Raises
    ------
    ValueError
        If the file is missing, truncated, or of a scene that is not known.
    """
    dataset = read_dataset(path)
    rows = unstacked(path, dataset, Coverage, SETTING)
    return _scene(path, dataset), tuple(Coverage(**row) for row in rows)


def _write(
    path: Path,
    title: str,
    scene: Scene,
    rows: tuple[Sample, ...] | tuple[Coverage, ...],
    origin: Provenance,
) -> None:
    """Write records of a scene, one a setting."""
    attributes = {"title": title, "scene": scene.name}
    write_dataset(path, xr.Dataset(stacked(rows, SETTING), attrs=attributes), origin)


def _scene(path: Path, dataset: xr.Dataset) -> Scene:
    """Scene that a file is about."""
    scene = SCENES.get(str(dataset.attrs.get("scene")))
    if scene is None:
        raise UnreadableFileError(f"{path} holds no errors of a known scene; measure them again")
    return scene


def laws_text(laws: Iterable[Law]) -> str:
    """Laws as the lines of `laws.csv`, five digits each."""
    text = io.StringIO()
    columns = ("shape", "elastic_energy", "knob", "direction")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*columns, "bias_0", "bias_1", "scatter_0", "scatter_1"])
    for law in laws:
        coefficients = [f"{value:.4f}" for value in (*law.bias, *law.scatter)]
        writer.writerow([*(getattr(law, name) for name in columns), *coefficients])
    return text.getvalue()
