"""The files of a validation by amplitude: its numbers, its figures and its tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.validity import validity_sentence, validity_text
from crackfront.data.files import write_text
from crackfront.data.provenance import Provenance
from crackfront.data.records import write_record, write_records
from crackfront.plots.style import save_figure
from studies.boundary_elements.amplitude_picture import (
    amplitude_picture,
    contact_figure,
    validity_figure,
)
from studies.boundary_elements.amplitudes import SurfaceComparison, compared_surfaces
from studies.boundary_elements.averages import (
    Setting,
    Value,
    limit_settings,
    settings,
    validity_row,
)
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.parameters import AmplitudeParameters, Case
from studies.boundary_elements.study import Progress, finished_cycle, stored_cycle


def write_amplitudes(
    folder: Path,
    parameters: AmplitudeParameters,
    origin: Provenance,
    progress: Progress,
    *,
    compute: bool = True,
) -> None:
    """Compare the front with boundary elements, case by case, and write what is found so far.

    Parameters
    ----------
    folder : Path
        Where every load step of the boundary elements is kept, and found again.
    compute : bool, optional
        Whether cases are computed that the folder does not hold; else they are left out.

    Raises
    ------
    ValueError
        If a front fails, or nothing is finished.
    """

    def cycle(case: Case) -> BoundaryCycle | None:
        path = folder / f"{case.stem}.nc"
        return stored_cycle(case, path, origin, progress) if compute else finished_cycle(path)

    rows: list[SurfaceComparison] = []
    pictured: tuple[float, ...] = ()
    for case, boundary, front, row in compared_surfaces(parameters, cycle):
        rows.append(row)
        write_records(folder / "differences.nc", rows, "case", origin)
        write_text(folder / "validation.md", amplitude_report(rows, parameters.short_cutoff))
        rank = row.asked_energy, -row.roll_off, row.n_point
        if not pictured or rank > pictured:
            pictured, picture = rank, amplitude_picture(case, boundary, front)
            write_record(folder / "picture.nc", picture, origin)
            save_figure(contact_figure(picture), folder / "contacts")
        progress(
            f"{case.label}: hysteresis {row.boundary_hysteresis:.4f} by boundary elements, "
            f"{row.front_hysteresis:.4f} by the front"
        )
    if not rows:
        raise ValueError(f"{folder} holds no finished case of this configuration; compute one")
    _write_validity(folder, rows, parameters.short_cutoff)
    progress(f"tables: {folder / 'validation.md'}")


def _write_validity(folder: Path, rows: Sequence[SurfaceComparison], short_cutoff: float) -> None:
    """Figure and table of the range within which the front's hysteresis holds."""
    limits = _rough(limit_settings(rows))
    if limits:
        save_figure(validity_figure(_rough(settings(rows)), limits), folder / "validation")
        told = [validity_row(one, short_cutoff) for one in limits]
        write_text(folder / "validity.csv", validity_text(told))


def _rough(found: Iterable[Setting]) -> list[Setting]:
    """Settings without the smooth spheres."""
    return [one for one in found if one.rows[0].asked_energy > 0]


def amplitude_report(rows: Sequence[SurfaceComparison], short_cutoff: float) -> str:
    """Markdown tables of what is finished."""
    found, limits = settings(rows), limit_settings(rows)
    told = [validity_row(one, short_cutoff) for one in _rough(limits)]
    parts = [
        ["# Crack front against boundary elements, by amplitude", ""],
        [validity_sentence(told), ""] if told else [],
        _hysteresis_rows((*found, *limits)),
        _change_rows(_rough(found)),
        _difference_rows(_rough(found)),
        _resolution_rows(rows),
        _minimiser_rows(found),
    ]
    return "\n".join(line for part in parts for line in part)


def _table(header: Sequence[str], lines: Iterable[Sequence[str]]) -> list[str]:
    """A table whose first columns say the setting."""
    head = ("roll-off", "e_el", "points", "range", "step", *header)
    return [
        "| " + " | ".join(head) + " |",
        "|" + " --: |" * len(head),
        *("| " + " | ".join(line) + " |" for line in lines),
        "",
    ]


def _setting(row: SurfaceComparison, energy: float) -> list[str]:
    """First cells of a row."""
    return [
        f"{row.roll_off:g}",
        f"{energy:.4f}",
        f"{row.n_point}",
        f"{row.interaction_range:g}",
        f"{row.step:g}",
    ]


def _cells(found: Setting, *values: Value, digits: int = 4) -> list[str]:
    """Means over the surfaces, with their standard errors where there are two or more."""
    return [_shown(found.mean(value), digits) for value in values]


def _shown(found: Estimate, digits: int) -> str:
    """A value and its standard error, if it has one."""
    value, error = float(found.value), float(found.standard_error)
    if math.isnan(value):
        return ""
    return f"{value:.{digits}f}" + (f" ({error:.{digits}f})" if math.isfinite(error) else "")


def _energy(row: SurfaceComparison) -> float:
    """Energy of full conformity (Units: w_int)."""
    return row.elastic_energy


def _hysteresis_rows(found: Sequence[Setting]) -> list[str]:
    """Works of adhesion, factors and midpoints of both models."""
    lines = []
    for one in found:
        row = one.rows[0]
        lines.append(
            [
                *_setting(row, float(one.mean(_energy).value)),
                f"{one.surfaces}",
                *_cells(
                    one,
                    lambda row: row.boundary_approach,
                    lambda row: row.front_approach,
                    lambda row: row.boundary_retraction,
                    lambda row: row.front_retraction,
                    lambda row: (row.boundary_approach + row.boundary_retraction) / 2,
                    lambda row: (row.front_approach + row.front_retraction) / 2,
                    lambda row: row.boundary_hysteresis,
                    lambda row: row.front_hysteresis,
                ),
                *(_cells(one, _factor, _front_factor, digits=2) if row.asked_energy else ["", ""]),
                _shown(one.hysteresis_ratio(), 2) if row.asked_energy else "",
            ]
        )
    return [
        "Works of adhesion of the smooth sphere with the same force at the same penetration, in "
        "w_int; boundary elements first, then the front on the same surfaces; in brackets standard "
        "errors over surfaces. Hysteresis: the energy that either branch loses per area that it "
        "sweeps, summed; k is half of it over e_el. Ratio: front over boundary elements. Range 0 "
        "is extrapolated from the two shortest of a surface: the mean of the longest over all "
        "surfaces, and that of what extrapolation changes on those that have a shorter one.",
        "",
        *_table(
            (
                *("surfaces", "w_appr", "front", "w_retr", "front", "mean", "front"),
                *("hysteresis", "front", "k", "front", "ratio"),
            ),
            lines,
        ),
    ]


def _factor(row: SurfaceComparison) -> float:
    """Factor k of the boundary elements."""
    return row.boundary_hysteresis / (2 * row.elastic_energy)


def _front_factor(row: SurfaceComparison) -> float:
    """Factor k of the front."""
    return row.front_hysteresis / (2 * row.elastic_energy)


def _change_rows(found: Sequence[Setting]) -> list[str]:
    """What changes of the front's model that are as cheap would give."""
    lines = [
        [
            *_setting(one.rows[0], float(one.mean(_energy).value)),
            *_cells(
                one,
                lambda row: row.boundary_hysteresis,
                lambda row: row.front_hysteresis,
                lambda row: row.zone_hysteresis,
                lambda row: row.squared_hysteresis,
                lambda row: (row.zone_approach + row.zone_retraction) / 2,
                lambda row: (row.squared_approach + row.squared_retraction) / 2,
            ),
        ]
        for one in found
    ]
    return [
        "Changes of the model that are as cheap, by their hysteresis. With zone: a front that "
        "feels the mean of the heights over a cohesive zone of the length E' w_int / tension^2. "
        "With square: a front whose energy release rate has K^2 / 2E' of the roughness where it "
        "acts, in place of its mean e_el.",
        "",
        *_table(
            ("hysteresis", "front", "with zone", "with square", "mean, zone", "mean, square"),
            lines,
        ),
    ]


def _difference_rows(found: Sequence[Setting]) -> list[str]:
    """Areas, jumps and lost energies."""
    lines = [
        [
            *_setting(one.rows[0], float(one.mean(_energy).value)),
            *_cells(
                one,
                lambda row: 100 * row.repelling,
                lambda row: 100 * row.open_inside,
                lambda row: 100 * row.closed_outside,
                lambda row: 100 * row.pockets,
                lambda row: 100 * row.islands,
                lambda row: 100 * row.overhangs,
                digits=2,
            ),
            *_cells(one, lambda row: row.boundary_jumps, lambda row: row.front_jumps, digits=0),
            *_cells(one, lambda row: row.boundary_dissipated, lambda row: row.front_dissipated),
        ]
        for one in found
    ]
    return [
        "Percent of the front's area: what repels it, what it counts as contact and boundary "
        "elements leave open, and the other way round; of the boundary elements the open pockets "
        "within the contact, closed islands outside it, and overhangs. Jumps of a quarter of a "
        "cutoff or more, where load steps are small enough to tell them, and the energy that both "
        "branches lose, in units of pi w_int R and a reduced vertical length.",
        "",
        *_table(
            (
                *("repels", "open inside", "closed outside", "pockets", "islands", "overhangs"),
                *("jumps", "front", "energy lost", "front"),
            ),
            lines,
        ),
    ]


def _resolution_rows(rows: Sequence[SurfaceComparison]) -> list[str]:
    """Hysteresis of the boundary elements on one surface at every resolution."""
    lines = []
    scenes = sorted({(*row.scene, row.seed) for row in rows if row.asked_energy > 0})
    for scene in scenes:
        alike = [row for row in rows if (*row.scene, row.seed) == scene]
        if len(alike) < 2:
            continue
        alike.sort(key=lambda row: (-row.interaction_range, row.n_point, -row.step))
        first = alike[0]
        for row in alike:
            change = row.boundary_hysteresis / first.boundary_hysteresis - 1
            lines.append(
                [
                    *_setting(row, row.elastic_energy),
                    f"{row.boundary_approach:.4f}",
                    f"{row.boundary_retraction:.4f}",
                    f"{row.boundary_hysteresis:.4f}",
                    f"{100 * change:+.1f}%",
                    f"{row.front_hysteresis:.4f}",
                ]
            )
    if not lines:
        return []
    return [
        "One surface by boundary elements at several resolutions: hysteresis, and its change from "
        "the coarsest.",
        "",
        *_table(("w_appr", "w_retr", "hysteresis", "change", "front"), lines),
    ]


def _minimiser_rows(found: Sequence[Setting]) -> list[str]:
    """What the minimiser did, and the processor time."""
    lines = [
        [
            *_setting(one.rows[0], float(one.mean(_energy).value)),
            f"{one.mean(lambda row: row.products).value:.0f}",
            f"{sum(row.barriers for row in one.rows)}",
            f"{sum(row.saddles for row in one.rows)}",
            f"{min(row.least_released for row in one.rows):.1e}",
            f"{one.mean(lambda row: row.boundary_seconds).value:.0f}",
            f"{one.mean(lambda row: row.front_seconds).value:.1f}",
        ]
        for one in found
    ]
    hours = sum(row.boundary_seconds for one in found for row in one.rows) / 3600
    return [
        "Products of a load step; steps that would have passed a barrier and were shortened; "
        "states without forces that were no minimum and were left; least fall of the energy at a "
        f"penetration; seconds of one core for a surface. Boundary elements took {hours:.2f} core "
        "hours in all.",
        "",
        *_table(("products", "barriers", "saddles", "least fall", "s", "front, s"), lines),
    ]
