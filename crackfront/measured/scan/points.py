"""Points in two or three columns of a text: lines, and maps on a regular grid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.measured.tables.headings import Heading, listed, matching
from crackfront.measured.tables.parsed_table import Table

_UNEVEN = 0.05
"""Distance of a point from its place, in spacings, that positions may have beyond their digits."""

_ROUNDING = 0.6
"""Distance of a number from the one that was printed, in units of the last digit."""

_MOST_ROUNDING = 0.25
"""Rounding of positions, in spacings, up to which places without a point are found."""

_OFF_LINE = 1e-3
"""Distance of points from an oblique line, in mean spacings along it, that is rounding."""

_SAME_PLACE = 0.1
"""Distance of neighbours on the grid, in the largest one, that is scatter at one place."""

_FEWEST_POSITIONS = 9
"""Numbers of a column or row from which equal steps are no chance."""

_FEWEST_ALONG = 0.5
"""Least part of the places along one direction at which there is any point."""

_FEWEST_FILLED = 0.05
"""Least part of the places of a grid that have a point; with fewer it is not a grid."""

_WORDS = "( ?-?(position|coordinate|axis|height)s?)?"
"""What may follow the name of a coordinate."""

_NAMES = {
    "x": f"(x|position|distance){_WORDS}",
    "y": f"y{_WORDS}",
    "z": f"(z|heights?|elevation|topography){_WORDS}",
}
"""What headings call the columns of points."""

HeadKind = Literal["dektak", "hfm", "comments"]
"""Heads of points that the library reads: of two instruments, and comments."""

Cells = NDArray[Any]
"""A column of numbers as texts, whose digits say how far they are rounded."""


@dataclass(frozen=True, slots=True)
class Points:
    """Heights of a map or a line, on the grid of its positions, in the units of the file."""

    heights: np.ndarray[Any, Any]
    """Masked where the file lacks a point."""
    size: tuple[float, ...]


def point_columns(path: Path, headings: Sequence[Heading]) -> list[int]:
    """Places of the columns named x, y and z, in this order; none if the headings name too few.

    ValueError if only the heights are named, and are not in the last column.
    """
    places = {name: matching(headings, pattern) for name, pattern in _NAMES.items()}
    if max(map(len, places.values())) == 1 and places["z"] and (places["x"] or places["y"]):
        return [place for name in "xyz" for place in places[name]]
    if places["z"] and len(headings) - 1 not in places["z"]:
        raise ValueError(
            f"{path}: its columns are {listed(headings)}; name the columns of the points x, y and "
            "z, once each, or write the heights in the last one"
        )
    return []


def read_points(table: Table, kind: HeadKind | None) -> Points:
    """Points of a table on a line or a regular grid.

    Parameters
    ----------
    table : Table
        Two or three columns of numbers; a further first one may count the points.
    kind : 'dektak', 'hfm' or None
        Kind of the head; some columns of these instruments are not heights.

    Returns
    -------
    Points
        In the units of the table.

    Raises
    ------
    ValueError
        If the points are neither on a line nor on a regular grid, or without heights.
    """
    path = table.path
    columns = [table.cells[place].to_numpy() for place in range(table.n_column)]
    if kind == "dektak":
        columns = columns[:2]
    elif kind == "hfm" and len(columns) == 3:
        x, z, valid = columns
        columns = [x, np.where(valid.astype(float) != 0, z, "nan")]
    elif len(columns) == 4:
        del columns[0]
    if len(columns) == 3:
        columns = _line_columns(columns) or columns
    *places, last = columns
    heights = np.ma.masked_invalid(last.astype(float))
    if not heights.count():
        raise ValueError(
            f"{path} lacks heights: the last column is without numbers; export it again"
        )
    return Points(*_on_grid(path, places, heights))


def even_line(path: Path, positions: Array, heights: Array) -> Points:
    """Line of points of another reader; ValueError if they are not equally spaced."""
    return Points(*_on_grid(path, [_texts(positions)], np.ma.masked_invalid(heights)))


def _texts(numbers: Array) -> Cells:
    """Numbers with all their digits, as cells."""
    return np.array(list(map(repr, np.asarray(numbers, dtype=float).tolist())), dtype=object)


def check_no_positions(table: Table) -> None:
    """Raise where the first column, or the first row, of a matrix has positions for heights."""
    cells = table.cells.to_numpy()
    if min(cells.shape) < 2 or len(cells) < _FEWEST_POSITIONS:
        return
    for name, lines in (("column", cells.T), ("row", cells)):
        first, second = lines[:2, 1:]
        if len(first) + 1 < _FEWEST_POSITIONS:
            continue
        if _are_positions(first) and not _are_positions(second):
            raise ValueError(
                f"{table.path}: the first {name} is equally spaced, {first[0]} to {first[-1]}, as "
                "positions are; export the heights alone, and name the sides with --size"
            )


def _are_positions(cells: Cells) -> bool:
    """Whether numbers ascend or descend by equal steps."""
    numbers = cells.astype(float)
    steps = np.diff(numbers)
    if not np.isfinite(numbers).all() or not (np.all(steps > 0) or np.all(steps < 0)):
        return False
    try:
        index, _ = _axis(Path(), "", cells)
    except ValueError:
        return False
    return len(set(index.tolist())) == len(cells) == np.ptp(index) + 1


def are_points(table: Table) -> bool:
    """Whether rows are points, of two or three numbers that a fourth may count."""
    if table.n_column != 4:
        return table.n_column in (2, 3)
    return _is_index(table.cells[0].to_numpy())


def _line_columns(columns: Sequence[Cells]) -> list[Cells] | None:
    """Positions and heights of a line in three columns; None where they are a map."""
    first, second, heights = columns
    x, y = first.astype(float), second.astype(float)
    if _is_index(first) and len(set(second)) > 1:
        return [second, heights]
    if not np.ptp(x) > 0:
        return [second, heights]
    if not np.ptp(y) > 0:
        return [first, heights]
    if not _is_line(x, y):
        return None
    distances = np.sign(x - x[0]) * np.hypot(x - x[0], y - y[0])
    return [_texts(distances), heights]


def _is_line(x: Array, y: Array) -> bool:
    """Whether points lie between the first and the last one on a line at an angle to both axes."""
    length_x, length_y = abs(x[-1] - x[0]), abs(y[-1] - y[0])
    departure = np.abs((x - x[0]) * length_y - np.abs(y - y[0]) * length_x)
    return not np.any(departure > _OFF_LINE * np.ptp(x) * np.ptp(y) / len(x))


def _is_index(cells: Cells) -> bool:
    """Whether cells are whole numbers, each one more than the one above."""
    numbers = cells.astype(float)
    whole = np.all(numbers == np.rint(numbers))
    return bool(whole and len(numbers) > 2 and np.all(np.diff(numbers) == 1))


def _on_grid(
    path: Path, places: Sequence[Cells], heights: np.ma.MaskedArray[Any, Any]
) -> tuple[np.ma.MaskedArray[Any, Any], tuple[float, ...]]:
    """Heights on the grid of their positions, masked where it lacks a point, and its sides."""
    axes = [_axis(path, name, cells) for name, cells in zip("xy", places, strict=False)]
    counts = tuple(int(index.max()) + 1 for index, _ in axes)
    if len(heights) < _FEWEST_FILLED * math.prod(counts):
        raise ValueError(
            f"{path} has {len(heights)} points for {' x '.join(map(str, counts))} places: they lie "
            "on no regular grid; interpolate them on one"
        )
    flat = np.ravel_multi_index([index for index, _ in axes], counts)
    if np.bincount(flat).max() > 1:
        order = np.argsort(flat, kind="stable")
        twice = order[1:][np.diff(flat[order]) == 0][0]
        position = ", ".join(cells[twice] for cells in places)
        raise ValueError(
            f"{path} names the position {position} twice, or with too few digits; export each "
            "point once, with more digits"
        )
    grid: np.ma.MaskedArray[Any, Any] = np.ma.array(np.zeros(math.prod(counts)), mask=True)
    grid[flat] = heights
    if not np.ma.getmaskarray(grid).any():
        grid = np.ma.array(np.ma.getdata(grid))
    size = tuple(step * count for (_, step), count in zip(axes, counts, strict=True))
    return grid.reshape(counts), size


def _axis(path: Path, name: str, cells: Cells) -> tuple[NDArray[np.int64], float]:
    """Places of positions on equal spacings, and the spacing; ValueError where there is none.

    Positions may depart from their places by their last digit, and by a small part of the spacing.
    """
    import pandas

    # By hashes, since sorting millions of texts takes minutes.
    inverse, texts = pandas.factorize(cells)
    values, rounding = texts.astype(float), _last_digits(texts.tolist())
    if not np.isfinite(values).all():
        raise ValueError(
            f"{path}: a position along {name} is not a number; export the points again"
        )
    order = np.argsort(values, kind="stable")
    positions, rounding = values[order], rounding[order]
    place, centres = _distinct(positions)
    if len(centres) < 2:
        return np.zeros(len(cells), dtype=np.int64), 0.0
    index = np.arange(len(centres))
    step, distances = _line_through(index, centres, positions, place)
    allowed = _ROUNDING * rounding + _UNEVEN * step
    if np.any(distances > allowed):
        grid = _grid_with_gaps(centres, positions, place, rounding)
        if grid is None:
            farthest = int(np.argmax(distances - allowed))
            n_spacing = distances[farthest] / step
            raise _uneven_error(path, name, centres, texts[order][farthest], n_spacing)
        index, step = grid
    places = np.empty(len(texts), dtype=np.int64)
    places[order] = index[place]
    return places[inverse], step


def _distinct(positions: Array) -> tuple[NDArray[np.int64], Array]:
    """Which of the distinct places each ascending position belongs to, and their mean positions."""
    gaps = np.diff(positions)
    is_next = gaps > _SAME_PLACE * gaps.max(initial=0.0)
    place = np.concatenate([[0], np.cumsum(is_next)])
    return place, np.bincount(place, positions) / np.bincount(place)


def _grid_with_gaps(
    centres: Array, positions: Array, place: NDArray[np.int64], rounding: Array
) -> tuple[NDArray[np.int64], float] | None:
    """Numbers of places on a grid that lacks points, and its spacing; None if there is none."""
    index = _places_with_gaps(centres)
    step, distances = _line_through(index, centres, positions, place)
    if (
        index[-1] + 1 > len(index) / _FEWEST_ALONG
        or rounding.max() > _MOST_ROUNDING * step
        or np.any(distances > _ROUNDING * rounding + _UNEVEN * step)
    ):
        return None
    return index, step


def _uneven_error(
    path: Path, name: str, centres: Array, position: str, n_spacing: float
) -> ValueError:
    """Error at places that are not equally spaced, with the position that departs most."""
    gaps = np.diff(centres)
    return ValueError(
        f"{path}: the points are not equally spaced: neighbours along {name} are "
        f"{gaps.min():.3g} to {gaps.max():.3g} apart, and {position} is {n_spacing:.2g} spacings "
        "from its place; interpolate the heights at equal steps, or export more digits if these "
        "are rounded"
    )


def _line_through(
    index: NDArray[np.int64], centres: Array, positions: Array, place: NDArray[np.int64]
) -> tuple[float, Array]:
    """Spacing of places that have been numbered, and distances of the positions from them."""
    step, start = np.polyfit(index, centres, 1)
    return float(step), np.abs(positions - start - step * index[place])


def _places_with_gaps(centres: Array) -> NDArray[np.int64]:
    """Numbers of places on a grid of which some have no point."""
    gaps = np.diff(centres)
    step = float(np.quantile(gaps, 0.25))
    for _ in range(3):
        index = np.concatenate([[0], np.cumsum(np.maximum(np.rint(gaps / step), 1))])
        step = float(np.polyfit(index, centres, 1)[0])
    return index.astype(np.int64)


def _last_digits(cells: Sequence[str]) -> Array:
    """Unit of the last digit of numbers as printed with so many decimals, or digits in all."""
    is_fixed = "e" not in " ".join(cells).lower()
    mantissas = cells if is_fixed else [cell.lower().partition("e")[0] for cell in cells]
    decimals = max(len(text.partition(".")[2]) for text in mantissas)
    digits = max(len(text.lstrip("+-0.").replace(".", "")) for text in mantissas)
    values = np.abs(np.array(cells, dtype=float))
    scale = np.floor(np.log10(np.where(values > 0, values, np.inf)))
    by_digits = np.where(values > 0, 10.0 ** np.where(values > 0, scale + 1 - digits, 0), 0.0)
    return np.maximum(by_digits, 10.0**-decimals if is_fixed else 0.0)
