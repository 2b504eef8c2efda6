"""The work of adhesion of the JKR curve that goes best through forces at radii."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from crackfront.analysis.estimate import Estimate, student_estimate
from crackfront.core import jkr

Array = NDArray[np.float64]

FEWEST_POINTS = 3
"""Points that a fit with an interval needs."""


def adhesion_from_forces(radius: Array, force: Array) -> Estimate:
    """Work of adhesion by least squares of the force of a smooth sphere (Units: w_int).

    Parameters
    ----------
    radius : (n_point,) array
        Contact radii. (Units: reduced lateral length)
    force : (n_point,) array
        Normal forces, whose errors are taken to be equal and independent. (Units: pi w_int R)

    Raises
    ------
    ValueError
        If there are too few points.

    Examples
    --------
    >>> radius = np.linspace(1.0, 2.0, 5)
    >>> fit = adhesion_from_forces(radius, jkr.equilibrium_force(radius, 0.3))
    >>> round(float(fit.value), 6)
    0.3
    """
    if radius.size < FEWEST_POINTS:
        raise ValueError(
            f"{radius.size} points are too few for a work of adhesion with its interval; give "
            f"{FEWEST_POINTS} or more"
        )
    found, covariance = curve_fit(
        jkr.equilibrium_force, radius, force, p0=[1.0], bounds=(0.0, np.inf), xtol=1e-14, ftol=1e-14
    )
    return student_estimate(found[0], np.sqrt(covariance[0, 0]), radius.size - 1)
