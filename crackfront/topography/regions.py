"""Parts of a scan: as a text names them, and the points within."""

from __future__ import annotations

import math
import re
from pathlib import Path

from crackfront.data.written_units import prefixed, si_value

Region = tuple[tuple[float, float], ...]
"""Ends of a part of a scan along every direction (Units: m)."""

_ZERO = re.compile(r"\s*0(\.0*)?\s*[a-zµ]*\s*")


def region_named(text: str, what: str) -> Region:
    """Region that a text like 2um:8um,0um:5um names, `what` being what the text is of.

    Raises
    ------
    ValueError
        If it names none.
    """
    ends = [part.split(":") for part in text.split(",")]
    if not all(len(part) == 2 for part in ends) or len(ends) > 2:
        raise ValueError(
            f"{what} is {text!r}; write both ends along every direction, as in 2um:8um,0um:5um"
        )

    def place(end: str) -> float:
        return 0.0 if _ZERO.fullmatch(end) else si_value(end, "m", what=what)

    found = tuple((place(low), place(high)) for low, high in ends)
    for low, high in found:
        if not low < high:
            raise ValueError(f"{what} is {text!r}, which ends where it begins or before; swap them")
    return found


def region_slices(
    path: Path, what: str, region: Region, counts: tuple[int, ...], size: tuple[float, ...]
) -> tuple[slice, ...]:
    """Points within a region of a scan."""
    if len(region) != len(counts):
        raise ValueError(
            f"{path} has {len(counts)} dimension(s) and the {what} {len(region)}; name both ends "
            "along each, as in 2um:8um,0um:5um"
        )
    for (_, high), side in zip(region, size, strict=True):
        if high > side * (1 + 1e-9):
            raise ValueError(
                f"{path} ends at {prefixed('m', side)} and the {what} at {prefixed('m', high)}; "
                "name ends within the scan"
            )
    return tuple(
        slice(*(math.ceil(end / side * count - 1e-6) for end in ends))
        for ends, side, count in zip(region, size, counts, strict=True)
    )
