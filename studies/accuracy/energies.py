"""Compare e_el of synthetic scans, as instruments distort them, with their known spectra.

Every scan is cut from a larger surface, distorted, written as the file of an instrument, and read
as `crackfront predict` reads it.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.ndimage import grey_dilation

from crackfront.analysis.estimate import REACH, Estimate
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum, TabulatedSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import MeasuredSurface, measured_surface
from studies.accuracy.scans import scanned
from studies.numbers import Number
from studies.tables import Table, make_table

Distortion = Callable[[Array, np.random.Generator], Array]

SEED = 20240229
"""Seed of all scans."""

N_POINT = 192
"""Points along a side of a scan."""

PIXEL = 0.1e-6
"""Distance of the points. (Units: m)"""

SIDE = N_POINT * PIXEL
"""Side of a scan. (Units: m)"""

MEAN_SQUARE = 1e-9
"""Mean square half-derivative of the scanned surface. (Units: m)"""

_LINE_POINTS = 600
"""Points of a line scan."""

_LINES = 3
"""Line scans of a surface."""

ANYWHERE = 1e-3 * PIXEL
"""Short cutoff that stands for an end at any of many wavelengths."""

_ENDS = (1.0, 4.0)
"""Points in the shortest waves of a scan, between which they are drawn."""

_FINER = 2
"""Points of a surface for one point of its scan."""


@dataclass(frozen=True, slots=True)
class Kind:
    """Scans of one spectrum, in m, that are distorted in one way.

    The tile is the number of sides of the scan in the surface that it is cut from. A scan is
    resolved if it contains the scales that matter to e_el; of an oblong one every other column is
    left out, and of one of lines all but some of them. Heights in their standard deviation may be
    shaped into a surface that is not Gaussian, of the same e_el.
    """

    name: str
    spectrum: Spectrum
    distortion: Distortion = lambda heights, rng: heights
    cut_first: bool = False
    """Whether the scan is cut out before it is distorted, by a form or holes of its size."""
    tile: int = 2
    resolved: bool = True
    oblong: bool = False
    is_line: bool = False
    tip_radius: float | None = None
    shaped: Callable[[Array], Array] | None = None

    def truth(self, rng: np.random.Generator) -> Spectrum:
        """The spectrum of a scan, of the same e_el for all.

        A self-affine one without an end of its own ends anywhere that a prediction allows.
        """
        spectrum = self.spectrum
        if isinstance(spectrum, SelfAffineSpectrum) and spectrum.short_cutoff == ANYWHERE:
            end = PIXEL * math.exp(rng.uniform(*np.log(_ENDS)))
            spectrum = replace(spectrum, short_cutoff=end)
        return spectrum.amplified(MEAN_SQUARE / spectrum.mean_square(0.5))


@dataclass(frozen=True, slots=True)
class ScanEnergy:
    """e_el as measured from a scan."""

    ratio: Estimate[float]
    """Relative to the true one."""
    measured_share: float
    """Part of it in the band of trusted waves."""

    @property
    def covers(self) -> bool:
        """Whether the interval contains the truth."""
        return self.ratio.low <= 1 <= self.ratio.high

    @property
    def factor(self) -> float:
        """Factor by which the interval reaches to either side of its middle."""
        return math.sqrt(self.ratio.high / self.ratio.low)


def _filtered(transfer: Callable[[Array], Array]) -> Distortion:
    """Distortion by an optic that transfers each wave of the heights by a factor."""

    def distorted(heights: Array, rng: np.random.Generator) -> Array:
        along = 2 * np.pi * np.fft.fftfreq(len(heights), PIXEL)
        waves = np.fft.fft2(heights) * transfer(np.hypot(along[:, None], along))
        return np.asarray(np.fft.ifft2(waves).real)

    return distorted


def _gaussian(wavevector: Array) -> Array:
    """Transfer of a Gaussian spot with a standard deviation of one pixel."""
    return np.asarray(np.exp(-((wavevector * PIXEL) ** 2) / 2))


def _small_spot(wavevector: Array) -> Array:
    """Transfer of a Gaussian spot with a standard deviation of 0.7 pixels."""
    return np.asarray(np.exp(-((0.7 * wavevector * PIXEL) ** 2) / 2))


def _pupil(wavevector: Array) -> Array:
    """Transfer of a circular pupil that ends at 2.5 pixels."""
    x = np.minimum(wavevector * 2.5 * PIXEL / (2 * np.pi), 1.0)
    return np.asarray(2 / np.pi * (np.arccos(x) - x * np.sqrt(1 - x**2)))


def _dilated(heights: Array, radius: float) -> Array:
    """What a parabolic tip of a radius in m records."""
    reach = math.ceil(math.sqrt(2 * radius * float(np.ptp(heights))) / PIXEL)
    shape = -((PIXEL * np.arange(-reach, reach + 1)) ** 2) / (2 * radius)
    # A paraboloid is the sum of a parabola along each axis, which dilate one after the other.
    along_x = grey_dilation(heights, structure=shape[:, None], mode="wrap")
    return np.asarray(grey_dilation(along_x, structure=shape[None], mode="wrap"))


def _noise(heights: Array, rng: np.random.Generator) -> Array:
    """White noise of a tenth of the rms height, more than short waves have."""
    return heights + 0.1 * heights.std() * rng.standard_normal(heights.shape)


def _weak_noise(heights: Array, rng: np.random.Generator) -> Array:
    """White noise of a twentieth of the rms height."""
    return heights + 0.05 * heights.std() * rng.standard_normal(heights.shape)


def _rows(heights: Array, rng: np.random.Generator) -> Array:
    """An offset of every row, a tenth of the rms height."""
    return heights + 0.1 * heights.std() * rng.standard_normal((1, heights.shape[1]))


def _bow(heights: Array, rng: np.random.Generator) -> Array:
    """Tilt and a bow, which levelling by a paraboloid removes."""
    x = np.linspace(-1, 1, len(heights))
    return heights + 40 * heights.std() * (x[:, None] - x[:, None] ** 2 + 0.7 * x**2)


def _form(heights: Array, rng: np.random.Generator) -> Array:
    """Tilt and a bow of higher orders, which levelling leaves in part."""
    x = np.linspace(-1, 1, len(heights))
    return heights + 40 * heights.std() * (x[:, None] + x**3 - x[:, None] ** 4)


def _holes(heights: Array, rng: np.random.Generator) -> Array:
    """Missing points, single ones and patches."""
    holes = heights.copy()
    holes[rng.uniform(size=holes.shape) < 0.03] = np.nan
    for x, y in rng.integers(0, N_POINT - 12, (4, 2)):
        holes[x : x + 12, y : y + 12] = np.nan
    return holes


def _two_slopes(first: float, then: float) -> TabulatedSpectrum:
    """Spectrum whose long and short waves have a Hurst exponent each."""
    lengths = SIDE / 8, SIDE / 32, 2 * PIXEL
    middle = 4.0 ** (-2 - 2 * first)
    last = middle * (lengths[1] / lengths[2]) ** (-2 - 2 * then)
    return TabulatedSpectrum(lengths, (1.0, middle, last))


def _self_affine(hurst: float, roll_off: float = SIDE / 8, points: float | None = None) -> Spectrum:
    """A self-affine spectrum whose shortest waves have some points, or any number."""
    return SelfAffineSpectrum(points * PIXEL if points else ANYWHERE, roll_off, hurst)


FILM = _self_affine(0.8)
KINDS = (
    Kind("self-affine, H = 0.8", FILM),
    Kind("self-affine, H = 1", _self_affine(1.0)),
    Kind("self-affine, H = 0.4", _self_affine(0.4), resolved=False),
    Kind("two slopes, H = 0.9 and 0.3", _two_slopes(0.9, 0.3)),
    Kind("two slopes, H = 0.3 and 0.9", _two_slopes(0.3, 0.9)),
    Kind("roll-off at the side", _self_affine(0.8, SIDE), tile=4, resolved=False),
    Kind("roll-off outside", _self_affine(0.8, 2 * SIDE), tile=6, resolved=False),
    Kind("end at four pixels", _self_affine(0.8, points=4.0)),
    Kind("optic, Gaussian", FILM, _filtered(_gaussian)),
    Kind("optic, circular pupil", FILM, _filtered(_pupil), resolved=False),
    Kind("tip of 1 um", FILM, tip_radius=1e-6),
    Kind("noise", FILM, _noise),
    Kind("rows that are shifted", FILM, _rows),
    Kind("tilt and bow", FILM, _bow, cut_first=True),
    Kind("form that is left", FILM, _form, cut_first=True),
    Kind("missing points", FILM, _holes, cut_first=True),
    Kind("oblong pixels", _self_affine(0.8, points=4.0), oblong=True),
    Kind("three line scans", _self_affine(0.8), is_line=True),
    Kind("tip of 3 um, H = 0.4", _self_affine(0.4), resolved=False, tip_radius=3e-6),
    Kind("tip of 10 um, H = 0.4", _self_affine(0.4), resolved=False, tip_radius=10e-6),
    Kind("plateau-honed", FILM, shaped=lambda heights: np.minimum(heights, 0.3)),
    Kind("particles", FILM, shaped=lambda heights: np.maximum(heights, 0.3)),
    Kind("deep scratches", FILM, shaped=lambda heights: -np.exp(-heights / 2)),
    Kind("deep scratches, tip of 1 um", FILM, tip_radius=1e-6, shaped=lambda h: -np.exp(-h / 2)),
)

ROLL_OFFS = tuple(
    Kind(
        f"roll-off {name}, H = {hurst:g}",
        _self_affine(hurst, sides * SIDE),
        tile=tile,
        resolved=False,
    )
    for hurst in (0.5, 0.8, 1.0)
    for name, sides, tile in (
        ("of a third of the side", 1 / 3, 3),
        ("of half a side", 1 / 2, 4),
        ("of the side", 1.0, 4),
        ("of two sides", 2.0, 6),
    )
)
"""Scans that hardly show their roll-off: by these its prior was chosen."""

HELD_OUT = (
    Kind("H = 0.8, end at two points", _self_affine(0.8, points=2.0)),
    Kind("H = 0.6, end at three pixels", _self_affine(0.6, SIDE / 12, 3.0)),
    Kind("H = 0.9, roll-off at a fifth", _self_affine(0.9, SIDE / 5)),
    Kind("H = 0.7, noise of 5%", _self_affine(0.7, SIDE / 16), _weak_noise),
    Kind("H = 0.5, rows that are shifted", _self_affine(0.5, SIDE / 6), _rows),
    Kind("H = 0.7, tip of 2 um", _self_affine(0.7, SIDE / 10), tip_radius=2e-6),
    Kind("H = 0.9, Gaussian spot", _self_affine(0.9, SIDE / 10), _filtered(_small_spot)),
    Kind("H = 0.8, roll-off of 1.5 sides", _self_affine(0.8, 1.5 * SIDE), tile=5, resolved=False),
    Kind("H = 0.7, scratches", _self_affine(0.7, SIDE / 10), shaped=lambda h: -np.exp(-h / 3)),
    Kind("H = 0.6, three line scans", _self_affine(0.6, SIDE / 10), is_line=True),
    Kind("H = 0.9, missing points", _self_affine(0.9), _holes, cut_first=True),
    Kind("two slopes, H = 0.7 and 1", _two_slopes(0.7, 1.0)),
)
"""Scans that had no part in any choice."""

_HARDEST = "roll-off of two sides, H = 1"
"""Kind of scans whose intervals contain the truth least often."""


def synthetic_surface(kind: Kind, number: int) -> MeasuredSurface:
    """Surface of a scan of a kind, as `crackfront predict` evaluates it."""
    key = _key(kind, number)
    rng = np.random.default_rng(np.random.SeedSequence(SEED, spawn_key=key))
    return _lines(kind, rng) if kind.is_line else _map(kind, rng)


def scan_energy(surface: MeasuredSurface) -> ScanEnergy:
    """e_el of a synthetic surface."""
    ratio = surface.half_derivative.each(lambda value: value / MEAN_SQUARE)
    return ScanEnergy(ratio, float(surface.joint.shares.measured))


def _key(kind: Kind, number: int) -> tuple[int, ...]:
    """Key of the seed of a scan."""
    if kind in KINDS:
        return KINDS.index(kind), number
    if kind in ROLL_OFFS:
        return 1, ROLL_OFFS.index(kind), number
    return 2, HELD_OUT.index(kind), number


def _map(kind: Kind, rng: np.random.Generator) -> MeasuredSurface:
    """Measured surface of a distorted map, cut from a larger one."""
    whole = _FINER * kind.tile * N_POINT
    heights = gaussian_field(kind.truth(rng), whole, kind.tile * SIDE, rng)[::_FINER, ::_FINER]
    if kind.shaped:
        shaped = kind.shaped(heights / heights.std())
        heights = shaped * math.sqrt(_relative_energy(heights) / _relative_energy(shaped))
    if kind.cut_first:
        heights = heights[:N_POINT, :N_POINT]
    if kind.tip_radius:
        heights = _dilated(heights, kind.tip_radius)
    heights = kind.distortion(heights, rng)[:N_POINT, :N_POINT]
    if kind.oblong:
        return scanned(heights[:, ::2], (PIXEL, 2 * PIXEL), kind.name)
    return scanned(heights, PIXEL, kind.name, kind.tip_radius)


def _relative_energy(heights: Array) -> float:
    """e_el of periodic heights, in a unit that is the same for all."""
    return rough_adhesion(1e-9 * heights, SIDE).e_el


def _lines(kind: Kind, rng: np.random.Generator) -> MeasuredSurface:
    """Measured surface of parallel line scans."""
    whole = 2 * _LINE_POINTS
    heights = gaussian_field(kind.truth(rng), _FINER * whole, whole * PIXEL, rng)
    heights = heights[: _FINER * _LINE_POINTS : _FINER, ::_FINER]
    places = PIXEL * np.arange(_LINE_POINTS)
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{number}.xyz" for number in range(_LINES)]
        for number, path in enumerate(paths):
            line = heights[:, number * whole // _LINES]
            np.savetxt(path, 1e6 * np.column_stack([places, line]))
        return measured_surface(read_measurements(paths, ReadingOptions(unit="um")))


def energy_table(energies: Mapping[Kind, Sequence[ScanEnergy]]) -> Table:
    """e_el of all scans relative to the true one, and how often the intervals contain it."""
    rows = []
    for kind, scans in energies.items():
        ratios = _ratios(scans)
        factor = np.median([scan.factor for scan in scans])
        measured = np.median([scan.measured_share for scan in scans])
        resolved = "yes" if kind.resolved else "no"
        rows.append(
            f"{kind.name} | {resolved} | {np.median(ratios):.2f} | "
            f"{100 * np.median(np.abs(ratios - 1)):.0f} | {100 * _coverage(scans):.0f} | "
            f"{factor:.2f} | {100 * measured:.0f}"
        )
    all_scans = [scan for scans in energies.values() for scan in scans]
    ratios = _ratios(all_scans)
    return make_table(
        "scans | resolved | e_el found / true | median error % | intervals that contain it % "
        "| factor of the interval | e_el measured %",
        rows,
        f"{len(all_scans)} scans: median error {np.median(np.abs(ratios - 1)):.0%}, "
        f"geometric mean of found / true {np.exp(np.mean(np.log(ratios))):.2f}, "
        f"{_coverage(all_scans):.1%} of the intervals contain the true value",
    )


def _ratios(scans: Sequence[ScanEnergy]) -> Array:
    """e_el of scans over the true one."""
    return np.array([scan.ratio.value for scan in scans])


def _coverage(scans: Sequence[ScanEnergy]) -> float:
    """Share of the intervals that contain the truth."""
    return float(np.mean([scan.covers for scan in scans]))


def hardest_coverage(energies: Mapping[Kind, Sequence[ScanEnergy]]) -> Number:
    """Share of the intervals that contain the truth, of the scans that show their roll-off least.

    The error is half of the 95% interval of the binomial distribution, taken as normal.
    """
    (scans,) = (scans for kind, scans in energies.items() if kind.name == _HARDEST)
    share = _coverage(scans)
    return Number(share, REACH * math.sqrt(share * (1 - share) / len(scans)))
