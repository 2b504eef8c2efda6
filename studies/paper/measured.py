"""Measured points from CSV files, whose errors name the line, and their fits.

Two kinds of file are known: forces with contact radii, and spectral densities of profiles.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from crackfront.analysis.estimate import Estimate, student_estimate
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.sweep.section import section_error
from studies.paper.figure import Integers

_FEWEST_POINTS = 3
"""Points that a fit with an interval needs."""


class Quantity(NamedTuple):
    """A column of numbers: `name (unit)` in the header, with units that lead to SI by a factor."""

    name: str
    units: Mapping[str, float]
    positive: bool = False


class MeasuredTable(NamedTuple):
    """Rows of a file: their lines, (n_row,), and a row for each column, in SI units."""

    lines: Integers
    numbers: Array
    words: NDArray[np.str_]


def read_measured(
    path: Path, quantities: Sequence[Quantity], words: Sequence[str] = ()
) -> MeasuredTable:
    """Columns of a CSV file, without empty lines, comments (#) and other columns.

    A pydantic error says if the file cannot be read or has no rows, if a column is missing or
    stands twice, or if a unit or a value is missing or not understood.
    """
    rows = _rows(path)
    top, header = f"{path}, line {rows[0][0]}", [_name_and_unit(title) for title in rows[0][1]]
    names = [name for name, _ in header]
    for name in (*(item.name for item in quantities), *words):
        if names.count(name) != 1:
            problem = "stands twice; remove one" if name in names else "is missing"
            raise section_error(
                f"{top}: column {name} {problem}; the header has {', '.join(names)}"
            )
    units = dict(header)
    for name, allowed, _ in quantities:
        if (unit := units[name]) not in allowed:
            problem = f"is in {unit}" if unit else "lacks a unit"
            raise section_error(
                f"{top}: {name} {problem}; write {name} (unit) with one of {', '.join(allowed)}"
            )
    if len(rows) == 1:
        raise section_error(f"{path} has a header but no rows; add the points")
    lines, numbers, texts = [], [], []
    for line, row in rows[1:]:
        where = f"{path}, line {line}"
        if len(row) != len(header):
            raise section_error(
                f"{where} has {len(row)} values for {len(header)} columns; complete it"
            )
        texts_by_name = dict(zip(names, row, strict=True))
        numbers.append(
            [
                _number(where, texts_by_name[item.name], item, units[item.name])
                for item in quantities
            ]
        )
        texts.append([texts_by_name[name].strip() for name in words])
        lines.append(line)
    return MeasuredTable(np.array(lines), np.array(numbers).T, np.array(texts, dtype=str).T)


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Header and rows of a file with the numbers of their lines."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise section_error(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise section_error(f"{path} is not UTF-8 text; save it as UTF-8") from error
    lines = ("" if line.lstrip().startswith("#") else line for line in text.splitlines())
    reader = csv.reader(lines, strict=True)
    try:
        rows = [(reader.line_num, row) for row in reader if any(row)]
    except csv.Error as error:
        raise section_error(f"{path}, line {reader.line_num}: {error}") from error
    if not rows:
        raise section_error(f"{path} is empty; it needs a header and rows")
    return rows


def _name_and_unit(title: str) -> tuple[str, str]:
    """Name and unit of a column, `name (unit)` or a name alone."""
    name, _, unit = title.partition("(")
    return name.strip(), unit.strip().removesuffix(")")


def _number(where: str, text: str, item: Quantity, unit: str) -> float:
    """A finite number in SI units."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or (item.positive and value <= 0):
        must = "a positive number" if item.positive else "a finite number"
        raise section_error(f"{where}: {item.name} is {text.strip()!r}; it must be {must}")
    return value * item.units[unit]


_BRANCHES = {"approach": 1, "retraction": -1}

_FORCE = Quantity("force", {"N": 1.0, "mN": 1e-3, "uN": 1e-6})
_RADIUS = Quantity("radius", {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}, positive=True)


class ForceRadius(NamedTuple):
    """Forces (N), contact radii (m), and +1 in approach, -1 in retraction, of (n_point,) each."""

    force: Array
    radius: Array
    direction: Integers


def read_force_radius(path: Path | None) -> ForceRadius:
    """Points from a CSV file with the columns force (mN), radius (um) and branch, as measured.

    The units are N, mN or uN, and m, mm, um or nm; the branch is approach or retraction. Without a
    file there are no points. Other branches are errors, and so is an approach after a
    retraction, of less than three points, or whose force does not grow.
    """
    if path is None:
        return ForceRadius(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))
    lines, (force, radius), (branches,) = read_measured(path, (_FORCE, _RADIUS), words=("branch",))
    for line, name in zip(lines, branches, strict=True):
        if name not in _BRANCHES:
            raise section_error(
                f"{path}, line {line}: branch is {str(name)!r}; it must be {' or '.join(_BRANCHES)}"
            )
    direction = np.array([_BRANCHES[name] for name in branches])
    back = np.flatnonzero(np.diff(direction) > 0)
    if back.size:
        raise section_error(
            f"{path}, line {lines[back[0] + 1]}: an approach follows the retraction; the "
            "rows must be one approach and then its retraction"
        )
    approach = force[direction > 0]
    end = f"{path}, line {lines[max(approach.size - 1, 0)]}: the approach"
    if approach.size < _FEWEST_POINTS:
        raise section_error(f"{end} has {approach.size} points; the fit needs {_FEWEST_POINTS}")
    if approach[-1] <= approach[0]:
        raise section_error(
            f"{end} ends at {approach[-1]:g} N and begins at {approach[0]:g} N; its force must "
            "grow, so put the rows in the order of measurement"
        )
    return ForceRadius(force, radius, direction)


_WAVEVECTOR = Quantity("q", {"1/m": 1.0, "1/um": 1e6, "1/nm": 1e9}, positive=True)
_DENSITY = Quantity("C1D", {"m^3": 1.0, "um^3": 1e-18, "nm^3": 1e-27}, positive=True)


class ProfileDensity(NamedTuple):
    """Increasing wavevectors (1 / m) and C_1D (m^3) of profiles, of (n_point,) each."""

    wavevector: Array
    density: Array


def read_profile_density(path: Path | None) -> ProfileDensity:
    """Profile density from a CSV file with the columns q (1/m) and C1D (m^3).

    The units are 1/m, 1/um or 1/nm, and m^3, um^3 or nm^3. The mean square height is the integral
    of C1D over q > 0, divided by pi. Without a file there are no points. A single row
    is an error, and so are wavevectors that do not increase.
    """
    if path is None:
        return ProfileDensity(np.empty(0), np.empty(0))
    lines, (wavevector, density), _ = read_measured(path, (_WAVEVECTOR, _DENSITY))
    wrong = np.flatnonzero(np.diff(wavevector) <= 0)
    if wrong.size:
        before, current = wavevector[wrong[0] : wrong[0] + 2]
        raise section_error(
            f"{path}, line {lines[wrong[0] + 1]}: q is {current:g} 1/m after {before:g} 1/m; "
            "wavevectors must increase"
        )
    if wavevector.size < 2:
        raise section_error(f"{path}, line {lines[0]} is the only row; a density needs two or more")
    return ProfileDensity(wavevector, density)


def adhesion_from_forces(radius: Array, force: Array) -> Estimate:
    """Work of adhesion (w_int) of the JKR curve that goes best through forces at radii.

    Least squares; the errors of the forces (pi w_int R) count as equal and independent. A
    ValueError says if there are less than three points.
    """
    if radius.size < _FEWEST_POINTS:
        raise ValueError(
            f"{radius.size} points are too few for a work of adhesion with its interval; give "
            f"{_FEWEST_POINTS} or more"
        )
    solution, covariance = curve_fit(
        jkr.equilibrium_force, radius, force, p0=[1.0], bounds=(0.0, np.inf), xtol=1e-14, ftol=1e-14
    )
    return student_estimate(solution[0], np.sqrt(covariance[0, 0]), radius.size - 1)


def fitted_adhesion(
    points: ForceRadius, scales: Scales, elastic_energy: float, factor: float
) -> Array:
    """Intrinsic work of adhesion of an approach, w_int = w_appr + (1 + k) e_el (J / m^2).

    The JKR curve of w_appr is fitted; e_el (J / m^2) does not depend on w_int. After the value come
    the ends of the interval that the scatter of the points leaves; all are NaN without points.
    """
    if points.force.size == 0:
        return np.full(3, np.nan)
    approach = points.direction > 0
    fit = adhesion_from_forces(
        points.radius[approach] / scales.lateral, points.force[approach] / scales.force
    )
    shift = (1 + factor) * elastic_energy
    return np.array([fit.value, fit.low, fit.high]) * scales.work_of_adhesion + shift
