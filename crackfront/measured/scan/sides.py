"""Units and sides of a scan: stated by its file, or named by options."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.core.words import counted
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.library import in_metres, library_part
from crackfront.surfaces.written_units import prefixed, unit_value

_SIDES = (1e-9, 1.0)
"""Sides of a scan that instruments measure (Units: m); others show that the unit is wrong."""

_SAME_SIDE = 0.01
"""Relative difference of sides that are rounded, and the same."""

_LEAST_HEIGHT = 1e-12
"""Least rms of heights that instruments measure (Units: m)."""

_MOST_HEIGHT = 10.0
"""Most span of heights over the side that instruments measure."""


def units_and_sides(
    path: Path, name: str, channel: Any, options: ReadingOptions
) -> tuple[dict[str, Any], tuple[float, ...] | None]:
    """Unit and sides that options add to a file; sides in metres if the file states wrong ones."""
    size, has_sides = channel.physical_sizes, is_sized(channel)
    if channel.unit is not None and has_sides:
        stated_sides = in_metres(channel.unit, *size)
        if not _are_possible(stated_sides):
            return {}, _corrected_sides(path, stated_sides, options)
    unit = _unit(path, name, channel.unit, options.unit)
    added: dict[str, Any] = {"unit": unit} if channel.unit is None else {}
    if not has_sides and size is not None and None not in size:
        return added, _completed_sides(path, channel, options, unit)
    if not has_sides:
        if options.size is None:
            raise ValueError(f"{path} states no size of the scan; name it, as in --size 50,50")
        added["physical_sizes"] = size = _sides(path, options.size, channel.dim)
    elif options.size is not None:
        shown = " x ".join(f"{side:g}" for side in size)
        raise ValueError(f"{path} states its own size, {shown} {unit}; leave --size out")
    _named_sides(path, size, unit)
    return added, None


def _corrected_sides(
    path: Path, stated: tuple[float, ...], options: ReadingOptions
) -> tuple[float, ...]:
    """Sides that options name in place of those that a file states and cannot have (Units: m)."""
    if options.size is None or options.unit is None:
        raise ValueError(
            f"{path} states sides of {shown_sides(stated)}, which no instrument measures; its unit "
            "is wrong, so name the sides, as in --size "
            f"{','.join(f'{side:g}' for side in stated)} --unit um"
        )
    unit = length_unit("--unit", options.unit)
    return _named_sides(path, _sides(path, options.size, len(stated)), unit)


def _unit(path: Path, name: str, stated: str | None, requested: str | None) -> str:
    """Unit of length that a file states, or that an option names; both may not differ."""
    if stated is None and requested is None:
        raise ValueError(
            f"{path}, read as {name}, states no unit of length; name it, as in --unit um"
        )
    unit = None if requested is None else length_unit("--unit", requested)
    if stated is not None and unit is not None and unit != length_unit("", stated):
        raise ValueError(f"{path} states its own unit, {stated}; leave --unit {requested} out")
    return str(unit if stated is None else stated)


def is_sized(channel: Any) -> bool:
    """Whether a file states a side of a channel for each of its directions."""
    size = channel.physical_sizes
    return size is not None and None not in size and len(size) == channel.dim


def _completed_sides(
    path: Path, channel: Any, options: ReadingOptions, unit: str
) -> tuple[float, ...]:
    """Sides of a map, named by options, whose file states a single one (Units: m).

    ValueError, of one sentence, where no sides are named, or others than the one that is stated.
    """
    side, *further = channel.physical_sizes
    if further:
        raise ValueError(
            f"{path} contains a line and states the sides of a map; write one side in its head"
        )
    problem = f"{path} states one side of its map, {side:g} {unit}"
    advice = f"name both in {unit}, as in --size {side:g},{side:g}"
    if options.size is None:
        raise ValueError(f"{problem}, and not the other; {advice}")
    sides = _sides(path, options.size, channel.dim)
    is_same = math.isclose(sides[0], side, rel_tol=_SAME_SIDE)
    if not is_same and _are_possible(in_metres(unit, side)):
        raise ValueError(f"{problem}, and --size names {sides[0]:g} {unit} for it; {advice}")
    return _named_sides(path, sides, unit)


def length_unit(option: str, unit: str) -> str:
    """Name by which the library knows a unit of length; ValueError, naming the option, if none."""
    units = library_part("Support.UnitConversion").length_units
    if unit in units:
        return str(next(name for name in units if units[name] == units[unit]))
    with suppress(ValueError):
        metres = unit_value(unit, "m")
        for name, value in units.items():
            if math.isclose(value, metres, rel_tol=1e-9) and not unit.strip()[0].isdigit():
                return str(name)
    raise ValueError(f"{option} {unit} is not a unit of length; name one, as in um")


def _sides(path: Path, size: tuple[float, ...], n_side: int) -> tuple[float, ...]:
    """Sides of a scan that are named, one number for a square."""
    sides = size * n_side if len(size) == 1 else size
    if len(sides) != n_side:
        raise ValueError(
            f"{path} has {counted(n_side, 'dimension')} and the size that is named "
            f"{len(size)}; name one length for each, as in --size 50,40, or one for a square"
        )
    return sides


def are_possible_heights(heights: np.ndarray[Any, Any], sides: tuple[float, ...]) -> bool:
    """Whether an instrument measures heights on such sides, all in metres."""
    present = np.ma.compressed(np.ma.masked_invalid(heights))
    return bool(np.std(present) >= _LEAST_HEIGHT and np.ptp(present) <= _MOST_HEIGHT * max(sides))


def _are_possible(sides: tuple[float, ...]) -> bool:
    """Whether an instrument measures sides of so many metres."""
    return all(_SIDES[0] <= side <= _SIDES[1] for side in sides)


def _named_sides(path: Path, sides: tuple[float, ...], unit: str) -> tuple[float, ...]:
    """Sides in metres; ValueError if no instrument measures them."""
    lengths = in_metres(unit, *sides)
    if not _are_possible(lengths):
        raise ValueError(
            f"{path} cannot have sides of {shown_sides(lengths)}: instruments measure from "
            f"{shown_sides(_SIDES[:1])} to {shown_sides(_SIDES[1:])}; check --size and --unit"
        )
    return lengths


def shown_sides(sides: tuple[float, ...]) -> str:
    """Sides of a scan as a text (Units: m)."""
    return " x ".join(prefixed("m", side) for side in sides)
