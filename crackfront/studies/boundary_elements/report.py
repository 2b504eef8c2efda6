"""The validation as a person reads it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crackfront.studies.boundary_elements.comparison import Comparison
from crackfront.studies.boundary_elements.trends import RotationEffect, Speed

_PULL_OFF = 1.5
"""Magnitude of the pull-off force of a smooth sphere (Units: pi w_int R)."""


def validation_report(
    differences: Sequence[Comparison],
    speeds: Sequence[Speed],
    effects: Sequence[RotationEffect],
) -> str:
    """Markdown tables of a validation.

    Parameters
    ----------
    differences : sequence of Comparison
        All cases, those without a range of attraction extrapolated.
    speeds : sequence of Speed
        Costs at equal error.
    effects : sequence of RotationEffect
        Works of adhesion with and without the rotation.
    """
    parts = [
        ["# Crack front against boundary elements", ""],
        _difference_rows(differences),
        _jump_rows([row for row in differences if row.elastic_energy > 0]),
        _trend_rows(differences),
        _speed_rows(speeds),
        _rotation_rows(effects),
    ]
    return "\n".join(line for part in parts for line in part)


def _difference_rows(differences: Sequence[Comparison]) -> list[str]:
    """Forces, areas and perimeters."""
    return [
        "Boundary elements minus front, in all states in which both have contact; in approach from "
        "the penetration b on at which the boundary elements have left, everywhere, the perimeter "
        "with which they jumped into contact. Forces in units of the smooth pull-off force, areas "
        "relative, distances of perimeters in short cutoffs: in approach and retraction at the "
        "shown penetration, and the mean over all states. Range 0 is extrapolated.",
        "",
        "| points | range | e_el | crack | from b | force, mean | median size | rms | largest "
        "| area, mean | rms | perimeter, appr. | retr. | all |",
        "| --: | --: | --: | --- " + "| --: " * 10 + "|",
        *(
            f"| {row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} "
            f"| {'turns' if row.rotated else 'fixed'} | {row.begin:.2f} "
            + "".join(
                f"| {100 * value / _PULL_OFF:.2f}% "
                for value in (row.force_mean, row.force_median, row.force_rms, row.force_largest)
            )
            + f"| {100 * row.area_mean:.2f}% | {100 * row.area_rms:.2f}% "
            f"| {row.perimeter_approach:.4f} | {row.perimeter_retraction:.4f} "
            f"| {row.perimeter_all:.4f} |"
            for row in differences
        ),
        "",
    ]


def _jump_rows(differences: Sequence[Comparison]) -> list[str]:
    """Jumps and the end of contact."""
    return [
        "## Jumps",
        "",
        "Arcs of the perimeter that move a quarter of a short cutoff or more in one load step; of "
        "the front's, those for which the boundary elements jump at the same place within 0.1 of "
        "penetration; their penetrations, boundary elements minus front.",
        "",
        "| points | range | e_el | crack | boundary | front | shared | mean shift | rms shift "
        "| pull-off force | end of contact |",
        "| --: | --: | --: | --- " + "| --: " * 7 + "|",
        *(
            f"| {row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} "
            f"| {'turns' if row.rotated else 'fixed'} | {row.jumps_boundary} | {row.jumps_front} "
            f"| {row.jumps_shared} | {row.jump_shift:.4f} | {row.jump_spread:.4f} "
            f"| {100 * row.pull_off_force / _PULL_OFF:.2f}% | {row.pull_off_penetration:.3f} |"
            for row in differences
            if row.interaction_range > 0
        ),
        "",
    ]


def _trend_rows(differences: Sequence[Comparison]) -> list[str]:
    """Orders in the range of the attraction and in the energy of full conformity."""
    smooth = [row for row in differences if row.elastic_energy == 0 and row.interaction_range > 0]
    limits = [row for row in differences if row.interaction_range == 0 and row.rotated]
    limits = [row for row in limits if row.elastic_energy > 0]
    lines = []
    if len({row.interaction_range for row in smooth}) > 1:
        ranges = [row.interaction_range for row in smooth]
        orders = [
            f"{name} {power_of(ranges, [getattr(row, key) for row in smooth]):.2f}"
            for name, key in (("rms force", "force_rms"), ("mean force", "force_mean"))
        ]
        lines += [f"Smooth sphere, order in the range: {', '.join(orders)}.", ""]
    if len(limits) > 1:
        energies = [row.elastic_energy for row in limits]
        orders = [
            f"{name} {power_of(energies, [getattr(row, key) for row in limits]):.2f}"
            for name, key in (
                ("rms force", "force_rms"),
                ("median force", "force_median"),
                ("perimeter", "perimeter_all"),
            )
        ]
        lines += [f"Extrapolated, order in e_el: {', '.join(orders)}.", ""]
    return ["## Trends", "", *lines] if lines else []


def power_of(abscissa: Sequence[float], ordinate: Sequence[float]) -> float:
    """Exponent of the power law through points, by least squares of the logarithms.

    Examples
    --------
    >>> round(power_of([1, 2, 4], [3, 12, -48]), 12)
    2.0
    """
    return float(np.polyfit(np.log(abscissa), np.log(np.abs(ordinate)), 1)[0])


def _speed_rows(speeds: Sequence[Speed]) -> list[str]:
    """Costs at equal error."""
    if not speeds:
        return []
    return [
        "## Cost of one cycle at equal error of the force",
        "",
        "Rms errors in units of the smooth pull-off force: of the boundary elements on the smooth "
        "sphere, where JKR is exact; of the front against one of many more sites. Seconds of one "
        "core, the front's with its field.",
        "",
        "| points | range | error | s | sites of the front | error | s | faster |",
        "| --: " * 8 + "|",
        *(
            f"| {row.n_point} | {row.interaction_range:g} "
            f"| {100 * row.boundary_error / _PULL_OFF:.2f}% | {row.boundary_seconds:.0f} "
            f"| {row.n_angle} | {100 * row.front_error / _PULL_OFF:.2f}% "
            f"| {row.front_seconds:.2f} | {row.boundary_seconds / row.front_seconds:.0f} |"
            for row in speeds
        ),
        "",
    ]


def _rotation_rows(effects: Sequence[RotationEffect]) -> list[str]:
    """Averages with and without the rotation."""
    if not effects:
        return []
    rows = (
        ("w_appr", [row.approach for row in effects], [row.approach_fixed for row in effects]),
        ("w_retr", [row.retraction for row in effects], [row.retraction_fixed for row in effects]),
    )
    return [
        "## The rotation of the crack and averages",
        "",
        f"Works of adhesion, in w_int, of {len(effects)} surfaces with a crack that turns and with "
        "one that does not: means, and mean and standard error of the paired difference.",
        "",
        "| | turns | fixed | difference | standard error |",
        "| --- " + "| --: " * 4 + "|",
        *(
            f"| {name} | {np.mean(turned):.5f} | {np.mean(fixed):.5f} "
            f"| {np.mean(np.subtract(turned, fixed)):.5f} "
            f"| {np.std(np.subtract(turned, fixed), ddof=1) / math.sqrt(len(effects)):.5f} |"
            for name, turned, fixed in rows
        ),
        "",
    ]
