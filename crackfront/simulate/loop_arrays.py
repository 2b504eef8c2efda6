"""What a loop in memory holds beside its curves: its measures, and its single instabilities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from crackfront.analysis.steady import SteadyAdhesion
from crackfront.core.cycle.instabilities import Motion, swept_clusters
from crackfront.core.records import ENERGY, LATERAL, VERTICAL, Variable
from crackfront.data.files import labelled
from crackfront.data.schema import ANGLE, ANGLES, COORDINATES, COSTS, HYSTERESIS

_KNOWN = {item.name: item for item in (*COORDINATES, *COSTS, *HYSTERESIS)}

INSTABILITY = "instability"
_jump, _jump_front = (INSTABILITY,), (INSTABILITY, ANGLE)
JUMPS = (
    Variable("penetration", _jump, VERTICAL, "penetration of the instability"),
    Variable("dissipated_energy", _jump, ENERGY, "energy that the instability dissipates"),
    Variable("area", _jump, f"({LATERAL})^2", "area that the front has swept"),
    Variable("extent", _jump, LATERAL, "width of the largest patch along the perimeter"),
    Variable("before", _jump_front, LATERAL, "front before the instability"),
    Variable("after", _jump_front, LATERAL, "front after the instability"),
)
"""Variables of the instabilities of a branch."""


def loop_measures(
    steady: SteadyAdhesion,
    elastic_energy: float,
    rms: float,
    correlation_length: float,
    numerical_error: tuple[float, float],
) -> dict[str, Any]:
    """Labelled measures of one loop, named as in the table of a sweep.

    Parameters
    ----------
    steady : SteadyAdhesion
        Its apparent works of adhesion.
    elastic_energy, rms : float
        e_el and w_rms measured on the tile. (Units: w_int)
    correlation_length : float
        That of w_loc. (Units: reduced lateral length)
    numerical_error : tuple of float
        Expected numerical errors of w_appr and w_retr. (Units: w_int)
    """
    values = {
        "e_el": elastic_energy,
        "w_rms": rms,
        "correlation_length": correlation_length,
        "w_appr": steady.approach,
        "w_retr": steady.retraction,
        "w_appr_error": steady.approach_error,
        "w_retr_error": steady.retraction_error,
        "w_appr_numerical_error": numerical_error[0],
        "w_retr_numerical_error": numerical_error[1],
        "hysteresis": steady.hysteresis,
        "lowest_radius": steady.lowest_radius,
        "highest_radius": steady.highest_radius,
    }
    return {name: labelled(replace(_KNOWN[name], dims=()), value) for name, value in values.items()}


def jump_dataset(
    jumps: Sequence[Motion], energies: Sequence[float], travel: float, n_angle: int
) -> xr.Dataset:
    """Labelled instabilities of a branch.

    Parameters
    ----------
    jumps : sequence of Motion
        The instabilities.
    energies : sequence of float
        What each dissipates. (Units: pi w_int R times a reduced vertical length)
    travel : float
        Smallest motion of a site that counts. (Units: reduced lateral length)
    n_angle : int
        Number of sites.
    """
    clusters = [swept_clusters(jump.before, jump.after, travel) for jump in jumps]
    fronts = [np.array([getattr(jump, name) for jump in jumps]) for name in ("before", "after")]
    columns = (
        np.array([jump.end for jump in jumps]),
        np.array(energies),
        np.array([sum(part.area for part in parts) for parts in clusters]),
        np.array([parts[0].extent for parts in clusters]),
        *(front.reshape(-1, n_angle) for front in fronts),
    )
    values = {
        item.name: labelled(item, column) for item, column in zip(JUMPS, columns, strict=True)
    }
    angles = {ANGLE: labelled(ANGLES, 2 * np.pi * np.arange(n_angle) / n_angle)}
    return xr.Dataset(values, angles, {"travel": travel})
