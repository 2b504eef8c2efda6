"""The files of a validation: its numbers, its figure, and its tables as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crackfront.analysis.validity import ValidityRow, validity_text
from crackfront.data.files import write_text
from crackfront.data.provenance import Provenance
from crackfront.data.records import write_record, write_records
from crackfront.plots.style import save_figure
from studies.boundary_elements.comparison import Comparison
from studies.boundary_elements.parameters import ValidationParameters
from studies.boundary_elements.picture import ValidationPicture, validation_figure
from studies.boundary_elements.study import Progress, RotationEffect, Speed, validation

_PULL_OFF = 1.5
"""Magnitude of the pull-off force of a smooth sphere (Units: pi w_int R)."""


def write_validation(
    folder: Path, parameters: ValidationParameters, origin: Provenance, progress: Progress
) -> None:
    """Compute what a folder does not hold of a validation, and write all that it finds."""
    found = validation(parameters, folder, origin, progress)
    for name, rows, along in (
        ("differences", found.differences, "case"),
        ("speed", found.speeds, "case"),
        ("rotation", found.effects, "surface"),
        ("jumps-boundary", [boundary for boundary, _ in found.jumps], "jump"),
        ("jumps-front", [front for _, front in found.jumps], "jump"),
    ):
        if rows:
            write_records(folder / f"{name}.nc", rows, along, origin)
    if found.picture is not None:
        write_record(folder / "picture.nc", found.picture, origin)
        for path in save_figure(validation_figure(found.picture), folder / "validation"):
            progress(f"figure: {path}")
        write_text(folder / "validity.csv", validity_text([loop_validity(found.picture)]))
    report = validation_report(found.differences, found.speeds, found.effects)
    write_text(folder / "validation.md", report, sealed=True)
    progress(f"tables: {folder / 'validation.md'}")


def loop_validity(picture: ValidationPicture) -> ValidityRow:
    """What the front's hysteresis is worth on a flat surface, by the work between the branches.

    That of the force from b = 0 on, where both models have both branches.
    """
    work = []
    for penetration, direction, force in (
        (picture.boundary_penetration, picture.boundary_direction, picture.boundary_force),
        (picture.front_penetration, picture.front_direction, picture.front_force),
    ):
        approach, retraction = (
            np.flatnonzero((direction == sign) & (penetration > -1e-9))[::sign] for sign in (1, -1)
        )
        back = np.interp(penetration[approach], penetration[retraction], force[retraction])
        # The deepest state is that of both branches.
        back[-1] = force[approach[-1]]
        work.append(float(np.trapezoid(force[approach] - back, penetration[approach])))
    return ValidityRow(
        roll_off=1.0,
        hurst=1.0,
        elastic_energy=picture.elastic_energy,
        ratio=work[1] / work[0],
        error=math.nan,
        surfaces=1,
        fine=1,
        n_point=picture.n_point,
        interaction_range=picture.interaction_range,
    )


def validation_report(
    differences: Sequence[Comparison],
    speeds: Sequence[Speed],
    effects: Sequence[RotationEffect],
) -> str:
    """Markdown tables; of differences, those without a range of attraction are extrapolated."""
    parts = [
        ["# Crack front against boundary elements", ""],
        _difference_rows(differences),
        _jump_rows([row for row in differences if row.elastic_energy > 0]),
        _trend_rows(differences),
        _speed_rows(speeds),
        _rotation_rows(effects),
    ]
    return "\n".join(line for part in parts for line in part)


def _case(row: Comparison) -> str:
    """First cells of a row."""
    crack = "turns" if row.rotated else "fixed"
    return f"| {row.n_point} | {row.interaction_range:g} | {row.elastic_energy:.4f} | {crack}"


def _relative(force: float) -> str:
    """A force relative to the pull-off force."""
    return f"{100 * force / _PULL_OFF:.2f}%"


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
            f"{_case(row)} | {row.begin:.2f} | {_relative(row.force_mean)} "
            f"| {_relative(row.force_median)} | {_relative(row.force_rms)} "
            f"| {_relative(row.force_largest)} "
            f"| {100 * row.area_mean:.2f}% | {100 * row.area_rms:.2f}% "
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
            f"{_case(row)} | {row.jumps_boundary} | {row.jumps_front} | {row.jumps_shared} "
            f"| {row.jump_shift:.4f} | {row.jump_spread:.4f} | {_relative(row.pull_off_force)} "
            f"| {row.pull_off_penetration:.3f} |"
            for row in differences
            if row.interaction_range > 0
        ),
        "",
    ]


def _trend_rows(differences: Sequence[Comparison]) -> list[str]:
    """Orders in the range of the attraction and in the energy of full conformity."""
    smooth = [row for row in differences if row.elastic_energy == 0 and row.interaction_range > 0]
    rough = [row for row in differences if row.elastic_energy > 0 and row.rotated]
    limits = [row for row in rough if row.interaction_range == 0]
    rms, mean = ("rms force", "force_rms"), ("mean force", "force_mean")
    others = ("median force", "force_median"), ("perimeter", "perimeter_all")
    lines = []
    for what, rows, key, ordinates in (
        ("Smooth sphere, order in the range", smooth, "interaction_range", (rms, mean)),
        ("Extrapolated, order in e_el", limits, "elastic_energy", (rms, *others)),
    ):
        abscissa = [getattr(row, key) for row in rows]
        if len(set(abscissa)) > 1:
            orders = (
                f"{name} {power_of(abscissa, [getattr(row, ordinate) for row in rows]):.2f}"
                for name, ordinate in ordinates
            )
            lines += [f"{what}: {', '.join(orders)}.", ""]
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
            f"| {row.n_point} | {row.interaction_range:g} | {_relative(row.boundary_error)} "
            f"| {row.boundary_seconds:.0f} | {row.n_angle} | {_relative(row.front_error)} "
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
