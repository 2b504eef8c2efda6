"""Conventions of spectral densities: what the columns are, and how they are normalised."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.options import PsdAbscissa, PsdKind, PsdOptions
from crackfront.measured.tables.parsed_table import Table
from crackfront.surfaces.written_units import is_unit, unit_value

_ABSCISSAS: dict[PsdAbscissa, str] = {
    "frequency": r"^(?!.*angular).*(?:frequenc|\bf(x|_x|r)?\b|\bν\b|cycles|\blines\b)",
    "wavelength": r"wave ?length|\blambda\b|λ",
    "wavevector": r"wave ?(vector|number)|\b[qk](x|_x|r)?\b|angular",
}
"""What headings call the first column."""

_PER_LENGTH: dict[PsdAbscissa, str] = {
    "frequency": r"\b(cycles?|turns?|revolutions?)\b",
    "wavevector": r"\b(rad|radians?)\b",
}
"""What units count per length, by what they are units of."""

_DEGREES = re.compile(r"deg|°|º|arc|grad|[a-z]rad", re.IGNORECASE)
"""Angles of which nobody has waves per length."""

GWYDDION = r"\bpsdf\b|\bw[_ ]?[12rxy₁₂]|\bw\("
"""Headings of Gwyddion, whose densities are per wavevector."""

_NAMES: dict[PsdKind, str] = {
    "1d": "C_1D of profiles",
    "2d": "isotropic C",
    "radial": "radial density",
    "q2d": "q/pi times the isotropic C",
}


@dataclass(frozen=True, slots=True)
class Convention:
    """What both columns of a density are."""

    abscissa: PsdAbscissa
    abscissa_unit: str
    kind: PsdKind
    density_unit: str
    factor: float
    """C, q C or C_1D in SI units over the number in the table."""
    norm: str
    """Sides and norm in words; empty if the kind determines them."""
    assumptions: tuple[str, ...]
    """Sentences on what neither the file nor the options say."""

    def wavevector(self, place: Array) -> Array:
        """Wavevectors of the first column. Shape (n,). (Units: 1 / m)."""
        waves = place * unit_value(
            self.abscissa_unit, "m" if self.abscissa == "wavelength" else "1/m"
        )
        if self.abscissa == "wavevector":
            return waves
        return 2 * np.pi * waves if self.abscissa == "frequency" else 2 * np.pi / waves

    def density(self, value: Array, wavevector: Array) -> Array:
        """C or C_1D of the second column. Shape (n,). (Units: m^4 or m^3)."""
        density = self.factor * value
        return density / wavevector if self.kind in ("radial", "q2d") else density

    def __str__(self) -> str:
        """The convention in words."""
        shown = f"{_NAMES[self.kind]} in {self.density_unit} by {self.abscissa} in "
        return ", ".join(filter(None, (f"{shown}{self.abscissa_unit}", self.norm)))


def stated_convention(series: Table, options: PsdOptions) -> Convention:
    """Convention that the headings of a density and the options state.

    ValueError if something is missing or contradictory; the sentence names the option.
    """
    path, words = series.path, _words(series)
    first, written = _units(series, options)
    abscissa, abscissa_unit = _abscissa(series, first, options)
    density_unit = _density_unit(path, written)
    kind, scale = _kind(path, words, density_unit, options)
    is_per_radian = re.search(_PER_LENGTH["wavevector"], written, re.IGNORECASE) is not None
    if is_per_radian and abscissa != "wavevector" and kind in ("1d", "2d"):
        raise ValueError(
            f"{path}: the density has the unit {written!r}, per radian, and the first column "
            f"is a {abscissa}; name both units, as in --psd-units 1/um,um^3"
        )
    _check_norm(path, kind, abscissa, options)
    factor, norm = _norm(words, kind, abscissa, options, is_per_radian=is_per_radian)
    assumptions: tuple[str, ...] = ()
    if kind == "1d":
        sides = options.psd_sides or _stated_sides(words)
        if sides is None:
            assumptions = (
                f"{path} does not say whether its density is one-sided; it is taken as two-sided, "
                "and --psd-sides one halves e_el.",
            )
        factor /= 2 if sides == "one" else 1
        norm = f"{'one' if sides == 'one' else 'two'}-sided, {norm}"
    elif options.psd_sides is not None:
        raise ValueError(
            f"{path}: its density is of kind {kind}, and only one of kind 1d is one-sided or "
            f"two-sided; leave --psd-sides {options.psd_sides} out"
        )
    return Convention(
        abscissa, abscissa_unit, kind, density_unit, scale * factor, norm, assumptions
    )


def _words(series: Table) -> str:
    """Titles and headings of a density, in lower case."""
    headings = [part for heading in series.headings for part in (heading.text, heading.unit)]
    return " ".join((*series.titles[-2:], *headings)).lower()


def written_unit(series: Table, place: int) -> str:
    """Unit of a column; empty if there is none."""
    return series.headings[place].unit if series.headings else ""


def _units(series: Table, options: PsdOptions) -> tuple[str, str]:
    """Units of both columns, as options name them, or else as they are written."""
    if options.psd_units is None:
        return written_unit(series, 0), written_unit(series, 1)
    units = [unit.strip() for unit in options.psd_units.split(",")]
    if len(units) != 2:
        raise ValueError(
            f"--psd-units is {options.psd_units!r}; write the units of both columns, as in "
            "1/um,um^3"
        )
    return units[0], units[1]


def _abscissa(series: Table, unit: str, options: PsdOptions) -> tuple[PsdAbscissa, str]:
    """What the first column is, and its unit without what it counts."""
    path = series.path
    head = series.headings[0].text.lower() if series.headings else ""
    counted = next(
        (name for name, words in _PER_LENGTH.items() if re.search(words, unit, re.IGNORECASE)), None
    )
    if counted and options.psd_abscissa not in (None, counted):
        raise ValueError(
            f"{path}: the unit of the first column is {unit!r}, which is one of a {counted}; leave "
            f"--psd-abscissa {options.psd_abscissa} out"
        )
    abscissa = counted or options.psd_abscissa
    abscissa = abscissa or next(
        (name for name, pattern in _ABSCISSAS.items() if re.search(pattern, head)), None
    )
    if abscissa is None:
        raise ValueError(
            f"{path} does not say whether its first column is a wavevector 2 pi / wavelength or a "
            f"frequency 1 / wavelength ({head!r}); name it, as in --psd-abscissa wavevector"
        )
    if not unit:
        raise ValueError(
            f"{path} states no unit of its first column; name both, as in --psd-units 1/um,um^3"
        )
    uncounted = _uncounted(unit)
    dimension_of_abscissa = "m" if abscissa == "wavelength" else "1/m"
    if _DEGREES.search(uncounted) or not is_unit(uncounted, dimension_of_abscissa):
        raise ValueError(
            f"{path}: the unit of the first column is {unit!r}, which is not one of a {abscissa}; "
            "name both, as in --psd-units 1/um,um^3"
        )
    return abscissa, uncounted


def _uncounted(unit: str) -> str:
    """A unit without cycles and radians, which pint takes for numbers."""
    return re.sub("|".join(_PER_LENGTH.values()), "1", unit, flags=re.IGNORECASE)


def _density_unit(path: Path, written: str) -> str:
    """Unit of the second column, as lengths alone."""
    unit = _uncounted(written)
    if not unit:
        raise ValueError(
            f"{path} states no unit of its density; name both, as in --psd-units 1/um,um^3"
        )
    if _DEGREES.search(unit) or not dimension(unit, (3, 4)):
        raise ValueError(
            f"{path}: the unit of the density is {unit!r}, neither a length^3 (of profiles) nor a "
            "length^4 (isotropic); name both, as in --psd-units 1/um,um^3"
        )
    return unit


def dimension(unit: str, powers: Sequence[int]) -> int:
    """Power of a length that a unit is; 0 if it is not one of `powers`."""
    return next((power for power in powers if unit and is_unit(unit, f"m^{power}")), 0)


def _kind(path: Path, words: str, unit: str, options: PsdOptions) -> tuple[PsdKind, float]:
    """What the density is of, and its unit in SI."""
    power = dimension(unit, (3, 4))
    written: PsdKind | None = None
    if re.search(r"q\s*/\s*(π|pi)\s*+[×x*]?\s*2d", words):
        written = "q2d"
    elif re.search(r"radial|\bw[_ ]?r\b", words) and power == 3:
        written = "radial"
    kind = options.psd_kind or written or ("1d" if power == 3 else "2d")
    if (kind == "2d") != (power == 4):
        raise ValueError(
            f"{path}: a density of kind {kind} does not have the unit {unit}; name another of "
            f"{', '.join(get_args(PsdKind))} with --psd-kind, or both units with --psd-units"
        )
    return kind, unit_value(unit, f"m^{power}")


def _check_norm(path: Path, kind: PsdKind, abscissa: PsdAbscissa, options: PsdOptions) -> None:
    """Raise where the named norm contradicts the kind of the density or its first column."""
    norm = options.psd_norm
    if norm is not None and kind == "q2d":
        raise ValueError(
            f"{path}: half of the integral of a density of kind q2d over wavevectors is the mean "
            f"square; leave --psd-norm {norm} out, or give another --psd-kind"
        )
    if norm == "1" and abscissa == "frequency":
        raise ValueError(
            f"{path}: the first column is a frequency, and --psd-norm 1 makes the mean square the "
            "integral over wavevectors; give --psd-norm 2pi if it is the integral over "
            "frequencies, or convert the first column to wavevectors"
        )


def _norm(
    words: str,
    kind: PsdKind,
    abscissa: PsdAbscissa,
    options: PsdOptions,
    *,
    is_per_radian: bool,
) -> tuple[float, str]:
    """Factor of C, or of q C, over a density by the norm of this, and the norm in words."""
    if kind == "q2d":
        return math.pi, ""
    if abscissa == "frequency":
        return 1.0, "mean square its integral over frequencies"
    if kind == "radial":
        is_over_wavevectors = abscissa == "wavevector"
    else:
        is_over_wavevectors = is_per_radian or re.search(GWYDDION, words) is not None
    norm = options.psd_norm or ("1" if is_over_wavevectors else "2pi")
    if norm == "1":
        factor = (2 * math.pi) ** (2 if kind == "2d" else 1)
        return factor, "mean square its integral over wavevectors"
    return 1.0, "mean square its integral over wavevectors / 2 pi"


def _stated_sides(words: str) -> str | None:
    """Whether a head says that the density is one-sided or two-sided."""
    sides = re.search(r"\b(one|single|two|double)[- ]sided", words)
    if sides is not None:
        return "one" if sides[1] in ("one", "single") else "two"
    # Programs whose convention is known.
    return "two" if re.search(rf"1d psd along|{GWYDDION}", words) else None
