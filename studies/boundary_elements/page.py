"""What the pages show of the comparisons that are kept: tables and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

from crackfront.analysis.validity import ValidityRow, excess_coefficient
from crackfront.simulate.storage import read_attributes
from studies.boundary_elements import report
from studies.boundary_elements.averages import brought_to_no_range, rows_by_zone
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.edges import EdgeForces
from studies.boundary_elements.hysteresis import Hysteresis
from studies.numbers import Number
from studies.records import read_records
from studies.tables import Table

REFERENCES = Path("docs/reference/validation")

_QUOTED = "512"
"""Points along a side of the loops whose numbers the pages quote."""

_NANODIAMOND = 0.177
"""e_el of the paper's nanodiamond. (Units: w_int)"""

SHORT_CUTOFFS = {"strong": 0.15, "fine": 0.05}
"""Shortest wavelength of the surfaces of `config/validation-<name>.yaml`."""


def page_parts() -> Iterator[tuple[dict[str, Table], dict[str, Number], dict[str, Any]]]:
    """Tables and numbers from each kept file, and what the file says of its origin."""
    surfaces = kept_surfaces()
    strong, fine = (read_attributes(REFERENCES / f"hysteresis-{name}.nc") for name in surfaces)
    yield *_strong_parts(surfaces["strong"]), strong
    yield *_common_parts(surfaces), fine
    for name in ("256", "512", "series"):
        path = REFERENCES / f"differences-{name}.nc"
        loops = read_records(path, Differences, "case")
        tables = {f"{part} {name}": table for part, table in report.loop_tables(loops).items()}
        numbers = _loop_numbers(loops) if name == _QUOTED else {}
        yield tables, numbers, read_attributes(path)
    path = REFERENCES / "edges.nc"
    forces = read_records(path, EdgeForces, "case")
    yield {"edges": report.edge_table(forces)}, {}, read_attributes(path)


def kept_surfaces() -> dict[str, Sequence[Hysteresis]]:
    """Rows of the surfaces of both branches, by the name of their configuration."""
    paths = {name: REFERENCES / f"hysteresis-{name}.nc" for name in SHORT_CUTOFFS}
    return {name: read_records(path, Hysteresis, "case") for name, path in paths.items()}


def kept_validity(surfaces: Mapping[str, Sequence[Hysteresis]]) -> list[ValidityRow]:
    """How far the front is right, by all surfaces: the table of the package."""
    strong, fine = (rows_by_zone(rows, SHORT_CUTOFFS[name]) for name, rows in surfaces.items())
    limits = [row for key, row in strong.items() if not key.zone]
    return [*limits, *brought_to_no_range(fine, strong)]


def _strong_parts(rows: Sequence[Hysteresis]) -> tuple[dict[str, Table], dict[str, Number]]:
    """Tables and numbers of the surfaces of several amplitudes."""
    finest = max(rows, key=attrgetter("n_point"))
    alone = [row for row in rows if row.seed == finest.seed]
    tables = {
        "averages": report.surface_tables(rows)["averages"],
        "one surface": report.surface_tables(alone)["settings"],
        "orders": report.order_table(rows),
    }
    return tables, {"saddles": Number(sum(row.saddles for row in rows))}


def _common_parts(
    surfaces: Mapping[str, Sequence[Hysteresis]],
) -> tuple[dict[str, Table], dict[str, Number]]:
    """Tables and numbers of the finer surfaces, and of all together."""
    validity = kept_validity(surfaces)
    slope, error = excess_coefficient(validity)
    zones = [rows_by_zone(rows, SHORT_CUTOFFS[name]) for name, rows in surfaces.items()]
    tables = {
        "fine": report.surface_tables(surfaces["fine"])["settings"],
        "ratios": report.ratio_table(validity),
        "sizes": report.size_table(zones),
    }
    ratio = math.exp(slope * _NANODIAMOND)
    numbers = {
        "coefficient": Number(slope, error, reason="standard error"),
        f"ratio at e_el = {_NANODIAMOND:g}": Number(ratio, ratio * error * _NANODIAMOND),
    }
    return tables, numbers


def _loop_numbers(loops: Sequence[Differences]) -> dict[str, Number]:
    """Differences of the front whose crack turns from the only rough loop."""
    (loop,) = (
        loop_differences
        for loop_differences in loops
        if loop_differences.elastic_energy > 0 and loop_differences.rotated
    )
    unit = "pull-off force of the smooth sphere"
    return {
        "median difference of the force": Number(loop.force_median / report.PULL_OFF, unit=unit),
        "jumps of the front": Number(loop.jumps_front),
        "shared jumps of the front": Number(loop.jumps_shared),
    }
