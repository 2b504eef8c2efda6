"""What the pages show of the comparisons that are kept, for `<!-- boundary-elements: PART -->`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

from crackfront.analysis.validity import ValidityRow, excess_coefficient
from crackfront.data.files import read_attributes
from crackfront.data.records import read_records
from studies.boundary_elements import report
from studies.boundary_elements.averages import brought_to_no_range, rows_by_zone
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.edges import EdgeForces
from studies.boundary_elements.hysteresis import Hysteresis

REFERENCES = Path("docs/reference/validation")

SHORT_CUTOFFS = {"strong": 0.15, "fine": 0.05}
"""Shortest wavelength of the surfaces of `config/validation-<name>.yaml`."""


def page_parts() -> Iterator[tuple[dict[str, str], dict[str, Any]]]:
    """Parts from each kept file, and what the file says of its origin."""
    kept = kept_surfaces()
    origins = [read_attributes(REFERENCES / f"hysteresis-{name}.nc") for name in kept]
    yield from zip((_strong_parts(kept["strong"]), _common_parts(kept)), origins, strict=True)
    for name in ("256", "512", "series"):
        path = REFERENCES / f"differences-{name}.nc"
        loops = read_records(path, Differences, "case")
        tables = {f"{part} {name}": text for part, text in report.loop_tables(loops).items()}
        yield tables, read_attributes(path)
    path = REFERENCES / "edges.nc"
    forces = read_records(path, EdgeForces, "case")
    yield {"edges": report.edge_table(forces)}, read_attributes(path)


def kept_surfaces() -> dict[str, Sequence[Hysteresis]]:
    """Rows of the surfaces of both branches, by the name of their configuration."""
    paths = {name: REFERENCES / f"hysteresis-{name}.nc" for name in SHORT_CUTOFFS}
    return {name: read_records(path, Hysteresis, "case") for name, path in paths.items()}


def kept_validity(kept: Mapping[str, Sequence[Hysteresis]]) -> list[ValidityRow]:
    """How far the front is right, by all surfaces: the table of the package."""
    strong, fine = (rows_by_zone(rows, SHORT_CUTOFFS[name]) for name, rows in kept.items())
    limits = [row for (*_, zone), row in strong.items() if not zone]
    return [*limits, *brought_to_no_range(fine, strong)]


def _strong_parts(rows: Sequence[Hysteresis]) -> dict[str, str]:
    """Tables and numbers of the surfaces of several amplitudes."""
    finest = max(rows, key=attrgetter("n_point"))
    alone = [row for row in rows if row.seed == finest.seed]
    return {
        "averages": report.surface_tables(rows)["averages"],
        "one surface": report.surface_tables(alone)["settings"],
        "orders": report.order_table(rows),
        "saddles": f"{sum(row.saddles for row in rows)}",
    }


def _common_parts(kept: Mapping[str, Sequence[Hysteresis]]) -> dict[str, str]:
    """Tables and numbers of the finer surfaces, and of all together."""
    told = kept_validity(kept)
    slope, error = excess_coefficient(told)
    zones = [rows_by_zone(rows, SHORT_CUTOFFS[name]) for name, rows in kept.items()]
    return {
        "fine": report.surface_tables(kept["fine"])["settings"],
        "ratios": report.ratio_table(told),
        "sizes": report.size_table(zones),
        "coefficient": f"{slope:.2f} ± {error:.2f}",
    }
