"""The files of measured numerical errors, and of the laws fitted to them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.accuracy import SCENES, Coverage, Errors, Sample, Scene, SceneErrors
from crackfront.dataset.files import UnreadableFileError, labelled, read_dataset, write_dataset
from crackfront.dataset.schema import REALISATION
from crackfront.laws import Law
from crackfront.provenance import Provenance
from crackfront.records import ADHESION, FORCE, Variable
from crackfront.scene import Numerics

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
_run, _branch = (SETTING, REALISATION), (SETTING, REALISATION, BRANCH)
_ERRORS = (
    Variable("seconds", _run, "s", "processor time of both branches, synthesis included"),
    Variable("adhesion", _branch, ADHESION, "error of w_appr and w_retr"),
    Variable("state", _branch, ADHESION, "rms error of one state's apparent work of adhesion"),
    Variable("force", _run, FORCE, "rms error of the normal force"),
    Variable("front_rms", _run, "short cutoff", "rms error of the radius over sites and states"),
    Variable("front_max", _run, "short cutoff", "largest error of the radius"),
)
_SAMPLES = (
    Variable("knob", _setting, "1", "what is varied: travel, step or tile"),
    Variable("value", _setting, "1", "correlation lengths, reduced vertical length, cutoffs"),
    Variable("hysteresis", _run, ADHESION, "w_retr - w_appr"),
    Variable("standard_error", _run, ADHESION, "that which a run states for its hysteresis"),
    Variable("seconds", _run, "s", "processor time"),
)
_COVERAGE = (
    Variable("asked", _setting, "e_el", "standard error that was asked for"),
    Variable("numerical", _branch, ADHESION, "numerical error of w_appr and w_retr"),
    Variable("numerical_stated", (SETTING, BRANCH), ADHESION, "stated numerical standard error"),
    Variable("total", _branch, ADHESION, "error of a steady run against the mean of the others"),
    Variable("run_numerical", _branch, ADHESION, "numerical standard error that the run states"),
    Variable("run_statistical", _branch, ADHESION, "statistical one"),
    Variable("n_state", _branch, "1", "its steady states"),
    Variable("truth_error", _branch, ADHESION, "standard error of the mean of the others"),
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
    errors = study.errors
    values = {
        item.name: labelled(item, np.array([getattr(one.numerics, item.name) for one in errors]))
        for item in _NUMERICS
    }
    values |= {
        item.name: labelled(item, np.array([getattr(one, item.name) for one in errors]))
        for item in _ERRORS
    }
    references = zip(_REFERENCE, (study.adhesion, study.seconds), strict=True)
    values |= {item.name: labelled(item, value) for item, value in references}
    knobs = Variable("knob", _setting, "1", "what is varied")
    amounts = Variable("value", _setting, "1", "its value; of asked the error of k")
    branches = Variable(BRANCH, (BRANCH,), "1", "approach or retraction")
    coordinates = {
        "knob": labelled(knobs, np.array([one.knob for one in errors])),
        "value": labelled(amounts, np.array([one.value for one in errors])),
        BRANCH: labelled(branches, np.array(["approach", "retraction"])),
    }
    scene = study.scene
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
    kept = {
        item.name: getattr(scene.reference, item.name)
        for item in fields(Numerics)
        if item.name not in own
    }
    errors = []
    for index in range(dataset.sizes[SETTING]):
        row = dataset.isel({SETTING: index})
        numerics = Numerics(**kept, **{name: row[name].values.item() for name in own})
        columns = {item.name: np.asarray(row[item.name]) for item in _ERRORS}
        knob, value = str(row["knob"].values), float(row["value"])
        errors.append(Errors(knob=knob, value=value, numerics=numerics, **columns))
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
    values = {
        item.name: labelled(item, np.array([getattr(one, item.name) for one in samples]))
        for item in _SAMPLES
    }
    attributes = {"title": f"errors of averaging, {scene.name}", "scene": scene.name}
    write_dataset(path, xr.Dataset(values, attrs=attributes), origin)


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
    samples = []
    for index in range(dataset.sizes[SETTING]):
        row = dataset.isel({SETTING: index})
        columns = [np.asarray(row[item.name]) for item in _SAMPLES[2:]]
        samples.append(Sample(str(row["knob"].values), float(row["value"]), *columns))
    return _scene(path, dataset), tuple(samples)


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
    values = {
        item.name: labelled(item, np.array([getattr(one, item.name) for one in coverages]))
        for item in _COVERAGE
    }
    attributes = {"title": f"true and stated errors, {scene.name}", "scene": scene.name}
    write_dataset(path, xr.Dataset(values, attrs=attributes), origin)


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
    coverages = []
    for index in range(dataset.sizes[SETTING]):
        row = dataset.isel({SETTING: index})
        columns = [np.asarray(row[item.name]) for item in _COVERAGE[1:]]
        coverages.append(Coverage(float(row["asked"]), *columns))
    return _scene(path, dataset), tuple(coverages)


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
