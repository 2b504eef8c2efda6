"""Tables of a validation, as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from operator import attrgetter
from typing import Any

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.validity import ValidityRow, excess_coefficient
from studies.boundary_elements import averages
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.hysteresis import Hysteresis
from studies.pages import markdown_table

_PULL_OFF = 1.5
"""Magnitude of the pull-off force of a smooth sphere (Units: pi w_int R)."""


def validation_report(
    rows: Sequence[Hysteresis], loops: Sequence[Differences], short_cutoff: float
) -> str:
    """Markdown tables of the finished cases, and of those that are whole loops."""
    found, limits = averages.settings(rows), averages.limit_settings(rows)
    told = averages.validity_rows(rows, short_cutoff)
    parts = [
        ["# Crack front against boundary elements", ""],
        _excess_table(told),
        _hysteresis_table([*found, *limits]),
        _run_table(found),
        _difference_table(loops),
        _jump_table([row for row in loops if row.elastic_energy > 0]),
    ]
    return "\n".join(line for part in parts for line in part)


def _table(text: str, header: str, lines: Iterable[str]) -> list[str]:
    """A paragraph and its table, or nothing where the table has no lines."""
    rows = list(lines)
    return [text, "", markdown_table(header, rows), ""] if rows else []


_SETTING = "roll-off | e_el | points | range | step"


def _cells(found: averages.Setting, *names: str) -> list[str]:
    """Cells of the setting, of the number of surfaces, and of means over them by their fields."""
    row, energy = found.rows[0], float(found.mean(attrgetter("elastic_energy")).value)
    grid = f"{row.n_point} | {row.interaction_range:g} | {row.step:g}"
    means = (_shown(found.mean(attrgetter(name))) for name in names)
    return [f"{row.roll_off:g} | {energy:.4f} | {grid}", f"{found.surfaces}", *means]


def _shown(found: Estimate, digits: int = 4) -> str:
    """A value and its standard error, if it has one."""
    value, error = float(found.value), float(found.standard_error)
    return f"{value:.{digits}f}" + (f" ({error:.{digits}f})" if math.isfinite(error) else "")


def _hysteresis_table(found: Sequence[averages.Setting]) -> list[str]:
    """Works of adhesion and hysteresis of both models."""
    models = [
        f"{model}_{name}"
        for name in ("approach", "retraction", "difference")
        for model in ("boundary", "front")
    ]
    return _table(
        "Works of adhesion of the smooth sphere with the same force at the same penetration, in "
        "w_int; boundary elements first, then the front on the same surfaces; in brackets standard "
        "errors over surfaces. Hysteresis: w_retr - w_appr; k is half of it over e_el. Range 0 "
        f"is extrapolated by the range to the power {averages.ORDER} from the two shortest of a "
        "surface: the mean of the longest over all surfaces, and that of what extrapolation "
        "changes on those that have a shorter one.",
        f"{_SETTING} | surfaces | w_appr | front | w_retr | front | hysteresis | front",
        (" | ".join(_cells(one, *models)) for one in found),
    )


def _excess_table(told: Sequence[ValidityRow]) -> list[str]:
    """Ratios of the hystereses at a vanishing range, and the law through them."""
    if not any(math.isfinite(row.error) for row in told):
        return []
    slope, error = excess_coefficient(told)
    return _table(
        "Hysteresis of the front over that of boundary elements at a vanishing range, without what "
        "these lose on the smooth sphere; 68% intervals by Student's t over the surfaces that have "
        "both ranges, and half of what extrapolation by the second and by the fourth power differ "
        f"by. The law through them is ln(ratio) = c e_el / w_int, c = {slope:.2f} ± {error:.2f}.",
        "roll-off / cutoff | H | e_el | g | ratio | interval | law | surfaces | with both ranges",
        (
            f"{row.roll_off:g} | {row.hurst:g} | {row.elastic_energy:.4f} | {row.size:.2g} | "
            f"{row.ratio:.2f} | {row.ratio * math.exp(-row.error):.2f} to "
            f"{row.ratio * math.exp(row.error):.2f} | {math.exp(slope * row.elastic_energy):.2f} | "
            f"{row.surfaces} | {row.fine}"
            for row in told
        ),
    )


def _run_table(found: Sequence[averages.Setting]) -> list[str]:
    """What the minimiser did, and the processor time."""
    hours = sum(row.boundary_seconds for one in found for row in one.rows) / 3600
    return _table(
        "Part of the surface that repels the front. Products of a load step; steps that would have "
        "passed a barrier and were shortened; states without forces that were no minimum and were "
        "left; least fall of the energy at a penetration. Seconds of one core for a surface; "
        f"boundary elements took {hours:.2f} core hours in all.",
        f"{_SETTING} | surfaces | repels | products | barriers | saddles | least fall | s "
        "| front, s",
        (
            " | ".join(_cells(one, "repelling"))
            + f" | {one.mean(lambda row: row.products).value:.0f} | "
            f"{sum(row.barriers for row in one.rows)} | {sum(row.saddles for row in one.rows)} | "
            f"{min(row.least_released for row in one.rows):.1e} | "
            f"{one.mean(lambda row: row.boundary_seconds).value:.0f} | "
            f"{one.mean(lambda row: row.front_seconds).value:.1f}"
            for one in found
        ),
    )


_CRACK = "points | range | e_el | crack"
_CRACK_CELLS = "{n_point} | {interaction_range:g} | {elastic_energy:.4f} | {crack}"


def _cell_values(row: Differences) -> dict[str, Any]:
    """Values of a row, with forces relative to the pull-off force and the name of the crack."""
    known = asdict(row)
    forces = {name: value / _PULL_OFF for name, value in known.items() if "force" in name}
    return known | forces | {"crack": "turns" if row.rotated else "fixed"}


def _difference_table(loops: Sequence[Differences]) -> list[str]:
    """Forces, areas and perimeters."""
    cells = (
        f"{_CRACK_CELLS} | {{force_mean:.2%}} | {{force_median:.2%}} | "
        "{force_rms:.2%} | {force_largest:.2%} | {area_mean:.2%} | {area_rms:.2%} | "
        "{perimeter_approach:.4f} | {perimeter_retraction:.4f} | {perimeter_all:.4f}"
    )
    return _table(
        "Boundary elements minus front, in all states in which both have contact; in approach from "
        "the penetration b on at which the boundary elements have left, everywhere, the perimeter "
        "with which they jumped into contact. Forces in units of the smooth pull-off force, areas "
        "relative, distances of perimeters in short cutoffs: in approach and retraction at the "
        "shown penetration, and the mean over all states.",
        f"{_CRACK} | force, mean | median size | rms | largest | area, mean | rms "
        "| perimeter, appr. | retr. | all",
        (cells.format(**_cell_values(row)) for row in loops),
    )


def _jump_table(loops: Sequence[Differences]) -> list[str]:
    """Jumps and the end of contact."""
    cells = (
        f"{_CRACK_CELLS} | {{jumps_boundary}} | {{jumps_front}} | {{jumps_shared}} | "
        "{jump_shift:.4f} | {jump_spread:.4f} | {pull_off_force:.2%} | {pull_off_penetration:.3f}"
    )
    return _table(
        "Arcs of the perimeter that move a quarter of a short cutoff or more in one load step; of "
        "the front's, those for which the boundary elements jump at the same place within 0.1 of "
        "penetration; their penetrations, boundary elements minus front.",
        f"{_CRACK} | boundary | front | shared | mean shift | rms shift | pull-off force "
        "| end of contact",
        (cells.format(**_cell_values(row)) for row in loops),
    )
