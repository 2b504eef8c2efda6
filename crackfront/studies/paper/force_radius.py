"""Measured contact radii against force, and the intrinsic work of adhesion that fits them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.force import FEWEST_POINTS, adhesion_from_forces
from crackfront.core.units import Scales
from crackfront.studies.paper.measured import MeasuredFileError, Quantity, read_measured

Array = NDArray[np.float64]

BRANCHES = {"approach": 1, "retraction": -1}

_FORCE = Quantity("force", {"N": 1.0, "mN": 1e-3, "uN": 1e-6})
_RADIUS = Quantity("radius", {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}, positive=True)


@dataclass(frozen=True, slots=True)
class ForceRadius:
    """Measured points.

    Attributes
    ----------
    force : (n_point,) array
        Normal force, positive where it pushes. (Units: N)
    radius : (n_point,) array
        Contact radius. (Units: m)
    direction : (n_point,) int array
        +1 in approach, -1 in retraction.
    """

    force: Array
    radius: Array
    direction: NDArray[np.int64]


NOTHING_MEASURED = ForceRadius(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))


def read_force_radius(path: Path) -> ForceRadius:
    """Points from a CSV file with the columns force (mN), radius (um) and branch.

    The units are N, mN or uN, and m, mm, um or nm; the branch is approach or retraction.

    Parameters
    ----------
    path : Path
        CSV file, in the order of the measurement.

    Raises
    ------
    MeasuredFileError
        If it cannot be read or holds no such columns; if a branch is unknown, an approach follows
        a retraction, the approach has fewer than three points, or ends at no larger force than it
        begins. The sentence names the line.
    """
    table = read_measured(path, (_FORCE, _RADIUS), words=("branch",))
    for line, name in zip(table.lines, table.words[0], strict=True):
        if name not in BRANCHES:
            raise MeasuredFileError(
                f"{path}, line {line}: branch is {str(name)!r}; it must be {' or '.join(BRANCHES)}"
            )
    direction = np.array([BRANCHES[name] for name in table.words[0]])
    force, radius = table.numbers
    points = ForceRadius(force, radius, direction)
    back = np.flatnonzero(np.diff(direction) > 0)
    if back.size:
        raise MeasuredFileError(
            f"{path}, line {table.lines[back[0] + 1]}: an approach follows the retraction; the "
            "rows must be one approach and then its retraction"
        )
    approach = points.force[direction > 0]
    last = table.lines[max(approach.size - 1, 0)]
    if approach.size < FEWEST_POINTS:
        raise MeasuredFileError(
            f"{path}, line {last}: the approach has {approach.size} points; the fit needs "
            f"{FEWEST_POINTS}"
        )
    if approach[-1] <= approach[0]:
        raise MeasuredFileError(
            f"{path}, line {last}: the approach ends at {approach[-1]:g} N and begins at "
            f"{approach[0]:g} N; its force must grow, so put the rows in the order of measurement"
        )
    return points


def fitted_adhesion(
    points: ForceRadius, scales: Scales, elastic_energy: float, factor: float
) -> Estimate:
    r"""Intrinsic work of adhesion of a measured approach.

    .. math:: w_{int} = w_{appr} + (1 + k) e_{el}

    with the JKR curve of w_appr fitted to the force at the measured radii. (e_el does not depend
    on w_int.)

    Parameters
    ----------
    points : ForceRadius
        What was measured.
    scales : Scales
        Sphere and modulus, for any work of adhesion.
    elastic_energy : float
        Energy of full conformity of the surface. (Units: J / m^2)
    factor : float
        The factor k.

    Returns
    -------
    Estimate
        w_int with the interval that the scatter of the points leaves. (Units: J / m^2)
    """
    approach = points.direction > 0
    fit = adhesion_from_forces(
        points.radius[approach] / scales.lateral, points.force[approach] / scales.force
    )
    shift, unit = (1 + factor) * elastic_energy, scales.work_of_adhesion
    return Estimate(
        fit.value * unit + shift,
        fit.standard_error * unit,
        fit.low * unit + shift,
        fit.high * unit + shift,
    )
