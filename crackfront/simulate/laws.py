r"""How wrong numerics make w_appr and w_retr: measured laws, and the numerics for an asked error.

`crackfront accuracy` measures the laws and writes them to `laws.csv`. An error is that of the mean
apparent work of adhesion of one branch, in units of e_el: that of its factor k. It has a bias,
equal on all surfaces, and a scatter, from avalanches that one discretisation triggers and another
does not; the scatter falls with the root of the size, the number of cutoffs along the front times
the number of its states. Each knob has a law of its own,

.. math:: \log e = c_0 + c_1 x,

where x is the number of sites per short cutoff (the front is smooth, so that the error falls
exponentially), or the logarithm of samples, pixels or tolerance. Errors of different knobs are
added in quadrature.
"""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import FieldKind
from crackfront.core.field.fields import Interpolation
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum

Array = NDArray[np.float64]

Knob = Literal["sites", "cubic", "linear", "pixels", "tolerance"]
KNOBS: tuple[Knob, ...] = get_args(Knob)

LAW_SIZE = 4000.0
"""Size of the fronts on which the laws were measured: states times circumference over the short
cutoff, for eight states, cutoff 0.02 and mean radius 1.6."""

_SHARES: dict[Knob, float] = {"sites": 0.8, "cubic": 0.4, "pixels": 0.35, "tolerance": 0.25}
"""Parts of an asked error, the largest for the costliest knob; their squares sum up to 0.98."""

_BETWEEN = 0.55
"""Hurst exponent between those of the two broad shapes that were measured, 0.8 and 0.3."""

_RANGES: dict[Knob, tuple[float, float]] = {
    "sites": (1.4, 12.0),
    "cubic": (2.5, 16.0),
    "pixels": (2.5, 8.0),
    "tolerance": (1e-9, 1e-3),
}
"""Values that may be chosen."""


@dataclass(frozen=True, slots=True)
class Knobs:
    """What an error decides: the resolution relative to the short cutoff, and the tolerance.

    Attributes
    ----------
    angles : int or None
        Number of sites of the front; where None, `angles_per_cutoff` decides.
    angles_per_cutoff : float
        Sites per short cutoff on the smooth contact's largest circle, rounded up to an even
        product of 2, 3 and 5.
    samples_per_cutoff : float
        Samples per short cutoff along a ray.
    interpolation : {"cubic", "linear"}
        Pieces between samples.
    pixels_per_cutoff : float
        Points of the tile per short cutoff, 2 or more.
    tolerance : float
        Largest force along the motion that may be left, relative to w_int per front length.
    """

    angles: int | None
    angles_per_cutoff: float
    samples_per_cutoff: float
    interpolation: Interpolation
    pixels_per_cutoff: float
    tolerance: float


@dataclass(frozen=True, slots=True)
class Law:
    """Error of one knob for one shape of spectrum, one amplitude and one branch.

    Attributes
    ----------
    shape : str
        Shape of the spectrum, as :func:`spectral_shape` names it.
    direction : {1, -1}
        +1 for w_appr, -1 for w_retr.
    bias, scatter : tuple of float
        Coefficients (c_0, c_1) of the logarithm of both. (Units: e_el)
    """

    shape: str
    elastic_energy: float
    knob: Knob
    direction: int
    bias: tuple[float, float]
    scatter: tuple[float, float]

    def error(self, value: float, size: float) -> float:
        """Standard error at a value of the knob, for a front of a size, in units of e_el."""
        x = abscissa(self.knob, value)
        bias, scatter = (math.exp(c0 + c1 * x) for c0, c1 in (self.bias, self.scatter))
        return math.hypot(bias, scatter * math.sqrt(LAW_SIZE / size))


def abscissa(knob: Knob, value: float) -> float:
    """Abscissa of a law: sites themselves, else the logarithm."""
    return value if knob == "sites" else math.log(value)


def spectral_shape(kind: FieldKind, spectrum: Spectrum) -> str:
    """The measured shape that comes nearest to a spectrum: chemical, flat, h08 or h03."""
    short, long = spectrum.short_cutoff, spectrum.longest_feature
    if long <= 1.5 * short:
        return "flat" if kind == "roughness" else "chemical"
    # The Hurst exponent, or that of the self-affine spectrum with as long a correlation.
    between = SelfAffineSpectrum(short, long, _BETWEEN)
    return "h08" if spectrum.correlation_length > between.correlation_length else "h03"


def chosen_knobs(error: float, kind: FieldKind, spectrum: Spectrum, elastic_energy: float) -> Knobs:
    """Knobs that leave an asked error in w_appr and w_retr: the coarsest that the laws allow.

    Parameters
    ----------
    error : float
        Standard error of the factor k of either branch that the numerics may leave, on fronts of
        :data:`LAW_SIZE`.
    kind : {"roughness", "chemical"}
        What the spectrum describes.
    spectrum : Spectrum
        Its shape.
    elastic_energy : float
        e_el / w_int.
    """
    shape = spectral_shape(kind, spectrum)
    found = {
        knob: _inverse(shape, elastic_energy, knob, share * error)
        for knob, share in _SHARES.items()
    }
    return Knobs(
        angles=None,
        angles_per_cutoff=found["sites"],
        samples_per_cutoff=found["cubic"],
        interpolation="cubic",
        pixels_per_cutoff=found["pixels"],
        tolerance=found["tolerance"],
    )


def combined_error(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    values: Mapping[Knob, float],
    size: float,
) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) that values of all knobs leave (Units: w_int).

    Parameters
    ----------
    kind, spectrum, elastic_energy
        As of :func:`chosen_knobs`.
    values : mapping
        Values of the knobs; of interpolations the one that is used.
    size : float
        Number of states times circumference of the front over the short cutoff.
    """
    shape = spectral_shape(kind, spectrum)
    approach, retraction = (
        elastic_energy
        * math.hypot(
            *(
                _interpolated(shape, elastic_energy, knob, direction, value, size)
                for knob, value in values.items()
            )
        )
        for direction in (1, -1)
    )
    return approach, retraction


@functools.cache
def _inverse(shape: str, elastic_energy: float, knob: Knob, error: float) -> float:
    """Coarsest value of a knob that leaves an error, to two digits."""
    low, high = _RANGES[knob]
    values = np.geomspace(low, high, 400)
    if knob == "tolerance":
        values = values[::-1]
    for value in values:
        worst = max(
            _interpolated(shape, elastic_energy, knob, direction, float(value), LAW_SIZE)
            for direction in (1, -1)
        )
        if worst <= error:
            break
    return float(f"{value:.2g}")


def _interpolated(
    shape: str, elastic_energy: float, knob: Knob, direction: int, value: float, size: float
) -> float:
    """Error between the amplitudes that were measured, and that of the nearest one outside."""
    laws = _laws()[shape, knob, direction]
    measured = np.log([law.elastic_energy for law in laws])
    errors = np.log([law.error(value, size) for law in laws])
    return float(np.exp(np.interp(math.log(elastic_energy), measured, errors)))


@functools.cache
def _laws() -> dict[tuple[str, Knob, int], list[Law]]:
    """All laws by shape, knob and direction, with increasing amplitudes."""
    found: dict[tuple[str, Knob, int], list[Law]] = {}
    for law in sorted(read_laws(), key=lambda law: law.elastic_energy):
        found.setdefault((law.shape, law.knob, law.direction), []).append(law)
    return found


def read_laws() -> Iterator[Law]:
    """Laws that come with the package."""
    with files("crackfront.simulate").joinpath("laws.csv").open(encoding="utf-8") as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            yield Law(
                row["shape"],
                float(row["elastic_energy"]),
                _knob(row["knob"]),
                int(row["direction"]),
                (float(row["bias_0"]), float(row["bias_1"])),
                (float(row["scatter_0"]), float(row["scatter_1"])),
            )


def _knob(name: str) -> Knob:
    """A knob by its name."""
    return next(knob for knob in KNOBS if knob == name)
