r"""Measured laws of the errors that the numerics leave in w_appr and w_retr, read from `laws.csv`.

`python -m studies accuracy report` fits the laws to measured errors and writes `laws.csv`. An error
concerns the mean apparent work of adhesion of one branch, in units of e_el, and thus its factor k.
It has a bias, equal on all surfaces, and a scatter, from avalanches that one discretisation
triggers and another does not; the scatter falls with the root of the cutoffs crossed, the number of
cutoffs along the front times the number of its states. Each setting has a law of its own,

.. math:: \log e = c_0 + c_1 x,

where x is the number of sites per short cutoff (the front is smooth, so that the error falls
exponentially), or the logarithm of samples, pixels or tolerance.
:mod:`crackfront.simulate.law_interpolation` evaluates the laws for other spectra and amplitudes.
"""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from typing import Literal, cast, get_args

import numpy as np
from numpy.typing import ArrayLike

from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum

LAW_CUTOFFS = 4000.0
"""Cutoffs crossed by the fronts on which the laws were measured: number of states times
circumference over the short cutoff, for eight states, cutoff 0.02 and mean radius 1.6."""

LAW_CUTOFF = 0.02
"""Short cutoff of all spectra of the laws. (Units: reduced lateral length)"""

SettingName = Literal["sites", "cubic", "linear", "pixels", "tolerance"]
SETTINGS: tuple[SettingName, ...] = get_args(SettingName)

MEASURED: dict[str, tuple[FieldKind, SelfAffineSpectrum]] = {
    "chemical": ("chemical", SelfAffineSpectrum(0.02, 0.02, 1.0)),
    "flat": ("roughness", SelfAffineSpectrum(0.02, 0.02, 1.0)),
    "h03": ("roughness", SelfAffineSpectrum(0.02, 0.4, 0.3)),
    "h08": ("roughness", SelfAffineSpectrum(0.02, 0.32, 0.8)),
}
"""Shapes of the laws, and the spectra on which they were measured."""


@dataclass(frozen=True, slots=True)
class ErrorLaw:
    """Error of one setting for one shape of spectrum, one amplitude and one branch."""

    shape: str
    """Shape of the spectrum, a name in :data:`MEASURED`."""
    elastic_energy: float
    """Amplitude of the surfaces, e_el. (Units: w_int)"""
    setting: SettingName
    """Setting of the numerics that was varied."""
    direction: int
    """+1 for w_appr, -1 for w_retr."""
    bias: tuple[float, float]
    """Coefficients (c_0, c_1) of the logarithm of the bias. (Units: e_el)"""
    scatter: tuple[float, float]
    """Coefficients (c_0, c_1) of the logarithm of the scatter. (Units: e_el)"""

    def parts(self, values: ArrayLike) -> Array:
        """Bias and scatter at values of the setting, for :data:`LAW_CUTOFFS` (Units: e_el)."""
        x = abscissa(self.setting, values)
        return np.array([np.exp(c0 + c1 * x) for c0, c1 in (self.bias, self.scatter)])

    def error(self, value: float, cutoffs: float) -> float:
        """Standard error at a value of the setting, for so many cutoffs crossed (Units: e_el)."""
        bias, scatter = self.parts(value)
        return math.hypot(bias, scatter * math.sqrt(LAW_CUTOFFS / cutoffs))


def abscissa(setting: SettingName, values: ArrayLike) -> Array:
    """Abscissa of a law: sites themselves, else the logarithm."""
    return np.asarray(values, dtype=float) if setting == "sites" else np.log(values)


@functools.cache
def error_laws() -> dict[tuple[str, SettingName, int], list[ErrorLaw]]:
    """All laws by shape, setting and direction, with increasing amplitudes."""
    laws: dict[tuple[str, SettingName, int], list[ErrorLaw]] = {}
    for law in sorted(read_laws(), key=lambda law: law.elastic_energy):
        laws.setdefault((law.shape, law.setting, law.direction), []).append(law)
    return laws


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
            )


def measured_energies() -> tuple[float, float]:
    """Smallest and largest e_el / w_int at which errors were measured."""
    energies = [law.elastic_energy for laws in error_laws().values() for law in laws]
    return min(energies), max(energies)


def sphere_cutoffs(spectrum: Spectrum) -> float:
    """Cutoffs crossed by the front of a usual sphere: eight states, mean radius 1.6."""
    return LAW_CUTOFFS * (LAW_CUTOFF / spectrum.short_cutoff)
