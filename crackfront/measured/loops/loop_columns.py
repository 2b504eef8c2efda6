"""Which columns of a table are force, contact radius and displacement of a loop."""

from __future__ import annotations

import re
from collections.abc import Mapping

from crackfront.measured.loops.recording import UNITS
from crackfront.measured.tables.headings import Heading, listed
from crackfront.measured.tables.parsed_table import Table

_NAMES = {
    "force": r"((normal |measured )?(force|load)|f|fn|p|(normal)?kraft|last)",
    "radius": (
        r"((contact )?(radius|diameter|area)|a|(kontakt)?(radius|durchmesser|fläche|flaeche))"
    ),
    "displacement": (
        r"((stage |measured )?(displacement|penetration|indentation|depth)|delta|δ|d"
        r"|weg|verschiebung|eindring(ung|tiefe))"
    ),
}
"""What headings call the columns, in English and German."""

_PIEZO = r"((z )?piezo( z)?( (travel|position|displacement))?|stage( position)?)"
"""Names of a displacement that counts if no other column does."""

_BRANCHES = (
    r"(approach|loading|extend|extension|trace|annäherung|belastung)",
    r"(retract|retraction|unloading|withdraw|retrace|rückzug|entlastung)",
)
"""What headings of columns of one branch have in addition: of approach and of retraction."""

Places = dict[str, int]
"""Place of each column in the table, by its name in a loop."""


def column_places(table: Table, names: Mapping[str, str]) -> tuple[Places, ...]:
    """Places of the columns of a loop: once, or for approach and retraction side by side.

    Parameters
    ----------
    table : Table
    names : mapping
        Headings of columns that have other names than usual: of `force`, `radius`, `displacement`.

    Raises
    ------
    ValueError
        If a named column does not exist, or several columns may be meant.
    """
    candidates = {name: _candidates(table, names, name) for name in UNITS}
    candidates = {name: places for name, places in candidates.items() if places}
    n_branch = max(map(len, candidates.values()), default=1)
    if n_branch == 2 and _are_branches(table, candidates):
        # A column that stands once, as the travel of a piezo, belongs to both.
        return tuple(
            {name: places[min(branch, len(places) - 1)] for name, places in candidates.items()}
            for branch in range(2)
        )
    for name, places in candidates.items():
        if len(places) > 1:
            option = "contact-radius" if name == "radius" else name
            headings = ", ".join(repr(table.headings[place].text) for place in places)
            raise ValueError(
                f"{table.path} has {len(places)} columns of {name}: {headings}; name "
                f"one by --{option}"
            )
    return ({name: place for name, [place] in candidates.items()},)


def unused_displacement(table: Table, places: Places) -> str:
    """Heading of a column that may be the displacement too, next to the one that is used."""
    for place, heading in enumerate(table.headings):
        if place not in places.values() and _is_named(
            heading, f"{_NAMES['displacement']}|{_PIEZO}"
        ):
            return heading.text
    return ""


def _candidates(table: Table, names: Mapping[str, str], name: str) -> list[int]:
    """Columns that may be one column of a loop, in the order of the table."""
    requested = {column: text.strip().lower() for column, text in names.items()}
    written = [{heading.text.lower(), heading.plain_name} for heading in table.headings]
    if name in requested:
        places = [n for n, texts in enumerate(written) if requested[name] in texts]
        if not places:
            raise ValueError(
                f"{table.path} lacks a column {names[name]!r}; its headings are "
                f"{listed(table.headings)}"
            )
        return places
    free = [n for n, texts in enumerate(written) if not texts & {*requested.values()}]
    places = [n for n in free if _is_named(table.headings[n], _NAMES[name])]
    if name == "displacement" and not places:
        places = [n for n in free if _is_named(table.headings[n], _PIEZO)]
    # An area next to the radius has the same values again.
    radii = [n for n in places if _plain(table.headings[n]).endswith("radius")]
    return radii or places


def _is_named(heading: Heading, pattern: str) -> bool:
    """Whether a heading, without the name of a branch, matches a pattern."""
    return re.fullmatch(pattern, _plain(heading), re.IGNORECASE) is not None


def _plain(heading: Heading) -> str:
    """Name of a column without the name of a branch."""
    words = "|".join(_BRANCHES)
    name = re.sub(rf"[(\[]?\b({words})\b[)\]]?", " ", heading.plain_name)
    return re.sub(r"\s+", " ", re.sub(r"\.1$", "", name)).strip(" -,.:")


def _are_branches(table: Table, candidates: Mapping[str, list[int]]) -> bool:
    """Whether columns that stand twice are of approach and retraction, by headings or order.

    Without the names of branches, all columns must stand twice with equal headings.
    """
    pairs = [places for places in candidates.values() if len(places) == 2]
    names = [[table.headings[place].plain_name for place in places] for places in pairs]
    if all(re.search(_BRANCHES[1], second) for _, second in names):
        return True
    is_repeated = all(first == re.sub(r"\.1$", "", second) for first, second in names)
    return is_repeated and len(pairs) == len(candidates) >= 2
