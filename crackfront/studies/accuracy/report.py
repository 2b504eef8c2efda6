"""Measured errors as a person reads them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from crackfront.studies.accuracy.coverage import Coverage, numerical_interval, total_interval
from crackfront.studies.accuracy.sampling import Sample
from crackfront.studies.accuracy.scenes import Scene
from crackfront.studies.accuracy.study import Errors, SceneErrors

Array = NDArray[np.float64]

_TABLE = re.compile(r"<!-- table: (?P<name>.*?) -->.*?<!-- end -->", re.DOTALL)

TARGETS = (0.1, 0.03, 0.01, 0.003)
"""Relative errors of the hysteresis whose cheapest settings the report names."""


def hysteresis_errors(study: SceneErrors, errors: Errors) -> Array:
    """Relative errors of the hysteresis of all realisations.

    Parameters
    ----------
    study : SceneErrors
        A scene.
    errors : Errors
        One of its settings.

    Returns
    -------
    (n_realisation,) array
        Error over the mean hysteresis of the reference.
    """
    mean = np.mean(study.adhesion[:, 1] - study.adhesion[:, 0])
    return (errors.adhesion[:, 1] - errors.adhesion[:, 0]) / mean


def pareto_front(seconds: Array, error: Array) -> NDArray[np.intp]:
    """Settings that no other one beats in time and in error, the fastest first.

    Parameters
    ----------
    seconds, error : (n_setting,) array
        Cost and error.

    Returns
    -------
    (n_front,) int array
        Their positions.
    """
    order = np.lexsort((error, seconds))
    best = np.minimum.accumulate(error[order])
    first = np.concatenate([[True], error[order][1:] < best[:-1]])
    return order[first]


def accuracy_tables(
    studies: Sequence[SceneErrors],
    samples: Iterable[tuple[Scene, tuple[Sample, ...]]],
    coverages: Sequence[tuple[Scene, tuple[Coverage, ...]]],
) -> dict[str, str]:
    """Markdown tables of all scenes, by their names.

    Parameters
    ----------
    studies : sequence of SceneErrors
        Numerical errors.
    samples : iterable
        Scenes with what schedules and tiles do to their hysteresis.
    coverages : sequence
        Scenes with their true and stated errors.

    Returns
    -------
    dict of str
        Their names are the headings of the report.
    """
    tables = {
        "Time to an error of the hysteresis": _target_rows(studies),
        "Errors that were asked for": _asked_rows(studies),
    }
    if coverages:
        tables["Stated and true errors"] = _coverage_rows(coverages)
    tables |= {f"Averages, {scene.name}": _sample_rows(found) for scene, found in samples}
    tables |= {f"Settings, {study.scene.name}": _setting_rows(study) for study in studies}
    return {name: "\n".join(rows) for name, rows in tables.items()}


def accuracy_report(tables: Mapping[str, str]) -> str:
    """A page of all tables.

    Parameters
    ----------
    tables : mapping of str
        Tables by their names.
    """
    parts = [f"## {name}\n\n{table}\n" for name, table in tables.items()]
    return "\n".join(["# Measured errors\n", *parts])


def filled_page(page: str, tables: Mapping[str, str]) -> str:
    r"""A page with its tables written anew.

    Parameters
    ----------
    page : str
        Markdown; each table stands between `<!-- table: NAME -->` and `<!-- end -->`.
    tables : mapping of str
        Tables by their names.

    Raises
    ------
    ValueError
        If a table of the page was not measured.

    Examples
    --------
    >>> filled_page("<!-- table: a --><!-- end -->", {"a": "| 1 |"}).split("\n\n")
    ['<!-- table: a -->', '| 1 |', '<!-- end -->']
    """

    def filled(found: re.Match[str]) -> str:
        name = found["name"]
        if name not in tables:
            raise ValueError(
                f"the page asks for the table {name!r}, which was not measured; there are "
                f"{', '.join(tables)}"
            )
        return f"<!-- table: {name} -->\n\n{tables[name]}\n\n<!-- end -->"

    return _TABLE.sub(filled, page)


def _rms(values: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _numbers(errors: Errors) -> str:
    """All numerics in a few words."""
    n = errors.knobs
    return (
        f"{n.angles_per_cutoff:g} sites, {n.samples_per_cutoff:g} {n.interpolation}, "
        f"{n.pixels_per_cutoff:g} pixels, {n.tolerance:g}"
    )


def _markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a table."""
    for row in (header, ["---"] * len(header), *rows):
        yield "| " + " | ".join(row) + " |"


def _target_rows(studies: Sequence[SceneErrors]) -> Iterator[str]:
    """Seconds of the cheapest setting for every error."""
    header = ["scene", "hysteresis", *(f"{100 * target:g}%" for target in TARGETS)]
    rows = []
    for study in studies:
        seconds = np.array([errors.seconds.mean() for errors in study.errors])
        error = np.array([_rms(hysteresis_errors(study, errors)) for errors in study.errors])
        entries = []
        for target in TARGETS:
            enough = np.flatnonzero(error <= target)
            if enough.size == 0:
                entries.append("-")
                continue
            best = enough[np.argmin(seconds[enough])]
            entry = f"{seconds[best]:.3g} s ({100 * error[best]:.2g}%)"
            if study.scene.authors_seconds is not None:
                entry += f", {study.scene.authors_seconds / seconds[best]:.0f} times"
            entries.append(entry)
        mean = np.mean(study.adhesion[:, 1] - study.adhesion[:, 0])
        rows.append([study.scene.name, f"{mean:.4g}", *entries])
    return _markdown(header, rows)


def _asked_rows(studies: Sequence[SceneErrors]) -> Iterator[str]:
    """Measured errors of k where the laws chose the numerics."""
    header = ["scene", "asked for", "numerics", "CPU s", "k of w_appr", "k of w_retr"]
    rows = [
        [
            study.scene.name,
            f"{errors.value:g}",
            _numbers(errors),
            f"{errors.seconds.mean():.3g}",
            *(f"{_rms(column) / study.scene.elastic_energy:.2g}" for column in errors.adhesion.T),
        ]
        for study in studies
        for errors in study.errors
        if errors.knob == "asked"
    ]
    return _markdown(header, rows)


def _coverage_rows(coverages: Sequence[tuple[Scene, tuple[Coverage, ...]]]) -> Iterator[str]:
    """How often intervals of the stated errors cover the true ones, and how wide they are."""
    header = [
        "scene",
        "asked for",
        "numerical: rms",
        "median",
        "interval",
        "covered",
        "total: median",
        "interval",
        "covered",
    ]
    rows = []
    pooled: tuple[list[Array], list[Array]] = [], []
    for scene, found in coverages:
        for item in found:
            parts = (
                (item.numerical, numerical_interval(item)),
                (item.total, total_interval(item)),
            )
            entries = [f"{_rms(item.numerical) / scene.elastic_energy:.2g}"]
            for (true, interval), every in zip(parts, pooled, strict=True):
                known = np.isfinite(interval) & np.isfinite(true)
                error = np.abs(true[known])
                every.append(error / interval[known])
                entries += [
                    f"{np.median(error) / scene.elastic_energy:.2g}",
                    f"{np.median(interval[known]) / scene.elastic_energy:.2g}",
                    f"{100 * np.mean(every[-1] <= 1):.0f}%",
                ]
            rows.append([scene.name, f"{item.asked:g}", *entries])
    ends = []
    for every in pooled:
        relative = np.concatenate(every)
        ends += [
            "",
            f"{1 / np.median(relative):.1f} times the median",
            f"{100 * np.mean(relative <= 1):.1f}%",
        ]
    rows.append(["**all**", "", "", *ends])
    return _markdown(header, rows)


def _setting_rows(study: SceneErrors) -> Iterator[str]:
    """Errors of all settings of a scene; those on the Pareto front in bold."""
    header = [
        "varied",
        "numerics",
        "CPU s",
        "hysteresis: bias %",
        "rms %",
        "k of w_appr",
        "k of w_retr",
        "force",
        "front rms",
        "front max",
    ]
    seconds = np.array([errors.seconds.mean() for errors in study.errors])
    relative = [hysteresis_errors(study, errors) for errors in study.errors]
    best = pareto_front(seconds, np.array([_rms(values) for values in relative]))
    rows = [["", "reference", f"{study.seconds.mean():.3g}", *[""] * 7]]
    for index, (errors, values) in enumerate(zip(study.errors, relative, strict=True)):
        spread = np.std(values, ddof=1) / np.sqrt(values.size)
        name = f"{errors.knob} {errors.value:g}" if errors.value else errors.knob
        rows.append(
            [
                f"**{name}**" if index in best else name,
                _numbers(errors),
                f"{seconds[index]:.3g}",
                f"{100 * values.mean():+.2f} ± {100 * spread:.2f}",
                f"{100 * _rms(values):.2f}",
                *(f"{_rms(x) / study.scene.elastic_energy:.2g}" for x in errors.adhesion.T),
                f"{_rms(errors.force):.1g}",
                f"{_rms(errors.front_rms):.2g}",
                f"{np.max(errors.front_max):.2g}",
            ]
        )
    return _markdown(header, rows)


def _sample_rows(samples: tuple[Sample, ...]) -> Iterator[str]:
    """Hysteresis for schedules and tiles; differences from the first on the same surfaces."""
    header = [
        "varied",
        "CPU s",
        "mean hysteresis",
        "one realisation, rms",
        "stated by the runs, rms",
        "against the first, mean",
        "rms",
    ]
    rows = []
    for sample in samples:
        if not np.all(np.isfinite(sample.hysteresis)):
            rows.append([f"{sample.knob} {sample.value:g}", "too few states", *[""] * 5])
            continue
        values = sample.hysteresis
        error = np.std(values, ddof=1)
        difference = values - samples[0].hysteresis
        compared = [f"{difference.mean():+.5f}", f"{_rms(difference):.5f}"]
        rows.append(
            [
                f"{sample.knob} {sample.value:g}",
                f"{sample.seconds.mean():.3g}",
                f"{values.mean():.5f} ± {error / np.sqrt(values.size):.5f}",
                f"{error:.5f}",
                f"{_rms(sample.standard_error):.5f}",
                *(["", ""] if sample.knob == "tile" else compared),
            ]
        )
    return _markdown(header, rows)
