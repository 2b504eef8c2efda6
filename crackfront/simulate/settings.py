"""Settings of the numerics: resolution and tolerance, and their choice for a requested error."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Interpolation
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.law_interpolation import (
    LawInterpolation,
    branch_errors,
    law_interpolation,
    unmeasured_reason,
)
from crackfront.simulate.laws import LAW_CUTOFFS, SettingName, sphere_cutoffs

_SHARES: dict[SettingName, float] = {"sites": 0.95, "cubic": 0.2, "pixels": 0.2, "tolerance": 0.1}
"""Share of each setting in a requested error, largest for the costly one; squares sum to 0.99."""

_RANGES: dict[SettingName, tuple[float, float]] = {
    "sites": (1.4, 12.0),
    "cubic": (2.5, 16.0),
    "pixels": (2.5, 8.0),
    "tolerance": (1e-3, 1e-9),
}
"""Values that may be chosen, from the coarsest to the finest."""

_LEAST_SHARES = 0.75
"""Common factor of all shares with which even biases of one sign leave the requested error."""

_MOST_SHARES = 2.0
"""Common factor of all shares above which the cheap settings have their coarsest values."""

_N_BISECTION = 10
"""Halvings of the range of the common factor, on a logarithmic scale."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Resolution in short cutoffs, and tolerance; a requested error may decide them."""

    angles: int | None
    """Number of sites of the front; where None, `angles_per_cutoff` decides."""
    angles_per_cutoff: float
    """Sites per short cutoff on the smooth contact's largest circle, rounded up to an even product
    of 2, 3 and 5."""
    samples_per_cutoff: float
    """Samples per short cutoff along a ray."""
    interpolation: Interpolation
    """Pieces between samples."""
    pixels_per_cutoff: float
    """Points of the tile per short cutoff, 2 or more."""
    tolerance: float
    """Largest force along the motion that may be left, relative to w_int per front length."""


def chosen_settings(
    error: float,
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    usual_cutoffs: float | None = None,
) -> Settings:
    """Settings that leave a requested error in w_appr and w_retr: the coarsest that the laws allow.

    Parameters
    ----------
    error : float
        Standard error of the factor k of either branch that the numerics may leave.
    kind : {'roughness', 'chemical'}
        What the spectrum describes.
    spectrum : Spectrum
        Shape of the spectrum. (Units: reduced lateral length)
    elastic_energy : float
        e_el / w_int.
    usual_cutoffs : float, optional
        Cutoffs crossed by the front, by default :func:`crackfront.simulate.laws.sphere_cutoffs`.

    Raises
    ------
    ValueError
        If errors were not measured at such an e_el, or for spectra as narrow.
    """
    if reason := unmeasured_reason(kind, spectrum, elastic_energy):
        raise ValueError(f"error is {error:g}, but {reason}")
    usual = sphere_cutoffs(spectrum) if usual_cutoffs is None else usual_cutoffs
    interpolation = law_interpolation(kind, spectrum, elastic_energy, usual)
    values = _chosen_values(error, interpolation, usual * interpolation.independent)
    return Settings(
        angles=None,
        angles_per_cutoff=values["sites"],
        samples_per_cutoff=values["cubic"],
        interpolation="cubic",
        pixels_per_cutoff=values["pixels"],
        tolerance=values["tolerance"],
    )


@functools.cache
def _chosen_values(
    error: float, interpolation: LawInterpolation, cutoffs: float
) -> dict[SettingName, float]:
    """Coarsest values of all settings whose errors together are at most the requested one."""
    values = {setting: _allowed_values(setting) for setting in _SHARES}
    errors = {setting: interpolation.errors(setting, values[setting]) for setting in _SHARES}
    for setting in _SHARES:
        errors[setting][1] *= math.sqrt(LAW_CUTOFFS / cutoffs)
    low, high = _LEAST_SHARES, _MOST_SHARES
    for _ in range(_N_BISECTION):
        middle = math.sqrt(low * high)
        chosen = _coarsest(errors, error, middle)
        remaining = {setting: errors[setting][..., chosen[setting]] for setting in _SHARES}
        low, high = (
            (middle, high) if max(branch_errors(remaining, LAW_CUTOFFS)) <= error else (low, middle)
        )
    chosen = _coarsest(errors, error, low)
    return {setting: float(values[setting][chosen[setting]]) for setting in _SHARES}


def _coarsest(
    errors: Mapping[SettingName, Array], error: float, shares: float
) -> dict[SettingName, int]:
    """Place of the coarsest value of each setting whose error is at most a multiple of its share.

    The finest where all are larger.
    """
    places = {}
    for setting, share in _SHARES.items():
        bias, scatter = errors[setting]
        larger_branch = np.hypot(bias, scatter).max(axis=0)
        is_enough = larger_branch[:-1] <= share * shares * error
        places[setting] = int(np.argmax(np.append(is_enough, True)))
    return places


@functools.cache
def _allowed_values(setting: SettingName) -> Array:
    """Values that may be chosen, of two digits, the coarsest first."""
    values = [float(f"{value:.2g}") for value in np.geomspace(*_RANGES[setting], 400)]
    return np.array(list(dict.fromkeys(values)))
