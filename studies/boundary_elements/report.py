"""Tables of a validation, as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from operator import attrgetter

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.validity import ValidityRow, excess_coefficient
from studies.boundary_elements import averages
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.edges import EdgeForces
from studies.boundary_elements.hysteresis import Hysteresis
from studies.tables import Table, make_table

PULL_OFF = 1.5
"""Magnitude of the pull-off force of a smooth sphere (Units: pi w_int R)."""


def validation_report(rows: Sequence[Hysteresis], loops: Sequence[Differences]) -> str:
    """Markdown tables of the finished cases, and of those that are whole loops."""
    tables = *surface_tables(rows).values(), *loop_tables(loops).values()
    texts = (table.text() for table in tables if table.rows)
    return "\n\n".join(["# Crack front against boundary elements", *texts, ""])


def surface_tables(rows: Sequence[Hysteresis]) -> dict[str, Table]:
    """Tables of both hystereses, empty ones where there is nothing to show."""
    return {
        "averages": _hysteresis_table(averages.limit_settings(rows)),
        "settings": _hysteresis_table(averages.settings(rows)),
    }


def loop_tables(loops: Sequence[Differences]) -> dict[str, Table]:
    """Tables of whole loops, state by state and jump by jump."""
    rough = [row for row in loops if row.elastic_energy > 0]
    return {"differences": _difference_table(loops), "events": _jump_table(rough)}


_WORKS = ("w_appr", "w_retr", "hysteresis")
"""Columns of both models."""


def _hysteresis_table(shown: Sequence[averages.Setting]) -> Table:
    """Works of adhesion and hysteresis of both models, and how much of a surface repels."""
    branches = "approach", "retraction", "difference"
    models = [f"{model}_{branch}" for branch in branches for model in ("boundary", "front")]
    rows = []
    for setting in shown:
        row = setting.rows[0]
        energy, repelling, *works = (
            setting.mean(attrgetter(name)) for name in ("elastic_energy", "repelling", *models)
        )
        rows.append(
            [
                f"{row.roll_off:g}",
                f"{float(energy.value):.4f}",
                f"{row.n_point}",
                f"{row.interaction_range:g}",
                f"{row.step:g}",
                f"{setting.surfaces}",
                f"{100 * float(repelling.value):.1f}",
                *(cell for work in works for cell in _value_and_error(work)),
            ]
        )
    columns = [
        f"{model}{work}{part}"
        for work in _WORKS
        for model in ("", "front ")
        for part in ("", " error")
    ]
    return make_table(
        f"roll-off | e_el | points | range | step | surfaces | repels % | {' | '.join(columns)}",
        rows,
        "A smooth sphere with the work of adhesion w_appr or w_retr has the same force at the same "
        "penetration. Works are in w_int, of boundary elements and of the front on the same "
        "surfaces; errors are standard errors over surfaces. The hysteresis is "
        "w_retr - w_appr. Range 0 is an extrapolation with the range to the power "
        f"{averages.ORDER}. Repels is the share of the surface with negative w_loc.",
    )


def _value_and_error(estimate: Estimate) -> tuple[str, str]:
    """Cells of a value and its standard error, which is empty for a single surface."""
    value, error = float(estimate.value), float(estimate.standard_error)
    return f"{value:.4f}", f"{error:.4f}" if math.isfinite(error) else ""


def ratio_table(validity: Sequence[ValidityRow]) -> Table:
    """Ratios of the hystereses at a vanishing range, and the law through them."""
    slope, error = excess_coefficient(validity)
    return make_table(
        "roll-off / cutoff | H | e_el | g | ratio | ratio low | ratio high | ratio by the law "
        "| surfaces | surfaces on the finest grid",
        (
            f"{row.roll_off:g} | {row.hurst:g} | {row.elastic_energy:.4f} | {row.size:.2g} | "
            f"{_interval(row)} | {math.exp(slope * row.elastic_energy):.2f} | "
            f"{row.surfaces} | {row.fine}"
            for row in validity
        ),
        "Hysteresis of the front over the hysteresis of boundary elements, extrapolated to a "
        "vanishing range and less the hysteresis of a smooth sphere in boundary elements. The 68% "
        "interval contains the scatter of the surfaces (Student's t) and half of the difference "
        "between extrapolations with the second and the fourth power. The law is "
        f"ln(ratio) = c e_el/w_int with c = {slope:.2f} ± {error:.2f}.",
    )


def order_table(rows: Sequence[Hysteresis]) -> Table:
    """Ratios of the hystereses at a vanishing range, by the power of the extrapolation."""
    powers = " | ".join(f"power {order:g}" for order in averages.ORDERS)
    return make_table(
        f"roll-off | H | e_el | {powers}",
        (
            [f"{value:g}" for value in setting.rows[0].scene]
            + [f"{math.exp(float(logarithm.value)):.2f}" for logarithm in logarithms]
            for setting, logarithms in averages.excess_by_order(rows)
        ),
        "The ratio at a vanishing range, extrapolated with three powers of the range.",
    )


def size_table(tables: Sequence[Mapping[averages.ZoneKey, ValidityRow]]) -> Table:
    """Ratios of surfaces that differ in their size g alone, not in amplitude, shape or zone."""
    keys = sorted(set.intersection(*(set(table) for table in tables)))
    return make_table(
        "roll-off / cutoff | H | e_el | zone / cutoff | g | ratio | ratio low | ratio high "
        "| surfaces",
        (
            f"{row.roll_off:g} | {row.hurst:g} | {row.elastic_energy:.4f} | {key.zone:g} | "
            f"{row.size:.2g} | {_interval(row)} | {row.surfaces}"
            for key in keys
            for row in (table[key] for table in tables)
        ),
        "Hysteresis of the front over the hysteresis of boundary elements. Rows differ in g alone "
        "if amplitude, shape and zone / cutoff are equal: the length of the cohesive zone over "
        "the cutoff. Intervals are 68% (Student's t).",
    )


def _interval(row: ValidityRow) -> str:
    """Cells of a ratio and its interval of 68%, which is empty for a single surface."""
    if not math.isfinite(row.error):
        return f"{row.ratio:.2f} |  | "
    low, high = row.ratio * math.exp(-row.error), row.ratio * math.exp(row.error)
    return f"{row.ratio:.2f} | {low:.2f} | {high:.2f}"


_CRACK = "points | range | e_el | crack"


def _crack_cells(row: Differences) -> str:
    """Cells of :data:`_CRACK`."""
    crack = "turns" if row.rotated else "fixed"
    return f"{row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} | {crack}"


def _difference_table(loops: Sequence[Differences]) -> Table:
    """Forces, areas and perimeters."""
    return make_table(
        f"{_CRACK} | force mean % | force median size % | force rms % | force largest % "
        "| area mean % | area rms % | perimeter approach | perimeter retraction | perimeter all",
        (
            f"{_crack_cells(row)} | {100 * row.force_mean / PULL_OFF:.2f} | "
            f"{100 * row.force_median / PULL_OFF:.2f} | {100 * row.force_rms / PULL_OFF:.2f} | "
            f"{100 * row.force_largest / PULL_OFF:.2f} | {100 * row.area_mean:.2f} | "
            f"{100 * row.area_rms:.2f} | {row.perimeter_approach:.4f} | "
            f"{row.perimeter_retraction:.4f} | {row.perimeter_all:.4f}"
            for row in loops
        ),
        "Boundary elements minus front. Forces are in units of the pull-off force of the smooth "
        "sphere, and areas are relative. Distances of perimeters are in short cutoffs: at the "
        "shown penetration of each branch, and in the mean of all states. The crack turns with "
        "the edge or is fixed.",
    )


def _jump_table(loops: Sequence[Differences]) -> Table:
    """Jumps and the end of contact."""
    return make_table(
        f"{_CRACK} | jumps of boundary elements | jumps of the front | shared jumps | mean shift "
        "| rms shift | pull-off force % | end of contact",
        (
            f"{_crack_cells(row)} | {row.jumps_boundary} | {row.jumps_front} | "
            f"{row.jumps_shared} | {row.jump_shift:.4f} | {row.jump_spread:.4f} | "
            f"{100 * row.pull_off_force / PULL_OFF:.2f} | {row.pull_off_penetration:.3f}"
            for row in loops
        ),
        "Jumps are arcs of the perimeter that move a quarter of a short cutoff or more in one load "
        "step. A jump of the front is shared if the boundary elements jump at the same place "
        "within 0.1 of penetration; shifts of penetration are boundary elements minus front.",
    )


def edge_table(rows: Sequence[EdgeForces]) -> Table:
    """Forces of the front's model on the edges of boundary elements."""
    return make_table(
        "points | range | e_el | slope | pinning | left / pinning | line",
        (
            f"{row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} | "
            f"{row.slope:.2f} | {row.pinning:.2f} | {row.left / row.pinning:.2f} | {row.share:.2f}"
            for row in rows
        ),
        "Rms slope of the edge, rms of w_loc along it (pinning, in w_int), and the remaining "
        "force in the model of the front over the pinning. Line is the force of the line that "
        "would balance the other forces, over the force of first order.",
    )
