"""SurfaceTopography: imported in parts, silent, and with one sentence for what it raises."""

from __future__ import annotations

import importlib.util
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.measured.optional_libraries import MissingExtraError
from crackfront.measured.scan.deferred_import import import_without_executing, import_without_mpi

_LIBRARY = "SurfaceTopography"

_REASONS = (
    (
        r"number of (rows|columns) \(=(\d+)\).*metadata \(=(\d+)\)",
        r"it has \2 \1, and its head says \3",
    ),
    (r"Units for x-coordinate and heights.*", "its sides and heights have different units"),
    (r"Units for x- and y-coordinate.*", "its sides have different units"),
    (
        r"Unknown unit '(.*)'",
        r"its values are in '\1', which is not a length, as of intensities; export the heights",
    ),
    (r"Could not find any topography data.*", "all of its channels lack a unit of length"),
    (r"Failed to read all data for array.*|EOF: .*", "it ends before its last number"),
    (r"'NoneType' object .*", "a part of it is missing or damaged"),
)
"""Reasons of the library, and what they say to one who has only the file."""


def library_part(name: str) -> Any:
    """A module of the library SurfaceTopography, and of the others only those that it imports.

    All of them take seconds, most of which is for formats and analyses that are not used.
    """
    with _importing():
        for package in (_LIBRARY, f"{_LIBRARY}.IO"):
            import_without_executing(package)
        return importlib.import_module(f"{_LIBRARY}.{name}")


def has_part(name: str) -> bool:
    """Whether the library, of which another part is imported, has a module of this name."""
    return importlib.util.find_spec(f"{_LIBRARY}.{name}") is not None


def surface_library() -> Any:
    """The library SurfaceTopography as a whole, with all methods of its objects."""
    with _importing():
        import SurfaceTopography

        SurfaceTopography.Topography  # noqa: B018
    return SurfaceTopography


@contextmanager
def _importing() -> Iterator[None]:
    """Import the library without MPI, or say how it is installed."""
    try:
        with silenced():
            import_without_mpi()
            yield
    except ModuleNotFoundError as error:
        raise MissingExtraError("measured surfaces", error, "surfaces") from error


@contextmanager
def silenced() -> Iterator[None]:
    """Keep from users what the library warns of, also at files that it leaves open."""
    with warnings.catch_warnings(action="ignore"):
        yield


@contextmanager
def errors_as_sentences(path: Path, name: str = "what its head says") -> Iterator[None]:
    """Turn what the library raises at a file into a sentence."""
    try:
        yield
    # A damaged file may fail anywhere in a parser that is not ours.
    except Exception as error:
        reason = next(iter(str(error).splitlines()), "") or type(error).__name__
        raise ValueError(f"{path} cannot be read as {name}: {_plain_reason(reason)}") from error


def _plain_reason(reason: str) -> str:
    """Reason of the library in plain words, and what to do."""
    for pattern, words in _REASONS:
        if (match := re.search(pattern, reason)) is not None:
            reason = match.expand(words)
    advice = "" if "; export" in reason else "; export it from the instrument again"
    return f"{reason.strip().rstrip('.')}{advice}"


def library_scan(
    heights: np.ndarray[Any, Any],
    size: tuple[float, ...] | None,
    *,
    unit: str | None = "m",
    periodic: bool = False,
    info: dict[str, Any] | None = None,
) -> Any:
    """Heights of a map or a line, and its sides, as an object of the library."""
    kinds = library_part("UniformLineScanAndTopography")
    kind = kinds.Topography if heights.ndim > 1 else kinds.UniformLineScan
    return kind(heights, size, periodic=periodic, unit=unit, info=info or {})


def in_metres(unit: str, *lengths: float) -> tuple[float, ...]:
    """Lengths of a unit in metres."""
    factor = library_part("Support.UnitConversion").get_unit_conversion_factor(unit, "m")
    return tuple(float(factor * float(length)) for length in lengths)
