"""Spectral densities among texts of scans, which are not read as lines."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.scan.psd_convention import GWYDDION, dimension, written_unit
from crackfront.measured.tables.number_tables import NumberTables
from crackfront.measured.tables.parsed_table import Table

_DENSITY = rf"\bpsd\b|\bc[_ ]?(1d|2d|iso)\b|spectral density|power spectrum|{GWYDDION}"
"""What headings call the second column."""

_HEIGHTS = r"height|topograph|elevation|position|distance|\b[xz]\b"
"""Headings of line scans."""

_MOST_ROWS = 100_000
"""Rows that a text of densities has at most."""

_MOST_COLUMNS = 8
"""Columns that a text of densities has at most."""

_STEEP = -0.9
"""Rank correlation below which values fall all along, which heights of a line do not."""

_SPAN = 1e3
"""Largest over least value, above which these are not heights of a line."""

_FEWEST_ROWS = 8
"""Rows from which both are judged."""


def check_no_spectrum(path: Path, text: NumberTables) -> None:
    """Raise if a text of two columns is a spectral density and not a line of heights."""
    n_row = sum(len(table.cells) for table in text.tables)
    if n_row > _MOST_ROWS or not 2 <= text.n_column <= _MOST_COLUMNS:
        return
    reason = None
    for series in (table for table in text.tables if table.n_column >= 2):
        names = [heading.text for heading in series.headings[:2]]
        units = [unit for unit in (written_unit(series, place) for place in (0, 1)) if unit]
        heads = " ".join(names).lower()
        if re.search(_DENSITY, heads) or dimension(units[-1] if units else "", (3, 4)):
            reason = f"its columns are named {' and '.join(map(repr, names))}"
        elif _looks_like_density(series) and not re.search(_HEIGHTS, heads):
            reason = "its values are positive and fall all along, as no heights do"
    if reason is not None:
        raise ValueError(
            f"{path} contains a spectral density, not a line scan: {reason}; predict from it with "
            f"--psd {path}, or name the columns x and z in its head if they are a line"
        )


def _looks_like_density(series: Table) -> bool:
    """Whether two columns without names fall as densities do."""
    if series.n_column != 2 or len(series.cells) < _FEWEST_ROWS:
        return False
    place, value = series.numbers((0, 1))
    if np.any(place < 0):
        return False
    place, value = place[place > 0], value[place > 0]
    if place.size < _FEWEST_ROWS or not np.all(value > 0):
        return False
    ranks = np.argsort(np.argsort([place, value], axis=1), axis=1)
    correlation: Array = np.asarray(np.corrcoef(ranks))
    falls = correlation[0, 1] < _STEEP
    return bool(falls) and float(np.max(value)) > _SPAN * float(np.min(value))
