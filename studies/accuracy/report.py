"""Measured errors as a person reads them, in tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np

from crackfront.core.arrays import Array
from studies.accuracy.averages import Coverage, Sample
from studies.accuracy.files import read_errors, read_study
from studies.accuracy.scenes import SCENES, Scene
from studies.accuracy.study import Errors, SceneErrors, pareto_front, rms
from studies.numbers import Number
from studies.tables import Table, make_table

Content = TypeVar("Content")

_TARGETS = (0.1, 0.03, 0.01, 0.003)
"""Relative errors of the hysteresis whose cheapest settings the report names."""


DETAILED_SCENES = ("chemical-0.0025", "chemical-0.04", "flat-0.16", "h03-0.04")
"""Scenes whose errors of all settings are kept for the pages."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Contents of a folder: every study by the names of its scenes."""

    settings: dict[str, SceneErrors]
    requested: dict[str, SceneErrors]
    unseen: dict[str, SceneErrors]
    expected: dict[str, SceneErrors]
    samples: dict[str, tuple[Scene, tuple[Sample, ...]]]
    coverages: dict[str, tuple[Scene, tuple[Coverage, ...]]]

    @property
    def scenes(self) -> dict[str, SceneErrors]:
        """Errors of single settings and of requests, by the names of their scenes."""
        errors_by_scene = self.settings | self.requested
        studies = {name: errors_by_scene[name] for name in SCENES if name in errors_by_scene}
        for name in self.settings.keys() & self.requested.keys():
            errors = self.settings[name].errors + self.requested[name].errors
            studies[name] = replace(self.settings[name], errors=errors)
        return studies

    @property
    def fitted(self) -> list[SceneErrors]:
        """Those to which laws are fitted."""
        return [study for study in self.settings.values() if study.scene.varies_single]


def measured(folder: Path) -> Measured:
    """All studies in a folder; ValueError if it is without any."""
    single, requested, unseen, expected = (
        _stored(folder, study, read_errors)
        for study in ("settings", "requested", "unseen", "expected")
    )
    samples = _stored(folder, "averages", lambda path: read_study(path, Sample))
    coverages = _stored(folder, "coverage", lambda path: read_study(path, Coverage))
    if not (single or requested or unseen or expected or samples or coverages):
        raise ValueError(f"{folder} contains no errors; run python -m studies accuracy scene")
    return Measured(single, requested, unseen, expected, samples, coverages)


def error_tables(study_errors: Measured) -> dict[str, Table]:
    """Tables of all studies by their names."""
    tables, scenes = {}, study_errors.scenes
    if scenes:
        tables["Time to an error of the hysteresis"] = _target_table(scenes.values())
    if study_errors.requested:
        tables["Errors that were requested"] = _request_table(study_errors.requested.values())
    if study_errors.unseen:
        tables["Errors on unseen surfaces"] = _request_table(study_errors.unseen.values())
    if study_errors.expected:
        tables["Errors on many surfaces"] = _request_table(study_errors.expected.values())
    if study_errors.coverages:
        tables["Stated and true errors"] = _coverage_table(study_errors.coverages.values())
    sampled = study_errors.samples.values()
    tables |= {f"Averages, {scene.name}": _sample_table(samples) for scene, samples in sampled}
    tables |= {f"Settings, {name}": _setting_table(study) for name, study in scenes.items()}
    return tables


def compared_numbers(study_errors: Measured) -> dict[str, Number]:
    """How much faster an error is reached than by the authors' code, where that is known."""
    numbers = {}
    for study in study_errors.scenes.values():
        if study.scene.authors_seconds is None:
            continue
        seconds, error = study.work_and_precision()
        for target in _TARGETS:
            best = _cheapest(seconds, error, target)
            if best is not None:
                name = f"times faster than the authors, {study.scene.name}, {100 * target:g}%"
                numbers[name] = Number(float(study.scene.authors_seconds / seconds[best]))
    return numbers


def _stored(folder: Path, study: str, read: Callable[[Path], Content]) -> dict[str, Content]:
    """Files of a study in a folder, read, by the names of its scenes."""
    paths = {name: folder / f"{study}-{name}.nc" for name in SCENES}
    return {name: read(path) for name, path in paths.items() if path.exists()}


_NUMERICS = "sites | samples | interpolation | pixels | tolerance"


def _numerics(errors: Errors) -> list[str]:
    """Entries of :data:`_NUMERICS`."""
    return [
        f"{errors.angles_per_cutoff:g}",
        f"{errors.samples_per_cutoff:g}",
        errors.interpolation,
        f"{errors.pixels_per_cutoff:g}",
        f"{errors.tolerance:g}",
    ]


_FACTOR_ERRORS = "rms error of k of w_appr | rms error of k of w_retr"


def _factor_errors(study: SceneErrors, errors: Errors) -> list[str]:
    """Entries of :data:`_FACTOR_ERRORS`."""
    return [f"{rms(column) / study.scene.elastic_energy:.2g}" for column in errors.adhesion.T]


def _cheapest(seconds: Array, error: Array, target: float) -> int | None:
    """Index of the fastest setting with a small enough error; None if there is none."""
    enough = np.flatnonzero(error <= target)
    return int(enough[np.argmin(seconds[enough])]) if enough.size else None


def _target_table(studies: Iterable[SceneErrors]) -> Table:
    """Seconds of the cheapest setting for every error; empty where no setting reaches it."""
    rows = []
    for study in studies:
        seconds, error = study.work_and_precision()
        for target in _TARGETS:
            best = _cheapest(seconds, error, target)
            reached = ["", "", ""]
            if best is not None:
                reached = [f"{seconds[best]:.3g}", f"{100 * error[best]:.2g}", ""]
                if study.scene.authors_seconds is not None:
                    reached[2] = f"{study.scene.authors_seconds / seconds[best]:.0f}"
            asked = f"{100 * target:g}"
            rows.append([study.scene.name, f"{study.hysteresis:.4g}", asked, *reached])
    return make_table(
        "scene | hysteresis | error asked for % | CPU s | error % | times faster than the authors",
        rows,
    )


_CHOSEN = f"scene | requested | {_NUMERICS} | CPU s"


def _chosen(study: SceneErrors, errors: Errors) -> list[str]:
    """Entries of :data:`_CHOSEN`, of numerics that the laws chose."""
    seconds = f"{errors.seconds.mean():.3g}"
    return [study.scene.name, f"{errors.value:g}", *_numerics(errors), seconds]


def _request_table(studies: Iterable[SceneErrors]) -> Table:
    """Errors of k where the laws chose the numerics, of each row and of all."""
    rows = []
    pooled: dict[float, list[Array]] = {}
    for study in studies:
        for errors in study.errors:
            factor_errors = errors.adhesion / study.scene.elastic_energy
            pooled.setdefault(errors.value, []).append(factor_errors)
            rows.append([*_chosen(study, errors), *_error_sizes(factor_errors, errors.value)])
    for requested, parts in pooled.items():
        sizes = _error_sizes(np.concatenate(parts), requested)
        rows.append(["all", f"{requested:g}", *[""] * 6, *sizes])
    return make_table(
        f"{_CHOSEN} | {_FACTOR_ERRORS} | bias of k of w_appr | bias of k of w_retr "
        "| largest error of one surface | median error | above the request % | rms of the others",
        rows,
    )


def _error_sizes(factor_errors: Array, requested: float) -> list[str]:
    """Sizes of errors of k, (realisation, branch), as a table shows them.

    Few are above the request, by an avalanche that one discretisation has and another has not.
    """
    is_above = np.abs(factor_errors) > requested
    return [
        *(f"{rms(column):.2g}" for column in factor_errors.T),
        *(f"{bias:+.2g}" for bias in factor_errors.mean(axis=0)),
        f"{np.abs(factor_errors).max():.2g}",
        f"{np.median(np.abs(factor_errors)):.2g}",
        f"{100 * np.mean(is_above):.1f}",
        f"{rms(factor_errors[~is_above]):.2g}",
    ]


def _coverage_table(coverages: Iterable[tuple[Scene, tuple[Coverage, ...]]]) -> Table:
    """How often intervals of the stated errors cover the true ones, and how wide they are."""
    rows, numerical_ratios, total_ratios = [], [], []
    for scene, scene_coverages in coverages:
        for item in scene_coverages:
            numerical = _covered(item.numerical, item.numerical_interval)
            total = _covered(item.total, item.total_interval)
            numerical_ratios.append(numerical.ratio)
            total_ratios.append(total.ratio)
            rows.append(
                [
                    scene.name,
                    f"{item.requested:g}",
                    f"{rms(item.numerical) / scene.elastic_energy:.2g}",
                    *_covered_cells(numerical, scene.elastic_energy),
                    *_covered_cells(total, scene.elastic_energy),
                    "",
                    "",
                ]
            )
    alone, both = _pooled(numerical_ratios), _pooled(total_ratios)
    rows.append(["all", *[""] * 4, alone.covered, "", "", both.covered, alone.width, both.width])
    return make_table(
        "scene | requested | numerical rms error | numerical median error | numerical interval "
        "| numerical covered % | total median error | total interval | total covered % "
        "| numerical interval over the median error | total interval over the median error",
        rows,
    )


class _Covered(NamedTuple):
    """Magnitudes of true errors, and half widths of their intervals."""

    error: Array
    interval: Array

    @property
    def ratio(self) -> Array:
        """True errors over their intervals, at most 1 if they are covered."""
        return self.error / self.interval


def _covered(true: Array, interval: Array) -> _Covered:
    """Errors that have an interval: a run without a steady part is part of every truth."""
    is_finite = np.isfinite(interval) & np.isfinite(true)
    return _Covered(np.abs(true[is_finite]), interval[is_finite])


def _covered_cells(covered: _Covered, elastic_energy: float) -> list[str]:
    """Median error and interval of k, and the share that is covered; empty without any."""
    if not covered.error.size:
        return ["", "", ""]
    return [
        f"{np.median(covered.error) / elastic_energy:.2g}",
        f"{np.median(covered.interval) / elastic_energy:.2g}",
        f"{100 * np.mean(covered.ratio <= 1):.0f}",
    ]


class _Pooled(NamedTuple):
    """Cells of all errors together."""

    width: str
    """Intervals in median errors."""
    covered: str
    """Share of the errors that is covered, in per cent."""


def _pooled(ratios: list[Array]) -> _Pooled:
    """Cells of the ratios of errors to intervals of all scenes."""
    ratio = np.concatenate(ratios)
    return _Pooled(f"{1 / np.median(ratio):.1f}", f"{100 * np.mean(ratio <= 1):.1f}")


def _setting_table(study: SceneErrors) -> Table:
    """Errors of all settings of a scene, and which of them are on the Pareto front."""
    seconds, error = study.work_and_precision()
    best = pareto_front(seconds, error)
    rows = [["reference", *[""] * 6, f"{study.reference_seconds.mean():.3g}", *[""] * 8]]
    for index, errors in enumerate(study.errors):
        values = study.hysteresis_errors(errors)
        spread = np.std(values, ddof=1) / np.sqrt(values.size)
        rows.append(
            [
                f"{errors.setting} {errors.value:g}" if errors.value else errors.setting,
                "yes" if index in best else "no",
                *_numerics(errors),
                f"{seconds[index]:.3g}",
                f"{100 * values.mean():+.2f}",
                f"{100 * spread:.2f}",
                f"{100 * error[index]:.2f}",
                *_factor_errors(study, errors),
                f"{rms(errors.force):.1g}",
                f"{rms(errors.front_rms):.2g}",
                f"{np.max(errors.front_max):.2g}",
            ]
        )
    return make_table(
        f"varied | on the Pareto front | {_NUMERICS} | CPU s | bias of the hysteresis % "
        f"| error of the bias % | rms error of the hysteresis % | {_FACTOR_ERRORS} "
        "| error of the force | front rms | front max",
        rows,
    )


def _sample_table(samples: tuple[Sample, ...]) -> Table:
    """Hysteresis for schedules and tiles; differences from the first on the same surfaces."""
    rows = []
    for sample in samples:
        values, setting = sample.hysteresis, f"{sample.setting} {sample.value:g}"
        if not np.all(np.isfinite(values)):
            rows.append([setting, *[""] * 7])
            continue
        error = np.std(values, ddof=1)
        difference = values - samples[0].hysteresis
        compared = [f"{difference.mean():+.5f}", f"{rms(difference):.5f}"]
        rows.append(
            [
                setting,
                f"{sample.seconds.mean():.3g}",
                f"{values.mean():.5f}",
                f"{error / np.sqrt(values.size):.5f}",
                f"{error:.5f}",
                f"{rms(sample.standard_error):.5f}",
                *(["", ""] if sample.setting == "tile" else compared),
            ]
        )
    return make_table(
        "varied | CPU s | mean hysteresis | mean hysteresis error | rms of one realisation "
        "| rms stated by the runs | mean difference from the first | rms difference from the first",
        rows,
        "A row without numbers has too few states.",
    )
