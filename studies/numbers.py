"""Numbers, tables and figures that studies have measured, a JSON file for each study.

The rows of a table are in a CSV file of :mod:`studies.tables`, which the JSON file names.

A number never becomes stale: it says where it was measured. Canaries recompute some of them every
night (:mod:`studies.canaries`), and a release measures all of them again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from crackfront.simulate.provenance import provenance, utc_now
from crackfront.simulate.storage import write_text
from studies.tables import Table, read_table, table_path, write_table

STORED = Path("docs/reference/numbers")
"""Folder of the files, each named as its study."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
    """Command, commit, machine and date of a measurement; empty until it is stored."""

    command: str = ""
    commit: str = ""
    machine: str = ""
    date: str = ""


@dataclass(frozen=True, slots=True)
class Number(Origin):
    """A measured number.

    Its error is half of a 95% interval if no reason says something else, and None if it is unknown.
    """

    value: float
    error: float | None = None
    unit: str = "1"
    reason: str = ""


@dataclass(frozen=True, slots=True)
class StoredTable(Origin):
    """A table of a CSV file; the JSON file has its note."""

    table: Table


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredFigure(Origin):
    """A figure of the gallery."""

    title: str
    picture: str
    """Name of its picture."""
    scale: str
    cpu_seconds: float
    """Processor time of its data. (Units: s)"""
    checks: Table
    """Its checks, which are in a CSV file."""


@dataclass(frozen=True, slots=True)
class Stored:
    """What is stored of a study, by name."""

    numbers: dict[str, Number] = field(default_factory=dict)
    canaries: dict[str, Number] = field(default_factory=dict)
    tables: dict[str, StoredTable] = field(default_factory=dict)
    figures: dict[str, StoredFigure] = field(default_factory=dict)


def stored(study: str) -> Stored:
    """What is stored of a study; empty if its file does not exist."""
    path = STORED / f"{study}.json"
    if not path.exists():
        return Stored()
    content = json.loads(path.read_text(encoding="utf-8"))
    return Stored(
        numbers={name: Number(**entry) for name, entry in content["numbers"].items()},
        canaries={name: Number(**entry) for name, entry in content["canaries"].items()},
        tables={name: _stored_table(entry) for name, entry in content["tables"].items()},
        figures={name: _stored_figure(entry) for name, entry in content["figures"].items()},
    )


def _stored_table(entry: dict[str, Any]) -> StoredTable:
    """Table of an entry of a JSON file, which names its CSV file."""
    table = read_table(Path(entry.pop("file")), entry.pop("note", ""))
    return StoredTable(table, **entry)


def _stored_figure(entry: dict[str, Any]) -> StoredFigure:
    """Figure of an entry of a JSON file, which names the CSV file of its checks."""
    checks = read_table(Path(entry.pop("file")))
    return StoredFigure(checks=checks, **entry)


def checks_path(study: str, figure: str) -> Path:
    """File with the checks of a figure."""
    return table_path(study, f"checks {figure}")


def store(
    study: str,
    *,
    numbers: Mapping[str, Number] | None = None,
    canaries: Mapping[str, Number] | None = None,
    tables: Mapping[str, Table] | None = None,
    figures: Mapping[str, StoredFigure] | None = None,
    data: Mapping[str, Any] | None = None,
) -> None:
    """Store what a study has measured; its other entries stay.

    The attributes of a file of data say where they were measured, if that is not here.
    """
    origin = _origin(data if data is not None else asdict(provenance()) | {"date": utc_now()})
    record = stored(study)
    for section, measured in ((record.numbers, numbers), (record.canaries, canaries)):
        for name, number in (measured or {}).items():
            section[name] = replace(number, **asdict(origin))
    for name, table in (tables or {}).items():
        record.tables[name] = StoredTable(table, **asdict(origin))
        write_table(table_path(study, name), table)
    for name, figure in (figures or {}).items():
        record.figures[name] = replace(figure, **asdict(origin))
        write_table(checks_path(study, name), figure.checks)
    text = json.dumps(_content(study, record), indent=1, ensure_ascii=False, sort_keys=True)
    write_text(STORED / f"{study}.json", text + "\n")


def _content(study: str, record: Stored) -> dict[str, Any]:
    """Content of the JSON file of a study, which names the files of its tables."""
    content = asdict(record)
    for name, entry in content["tables"].items():
        entry["file"] = str(table_path(study, name))
        if note := entry.pop("table")["note"]:
            entry["note"] = note
    for name, entry in content["figures"].items():
        entry["file"] = str(checks_path(study, name))
        del entry["checks"]
    return content


def _origin(data: Mapping[str, Any]) -> Origin:
    """Origin that attributes of a file of data, or of this process, tell."""
    return Origin(
        command=str(data["command"]),
        commit=str(data["git_commit"]),
        machine=str(data.get("processor", "unknown")),
        date=str(data["date"]),
    )
