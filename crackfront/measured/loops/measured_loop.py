"""A measured loop in the library: from a file or from arrays to its works of adhesion."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field
from xarray import DataArray, Dataset

from crackfront.core.arrays import Array
from crackfront.core.bounds import POISSON
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.loop_choice import chosen_loop
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.loops.loop_table import read_recording
from crackfront.measured.loops.recording import UNITS, Recording
from crackfront.measured.loops.rig import Rig
from crackfront.measured.loops.simulated_loop import simulated_loop
from crackfront.measured.scan.netcdf import is_netcdf
from crackfront.simulate.storage import read_dataset
from crackfront.surfaces.scales import in_si, stated_modulus
from crackfront.surfaces.written_units import unit_value
from crackfront.validation import PathName, WholeNumber, checked_call, within

_SIMULATED = {"mean_radius", "pinning_force"}
"""Variables one of which every simulated cycle has, and no measured loop."""


@checked_call
def measured_loop(
    loop: PathName | Mapping[str, Any] | Dataset,
    *,
    radius: float | str | None = None,
    contact_modulus: float | str | None = None,
    modulus: float | str | None = None,
    poisson: Annotated[float, within(POISSON)] | None = None,
    modulus_error: float = 0.0,
    radius_error: float = 0.0,
    stiffness: float | str | None = None,
    window: Annotated[tuple[float | str, float | str], Field(strict=False)] | None = None,
    loop_number: WholeNumber | None = None,
    segment: Literal["approach", "retract"] | None = None,
    invert: Literal["force", "displacement"] | None = None,
) -> MeasuredLoop:
    """Works of adhesion of a loop that a rig measured, or of a simulated one, with intervals.

    Parameters
    ----------
    loop : path, mapping or xarray.Dataset
        A table whose heads name force, contact radius and displacement with their units, or arrays
        by these names in SI units: `force`, `radius` (0 or NaN out of contact), `displacement`. Two
        of them suffice; rows that are masked or NaN are left out. Or a simulated cycle, the result
        of :func:`run_loop` or the file of one; it states its sphere, and all other arguments are
        left out.
    radius : float or str, optional
        Radius of the sphere, which a measured loop needs; a number of metres, or a text with a
        unit, as '1.25mm'. (Units: m)
    contact_modulus : float or str, optional
        E' = E / (1 - nu^2), in place of `modulus` and `poisson`; fitted to force and contact radius
        without any of them. (Units: Pa)
    modulus : float or str, optional
        Young's modulus E, as '0.7MPa'. (Units: Pa)
    poisson : float, optional
        Poisson's ratio nu, as 0.5.
    modulus_error, radius_error : float, optional
        Relative standard errors of the two.
    stiffness : float or str, optional
        Stiffness of the machine, for displacements with a force or a contact radius alone.
        (Units: N/m)
    window : (float, float), optional
        Contact radii that both branches are averaged over; numbers, or texts with a unit.
        (Units: m)
    loop_number : int, optional
        Which loop to evaluate if there are several, from 1.
    segment : "approach" or "retract", optional
        Branch to evaluate alone.
    invert : "force" or "displacement", optional
        Column with the opposite sign: a force that is positive where it pulls, a displacement that
        decreases towards the surface.

    Returns
    -------
    MeasuredLoop
        w_appr, w_retr, hysteresis and more in SI units; printed, it is a page. The values of a
        simulated cycle are those that the simulation states, in its units.

    Raises
    ------
    ValueError
        If the loop cannot be used; the sentence says what to do.
    TypeError
        If it is neither a path, nor a mapping, nor a dataset.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> radius = np.concatenate([np.linspace(60e-6, 150e-6, 40), np.linspace(149e-6, 60e-6, 40)])
    >>> work = np.repeat([0.03, 0.06], 40)
    >>> force = 4e6 / 3 * radius**3 / 1e-3 - np.sqrt(8 * np.pi * 1e6 * work * radius**3)
    >>> columns = {"force": force, "radius": radius}
    >>> loop = measured_loop(columns, radius="1mm", modulus="0.75MPa", poisson=0.5)
    >>> round(loop.w_appr.value, 6), round(loop.w_retr.value, 6)
    (0.03, 0.06)
    """
    if isinstance(loop, Path) and is_netcdf(loop):
        loop = read_dataset(loop)
    if isinstance(loop, Dataset) and _SIMULATED & {*loop}:
        _check_no_rig(
            radius=radius,
            contact_modulus=contact_modulus,
            modulus=modulus,
            poisson=poisson,
            modulus_error=modulus_error or None,
            radius_error=radius_error or None,
            stiffness=stiffness,
            window=window,
            loop_number=loop_number,
            segment=segment,
            invert=invert,
        )
        return simulated_loop(loop)
    if radius is None:
        raise ValueError("a measured loop does not state its sphere; give its radius in metres")
    is_fitted = contact_modulus is None and modulus is None and poisson is None
    rig = Rig(
        radius=in_si("radius", radius, "m"),
        contact_modulus=None if is_fitted else stated_modulus(contact_modulus, modulus, poisson),
        modulus_error=modulus_error,
        radius_error=radius_error,
        stiffness=None if stiffness is None else in_si("stiffness", stiffness, "N/m"),
        window=None if window is None else _window(window),
        segment=segment,
    )
    recording = read_recording(loop, {}, {}) if isinstance(loop, Path) else _recording(loop)
    if invert is not None:
        recording = recording.inverted([invert])
    return analyse_loop(chosen_loop(recording, loop_number), rig)


def _check_no_rig(**arguments: object) -> None:
    """Raise ValueError if an argument describes the rig of a simulated cycle, which has none."""
    if names := [name for name, value in arguments.items() if value is not None]:
        raise ValueError(
            f"a simulated cycle states its sphere and lacks a rig; leave out {', '.join(names)} "
            "(crackfront.in_si_units gives a cycle in reduced units a sphere)"
        )


def _window(window: tuple[float | str, float | str]) -> tuple[float, float]:
    """Contact radii of a window (Units: m)."""
    first, last = (in_si("a contact radius of window", end, "m") for end in window)
    return first, last


def _recording(arrays: Mapping[str, ArrayLike] | Dataset) -> Recording:
    """Columns of arrays by their names; other variables of a dataset, as a time, are left out."""
    columns = {name: arrays[name] for name in UNITS if arrays.get(name) is not None}
    unknown = set(map(str, arrays)) - set(UNITS)
    if unknown and not isinstance(arrays, Dataset):
        raise ValueError(
            f"{', '.join(sorted(unknown))} is not a column of a loop; give two of "
            f"{', '.join(UNITS)}"
        )
    force, radius, displacement = (
        _column(name, columns[name]) if name in columns else None for name in UNITS
    )
    return Recording(force, radius, displacement)


def _column(name: str, values: ArrayLike) -> Array:
    """A column in SI units, NaN where it is masked; an array that states its unit is converted."""
    unit = values.attrs.get("units") if isinstance(values, DataArray) else None
    factor = 1.0 if unit is None else unit_value(unit, UNITS[name])
    try:
        column: Array = factor * np.ma.array(values, dtype=float).filled(np.nan)
    except (TypeError, ValueError) as error:
        raise TypeError(f"the values of {name} are no array of numbers: {error}") from error
    if not np.any(np.isfinite(column)):
        raise ValueError(f"{name} lacks finite values; leave the column out, or check the file")
    return np.where(np.isfinite(column), column, np.nan)
