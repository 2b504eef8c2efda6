"""What the pages show of the comparisons that are kept, for `<!-- boundary-elements: PART -->`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

from crackfront.analysis.validity import excess_coefficient
from crackfront.data.files import read_attributes
from crackfront.data.records import read_records
from studies.boundary_elements.averages import validity_rows
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.edges import EdgeForces
from studies.boundary_elements.hysteresis import Hysteresis
from studies.boundary_elements.report import edge_table, loop_tables, surface_tables

REFERENCES = Path("docs/reference/validation")

SHORT_CUTOFF = 0.15
"""Shortest wavelength of the surfaces of `config/validation-strong.yaml`."""


def page_parts() -> Iterator[tuple[dict[str, str], dict[str, Any]]]:
    """Parts from each kept file, and what the file says of its origin."""
    path = REFERENCES / "hysteresis-strong.nc"
    yield surface_parts(read_records(path, Hysteresis, "case")), read_attributes(path)
    for name in ("256", "512", "series"):
        path = REFERENCES / f"differences-{name}.nc"
        rows = read_records(path, Differences, "case")
        tables = {f"{part} {name}": text for part, text in loop_tables(rows).items()}
        yield tables, read_attributes(path)
    path = REFERENCES / "edges.nc"
    yield {"edges": edge_table(read_records(path, EdgeForces, "case"))}, read_attributes(path)


def surface_parts(rows: Sequence[Hysteresis]) -> dict[str, str]:
    """Tables and numbers of the surfaces of both branches."""
    tables, finest = surface_tables(rows, SHORT_CUTOFF), max(rows, key=attrgetter("n_point"))
    alone = surface_tables([row for row in rows if row.seed == finest.seed], SHORT_CUTOFF)
    slope, error = excess_coefficient(validity_rows(rows, SHORT_CUTOFF))
    return {
        "ratios": tables["ratios"],
        "averages": tables["averages"],
        "one surface": alone["settings"],
        "saddles": f"{sum(row.saddles for row in rows)}",
        "coefficient": f"{slope:.2f} ± {error:.2f}",
    }
