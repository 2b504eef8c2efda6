"""Whether two results agree, file by file and variable by variable, in values and in bits."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.data.files import UnreadableFileError, read_dataset
from crackfront.data.packs import PACK, File, members
from crackfront.data.provenance import Provenance

_COSTS = {"s", "byte"}
"""Units of costs, which differ between any two runs."""

_OF_ONE_RUN = {"date", "history", "key", "seconds", "cpu_seconds", "sweep_fingerprint"}
_OF_ONE_RUN |= {item.name for item in fields(Provenance)}
"""Attributes that say where, when and how a file was made."""

_KEY = re.compile(r"-[0-9a-f]{16}(?=\.nc$)")
"""The key in the name of a file, which changes with the sources."""


@dataclass(frozen=True, slots=True)
class Difference:
    """How much a variable or an attribute of two files differs."""

    file: str
    variable: str
    """Where it stands; the name of the file is empty where two files are compared."""
    largest: float
    """Largest difference relative to the largest magnitude in the second; of texts 0 or 1.
    Infinite where the shapes disagree, or one of the two lacks it."""
    in_bits: bool
    """Whether the values are the same bit by bit."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Differences of two results, of all variables of all their files, and files of one alone."""

    n_file: int
    differences: tuple[Difference, ...]
    alone: tuple[File, ...]

    @property
    def largest(self) -> float:
        """Largest of all differences; infinite where files have no counterpart."""
        if self.alone:
            return math.inf
        return max((item.largest for item in self.differences), default=0.0)

    @property
    def in_bits(self) -> bool:
        """Whether all values are the same bit by bit."""
        return not self.alone and all(item.in_bits for item in self.differences)

    def by_variable(self) -> dict[str, Difference]:
        """For every variable, the file in which it differs most."""
        most: dict[str, Difference] = {}
        for item in self.differences:
            known = most.get(item.variable, item)
            worse = (known.largest, not known.in_bits) < (item.largest, not item.in_bits)
            most[item.variable] = item if worse else known
        return most


def comparison(one: Path, other: Path) -> Comparison:
    """Two netCDF files of results, or the files of that kind in two folders.

    What a run cost and where it comes from is left out. Files of simulations are paired by their
    names without the key, which changes with the sources. UnreadableFileError if a file is missing
    or damaged, two files are not of one kind, or the folders hold none.
    """
    if one.is_dir() != other.is_dir():
        folder, file = (one, other) if one.is_dir() else (other, one)
        raise UnreadableFileError(f"{folder} is a folder, and {file} is none; name two of a kind")
    if not one.is_dir():
        return Comparison(1, tuple(_differences("", one, other)), ())
    pairs, alone = _pairs(_results(one), _results(other))
    if not pairs and not alone:
        raise UnreadableFileError(f"{one} and {other} hold no results; name two folders of results")
    found = (_differences(name, *paths) for name, paths in pairs.items())
    return Comparison(len(pairs), tuple(item for items in found for item in items), alone)


def _results(folder: Path) -> dict[str, File]:
    """Results of a folder, also in packs, by their names in it, without checkpoints."""
    found: dict[str, File] = {}
    for path in folder.rglob("[!.]*.*"):
        if path.suffix == PACK:
            curves = (one for one in members(path)[0] if one.name.endswith(".nc"))
            found |= {f"curves/{one.name}": one for one in curves}
        elif path.suffix == ".nc" and "checkpoints" not in path.relative_to(folder).parts:
            found[str(path.relative_to(folder))] = path
    return found


def _pairs(
    ones: dict[str, File], others: dict[str, File]
) -> tuple[dict[str, tuple[File, File]], tuple[File, ...]]:
    """Files of equal names, or of names that are equal without a key, and those that are alone."""
    pairs = {name: (ones[name], others[name]) for name in sorted(ones.keys() & others.keys())}
    alike: dict[str, tuple[list[File], list[File]]] = defaultdict(lambda: ([], []))
    for side, paths in enumerate((ones, others)):
        for name in sorted(paths.keys() - pairs.keys()):
            alike[_KEY.sub("", name)][side].append(paths[name])
    alone: list[File] = []
    for name, (first, second) in sorted(alike.items()):
        if len(first) == len(second) == 1:
            pairs[name] = first[0], second[0]
        else:
            alone += first + second
    return pairs, tuple(alone)


def _differences(file: str, one: File, other: File) -> Iterator[Difference]:
    """Differences of the variables of two files, and of their attributes."""
    first, second = read_dataset(one), read_dataset(other)
    if not first.variables.keys() & second.variables.keys():
        raise UnreadableFileError(
            f"{one} and {other} are not of one kind: they share no variable; compare results of "
            "one command"
        )
    for name in map(str, dict.fromkeys([*first.variables, *second.variables])):
        known = [data[name] for data in (first, second) if name in data.variables]
        if any(item.attrs.get("units") in _COSTS for item in known):
            continue
        if len(known) == 1:
            yield Difference(file, name, math.inf, in_bits=False)
        else:
            yield _difference(file, name, *(np.asarray(item) for item in known))
    for name in sorted(map(str, first.attrs.keys() & second.attrs.keys() - _OF_ONE_RUN)):
        values = (np.asarray(data.attrs[name]) for data in (first, second))
        yield _difference(file, f"attribute {name}", *values)


def _difference(file: str, name: str, one: NDArray[Any], other: NDArray[Any]) -> Difference:
    """How much two arrays differ."""
    texts = [array.dtype.kind in "OU" for array in (one, other)]
    if one.shape != other.shape or any(texts) != all(texts):
        return Difference(file, name, math.inf, in_bits=False)
    if all(texts):
        first, second = ([_KEY.sub("", str(text)) for text in array.flat] for array in (one, other))
        return Difference(file, name, float(first != second), in_bits=first == second)
    if one.dtype == other.dtype and one.tobytes() == other.tobytes():
        return Difference(file, name, 0.0, in_bits=True)
    if np.array_equal(one, other, equal_nan=True):
        return Difference(file, name, 0.0, in_bits=False)
    scale = float(np.max(np.abs(other[np.isfinite(other)], dtype=float), initial=0.0)) or 1.0
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(np.subtract(one, other, dtype=float))
    # Equal infinities and two NaN are not apart; a number and none are infinitely so.
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    largest = float(np.max(np.where(same, 0.0, np.nan_to_num(apart, nan=math.inf)), initial=0.0))
    return Difference(file, name, largest / scale, in_bits=False)
