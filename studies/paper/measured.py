"""Measured points from CSV files, whose errors name the line, and their fits.

Two kinds of file are known: forces with contact radii, and spectral densities of profiles.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from crackfront.analysis.estimate import Estimate, student_estimate
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.measured.tables.headed_table import table_of_texts
from crackfront.measured.tables.parsed_table import Table
from crackfront.surfaces.written_units import unit_value
from crackfront.sweep.section import section_error
from studies.paper.figure import Integers

if TYPE_CHECKING:
    from pandas import Series

_FEWEST_POINTS = 3
"""Points that a fit with an interval needs."""


class Quantity(NamedTuple):
    """A column of numbers: `name (unit)` in the header, of the dimension of an SI unit."""

    name: str
    unit: str
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

    A pydantic error says if the file cannot be read or lacks rows, if a column is missing or
    stands twice, or if a unit or a value is missing or not understood.
    """
    try:
        table = table_of_texts(path)
        numbers = [_si_values(table, quantity) for quantity in quantities]
        texts = [_column(table, name).to_numpy(dtype=str) for name in words]
    except OSError as error:
        raise section_error(f"{path} cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise section_error(str(error)) from error
    if not table.lines:
        raise section_error(f"{path} has a header but lacks rows; add the points")
    return MeasuredTable(np.array(table.lines), np.array(numbers), np.array(texts, dtype=str))


def _place(table: Table, name: str) -> int:
    """Place of the column of a name; a ValueError if it is missing or stands twice."""
    names = [heading.name for heading in table.headings]
    if names.count(name) != 1:
        problem = "stands twice; remove one" if name in names else "is missing"
        raise ValueError(
            f"{table.path}: column {name} {problem}; the header has {', '.join(names)}"
        )
    return names.index(name)


def _column(table: Table, name: str) -> Series:
    """Texts of a column."""
    return table.cells[_place(table, name)].str.strip()


def _si_values(table: Table, quantity: Quantity) -> Array:
    """Numbers of a column in SI units; a ValueError if one is not finite or not positive."""
    name, place = quantity.name, _place(table, quantity.name)
    unit = table.headings[place].unit
    if not unit:
        raise ValueError(f"{table.path}: {name} lacks a unit; write {name} ({quantity.unit})")
    (values,) = table.numbers([place])
    is_wrong = ~np.isfinite(values) | (quantity.positive & (values <= 0))
    for row in np.flatnonzero(is_wrong):
        text, must = _column(table, name)[row], "positive" if quantity.positive else "finite"
        raise ValueError(
            f"{table.path}, line {table.lines[row]}: {name} is {text!r}; it must be a {must} number"
        )
    return values * unit_value(unit, quantity.unit)


_BRANCHES = {"approach": 1, "retraction": -1}

_FORCE = Quantity("force", "N")
_RADIUS = Quantity("radius", "m", positive=True)


class ForceRadius(NamedTuple):
    """Forces (N), contact radii (m), and +1 in approach, -1 in retraction, of (n_point,) each."""

    force: Array
    radius: Array
    direction: Integers


def read_force_radius(path: Path | None) -> ForceRadius:
    """Points from a CSV file with the columns force (mN), radius (um) and branch, as measured.

    The units are any of force and length; the branch is approach or retraction. Without a file
    there are no points. Other branches are errors, and so is an approach after a
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


_WAVEVECTOR = Quantity("q", "1/m", positive=True)
_DENSITY = Quantity("C1D", "m^3", positive=True)


class ProfileDensity(NamedTuple):
    """Increasing wavevectors (1 / m) and C_1D (m^3) of profiles, of (n_point,) each."""

    wavevector: Array
    density: Array


def read_profile_density(path: Path | None) -> ProfileDensity:
    """Profile density from a CSV file with the columns q (1/m) and C1D (m^3).

    The units are any of the same dimensions. The mean square height is the integral
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
