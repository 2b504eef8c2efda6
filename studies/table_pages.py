"""Pages that only show what studies have stored: the tables of each study, and the gallery."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from studies.numbers import Origin, Stored, Table
from studies.paper.figure import FIGURES

TABLES = Path("docs/experiments/tables")
"""Folder of the pages with tables, each named as its study."""

GALLERY = Path("docs/experiments/gallery.md")
"""Page with the figures of the paper."""

_COUNTS = "counts"
"""Stored text of the study of the paper that says how many checks agree."""

_GALLERY = """\
# Gallery

Every computed figure of the paper with checks against the statements of the paper or against
exact results. `make figures` computes the figures, `python -m studies paper gallery` stores them,
and `python -m studies pages` writes this page. A check agrees if the number that was found lies
within the stated tolerance or bound; if its 95% interval does not contain the expected number, the
remark says so. A check may differ from the paper as [the law of k](../law.md) predicts; then the
number of the law is stated too. Or it fails, and the difference is unexplained."""

_TABLES = """\
# Tables of the study {}

The [experiments](../index.md) explain these tables. `python -m studies pages` writes this page."""


def written_pages(studies: Mapping[str, Stored]) -> dict[Path, str]:
    """Text of every page that is written from stored tables alone, by its path."""
    pages = {}
    for study, record in studies.items():
        tables = dict(record.tables)
        shown = [tables.pop(name) for name in (_COUNTS, *FIGURES) if name in tables]
        if shown:
            pages[GALLERY] = _page([_GALLERY, *(table.text for table in shown)], shown)
        if tables:
            sections = (_section(name, table) for name, table in sorted(tables.items()))
            pages[TABLES / f"{study}.md"] = _page(
                [_TABLES.format(study), *sections], tables.values()
            )
    return pages


def _page(parts: Iterable[str], origins: Iterable[Origin]) -> str:
    """Page of some parts; its last line says where they were measured."""
    return "\n\n".join([*parts, _measured_line(origins)]) + "\n"


def _section(name: str, table: Table) -> str:
    """Name, command and text of a stored table; headings within it are one level lower."""
    text = re.sub("^#", "##", table.text, flags=re.MULTILINE)
    return f"## {name[0].upper()}{name[1:]}\n\nBy `{table.command}`:\n\n{text}"


def _measured_line(origins: Iterable[Origin]) -> str:
    """Commands, commits and machines that some tables come from."""
    commands: dict[tuple[str, str], dict[str, None]] = {}
    for origin in origins:
        machine = "" if origin.machine == "unknown" else f", {origin.machine}"
        place = f"commit {origin.commit[:7]}{machine}", origin.date[:10]
        commands.setdefault(place, {})[f"`{origin.command}`"] = None
    parts = (f"{', '.join(names)} ({commit}, {date})" for (commit, date), names in commands.items())
    return f"*Numbers of this page: {'; '.join(parts)}.*"
