r"""Spectral densities that other programs have exported, with the convention of each.

All become the isotropic density C or the profile density C_1D, two-sided over wavevectors. The mean
square of the heights is :math:`\int d^2q\,C/4\pi^2` or :math:`\int dq\,C_{1D}/2\pi`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.options import PsdOptions
from crackfront.measured.scan.psd_convention import stated_convention
from crackfront.measured.scan.scan_files import check_readable, checksum
from crackfront.measured.tables.number_tables import number_tables
from crackfront.measured.tables.parsed_table import Table

_BINS_PER_DECADE = 20
"""Bins that values are averaged in, as many as densities of scans have."""

_FEWEST_BINS = 3
"""Values that a density needs."""

_LEAST_RANGE = 2.0
"""Longest over shortest wavelength that a density needs."""

_FURTHER_COLUMN = re.compile(r"err|std|dev|count|number", re.IGNORECASE)
"""Columns next to a density that are not another one."""


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


def read_psd_file(path: Path, options: PsdOptions) -> Psd:
    """Density in a text of two columns, as programs for surfaces export it.

    Parameters
    ----------
    path : Path
        Text of any encoding, separator and decimal sign, with headings.
    options : PsdOptions
        What the headings do not state.

    Returns
    -------
    Psd
        In SI units, averaged in bins.

    Raises
    ------
    ValueError
        If it is not a density, or its convention is unknown.
    OSError
        If the file cannot be opened.
    """
    check_readable(path)
    text = number_tables(path)
    if text is None:
        raise ValueError(f"{path} lacks rows of numbers; export the density as text, as CSV")
    series = _chosen_series(path, text.tables, options.psd_series)
    convention = stated_convention(series, options)
    place, value = _positive_columns(series)
    wavevector = convention.wavevector(place)
    wavevector, value = _binned(path, wavevector, convention.density(value, wavevector))
    return Psd(
        path=path,
        checksum=checksum(path),
        wavevector=wavevector,
        value=value,
        is_profile=convention.kind == "1d",
        convention=str(convention),
        assumptions=convention.assumptions,
    )


def _chosen_series(path: Path, tables: Sequence[Table], requested: str | None) -> Table:
    """The series of a name or number, or the only one."""
    names = [table.titles[-1] if table.titles else "" for table in tables]
    listed = "; ".join(f"{number} {name!r}" for number, name in enumerate(names, 1))
    if requested is None:
        if len(tables) > 1:
            raise ValueError(
                f"{path} has {len(tables)} series; choose one by number or name with "
                f"--psd-series: {listed}"
            )
        [series] = tables
    else:
        matches = [table for table, name in zip(tables, names, strict=True) if name == requested]
        if not matches and requested.isdecimal() and 0 < int(requested) <= len(tables):
            matches = [tables[int(requested) - 1]]
        if len(matches) != 1:
            raise ValueError(f"{path} lacks a series {requested!r}; its series are {listed}")
        [series] = matches
    further = " ".join(heading.text for heading in series.headings[2:])
    if series.n_column < 2 or (series.n_column > 2 and not _FURTHER_COLUMN.search(further)):
        raise ValueError(
            f"{path}, line {series.lines[0]}: the rows have {series.n_column} columns; export one "
            "curve, of the wavevector and the density"
        )
    return series


def _positive_columns(series: Table) -> tuple[Array, Array]:
    """Both columns, without rows that have no wave or no value."""
    place, value = series.numbers((0, 1))
    is_used = np.isfinite(value) & np.isfinite(place) & (place != 0)
    if not np.any(is_used):
        raise ValueError(
            f"{series.path} lacks rows with a wavevector and a finite density; export it again"
        )
    for name, column in (("first column", place), ("density", value)):
        bad = np.flatnonzero(is_used & ~(column > 0))
        if bad.size:
            raise ValueError(
                f"{series.path}, line {series.lines[bad[0]]}: the {name} is {column[bad[0]]:g}; it "
                "must be positive, so leave the row out or export the density without logarithms"
            )
    return place[is_used], value[is_used]


def _binned(path: Path, wavevector: Array, value: Array) -> tuple[Array, Array]:
    """Means in logarithmic bins; ValueError if there are too few."""
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
