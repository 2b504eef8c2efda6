r"""Errors of w_appr and w_retr by the numerics: measured laws, and numerics for a requested error.

`python -m studies accuracy report` fits the laws to measured errors and writes `laws.csv`. An error
is that of the mean apparent work of adhesion of one branch, in units of e_el: that of its factor k.
It has a bias, equal on all surfaces, and a scatter, from avalanches that one discretisation
triggers and another does not; the scatter falls with the root of the size, the number of cutoffs
along the front times the number of its states. Each setting has a law of its own,

.. math:: \log e = c_0 + c_1 x,

where x is the number of sites per short cutoff (the front is smooth, so that the error falls
exponentially), or the logarithm of samples, pixels or tolerance. Between measured shapes and
amplitudes errors are interpolated; beyond the amplitudes they are not known. Scatters of different
settings are added in quadrature, biases as they are where they have one sign: too few samples make
the hysteresis too small, all else makes it too large.
"""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Literal, cast, get_args

import numpy as np
from numpy.typing import ArrayLike

from crackfront.core.adhesion import FieldKind, correlation_length, force_correlation_length
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Interpolation
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum

LAW_SIZE = 4000.0
"""Size of the fronts on which the laws were measured: states times circumference over the short
cutoff, for eight states, cutoff 0.02 and mean radius 1.6."""

LAW_CUTOFF = 0.02
"""Short cutoff of all spectra of the laws. (Units: reduced lateral length)"""

SettingName = Literal["sites", "cubic", "linear", "pixels", "tolerance"]
SETTINGS: tuple[SettingName, ...] = get_args(SettingName)

_SHARES: dict[SettingName, float] = {"sites": 0.95, "cubic": 0.2, "pixels": 0.2, "tolerance": 0.1}
"""Share of each setting in a requested error, largest for the costly one; squares sum to 0.99."""

MEASURED: dict[str, tuple[FieldKind, SelfAffineSpectrum]] = {
    "chemical": ("chemical", SelfAffineSpectrum(0.02, 0.02, 1.0)),
    "flat": ("roughness", SelfAffineSpectrum(0.02, 0.02, 1.0)),
    "h03": ("roughness", SelfAffineSpectrum(0.02, 0.4, 0.3)),
    "h08": ("roughness", SelfAffineSpectrum(0.02, 0.32, 0.8)),
}
"""Shapes of the laws, and the spectra on which they were measured."""

_NARROW: dict[FieldKind, str] = {"chemical": "chemical", "roughness": "flat"}
"""The shape without long wavelengths; the broad ones serve both kinds."""

_ONSET = 0.7
"""Larkin length, in radii of the sphere, at which scatter was largest in all shapes."""

_LEEWAY = 1.05
"""By how much the e_el of a tile may lie beyond the measured amplitudes, relative to them."""

_RANGES: dict[SettingName, tuple[float, float]] = {
    "sites": (1.4, 12.0),
    "cubic": (2.5, 16.0),
    "pixels": (2.5, 8.0),
    "tolerance": (1e-3, 1e-9),
}
"""Values that may be chosen, from the coarsest to the finest."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings that a requested error decides: resolution in short cutoffs, and tolerance."""

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


@dataclass(frozen=True, slots=True)
class ErrorLaw:
    """Error of one setting for one shape of spectrum, one amplitude and one branch."""

    shape: str
    """Shape of the spectrum, a name in :data:`MEASURED`."""
    elastic_energy: float
    setting: SettingName
    direction: int
    """+1 for w_appr, -1 for w_retr."""
    bias: tuple[float, float]
    scatter: tuple[float, float]
    """Coefficients (c_0, c_1) of the logarithm, as of that of the bias. (Units: e_el)"""
    avalanche: float
    """Change by one avalanche, on fronts of :data:`LAW_SIZE`; equal for all settings of a shape and
    an amplitude. (Units: e_el)"""

    def parts(self, values: ArrayLike) -> Array:
        """Bias and scatter at values of the setting, fronts of :data:`LAW_SIZE` (Units: e_el)."""
        x = abscissa(self.setting, values)
        return np.array([np.exp(c0 + c1 * x) for c0, c1 in (self.bias, self.scatter)])

    def error(self, value: float, size: float) -> float:
        """Standard error at a value of the setting, for a front of a size, in units of e_el."""
        bias, scatter = self.parts(value)
        return math.hypot(bias, scatter * math.sqrt(LAW_SIZE / size))


def abscissa(setting: SettingName, values: ArrayLike) -> Array:
    """Abscissa of a law: sites themselves, else the logarithm."""
    return np.asarray(values, dtype=float) if setting == "sites" else np.log(values)


@dataclass(frozen=True, slots=True)
class _Interpolation:
    """Measured shapes and amplitudes from which the errors of others are interpolated."""

    shapes: tuple[tuple[str, float], ...]
    """Measured shapes, and the parts that they have in the error."""
    lowest: float
    highest: float
    """Ends of a range of e_el / w_int; the largest error among its amplitudes counts."""
    independent: float
    """Share of independent cutoffs along a front, relative to the fronts of the laws."""


@functools.cache
def _interpolation(
    kind: FieldKind, spectrum: Spectrum, elastic_energy: float, size: float
) -> _Interpolation:
    """Shapes with the next correlation lengths, and amplitudes with as early an onset."""
    shapes = (_NARROW[kind], "h03", "h08")
    measured = [_relative_correlation_length(*MEASURED[shape]) for shape in shapes]
    length = math.log(_relative_correlation_length(kind, spectrum))
    parts = [float(np.interp(length, np.log(measured), row)) for row in np.eye(len(shapes))]
    correlated = force_correlation_length(kind, spectrum) * LAW_CUTOFF / spectrum.short_cutoff
    # Avalanches begin where the Larkin length falls to _ONSET, within a factor of 2. Below it the
    # amplitudes count up to that with as many at the cutoff of the laws; w_rms**2 = 4 e_el w_int.
    onset = 2 * math.pi * correlated / (4 * _ONSET)
    shorter = size / LAW_SIZE
    highest = max(elastic_energy, min(2 * elastic_energy * shorter, onset))
    return _Interpolation(
        tuple((shape, part) for shape, part in zip(shapes, parts, strict=True) if part > 0),
        elastic_energy,
        highest,
        max(elastic_energy / highest, 1 / max(shorter, 1.0)),
    )


def _relative_correlation_length(kind: FieldKind, spectrum: Spectrum) -> float:
    """Correlation length of w_loc in short cutoffs."""
    return correlation_length(kind, spectrum) / spectrum.short_cutoff


def chosen_settings(
    error: float,
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    usual_size: float | None = None,
) -> Settings:
    """Settings that leave a requested error in w_appr and w_retr: the coarsest that the laws allow.

    The error is the standard error of the factor k of either branch that the numerics may leave, on
    fronts of the usual size, by default :func:`sphere_size`; the
    elastic energy is e_el / w_int. ValueError if errors were not measured at such an e_el, or for
    spectra as narrow.
    """
    if refusal := _unmeasured_reason(kind, spectrum, elastic_energy):
        raise ValueError(f"error is {error:g}, but {refusal}")
    usual = sphere_size(spectrum) if usual_size is None else usual_size
    interpolation = _interpolation(kind, spectrum, elastic_energy, usual)
    found = _chosen_values(error, interpolation, usual * interpolation.independent)
    return Settings(
        angles=None,
        angles_per_cutoff=found["sites"],
        samples_per_cutoff=found["cubic"],
        interpolation="cubic",
        pixels_per_cutoff=found["pixels"],
        tolerance=found["tolerance"],
    )


def _unmeasured_reason(kind: FieldKind, spectrum: Spectrum, elastic_energy: float) -> str:
    """Why no errors were measured for a spectrum and amplitude; empty if they were."""
    low, high = measured_energies()
    remedy = "give the resolution and the tolerance instead"
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


def measured_energies() -> tuple[float, float]:
    """Smallest and largest e_el / w_int at which errors were measured."""
    energies = [law.elastic_energy for laws in _laws().values() for law in laws]
    return min(energies), max(energies)


@functools.cache
def _chosen_values(
    error: float, interpolation: _Interpolation, size: float
) -> dict[SettingName, float]:
    """Coarsest values of all settings whose errors together are at most the requested one."""
    tried = {setting: _values(setting) for setting in _SHARES}
    parts = {setting: _parts(interpolation, setting, values) for setting, values in tried.items()}
    margin = _avalanche_margin(error, interpolation, size)
    for of in parts.values():
        of[1] *= margin * math.sqrt(LAW_SIZE / size)
    single = {setting: np.hypot(*of).max(axis=0) for setting, of in parts.items()}

    def chosen(shares: float) -> dict[SettingName, int]:
        return {
            setting: int(np.argmax(np.append(errors[:-1] <= share * shares * error, True)))
            for (setting, share), errors in zip(_SHARES.items(), single.values(), strict=True)
        }

    # At 0.75 all biases may have one sign; above 1 the coarsest values of cheap settings suffice.
    low, high = 0.75, 2.0
    for _ in range(10):
        middle = math.sqrt(low * high)
        left = {setting: parts[setting][..., index] for setting, index in chosen(middle).items()}
        low, high = (middle, high) if max(_combined(left, LAW_SIZE)) <= error else (low, middle)
    return {setting: float(tried[setting][index]) for setting, index in chosen(low).items()}


def _avalanche_margin(error: float, interpolation: _Interpolation, size: float) -> float:
    """Factor by which scatter must be below a requested error: few surfaces have an avalanche."""
    largest = 0.0
    for shape, part in interpolation.shapes:
        laws = _laws()[shape, "sites", 1]
        sizes = np.array([[law.avalanche] for law in laws])
        largest += part * float(_largest_between(laws, sizes, interpolation)[0])
    largest *= LAW_SIZE / size
    # The mean square of eight surfaces has the mean s^2 and, of avalanches of one size a, the
    # variance s^2 (a^2 + 2 s^2) / 8: the mean and three standard deviations are the bound.
    bound = (1.5 * error) ** 2
    half = bound + 9 / 16 * largest**2
    square = bound**2 / (half + math.sqrt(half**2 + 5 / 4 * bound**2))
    return float(np.clip(error / math.sqrt(square), 1.0, 3.0))


def _values(setting: SettingName) -> Array:
    """Values that may be chosen, of two digits, the coarsest first."""
    values = [float(f"{value:.2g}") for value in np.geomspace(*_RANGES[setting], 400)]
    return np.array(list(dict.fromkeys(values)))


def combined_error(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    values: Mapping[SettingName, float],
    size: float,
    usual_size: float | None = None,
) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) that values of all settings leave (Units: w_int).

    They are NaN where errors were not measured. Of interpolations, the value is the one that is
    used; `size` is the number of states times circumference of the front over the short cutoff. The
    other arguments are as of :func:`chosen_settings`.
    """
    if _unmeasured_reason(kind, spectrum, elastic_energy):
        return math.nan, math.nan
    usual = sphere_size(spectrum) if usual_size is None else usual_size
    interpolation = _interpolation(kind, spectrum, elastic_energy, usual)
    parts = {setting: _parts(interpolation, setting, value) for setting, value in values.items()}
    approach, retraction = _combined(parts, size * interpolation.independent)
    return elastic_energy * approach, elastic_energy * retraction


def _combined(parts: Mapping[SettingName, Array], size: float) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) of all settings; a part is (bias or scatter, branch)."""
    lowered = [bias for setting, (bias, _) in parts.items() if setting in get_args(Interpolation)]
    raised = [
        bias for setting, (bias, _) in parts.items() if setting not in get_args(Interpolation)
    ]
    bias = np.maximum(sum(lowered), sum(raised))
    scatter = np.sqrt(sum(scatter**2 for _, scatter in parts.values()) * LAW_SIZE / size)
    approach, retraction = np.hypot(bias, scatter)
    return float(approach), float(retraction)


def _parts(interpolation: _Interpolation, setting: SettingName, values: ArrayLike) -> Array:
    """Errors at values of a setting, (bias or scatter, branch, values) (Units: e_el)."""
    # Errors are interpolated, not their logarithms: the geometric mean with a bias of 0 is 0.
    branches = [
        np.tensordot(
            [part for _, part in interpolation.shapes],
            [
                _largest(_laws()[shape, setting, branch], interpolation, values)
                for shape, _ in interpolation.shapes
            ],
            axes=1,
        )
        for branch in (1, -1)
    ]
    return np.stack(branches, axis=1)


def _largest(laws: Sequence[ErrorLaw], interpolation: _Interpolation, values: ArrayLike) -> Array:
    """Bias and scatter of one shape, the largest among the amplitudes of an interpolation."""
    return _largest_between(laws, np.array([law.parts(values) for law in laws]), interpolation)


def _largest_between(
    laws: Sequence[ErrorLaw], measured: Array, interpolation: _Interpolation
) -> Array:
    """Largest of the values of laws of rising amplitudes, among those of an interpolation."""
    energies = np.array([law.elastic_energy for law in laws])
    between = (energies > interpolation.lowest) & (energies < interpolation.highest)
    amplitudes = np.log([interpolation.lowest, *energies[between], interpolation.highest])
    parts = [np.interp(amplitudes, np.log(energies), row) for row in np.eye(energies.size)]
    return np.max(np.tensordot(np.transpose(parts), measured, axes=1), axis=0)


@functools.cache
def _laws() -> dict[tuple[str, SettingName, int], list[ErrorLaw]]:
    """All laws by shape, setting and direction, with increasing amplitudes."""
    found: dict[tuple[str, SettingName, int], list[ErrorLaw]] = {}
    for law in sorted(read_laws(), key=lambda law: law.elastic_energy):
        found.setdefault((law.shape, law.setting, law.direction), []).append(law)
    return found


def read_laws() -> Iterator[ErrorLaw]:
    """Laws that come with the package."""
    with files("crackfront.simulate").joinpath("laws.csv").open(encoding="utf-8") as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            yield ErrorLaw(
                row["shape"],
                float(row["elastic_energy"]),
                cast(SettingName, row["setting"]),
                int(row["direction"]),
                (float(row["bias_0"]), float(row["bias_1"])),
                (float(row["scatter_0"]), float(row["scatter_1"])),
                float(row["avalanche"]),
            )


def sphere_size(spectrum: Spectrum) -> float:
    """Size of a sphere's front for which settings are chosen: eight states, mean radius 1.6."""
    return LAW_SIZE * (LAW_CUTOFF / spectrum.short_cutoff)
