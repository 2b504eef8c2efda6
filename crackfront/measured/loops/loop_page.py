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
    yield "averaged over", f"contact radii of {low} to {high}: {_averaged_rows(loop)}"


def _averaged_rows(loop: MeasuredLoop) -> str:
    """Counts of the averaged rows of each branch that has some."""
    counts: list[str] = []
    for direction, name in ((1, "approach"), (-1, "retraction")):
        n_row = int(np.sum(loop.in_window & (loop.direction == direction)))
        if n_row:
            counts.append(f"{n_row} {'' if counts else 'rows '}of {name}")
    return ", ".join(counts)


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
    return pure_number(*values, unit=_REDUCED_UNITS[unit], digits=4)


def pure_number(*values: float, unit: str = "", digits: int = 3) -> str:
    """A number, or a number and the ends of its interval, without a prefix of its unit.

    An interval that these digits do not show is left out, as in
    :func:`crackfront.surfaces.written_units.prefixed`.

    Examples
    --------
    >>> pure_number(1.5, 0.9, 2.5), pure_number(105.01, 104.99, 105.02)
    ('1.5 (0.9 to 2.5)', '105')
    """
    value, *ends = (f"{number:.{digits}g}" for number in values)
    is_shown = bool(ends) and math.isfinite(values[1]) and {*ends} != {value}
    interval = f" ({ends[0]} to {ends[1]})" if is_shown else ""
    return f"{value}{unit}{interval}"


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
