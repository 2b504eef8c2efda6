r"""Spectral densities that other programs have exported, with the convention of each.

All become the isotropic density C or that of profiles C_1D, two-sided over wavevectors, of which
the mean square of the heights is :math:`\int d^2q\,C/4\pi^2` or :math:`\int dq\,C_{1D}/2\pi`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import get_args

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.options import PsdAbscissa, PsdKind, PsdOptions
from crackfront.measured.scan.scan_files import checksum, refuse_unreadable
from crackfront.measured.scan.text import NumberText, number_text
from crackfront.surfaces.written_units import is_unit, unit_value

_BINS_PER_DECADE = 20
"""Bins that values are averaged in, as many as densities of scans have."""

_FEWEST_BINS, _LEAST_RANGE = 3, 2.0
"""Values, and longest over shortest wavelength, that a density needs."""

_ABSCISSAS: dict[PsdAbscissa, str] = {
    "frequency": r"^(?!.*angular).*(?:frequenc|\bf(x|_x|r)?\b|\bν\b|cycles|\blines\b)",
    "wavelength": r"wave ?length|\blambda\b|λ",
    "wavevector": r"wave ?(vector|number)|\b[qk](x|_x|r)?\b|angular",
}
"""What heads call the first column."""

_PER_LENGTH: dict[PsdAbscissa, str] = {
    "frequency": r"\b(cycles?|turns?|revolutions?)\b",
    "wavevector": r"\b(rad|radians?)\b",
}
"""What units count per length, by what they are units of."""

_DEGREES = re.compile(r"deg|°|º|arc|grad|[a-z]rad", re.IGNORECASE)
"""Angles of which nobody has waves per length."""

_GWYDDION = r"\bpsdf\b|\bw[_ ]?[12rxy₁₂]|\bw\("
"""Heads of Gwyddion, whose densities are per wavevector."""

_DENSITY = rf"\bpsd\b|\bc[_ ]?(1d|2d|iso)\b|spectral density|power spectrum|{_GWYDDION}"
"""What heads call the second column."""

_HEIGHTS = r"height|topograph|elevation|position|distance|\b[xz]\b"
"""Heads of line scans."""

_UNIT = re.compile(r"[\[(]\s*([^\[\]()]+(?:\([^()]*\)[^\[\]()]*)?)\s*[\])]|\s/\s*(\S.*)$")
_BRACKETED = re.compile(r"[^\[\]()]*[\[(][^\[\]()]+[\])]")
_UNIT_OF_LENGTH = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]|/\s*([A-Za-zµμ]\S*)\s*$")
_MARKUP = re.compile(r"</?su[bp]>")
_SPLITS = (r";", r"\t", r",", r"\s{2,}", r"\s+")

_MOST_ROWS, _MOST_COLUMNS = 100_000, 8
"""Rows and columns that a text of densities has at most."""

_STEEP, _SPAN, _FEWEST_ROWS = -0.9, 1e3, 8
"""Rank correlation, largest over least value, and rows, from which values are those of a density:
heights of a line neither fall all along nor come so near to zero."""


@dataclass(frozen=True, slots=True)
class Psd:
    """A spectral density of a file, in bins of wavevectors."""

    path: Path
    checksum: str
    """Eight hexadecimal digits of the content of the file."""
    wavevector: Array
    """Geometric means in the bins, increasing. Shape (n,). (Units: 1 / m)"""
    value: Array
    """C, or C_1D. Shape (n,). (Units: m^4 or m^3)"""
    is_profile: bool
    """Whether it is C_1D."""
    convention: str
    """What the columns were taken for, in words."""
    assumptions: tuple[str, ...]
    """Sentences on what neither the file nor the options say."""


@dataclass(frozen=True, slots=True)
class _Series:
    """Rows of numbers without a text between them."""

    name: str
    heads: tuple[str, ...]
    below: tuple[str, ...]
    """Units where a line of its own has them."""
    text: str
    """All lines of the head, in lower case."""
    numbers: Array
    line: int
    """Number of its first row."""


def read_psd_file(path: Path, options: PsdOptions) -> Psd:
    """The density of a file of two columns, as programs of surfaces export it.

    ValueError, of one sentence, where it is no density or its convention is not known; OSError if
    the file cannot be opened.
    """
    refuse_unreadable(path)
    text = number_text(path)
    if text is None:
        raise ValueError(f"{path} has no rows of numbers; export the density as text, as CSV")
    one = _chosen(path, list(_series(text)), options.psd_series)
    abscissa, abscissa_unit = _abscissa(path, one, options)
    named = _units(path, options)
    written = named[1] if named else _written_unit(one, 1)
    density_unit = _density_unit(path, written)
    kind, scale = _kind(path, one, density_unit, options)
    assumptions: list[str] = []
    is_per_radian = re.search(_PER_LENGTH["wavevector"], written, re.IGNORECASE) is not None
    if is_per_radian and abscissa != "wavevector" and kind in ("1d", "2d"):
        raise ValueError(
            f"{path}: the density has the unit {written!r}, per radian, and the first column "
            f"is a {abscissa}; name both units, as in --psd-units 1/um,um^3"
        )
    _refuse_other_norm(path, kind, abscissa, options)
    factor, words = _norm(one, kind, abscissa, options, is_per_radian=is_per_radian)
    if kind == "1d":
        sides = options.psd_sides or _stated_sides(one)
        if sides is None:
            assumptions.append(
                f"{path} does not say whether its density is one-sided; it is taken as two-sided, "
                "and --psd-sides one halves e_el."
            )
        factor /= 2 if sides == "one" else 1
        words = f"{'one' if sides == 'one' else 'two'}-sided, {words}"
    elif options.psd_sides is not None:
        raise ValueError(
            f"{path}: its density is of kind {kind}, and only one of kind 1d is one-sided or "
            f"two-sided; leave --psd-sides {options.psd_sides} out"
        )
    place, value = _columns(path, one)
    waves = place * unit_value(abscissa_unit, "m" if abscissa == "wavelength" else "1/m")
    q = {"wavevector": waves, "frequency": 2 * np.pi * waves}.get(abscissa, 2 * np.pi / waves)
    value = scale * factor * value
    if kind in ("radial", "q2d"):
        value = value / q
    q, value = _binned(path, q, value)
    name = {"1d": "C_1D of profiles", "2d": "isotropic C", "radial": "radial density"}
    shown = name.get(kind, "q/pi times the isotropic C")
    return Psd(
        path=path,
        checksum=checksum(path),
        wavevector=q,
        value=value,
        is_profile=kind == "1d",
        convention=", ".join(
            filter(None, (f"{shown} in {density_unit} by {abscissa} in {abscissa_unit}", words))
        ),
        assumptions=tuple(assumptions),
    )


def refuse_spectrum(path: Path, text: NumberText) -> None:
    """Raise where a text of two columns is a spectral density and no line of heights."""
    if len(text.rows) > _MOST_ROWS or not 2 <= text.n_column <= _MOST_COLUMNS:
        return
    named, found = None, [one for one in _series(text) if one.numbers.shape[1] >= 2]
    for one in found:
        heads = " ".join(one.heads[:2]).lower()
        units = [unit for unit in (_written_unit(one, place) for place in (0, 1)) if unit]
        if re.search(_DENSITY, heads) or _dimension(units[-1] if units else "", (3, 4)):
            named = f"its columns are named {' and '.join(map(repr, one.heads[:2]))}"
        elif _looks_like_density(one) and not re.search(_HEIGHTS, heads):
            named = "its values are positive and fall all along, as no heights do"
    if named is not None:
        raise ValueError(
            f"{path} holds a spectral density, no line scan: {named}; predict from it with "
            f"--psd {path}, or name the columns x and z in its head if they are a line"
        )


def column_heads(text: NumberText) -> tuple[tuple[str, str], ...]:
    """Name and unit of every column, as heads have them; nothing where no head has them all."""
    if text.n_column > _MOST_COLUMNS:
        return ()
    lines = [_MARKUP.sub("", line.strip().lstrip("#%! ")) for line in text.head]
    lines = [line for line in lines if line.strip(" -=")]
    heads, below = _heads(lines, text.n_column)
    if not heads and lines:
        # Names and units between blanks alone, as in x [um] z [nm].
        bracketed = tuple(_BRACKETED.findall(lines[-1]))
        heads = bracketed if len(bracketed) == text.n_column else ()
    if below:
        names = heads or ("",) * len(below)
        return tuple((name, unit.strip("[]() ")) for name, unit in zip(names, below, strict=True))
    return tuple((_UNIT_OF_LENGTH.sub("", head).strip(), _unit_of_length(head)) for head in heads)


def _unit_of_length(head: str) -> str:
    """What stands in brackets in the head of a column, or behind a stroke; empty if nothing."""
    found = _UNIT_OF_LENGTH.search(head)
    return (found[1] or found[2]) if found else ""


def _looks_like_density(one: _Series) -> bool:
    """Whether two columns without names fall as densities do."""
    if one.numbers.shape[1] != 2 or len(one.numbers) < _FEWEST_ROWS:
        return False
    place, value = one.numbers[one.numbers[:, 0] > 0].T
    if place.size < _FEWEST_ROWS or not np.all(value > 0) or np.any(one.numbers[:, 0] < 0):
        return False
    ranks = np.argsort(np.argsort([place, value], axis=1), axis=1)
    correlation: Array = np.asarray(np.corrcoef(ranks))
    falls = correlation[0, 1] < _STEEP
    return bool(falls) and float(np.max(value)) > _SPAN * float(np.min(value))


def _series(text: NumberText) -> Iterator[_Series]:
    """Every block of rows, with the heads above it."""
    rows = np.array(text.rows)
    ends = [0, *(np.flatnonzero(_is_new(text, rows)) + 1).tolist(), len(rows)]
    before = 0
    for start, end in pairwise(ends):
        head = [line.strip() for line in text.lines[before : rows[start]]]
        cells = [text.lines[row].split() for row in rows[start:end]]
        width = min(map(len, cells))
        numbers = np.array([line[:width] for line in cells], dtype=float)
        lines = [_MARKUP.sub("", line.lstrip("#%! ")) for line in head]
        lines = [line for line in lines if line.strip(" -=")]
        heads, below = _heads(lines, width)
        n_used = bool(heads) + bool(below)
        titles = lines[: len(lines) - n_used] if n_used else lines
        yield _Series(
            name=titles[-1] if titles else "",
            heads=heads,
            below=below,
            text=" ".join((*titles[-2:], *heads, *below)).lower(),
            numbers=numbers,
            line=int(rows[start]) + 1,
        )
        before = int(rows[end - 1]) + 1


def _is_new(text: NumberText, rows: Array) -> Array:
    """Whether a text, and not blanks alone, stands between a row and the next."""
    return np.array(
        [any(map(str.strip, text.lines[low + 1 : high])) for low, high in pairwise(rows)], bool
    )


def _heads(lines: Sequence[str], width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of columns in the last lines above rows, and units if those have a line below."""
    last = _cells(lines[-1], width) if lines else ()
    if len(lines) > 1 and last and all(_is_bare_unit(cell) for cell in last):
        return _cells(lines[-2], width), last
    return last, ()


def _cells(line: str, width: int) -> tuple[str, ...]:
    """Names in a line, one for each column; none where it has no such number of them."""
    line = re.sub(r"^columns?\s*:\s*", "", line, flags=re.IGNORECASE)
    for split in _SPLITS:
        cells = tuple(cell.strip().strip('"') for cell in re.split(split, line.strip().strip(";")))
        if len(cells) == width and all(cells):
            return cells
    return ()


def _is_bare_unit(cell: str) -> bool:
    """Whether a cell is nothing but a unit, in brackets or not."""
    unit = cell.strip("[]() ")
    return any(is_unit(unit, one) for one in ("1/m", "m", "m^2", "m^3", "m^4"))


def _chosen(path: Path, found: Sequence[_Series], wanted: str | None) -> _Series:
    """The series of a name or number, or the only one."""
    listed = "; ".join(f"{number} {one.name!r}" for number, one in enumerate(found, 1))
    if wanted is None:
        if len(found) > 1:
            raise ValueError(
                f"{path} holds {len(found)} series; choose one by number or name with "
                f"--psd-series: {listed}"
            )
        [one] = found
    else:
        chosen = [one for one in found if one.name == wanted]
        if not chosen and wanted.isdecimal() and 0 < int(wanted) <= len(found):
            chosen = [found[int(wanted) - 1]]
        if len(chosen) != 1:
            raise ValueError(f"{path} has no series {wanted!r}; its series are {listed}")
        [one] = chosen
    others = " ".join(one.heads[2:]).lower()
    n_column = one.numbers.shape[1]
    if n_column < 2 or (n_column > 2 and not re.search(r"err|std|dev|count|number", others)):
        raise ValueError(
            f"{path}, line {one.line}: the rows have {n_column} columns; export one curve, of the "
            "wavevector and the density"
        )
    return one


def _written_unit(one: _Series, place: int) -> str:
    """Unit of a column in its head or below; empty if there is none."""
    if one.below:
        return one.below[place].strip("[]() ")
    found = _UNIT.search(one.heads[place]) if one.heads else None
    return (found[1] or found[2]).strip() if found else ""


def _units(path: Path, options: PsdOptions) -> tuple[str, ...]:
    """Units that options name, of both columns."""
    if options.psd_units is None:
        return ()
    units = tuple(unit.strip() for unit in options.psd_units.split(","))
    if len(units) != 2:
        raise ValueError(
            f"--psd-units is {options.psd_units!r}; write those of both columns, as in 1/um,um^3"
        )
    return units


def _abscissa(path: Path, one: _Series, options: PsdOptions) -> tuple[PsdAbscissa, str]:
    """What the first column is, and its unit."""
    named = _units(path, options)
    unit = named[0] if named else _written_unit(one, 0)
    head = one.heads[0].lower() if one.heads else ""
    counted = next(
        (name for name, words in _PER_LENGTH.items() if re.search(words, unit, re.IGNORECASE)), None
    )
    if counted and options.psd_abscissa not in (None, counted):
        raise ValueError(
            f"{path}: the unit of the first column is {unit!r}, which is one of a {counted}; leave "
            f"--psd-abscissa {options.psd_abscissa} out"
        )
    found = counted or options.psd_abscissa
    found = found or next(
        (name for name, pattern in _ABSCISSAS.items() if re.search(pattern, head)), None
    )
    if found is None:
        raise ValueError(
            f"{path} does not say whether its first column is a wavevector 2 pi / wavelength or a "
            f"frequency 1 / wavelength ({head!r}); name it, as in --psd-abscissa wavevector"
        )
    if not unit:
        raise ValueError(
            f"{path} states no unit of its first column; name both, as in --psd-units 1/um,um^3"
        )
    plain = _uncounted(unit)
    if _DEGREES.search(plain) or not is_unit(plain, "m" if found == "wavelength" else "1/m"):
        raise ValueError(
            f"{path}: the unit of the first column is {unit!r}, none of a {found}; name both, as "
            "in --psd-units 1/um,um^3"
        )
    return found, plain


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
    if _DEGREES.search(unit) or not _dimension(unit, (3, 4)):
        raise ValueError(
            f"{path}: the unit of the density is {unit!r}, neither a length^3 (of profiles) nor a "
            "length^4 (isotropic); name both, as in --psd-units 1/um,um^3"
        )
    return unit


def _dimension(unit: str, powers: Sequence[int]) -> int:
    """Power of a length that a unit is, 0 if none of some powers."""
    return next((power for power in powers if unit and is_unit(unit, f"m^{power}")), 0)


def _kind(path: Path, one: _Series, unit: str, options: PsdOptions) -> tuple[PsdKind, float]:
    """What the density is of, and its unit in SI."""
    power = _dimension(unit, (3, 4))
    stated: PsdKind | None = None
    if re.search(r"q\s*/\s*(π|pi)\s*[×x*]?\s*2d", one.text):
        stated = "q2d"
    elif re.search(r"radial|\bw[_ ]?r\b", one.text) and power == 3:
        stated = "radial"
    found = options.psd_kind or stated or ("1d" if power == 3 else "2d")
    if (found == "2d") != (power == 4):
        raise ValueError(
            f"{path}: a density of kind {found} has no unit {unit}; name another of "
            f"{', '.join(get_args(PsdKind))} with --psd-kind, or both units with --psd-units"
        )
    return found, unit_value(unit, f"m^{power}")


def _refuse_other_norm(
    path: Path, kind: PsdKind, abscissa: PsdAbscissa, options: PsdOptions
) -> None:
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
    one: _Series,
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
        is_over_wavevectors = is_per_radian or re.search(_GWYDDION, one.text) is not None
    norm = options.psd_norm or ("1" if is_over_wavevectors else "2pi")
    if norm == "1":
        factor = (2 * math.pi) ** (2 if kind == "2d" else 1)
        return factor, "mean square its integral over wavevectors"
    return 1.0, "mean square its integral over wavevectors / 2 pi"


def _stated_sides(one: _Series) -> str | None:
    """Whether a head says that the density is one-sided or two-sided."""
    found = re.search(r"\b(one|single|two|double)[- ]sided", one.text)
    if found is not None:
        return "one" if found[1] in ("one", "single") else "two"
    # Programs whose convention is known.
    return "two" if re.search(rf"1d psd along|{_GWYDDION}", one.text) else None


def _columns(path: Path, one: _Series) -> tuple[Array, Array]:
    """Both columns, without rows that have no wave or no value."""
    place, value = one.numbers[:, 0], one.numbers[:, 1]
    known = np.isfinite(value) & np.isfinite(place) & (place != 0)
    for what, column in (("first column", place), ("density", value)):
        bad = np.flatnonzero(known & ~(column > 0))
        if bad.size:
            raise ValueError(
                f"{path}, line {one.line + int(bad[0])}: the {what} is {column[bad[0]]:g}; it must "
                "be positive, so leave the row out or export the density without logarithms"
            )
    return place[known], value[known]


def _binned(path: Path, wavevector: Array, value: Array) -> tuple[Array, Array]:
    """Means in logarithmic bins; refused where there are too few."""
    scale = _BINS_PER_DECADE / math.log(10)
    _, index = np.unique(np.floor(np.log(wavevector) * scale), return_inverse=True)
    count = np.bincount(index)
    place = np.exp(np.bincount(index, np.log(wavevector)) / count)
    if place.size < _FEWEST_BINS or place[-1] < _LEAST_RANGE * place[0]:
        raise ValueError(
            f"{path} has {place.size} values of the density over a factor of "
            f"{place[-1] / place[0]:.2g} in wavelength; give {_FEWEST_BINS} or more over a factor "
            f"of {_LEAST_RANGE:g}"
        )
    return place, np.bincount(index, value) / count
