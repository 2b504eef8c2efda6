"""A loop as lines of text, and as JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crackfront.core.variables import variables
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

INTERVALS = "Intervals are 95% intervals."

_REDUCED_UNITS = {"J/m2": " w_int", "N": " pi w_int R", "Pa": "", "m": ""}
"""Text after a number in reduced units, by the unit of SI."""


def loop_lines(loop: MeasuredLoop) -> Iterator[str]:
    """Lines of a page: what a reader wants first, then the remarks."""
    for name, text in loop_numbers(loop):
        yield f"{name:18}{text}"
    yield from loop.remarks
    yield INTERVALS


def loop_numbers(loop: MeasuredLoop) -> Iterator[tuple[str, str]]:
    """Names and texts of the numbers of a loop that are known, the works of adhesion first."""
    for name in ("hysteresis", "w_appr", "w_retr"):
        work = getattr(loop, name)
        if math.isfinite(work.value):
            yield name, _text(loop, "J/m2", work.value, work.low, work.high)
        else:
            yield name, "unknown"
    if math.isfinite(loop.pull_off_force.value):
        yield "pull-off force", _pull_text(loop)
    if math.isfinite(loop.lost_energy):
        energy = _text(loop, "J/m2", loop.lost_energy)
        yield "energy lost", f"{energy} of the largest contact area"
    yield "contact modulus", _text(loop, "Pa", loop.contact_modulus.value)
    for name, fitted, unit in (
        ("modulus by fit", loop.fitted_modulus, "Pa"),
        ("machine", loop.stiffness, "N/m"),
    ):
        if math.isfinite(fitted.value):
            yield name, _text(loop, unit, fitted.value, fitted.low, fitted.high)
    low, high = (_text(loop, "m", end) for end in loop.window)
    approach, retraction = (
        int(np.sum(loop.in_window & (loop.direction == direction))) for direction in (1, -1)
    )
    counts = f"{approach} rows of approach, {retraction} of retraction"
    yield "averaged over", f"contact radii of {low} to {high}: {counts}"


def _pull_text(loop: MeasuredLoop) -> str:
    """The pull-off force, or its lower bound if a saturated detector hides it."""
    pull = loop.pull_off_force
    if math.isinf(pull.high):
        return f"at least {_text(loop, 'N', pull.value)}"
    return _text(loop, "N", pull.value, pull.low, pull.high)


def _text(loop: MeasuredLoop, unit: str, *values: float) -> str:
    """A number, or a number and the ends of its interval, in the units of the loop."""
    if not loop.reduced:
        return prefixed(unit, *values)
    value, *ends = (f"{number:.4g}" for number in values)
    interval = f" ({ends[0]} to {ends[1]})" if ends else ""
    return f"{value}{_REDUCED_UNITS[unit]}{interval}"


def loop_json(loop: MeasuredLoop) -> dict[str, Any]:
    """Numbers and remarks of a loop, in its units, by the names that JSON has for them."""
    numbers = {
        item.name: to_jsonable(getattr(loop, item.name))
        for item in variables(MeasuredLoop)
        if not item.dims
    }
    return numbers | {
        "units": "reduced" if loop.reduced else "SI",
        "window": list(loop.window),
        "remarks": list(loop.remarks),
    }
