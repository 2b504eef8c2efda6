"""A validation, case by case: what is computed, resumed and written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

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
from studies.progress import Progress
from studies.records import read_record, write_record, write_records

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
    """Compare the front with boundary elements, case by case, and write the results so far.

    Every load step of the boundary elements is kept in the folder, so that a run resumes. Cases are
    computed as `watched` yields them, which may show how far this is. A ValueError says if a front
    fails.
    """
    results = _Results(folder, origin, _Fronts(parameters.front))
    for case in watched(validation_cases(parameters)):
        row = results.add(case, _cycle(folder, case, origin, progress))
        progress(
            f"{case.label}: hysteresis {row.boundary_difference:.4f} by boundary elements, "
            f"{row.front_difference:.4f} by the front"
        )
    results.draw(parameters.short_cutoff)
    progress(f"tables: {folder / 'validation.md'}")


class _Results:
    """Finished cases, written to a folder whenever one is added."""

    def __init__(self, folder: Path, origin: Provenance, fronts: _Fronts) -> None:
        self._folder, self._origin, self._fronts = folder, origin, fronts
        self._rows: list[Hysteresis] = []
        self._loops: list[Differences] = []
        self._edges: list[EdgeForces] = []
        self._pictured_rank: tuple[float, ...] = ()

    def add(self, case: Case, boundary: BoundaryCycle) -> Hysteresis:
        """Compare the front with a case, and write all tables again; the row of the case."""
        row = hysteresis(case, boundary, self._fronts.cycle(case))
        self._rows.append(row)
        self._write("hysteresis.nc", self._rows)
        if case.loads.steady is None:
            self._loops += _loop_differences(case, boundary, self._fronts)
            self._write("differences.nc", self._loops)
        elif case.elastic_energy:
            self._edges.append(edge_forces(case, boundary, self._fronts.cycle(case)))
            self._write("edges.nc", self._edges)
        report = validation_report(self._rows, self._loops)
        write_text(self._folder / "validation.md", report)
        # The picture shows the roughest case, of these the shortest roll-off and finest grid.
        rank = case.elastic_energy, -case.roll_off, case.n_point
        if case.elastic_energy and rank > self._pictured_rank:
            _write_picture(self._folder, case, boundary, self._fronts, self._origin)
            self._pictured_rank = rank
        return row

    def _write(self, name: str, records: Sequence[Any]) -> None:
        """Write the records of all cases so far."""
        write_records(self._folder / name, records, "case", self._origin)

    def draw(self, short_cutoff: float) -> None:
        """Draw the figures of all cases, if there are enough."""
        if self._edges:
            save_figure(edge_figure(self._edges), self._folder / "edges")
        if limit_settings(self._rows):
            figure = hysteresis_figure(self._rows, short_cutoff)
            save_figure(figure, self._folder / "hysteresis")


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
