"""Power spectra of rough surfaces and the rms of any derivative that follows from them.

Shapes are isotropic; an :class:`AnisotropicSpectrum` stretches one of them.
"""

from __future__ import annotations

import math
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

import numpy as np
import scipy
from numpy.typing import ArrayLike
from scipy.special import beta, betainc

from crackfront.core.arguments import check_numbers, check_positive
from crackfront.core.arrays import Array
from crackfront.core.units import CONTACT_MODULUS

ENSEMBLE = "ensemble"
"""Key next to the parameters of a spectrum: a description of surfaces that are not Gaussian."""


class Spectrum(ABC):
    """2D spectrum of a rough surface: what any shape has in common.

    A shape is a frozen dataclass with a `short_cutoff`, beyond which it is zero, and the methods
    that are abstract here. It says which of its fields are lengths, pure numbers and amplitudes;
    files, seeds, keys and units follow from these names, which no two shapes share.
    """

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def short_cutoff(self) -> float:
            """Shortest wavelength (Units: length); a field or a property of each shape."""

    is_isotropic: ClassVar[bool] = True
    """Whether waves in all directions have the same density; the law of k needs it."""

    lengths: ClassVar[tuple[str, ...]] = ("short_cutoff",)
    numbers: ClassVar[tuple[str, ...]] = ()
    amplitudes: ClassVar[tuple[str, ...]] = ("plateau",)

    _shapes: ClassVar[dict[str, type[Spectrum]]] = {}

    def __init_subclass__(cls) -> None:
        if cls.lengths:
            Spectrum._shapes[cls.__name__] = cls

    @staticmethod
    def stated(parameters: Mapping[str, Any]) -> Spectrum | None:
        """Spectrum whose parameters, numbers or arrays, are stated by their names; else None."""
        # A shape with few parameters may have them in common with a shape that has more.
        shapes = sorted(
            Spectrum._shapes.values(), key=lambda shape: len(shape._names()), reverse=True
        )
        for shape in shapes:
            if parameters.keys() >= {*shape._names()}:
                return _stretched(shape._with_parameters(parameters), parameters)
        return None

    @classmethod
    def _with_parameters(cls, parameters: Mapping[str, Any]) -> Spectrum:
        """The shape with parameters, numbers or arrays, by their names."""
        values = []
        for name in cls._names():
            value = np.asarray(parameters[name], float).tolist()
            values.append(tuple(value) if isinstance(value, list) else value)
        return cls(*values)

    @staticmethod
    def length_names() -> set[str]:
        """Names of the lengths of all shapes."""
        return {name for shape in Spectrum._shapes.values() for name in shape.lengths}

    @classmethod
    def _names(cls) -> tuple[str, ...]:
        """Names of the parameters."""
        return *cls.lengths, *cls.numbers

    @property
    def parameters(self) -> dict[str, float | Array]:
        """Lengths and pure numbers by their names, from which :meth:`stated` makes the shape."""
        values = {name: getattr(self, name) for name in self._names()}
        return {
            name: np.array(value) if isinstance(value, tuple) else value
            for name, value in values.items()
        }

    @property
    def identity(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lengths and pure numbers that differ between shapes, but not with the amplitude."""
        lengths, numbers = (
            tuple(float(value) for name in names for value in np.ravel(getattr(self, name)))
            for names in (self.lengths, self.numbers)
        )
        return lengths, (*numbers, float(zlib.crc32(type(self).__name__.encode())))

    @abstractmethod
    def density(self, wavevector: ArrayLike) -> Array:
        """Spectral density C(q) at q >= 0, zero beyond q_s; of anisotropic ones the mean.

        (Units: length**4 for heights, 1 / length for the wavevector)
        """

    def density_of_modes(self, step: float, along_x: ArrayLike, along_y: ArrayLike) -> Array:
        """Spectral density of wavevectors with components of so many steps along x and y."""
        return self.density(step * np.hypot(along_x, along_y))

    @abstractmethod
    def mean_square(self, order: float) -> float:
        r"""Mean square of the derivative of a given order.

        .. math:: (h^{(\alpha)}_{rms})^2 = \frac{1}{4\pi^2} \int d^2q\, q^{2\alpha} C(q)

        The order alpha is 0 for heights, 1/2 for the half-derivative, 1 for slopes.
        (Units: density / length**(2 + 2 * order))
        """

    def longer_than(self, wavelength: float) -> Self:
        """Part of the spectrum with wavelengths above one that is not below the short cutoff."""
        return self._with(("short_cutoff",), lambda _: wavelength)

    def in_units(self, length: float) -> Self:
        """The spectrum with its lengths divided by a unit, and the density as it is."""
        return self._with(self.lengths, lambda value: value / length)

    def amplified(self, factor: float) -> Self:
        """The spectrum with its density multiplied by a factor."""
        return self._with(self.amplitudes, lambda value: value * factor)

    def _with(self, names: Sequence[str], change: Callable[[float], float]) -> Self:
        """Copy with every number of some fields changed."""
        changed = {}
        for name in names:
            value = getattr(self, name)
            changed[name] = tuple(map(change, value)) if isinstance(value, tuple) else change(value)
        return cast(Self, replace(cast(Any, self), **changed))

    @property
    def longest_feature(self) -> float:
        """Wavelength above which the spectrum adds little to w_loc, for the side of tiles."""
        return self.dominant_wavelengths(0.5)[1]

    def dominant_wavelengths(self, order: float, share: float = 0.8) -> tuple[float, float]:
        """Shortest and longest wavelength of the range that carries a share of a mean square.

        The mean square is as in :meth:`mean_square`. Half of the remaining share lies at shorter
        wavelengths, the other half at longer ones.
        """
        total = self.mean_square(order)
        share_outside = (1 - share) / 2

        def wavelength_above_which(part: float) -> float:
            def excess(logarithm: float) -> float:
                return self.longer_than(math.exp(logarithm)).mean_square(order) / total - part

            low = math.log(self.short_cutoff) + 1e-14
            high = low + 1.0
            while excess(high) > 0:
                high += 1.0
            return math.exp(scipy.optimize.brentq(excess, low, high, xtol=1e-13))

        return wavelength_above_which(1 - share_outside), wavelength_above_which(share_outside)

    def mean_square_between(self, order: float, shortest: float, longest: float) -> float:
        """Part of :meth:`mean_square` of the waves between two wavelengths (Units: length)."""
        ends = (max(end, self.short_cutoff) for end in (shortest, longest))
        inner, outer = (self.longer_than(end).mean_square(order) for end in ends)
        return inner - outer

    @property
    def elastic_energy(self) -> float:
        """Energy of full conformity of heights, e_el = E'/4 [h_rms^(1/2)]^2, in units of w_int."""
        return math.pi * CONTACT_MODULUS / 4 * self.mean_square(0.5)

    @property
    def correlation_length(self) -> float:
        """Correlation length of w_loc if the spectrum describes heights (Units: length).

        For fields of any kind: :func:`crackfront.core.adhesion.correlation_length`.
        """
        return 2 * math.pi * self.mean_square(0.5) / self.mean_square(1.0)

    def with_elastic_energy(self, elastic_energy: float) -> Self:
        """Same shape, scaled to an energy of full conformity (in units of w_int)."""
        return self.amplified(elastic_energy / self.elastic_energy)


@dataclass(frozen=True, slots=True)
class SelfAffineSpectrum(Spectrum):
    r"""Isotropic 2D spectrum: flat to q_r, falling as q^(-2-2H) to q_s, zero beyond.

    Parameters
    ----------
    short_cutoff : float
        Shortest wavelength lambda_s = 2 pi / q_s. (Units: length)
    roll_off : float
        Roll-off wavelength lambda_r = 2 pi / q_r; equal to `short_cutoff` for a flat spectrum.
        (Units: length)
    hurst : float
        Hurst exponent H in (0, 1]; without effect on a flat spectrum.
    plateau : float, optional
        Value C_0 below the roll-off. (Units: length**4 for heights)

    Raises
    ------
    TypeError
        If one of them is not a number.
    ValueError
        If a length is not positive, the roll-off is shorter than the cutoff, or H is outside
        (0, 1].

    References
    ----------
    .. [1] Jacobs, Junge, Pastewka, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017).

    Examples
    --------
    >>> flat = SelfAffineSpectrum(short_cutoff=0.02, roll_off=0.02, hurst=0.8)
    >>> round(flat.with_elastic_energy(0.05).elastic_energy, 12)
    0.05
    """

    lengths: ClassVar[tuple[str, ...]] = ("short_cutoff", "roll_off")
    numbers: ClassVar[tuple[str, ...]] = ("hurst",)

    short_cutoff: float
    roll_off: float
    hurst: float
    plateau: float = 1.0

    def __post_init__(self) -> None:
        numbers = asdict(self)
        check_numbers(**numbers)
        hurst = numbers.pop("hurst")
        check_positive(**numbers)
        if self.roll_off < self.short_cutoff:
            raise ValueError(
                f"roll_off {self.roll_off} is shorter than short_cutoff {self.short_cutoff}; "
                "lower the cutoff or raise the roll-off (equal values give a flat spectrum)"
            )
        if not 0 < hurst <= 1:
            raise ValueError(f"hurst is {hurst}; it must lie in (0, 1]")

    @property
    def identity(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lengths and pure numbers of the shape."""
        return (self.short_cutoff, self.roll_off), (self.hurst,)

    @property
    def longest_feature(self) -> float:
        """The roll-off."""
        return self.roll_off

    def density(self, wavevector: ArrayLike) -> Array:
        """Spectral density C(q)."""
        # A mode on the cutoff itself counts whatever the round-off of its q.
        q = np.asarray(wavevector, dtype=float) * self.roll_off / (2 * np.pi)
        falling = self.plateau * np.maximum(q, 1.0) ** (-2 - 2 * self.hurst)
        return np.where(q <= self.roll_off / self.short_cutoff * (1 + 1e-12), falling, 0.0)

    def mean_square(self, order: float) -> float:
        """Mean square of the derivative of a given order, in closed form."""
        knee, cutoff = 2 * math.pi / self.roll_off, 2 * math.pi / self.short_cutoff
        exponent = 2 * (order - self.hurst)
        growth = math.log(cutoff / knee)
        # expm1(x L) / x tends to the logarithm L where order and Hurst exponent agree.
        tail = growth if exponent == 0 else math.expm1(exponent * growth) / exponent
        moment = knee ** (2 + 2 * order) * (1 / (2 + 2 * order) + tail)
        return self.plateau * moment / (2 * math.pi)

    def profile_density(self, wavevector: ArrayLike) -> Array:
        r"""Spectral density of a profile along a line (1D PSD), the projection of C.

        .. math:: C_{1D}(q) = \frac{1}{2\pi} \int dk\, C(\sqrt{q^2 + k^2})

        Parameters
        ----------
        wavevector : array_like
            Magnitude q > 0. (Units: 1 / length)

        Returns
        -------
        array
            C_1D(q); the mean square height is its integral over q > 0, divided by pi.
            (Units: density / length)
        """
        q = np.asarray(wavevector, dtype=float)
        knee, cutoff = 2 * math.pi / self.roll_off, 2 * math.pi / self.short_cutoff
        on_plateau = np.sqrt(np.maximum(knee**2 - q**2, 0.0))
        # With k = q tan(phi) the tail is an incomplete beta function, here of its complement.
        power = self.hurst + 0.5
        beyond_knee, beyond_cutoff = (
            betainc(power, 0.5, np.minimum((q / limit) ** 2, 1.0)) for limit in (knee, cutoff)
        )
        tail = knee * (knee / q) ** (2 * power) * beta(power, 0.5) / 2
        return self.plateau / np.pi * (on_plateau + tail * (beyond_knee - beyond_cutoff))

    def longer_than(self, wavelength: float) -> SelfAffineSpectrum:
        """Part of the spectrum with wavelengths above one that is not below the short cutoff."""
        return replace(self, short_cutoff=wavelength, roll_off=max(self.roll_off, wavelength))


@dataclass(frozen=True, slots=True)
class TabulatedSpectrum(Spectrum):
    """Isotropic 2D spectrum by its values at some wavelengths, as of a measurement.

    The spectrum is flat above the longest wavelength, a power law between neighbours, and zero
    below the shortest.

    Parameters
    ----------
    wavelengths : (n,) array_like
        Two or more wavelengths, from long to short; stored as a tuple. (Units: length)
    densities : (n,) array_like
        Values of C there; stored as a tuple. (Units: length**4 for heights)

    Raises
    ------
    TypeError
        If one of them is not a sequence of numbers.
    ValueError
        If a number is not positive and finite, the wavelengths do not fall, or there are not as
        many densities as wavelengths.

    Examples
    --------
    >>> wavelengths = np.array([0.5, 0.02])
    >>> table = TabulatedSpectrum(wavelengths, (wavelengths / 0.5) ** 3.6)
    >>> fractal = SelfAffineSpectrum(short_cutoff=0.02, roll_off=0.5, hurst=0.8)
    >>> round(table.elastic_energy / fractal.elastic_energy, 12)
    1.0
    """

    lengths: ClassVar[tuple[str, ...]] = ("wavelengths",)
    numbers: ClassVar[tuple[str, ...]] = ("densities",)
    amplitudes: ClassVar[tuple[str, ...]] = ("densities",)

    wavelengths: tuple[float, ...]
    densities: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("wavelengths", "densities"):
            values = _numbers(name, getattr(self, name))
            for value in values:
                if not (math.isfinite(value) and value > 0):
                    raise ValueError(f"{name} contain {value}; they must be positive and finite")
            object.__setattr__(self, name, values)
        if len(self.wavelengths) < 2 or len(self.wavelengths) != len(self.densities):
            raise ValueError(
                f"{len(self.wavelengths)} wavelengths and {len(self.densities)} densities make no "
                "table; give two or more of each"
            )
        if not np.all(np.diff(self.wavelengths) < 0):
            raise ValueError("the wavelengths of a table must fall; order them from long to short")

    @property
    def short_cutoff(self) -> float:
        """Shortest wavelength (Units: length)."""
        return self.wavelengths[-1]

    @property
    def identity(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Wavelengths, and densities relative to the first."""
        return self.wavelengths, tuple(value / self.densities[0] for value in self.densities)

    def density(self, wavevector: ArrayLike) -> Array:
        """Spectral density C(q)."""
        q = np.asarray(wavevector, dtype=float) * self.short_cutoff / (2 * np.pi)
        places = -np.log(np.array(self.wavelengths) / self.short_cutoff)
        # Far below the first wavelength all is flat; the logarithm needs a number.
        log_density = np.interp(
            np.log(np.maximum(q, math.exp(places[0]))), places, np.log(self.densities)
        )
        return np.where(q <= 1 + 1e-12, np.exp(log_density), 0.0)

    def mean_square(self, order: float) -> float:
        """Mean square of the derivative of a given order, exact for the pieces."""
        wavevector, densities = 2 * np.pi / np.array(self.wavelengths), np.array(self.densities)
        power = 2 + 2 * order
        growth = np.diff(np.log(wavevector))
        exponent = power * growth + np.diff(np.log(densities))
        # expm1(x) / x tends to 1 where the integrand is flat.
        near = np.abs(exponent) < 1e-9
        mean = np.where(near, 1.0, np.expm1(exponent) / np.where(near, 1.0, exponent))
        pieces = densities[:-1] * wavevector[:-1] ** power * growth * mean
        below = densities[0] * wavevector[0] ** power / power
        return float(below + np.sum(pieces)) / (2 * math.pi)

    def longer_than(self, wavelength: float) -> TabulatedSpectrum:
        """Part of the spectrum with wavelengths above one that is not below the short cutoff."""
        longer = [length for length in self.wavelengths if length > wavelength * (1 + 1e-12)]
        if not longer:
            longer = [2 * wavelength]
        end = float(self.density(2 * np.pi / wavelength))
        # If all of it is flat, the first density applies at any longer wavelength as well.
        values = (self.densities[0], *self.densities[1 : len(longer)], end)
        return TabulatedSpectrum((*longer, wavelength), values)


@dataclass(frozen=True, slots=True)
class AnisotropicSpectrum(Spectrum):
    r"""A spectrum whose waves are longer along one direction than across it, as of grooves.

    .. math:: C(\mathbf q) = C_0\left(\sqrt{r\, q_\parallel^2 + q_\perp^2 / r}\right)

    with the isotropic spectrum C_0, the ratio r, and the components of q along the grooves and
    across them. Lengths along the grooves are r times those across; their geometric mean and the
    mean square height are as of C_0.

    Parameters
    ----------
    shape : Spectrum
        The isotropic spectrum C_0.
    anisotropy : float
        Ratio r of the lengths along and across the grooves, at least 1.
    anisotropy_angle : float, optional
        Angle from x to the grooves. (Units: degrees)

    Raises
    ------
    TypeError
        If the ratio or the angle is not a number.
    ValueError
        If the ratio is below 1, or the shape is stretched already.

    Examples
    --------
    >>> flat = SelfAffineSpectrum(short_cutoff=0.02, roll_off=0.02, hurst=1.0)
    >>> grooves = AnisotropicSpectrum(flat, anisotropy=4.0)
    >>> grooves.short_cutoff, grooves.longest_feature
    (0.01, 0.04)
    >>> round(grooves.mean_square(0.0) / flat.mean_square(0.0), 12)
    1.0
    """

    is_isotropic: ClassVar[bool] = False
    lengths: ClassVar[tuple[str, ...]] = ()
    numbers: ClassVar[tuple[str, ...]] = ("anisotropy", "anisotropy_angle")

    shape: Spectrum
    anisotropy: float
    anisotropy_angle: float = 0.0

    def __post_init__(self) -> None:
        check_numbers(anisotropy=self.anisotropy, anisotropy_angle=self.anisotropy_angle)
        if not self.shape.is_isotropic:
            raise ValueError("the shape is anisotropic already; stretch an isotropic one")
        if not (1 <= self.anisotropy < math.inf and math.isfinite(self.anisotropy_angle)):
            raise ValueError(
                f"anisotropy is {self.anisotropy} at {self.anisotropy_angle} degrees; the ratio "
                "must be 1 or more and the angle finite: turn the grooves by 90 degrees for less"
            )

    @property
    def short_cutoff(self) -> float:
        """Shortest wavelength, across the grooves (Units: length)."""
        return self.shape.short_cutoff / math.sqrt(self.anisotropy)

    @property
    def longest_feature(self) -> float:
        """Longest wavelength that matters, along the grooves (Units: length)."""
        return self.shape.longest_feature * math.sqrt(self.anisotropy)

    @property
    def parameters(self) -> dict[str, float | Array]:
        """Parameters of the shape, the ratio and the angle."""
        return self.shape.parameters | {name: getattr(self, name) for name in self.numbers}

    @property
    def identity(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lengths of the shape; its pure numbers, the ratio and the angle."""
        lengths, numbers = self.shape.identity
        stretch = self.anisotropy, self.anisotropy_angle
        return lengths, (*numbers, *stretch, float(zlib.crc32(type(self).__name__.encode())))

    def density(self, wavevector: ArrayLike) -> Array:
        """Mean of C over the directions of a wavevector."""
        q = np.asarray(wavevector, dtype=float)
        stretched = (
            self.shape.density(q * root) for root in np.sqrt(self._squared_stretch(_N_ANGLE))
        )
        return np.asarray(sum(stretched) / _N_ANGLE)

    def density_of_modes(self, step: float, along_x: ArrayLike, along_y: ArrayLike) -> Array:
        """Spectral density of wavevectors with components of so many steps along x and y."""
        x, y = np.asarray(along_x, dtype=float), np.asarray(along_y, dtype=float)
        angle, root = math.radians(self.anisotropy_angle), math.sqrt(self.anisotropy)
        along = math.cos(angle) * x + math.sin(angle) * y
        across = math.cos(angle) * y - math.sin(angle) * x
        return self.shape.density(step * np.hypot(root * along, across / root))

    def mean_square(self, order: float) -> float:
        """Mean square of the derivative of a given order."""
        # With p, the stretched wavevector, q^2 = p_along^2 / r + r p_across^2.
        return self.shape.mean_square(order) * float(
            np.mean(self._squared_stretch(_N_EXACT) ** order)
        )

    def longer_than(self, wavelength: float) -> AnisotropicSpectrum:
        """Part of the spectrum whose waves across the grooves are longer."""
        return replace(self, shape=self.shape.longer_than(wavelength * math.sqrt(self.anisotropy)))

    def in_units(self, length: float) -> AnisotropicSpectrum:
        """The spectrum with its lengths divided by a unit, and the density as it is."""
        return replace(self, shape=self.shape.in_units(length))

    def amplified(self, factor: float) -> AnisotropicSpectrum:
        """The spectrum with its density multiplied by a factor."""
        return replace(self, shape=self.shape.amplified(factor))

    def _squared_stretch(self, n_angle: int) -> Array:
        """Squares of wavevectors over squares of stretched ones, at evenly spaced directions."""
        angle = np.pi * (np.arange(n_angle) + 0.5) / n_angle
        return np.cos(angle) ** 2 / self.anisotropy + self.anisotropy * np.sin(angle) ** 2


def _stretched(spectrum: Spectrum, parameters: Mapping[str, Any]) -> Spectrum:
    """A spectrum, stretched if parameters state how."""
    anisotropy, angle = (parameters.get(name) for name in AnisotropicSpectrum.numbers)
    if anisotropy is None or angle is None:
        return spectrum
    return AnisotropicSpectrum(spectrum, float(anisotropy), float(angle))


_N_ANGLE = 180
"""Directions whose mean is the density in figures."""

_N_EXACT = 4096
"""Directions whose mean is exact to round-off, for ratios up to 100."""


def _numbers(name: str, values: ArrayLike) -> tuple[float, ...]:
    """Numbers of an array or a sequence; TypeError if it is something else."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.zeros((0, 0))
    if array.ndim != 1:
        kind = type(values).__name__
        raise TypeError(f"{name} is a {kind}; give one sequence of numbers, as in [0.5, 0.02]")
    return tuple(array.tolist())
