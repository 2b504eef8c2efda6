"""Errors that settings leave, interpolated between the measured laws.

Between measured shapes and amplitudes errors are interpolated; beyond the amplitudes they are not
known. Scatters of different settings are added in quadrature, biases as they are where they have
one sign: too few samples make the hysteresis too small, all else makes it too large.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from crackfront.core.adhesion import FieldKind, correlation_length, force_correlation_length
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Interpolation
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.laws import (
    LAW_CUTOFF,
    LAW_CUTOFFS,
    MEASURED,
    ErrorLaw,
    SettingName,
    error_laws,
    measured_energies,
    sphere_cutoffs,
)

_NARROW: dict[FieldKind, str] = {"chemical": "chemical", "roughness": "flat"}
"""The shape without long wavelengths; the broad ones serve both kinds."""

_ONSET = 0.7
"""Larkin length, in radii of the sphere, at which scatter was largest in all shapes."""

_ONSET_SPREAD = 2.0
"""Factor within which the onset of avalanches is known."""

_LEEWAY = 1.05
"""Relative tolerance of e_el and correlation lengths outside the measured range."""


@dataclass(frozen=True, slots=True)
class LawInterpolation:
    """Measured shapes and amplitudes from which the errors of others are interpolated."""

    weights: tuple[tuple[str, float], ...]
    """Measured shapes, and the weight of each in the error."""
    lowest: float
    """Least e_el / w_int; the largest error of the amplitudes up to `highest` counts."""
    highest: float
    """Largest e_el / w_int of these amplitudes."""
    independent: float
    """Share of independent cutoffs along a front, relative to the fronts of the laws."""

    def errors(self, setting: SettingName, values: ArrayLike) -> Array:
        """Errors at values of a setting for :data:`LAW_CUTOFFS` (Units: e_el).

        Their axes are bias and scatter, approach and retraction, values.
        """
        # Errors are interpolated, not their logarithms: the geometric mean with a bias of 0 is 0.
        shapes, weights = zip(*self.weights, strict=True)
        branches = []
        for direction in (1, -1):
            shape_laws = [error_laws()[shape, setting, direction] for shape in shapes]
            errors = [
                self._largest(laws, np.array([law.parts(values) for law in laws]))
                for laws in shape_laws
            ]
            branches.append(np.tensordot(weights, errors, axes=1))
        return np.stack(branches, axis=1)

    def _largest(self, laws: Sequence[ErrorLaw], measured: Array) -> Array:
        """Largest value in the range of amplitudes, interpolated between the laws."""
        energies = np.array([law.elastic_energy for law in laws])
        between = (energies > self.lowest) & (energies < self.highest)
        amplitudes = np.log([self.lowest, *energies[between], self.highest])
        return np.max(_interpolated(amplitudes, np.log(energies), measured), axis=0)


@functools.cache
def law_interpolation(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: float, cutoffs: float
) -> LawInterpolation:
    """Measured shapes and amplitudes whose errors stand for a spectrum and an amplitude.

    Shapes: the two neighbours in correlation length, interpolated linearly in its logarithm.

    Amplitudes: from e_el up to the one at which the fronts of the laws have as many Larkin lengths
    as this front, because avalanches begin along a long front at a smaller e_el. A Larkin length
    is proportional to 1 / e_el, so that this equivalent amplitude is e_el times the length of the
    front over the length of the laws' fronts. Amplitudes above the onset of avalanches are left
    out.

    `cutoffs` is the number of cutoffs crossed, for which settings are chosen.
    """
    shapes = (_NARROW[kind], "h03", "h08")
    measured = np.log([_relative_correlation_length(*MEASURED[shape]) for shape in shapes])
    length = np.log(_relative_correlation_length(kind, spectrum))
    weights = _interpolated(length, measured, np.eye(len(shapes))).tolist()
    correlated = force_correlation_length(kind, spectrum) * LAW_CUTOFF / spectrum.short_cutoff
    # The Larkin length at the cutoff of the laws is 2 pi correlated / (4 e_el / w_int).
    onset_energy = 2 * math.pi * correlated / (4 * _ONSET)
    relative_length = cutoffs / LAW_CUTOFFS
    equivalent_energy = elastic_energy * relative_length
    highest = max(elastic_energy, min(_ONSET_SPREAD * equivalent_energy, onset_energy))
    return LawInterpolation(
        tuple((shape, weight) for shape, weight in zip(shapes, weights, strict=True) if weight > 0),
        elastic_energy,
        highest,
        max(elastic_energy / highest, 1 / max(relative_length, 1.0)),
    )


def _interpolated(places: float | Array, measured: Array, values: Array) -> Array:
    """Values (n_measured, ...) at other places, linear between the measured ones, constant beyond.

    The measured places increase.
    """
    places = np.clip(places, measured[0], measured[-1])
    last = len(measured) - 1
    before = np.maximum(np.searchsorted(measured, places, side="right") - 1, 0)
    after = np.minimum(before + 1, last)
    # At the last measured place both neighbours are that place.
    distance = np.where(before == last, 1.0, measured[after] - measured[before])
    one_per_value = np.shape(places) + (1,) * (values.ndim - 1)
    slope = (values[after] - values[before]) / distance.reshape(one_per_value)
    return slope * (places - measured[before]).reshape(one_per_value) + values[before]


def _relative_correlation_length(kind: FieldKind, spectrum: Spectrum) -> float:
    """Correlation length of w_loc in short cutoffs."""
    return correlation_length(kind, spectrum) / spectrum.short_cutoff


def unmeasured_reason(kind: FieldKind, spectrum: Spectrum, elastic_energy: float) -> str:
    """Why no errors were measured for a spectrum and amplitude; empty if they were."""
    low, high = measured_energies()
    remedy = "give the resolution and the tolerance instead"
    if not spectrum.is_isotropic:
        return f"errors were measured for isotropic spectra alone; {remedy}"
    if not low / _LEEWAY <= elastic_energy <= high * _LEEWAY:
        return (
            f"errors were measured for e_el/w_int from {low:g} to {high:g}, not at "
            f"{elastic_energy:.3g}; {remedy}"
        )
    shape = _NARROW[kind]
    least = _relative_correlation_length(*MEASURED[shape])
    length = _relative_correlation_length(kind, spectrum)
    # Spectra broader than all that were measured have smaller errors for their cutoff.
    if length * _LEEWAY < least:
        return (
            f"errors were measured for correlation lengths of w_loc from {least:.3g} short cutoffs "
            f"on, not {length:.3g}; {remedy}"
        )
    return ""


def combined_error(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    values: Mapping[SettingName, float],
    cutoffs: float,
    usual_cutoffs: float | None = None,
) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) that values of all settings leave (Units: w_int).

    They are NaN where errors were not measured. `values` has one interpolation, the one that is
    used; `cutoffs` is the number of cutoffs crossed, as in :mod:`crackfront.simulate.laws`. The
    other arguments are as of :func:`crackfront.simulate.settings.chosen_settings`.
    """
    if unmeasured_reason(kind, spectrum, elastic_energy):
        return math.nan, math.nan
    usual = sphere_cutoffs(spectrum) if usual_cutoffs is None else usual_cutoffs
    interpolation = law_interpolation(kind, spectrum, elastic_energy, usual)
    errors = {setting: interpolation.errors(setting, value) for setting, value in values.items()}
    approach, retraction = branch_errors(errors, cutoffs * interpolation.independent)
    return elastic_energy * approach, elastic_energy * retraction


def branch_errors(errors: Mapping[SettingName, Array], cutoffs: float) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) of all settings, each with (bias or scatter, branch)."""
    biases = {setting: bias for setting, (bias, _) in errors.items()}
    lowered = [biases.pop(setting) for setting in get_args(Interpolation) if setting in biases]
    raised = list(biases.values())
    bias = np.maximum(sum(lowered), sum(raised))
    scatter = np.sqrt(sum(scatter**2 for _, scatter in errors.values()) * LAW_CUTOFFS / cutoffs)
    approach, retraction = np.hypot(bias, scatter)
    return float(approach), float(retraction)
