"""Numbers, tables and figures that studies have measured, a JSON file for each study.

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
class Table(Origin):
    """A text of the pages, mostly a table in Markdown."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredFigure(Origin):
    """A figure of the gallery."""

    title: str
    picture: str
    """Name of its picture."""
    scale: str
    cpu_seconds: float
    """Processor time of its data. (Units: s)"""
    checks: str
    """Tables of its checks in Markdown."""


@dataclass(frozen=True, slots=True)
class Stored:
    """What is stored of a study, by name."""

    numbers: dict[str, Number] = field(default_factory=dict)
    canaries: dict[str, Number] = field(default_factory=dict)
    tables: dict[str, Table] = field(default_factory=dict)
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
        tables={name: Table(**entry) for name, entry in content["tables"].items()},
        figures={name: StoredFigure(**entry) for name, entry in content["figures"].items()},
    )


def store(
    study: str,
    *,
    numbers: Mapping[str, Number] | None = None,
    canaries: Mapping[str, Number] | None = None,
    tables: Mapping[str, str] | None = None,
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
    for name, text in (tables or {}).items():
        record.tables[name] = Table(text, **asdict(origin))
    for name, figure in (figures or {}).items():
        record.figures[name] = replace(figure, **asdict(origin))
    text = json.dumps(asdict(record), indent=1, ensure_ascii=False, sort_keys=True)
    write_text(STORED / f"{study}.json", text + "\n")


def _origin(data: Mapping[str, Any]) -> Origin:
    """Origin that attributes of a file of data, or of this process, tell."""
    return Origin(
        command=str(data["command"]),
        commit=str(data["git_commit"]),
        machine=str(data.get("processor", "unknown")),
        date=str(data["date"]),
    )
