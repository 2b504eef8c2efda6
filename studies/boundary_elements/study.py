"""A validation, case by case: what is computed, found again and written."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path

from crackfront.measured.optional_libraries import MissingExtraError
from crackfront.plots.style import save_figure
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.storage import write_text
from studies.boundary_elements.averages import limit_settings
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import RUNNING, BoundaryCycle, boundary_cycle
from studies.boundary_elements.differences import Differences, differences
from studies.boundary_elements.edges import EdgeForces, edge_forces
from studies.boundary_elements.front import FrontCycle, front_cycle
from studies.boundary_elements.hysteresis import Hysteresis, hysteresis
from studies.boundary_elements.parameters import (
    FrontSection,
    ValidationParameters,
    validation_cases,
)
from studies.boundary_elements.picture import (
    edge_figure,
    hysteresis_figure,
    validation_figure,
    validation_picture,
)
from studies.boundary_elements.report import validation_report
from studies.records import read_record, write_record, write_records

Progress = Callable[[str], None]

_LIBRARIES = ("ContactMechanics", "Adhesion", "SurfaceTopography", "finufft")


def check_libraries() -> None:
    """Raise before anything is computed if a library is missing that a validation needs."""
    for name in _LIBRARIES:
        try:
            import_module(name)
        except ModuleNotFoundError as error:
            raise MissingExtraError("boundary elements", error, "bem") from error


def write_validation(
    folder: Path,
    parameters: ValidationParameters,
    origin: Provenance,
    progress: Progress,
    watched: Callable[[tuple[Case, ...]], Iterable[Case]] = iter,
) -> None:
    """Compare the front with boundary elements, case by case, and write what is found so far.

    Every load step of the boundary elements is kept in the folder, and found again. Cases are
    computed as `watched` yields them, which may show how far this is. A ValueError says if a front
    fails.
    """
    fronts = _Fronts(parameters.front)
    rows: list[Hysteresis] = []
    loops: list[Differences] = []
    edges: list[EdgeForces] = []
    pictured: tuple[float, ...] = ()
    for case in watched(validation_cases(parameters)):
        boundary = _cycle(folder, case, origin, progress)
        rows.append(hysteresis(case, boundary, fronts.cycle(case)))
        write_records(folder / "hysteresis.nc", rows, "case", origin)
        if case.loads.steady is None:
            loops += _loop_differences(case, boundary, fronts)
            write_records(folder / "differences.nc", loops, "case", origin)
        elif case.elastic_energy:
            edges.append(edge_forces(case, boundary, fronts.cycle(case)))
            write_records(folder / "edges.nc", edges, "case", origin)
        write_text(folder / "validation.md", validation_report(rows, loops))
        rank = case.elastic_energy, -case.roll_off, case.n_point
        if case.elastic_energy and rank > pictured:
            _write_picture(folder, case, boundary, fronts, origin)
            pictured = rank
        progress(
            f"{case.label}: hysteresis {rows[-1].boundary_difference:.4f} by boundary elements, "
            f"{rows[-1].front_difference:.4f} by the front"
        )
    if edges:
        save_figure(edge_figure(edges), folder / "edges")
    if limit_settings(rows):
        save_figure(hysteresis_figure(rows, parameters.short_cutoff), folder / "hysteresis")
    progress(f"tables: {folder / 'validation.md'}")


class _Fronts:
    """Cycles of the crack front on the surfaces of the cases, each computed once."""

    def __init__(self, numerics: FrontSection) -> None:
        self._numerics = numerics
        self._cycles: dict[tuple[object, ...], FrontCycle] = {}

    def cycle(self, case: Case, *, rotated: bool = True) -> FrontCycle:
        """Cycle on the surface of a case, with a crack that turns with the angle or not."""
        key = *case.surface, rotated
        if key not in self._cycles:
            n_angle, spacing = self._numerics.n_angle, self._numerics.spacing
            self._cycles[key] = front_cycle(case, n_angle, spacing, rotated=rotated)
        return self._cycles[key]


def _loop_differences(case: Case, boundary: BoundaryCycle, fronts: _Fronts) -> list[Differences]:
    """Differences of both models over a loop, with a crack that turns with the angle and not."""
    # The front of a smooth sphere does not know where the crack points.
    cracks = (True, False) if case.elastic_energy else (True,)
    return [differences(case, boundary, fronts.cycle(case, rotated=rotated)) for rotated in cracks]


def _write_picture(
    folder: Path, case: Case, boundary: BoundaryCycle, fronts: _Fronts, origin: Provenance
) -> None:
    """Write the data and the figure of a case."""
    rotated, unrotated = fronts.cycle(case), fronts.cycle(case, rotated=False)
    picture = validation_picture(case, boundary, rotated, unrotated)
    write_record(folder / "picture.nc", picture, origin, case=case.label)
    save_figure(validation_figure(picture), folder / "validation")


def _cycle(folder: Path, case: Case, origin: Provenance, progress: Progress) -> BoundaryCycle:
    """Cycle of a case: read, else continued or computed."""
    path = folder / f"{case.stem}.nc"
    stored = read_record(path, BoundaryCycle) if path.exists() else None
    if stored is not None and stored.status != RUNNING:
        return stored

    def keep(cycle: BoundaryCycle) -> None:
        write_record(path, cycle, origin, case=case.label)
        branch = "approach" if cycle.direction[-1] > 0 else "retraction"
        progress(
            f"{case.label}: {branch} to {cycle.penetration[-1]:.4g}, force {cycle.force[-1]:.4f}, "
            f"{cycle.seconds[-1]:.2f} s"
        )

    return boundary_cycle(case, stored, keep)
