"""Measured numbers within the sentences of pages, compared with the stored ones."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ruamel.yaml import YAML

from crackfront.analysis.estimate import with_error
from studies.numbers import Number, Stored

QUOTED = Path("docs/reference/quoted.yaml")
"""File that lists the sentences of each page with their numbers, and explains how."""

_PLACE = re.compile(r"\{(?P<study>[\w-]+): (?P<name>.+?)(?: -> (?P<form>[^}]+))?\}")
"""Place of a stored number in a fragment of a sentence."""


@dataclass(frozen=True, slots=True)
class Quote:
    """Fragment of a page with places for stored numbers."""

    page: Path
    fragment: str

    def text(self, studies: Mapping[str, Stored]) -> str:
        """Fragment with its numbers; a ValueError names one that was not measured."""

        def stored_text(place: re.Match[str]) -> str:
            study, (name, *cell) = place["study"], place["name"].split(" / ", 2)
            record = studies.get(study, Stored())
            if number := record.numbers.get(name):
                return _number_text(number, place["form"])
            tables = {shown: figure.checks for shown, figure in record.figures.items()}
            tables |= {shown: stored_table.table for shown, stored_table in record.tables.items()}
            if name in tables and len(cell) == 2:
                return tables[name].cell(*cell)
            raise ValueError(f"the study {study} has not measured {name!r}; run it with --keep")

        return _PLACE.sub(stored_text, self.fragment)

    def is_shown(self, studies: Mapping[str, Stored]) -> bool:
        """Whether the page has the fragment with its stored numbers; breaks of lines are spaces."""
        page = self.page.read_text(encoding="utf-8")
        return " ".join(self.text(studies).split()) in " ".join(page.split())


def read_quotes() -> list[Quote]:
    """All fragments of :data:`QUOTED`."""
    pages = YAML(typ="safe", pure=True).load(QUOTED)
    return [
        Quote(Path(page), fragment) for page, fragments in pages.items() for fragment in fragments
    ]


def _number_text(number: Number, form: str | None) -> str:
    """Number in the form ".2f", or with its error in the form ".2f ± .2f" or as is usual."""
    if form is not None:
        parts = zip((number.value, number.error), form.split(" ± "), strict=False)
        return " ± ".join(format(value, part) for value, part in parts)
    return f"{number.value:g}" if number.error is None else with_error(number.value, number.error)
