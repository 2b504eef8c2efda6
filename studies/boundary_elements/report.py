"""Tables of a validation, as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from operator import attrgetter

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.validity import ValidityRow, excess_coefficient
from studies.boundary_elements import averages
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.edges import EdgeForces
from studies.boundary_elements.hysteresis import Hysteresis
from studies.pages import markdown_table

PULL_OFF = 1.5
"""Magnitude of the pull-off force of a smooth sphere (Units: pi w_int R)."""


def validation_report(rows: Sequence[Hysteresis], loops: Sequence[Differences]) -> str:
    """Markdown tables of the finished cases, and of those that are whole loops."""
    tables = *surface_tables(rows).values(), *loop_tables(loops).values()
    return "\n\n".join(["# Crack front against boundary elements", *filter(None, tables), ""])


def surface_tables(rows: Sequence[Hysteresis]) -> dict[str, str]:
    """Tables of both hystereses, empty ones where there is nothing to show."""
    return {
        "averages": _hysteresis_table(averages.limit_settings(rows)),
        "settings": _hysteresis_table(averages.settings(rows)),
    }


def loop_tables(loops: Sequence[Differences]) -> dict[str, str]:
    """Tables of whole loops, state by state and jump by jump."""
    rough = [row for row in loops if row.elastic_energy > 0]
    return {"differences": _difference_table(loops), "events": _jump_table(rough)}


def _table(text: str, header: str, lines: Iterable[str]) -> str:
    """A paragraph and its table, or nothing if the table is empty."""
    rows = list(lines)
    return f"{text}\n\n{markdown_table(header, rows)}" if rows else ""


def _hysteresis_table(shown: Sequence[averages.Setting]) -> str:
    """Works of adhesion and hysteresis of both models, and how much of a surface repels."""
    branches = "approach", "retraction", "difference"
    models = [f"{model}_{branch}" for branch in branches for model in ("boundary", "front")]
    lines = []
    for setting in shown:
        row = setting.rows[0]
        energy, repelling, *works = (
            setting.mean(attrgetter(name)) for name in ("elastic_energy", "repelling", *models)
        )
        lines.append(
            f"{row.roll_off:g} | {float(energy.value):.4f} | {row.n_point} | "
            f"{row.interaction_range:g} | {row.step:g} | {setting.surfaces} | "
            f"{float(repelling.value):.1%} | {' | '.join(map(_shown, works))}"
        )
    return _table(
        "A smooth sphere with the work of adhesion w_appr or w_retr has the same force at the same "
        "penetration. Works are in w_int, of boundary elements and then of the front on the same "
        "surfaces; brackets contain standard errors over surfaces. The hysteresis is "
        "w_retr - w_appr. Range 0 is an extrapolation with the range to the power "
        f"{averages.ORDER}. *Repels* is the share of the surface with negative w_loc.",
        "roll-off | e_el | points | range | step | surfaces | repels | w_appr | front | w_retr "
        "| front | hysteresis | front",
        lines,
    )


def _shown(estimate: Estimate) -> str:
    """A value and its standard error, if it has one."""
    value, error = float(estimate.value), float(estimate.standard_error)
    return f"{value:.4f}" + (f" ({error:.4f})" if math.isfinite(error) else "")


def ratio_table(validity: Sequence[ValidityRow]) -> str:
    """Ratios of the hystereses at a vanishing range, and the law through them."""
    if not any(math.isfinite(row.error) for row in validity):
        return ""
    slope, error = excess_coefficient(validity)
    return _table(
        "Hysteresis of the front over the hysteresis of boundary elements, extrapolated to a "
        "vanishing range and less the hysteresis of a smooth sphere in boundary elements. The 68% "
        "interval contains the scatter of the surfaces (Student's t) and half of the difference "
        "between extrapolations with the second and the fourth power. The law is "
        f"ln(ratio) = c e_el/w_int with c = {slope:.2f} ± {error:.2f}.",
        "roll-off / cutoff | H | e_el | g | ratio | interval | law | surfaces | on the finest grid",
        (
            f"{row.roll_off:g} | {row.hurst:g} | {row.elastic_energy:.4f} | {row.size:.2g} | "
            f"{row.ratio:.2f} | {_interval(row)} | {math.exp(slope * row.elastic_energy):.2f} | "
            f"{row.surfaces} | {row.fine}"
            for row in validity
        ),
    )


def order_table(rows: Sequence[Hysteresis]) -> str:
    """Ratios of the hystereses at a vanishing range, by the power of the extrapolation."""
    powers = " | ".join(f"power {order:g}" for order in averages.ORDERS)
    return _table(
        "The ratio at a vanishing range, extrapolated with three powers of the range.",
        f"roll-off | H | e_el | {powers}",
        (
            " | ".join(
                [f"{value:g}" for value in setting.rows[0].scene]
                + [f"{math.exp(float(logarithm.value)):.2f}" for logarithm in logarithms]
            )
            for setting, logarithms in averages.excess_by_order(rows)
        ),
    )


def size_table(tables: Sequence[Mapping[averages.ZoneKey, ValidityRow]]) -> str:
    """Ratios of surfaces that differ in their size g alone, not in amplitude, shape or zone."""
    keys = sorted(set.intersection(*(set(table) for table in tables)))
    return _table(
        "Hysteresis of the front over the hysteresis of boundary elements. Rows differ in g alone "
        "if amplitude, shape and *zone / cutoff* are equal: the length of the cohesive zone over "
        "the cutoff. Intervals are 68% (Student's t).",
        "roll-off / cutoff | H | e_el | zone / cutoff | g | ratio | interval | surfaces",
        (
            f"{row.roll_off:g} | {row.hurst:g} | {row.elastic_energy:.4f} | {key.zone:g} | "
            f"{row.size:.2g} | {row.ratio:.2f} | {_interval(row)} | {row.surfaces}"
            for key in keys
            for row in (table[key] for table in tables)
        ),
    )


def _interval(row: ValidityRow) -> str:
    """Interval of 68% of a ratio; empty for a single surface."""
    if not math.isfinite(row.error):
        return ""
    return f"{row.ratio * math.exp(-row.error):.2f} to {row.ratio * math.exp(row.error):.2f}"


_CRACK = "points | range | e_el | crack"


def _crack_cells(row: Differences) -> str:
    """Cells of :data:`_CRACK`."""
    crack = "turns" if row.rotated else "fixed"
    return f"{row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} | {crack}"


def _difference_table(loops: Sequence[Differences]) -> str:
    """Forces, areas and perimeters."""
    return _table(
        "Boundary elements minus front. Forces are in units of the pull-off force of the smooth "
        "sphere, and areas are relative. Distances of perimeters are in short cutoffs: at the "
        "shown penetration of each branch, and in the mean of all states. The crack *turns* with "
        "the edge or is *fixed*.",
        f"{_CRACK} | force, mean | median size | rms | largest | area, mean | rms "
        "| perimeter, appr. | retr. | all",
        (
            f"{_crack_cells(row)} | {row.force_mean / PULL_OFF:.2%} | "
            f"{row.force_median / PULL_OFF:.2%} | {row.force_rms / PULL_OFF:.2%} | "
            f"{row.force_largest / PULL_OFF:.2%} | {row.area_mean:.2%} | {row.area_rms:.2%} | "
            f"{row.perimeter_approach:.4f} | {row.perimeter_retraction:.4f} | "
            f"{row.perimeter_all:.4f}"
            for row in loops
        ),
    )


def _jump_table(loops: Sequence[Differences]) -> str:
    """Jumps and the end of contact."""
    return _table(
        "Jumps are arcs of the perimeter that move a quarter of a short cutoff or more in one load "
        "step. A jump of the front is *shared* if the boundary elements jump at the same place "
        "within 0.1 of penetration; shifts of penetration are boundary elements minus front.",
        f"{_CRACK} | boundary | front | shared | mean shift | rms shift | pull-off force "
        "| end of contact",
        (
            f"{_crack_cells(row)} | {row.jumps_boundary} | {row.jumps_front} | "
            f"{row.jumps_shared} | {row.jump_shift:.4f} | {row.jump_spread:.4f} | "
            f"{row.pull_off_force / PULL_OFF:.2%} | {row.pull_off_penetration:.3f}"
            for row in loops
        ),
    )


def edge_table(rows: Sequence[EdgeForces]) -> str:
    """Forces of the front's model on the edges of boundary elements."""
    return _table(
        "Rms slope of the edge, rms of w_loc along it (*pinning*, in w_int), and the remaining "
        "force in the model of the front over the pinning. *Line* is the force of the line that "
        "would balance the other forces, over the force of first order.",
        "points | range | e_el | slope | pinning | left / pinning | line",
        (
            f"{row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} | "
            f"{row.slope:.2f} | {row.pinning:.2f} | {row.left / row.pinning:.2f} | {row.share:.2f}"
            for row in rows
        ),
    )
