"""Pages that only show what studies have stored: the tables of each study, and the gallery."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from studies.numbers import Origin, Stored, StoredFigure, Table
from studies.pages import markdown_table
from studies.paper.figure import FIGURES

TABLES = Path("docs/experiments/tables")
"""Folder of the pages with tables, each named as its study."""

GALLERY = Path("docs/experiments/gallery.md")
"""Page with the figures of the paper."""

_COUNTS = "counts"
"""Stored text of the study of the paper that says how many checks agree."""

_ABOUT_GALLERY = """\
- **Differs as the law of k says:** the paper has k = 3 everywhere; simulated k depends on disorder,
  spectrum and size of the contact. The number is from [the law](../law.md).
- **Cannot be decided:** the data are too few.
- **Is not met:** an expectation of this project, not of the paper.
- **FAIL:** unexplained.

A check agrees if the number lies within the stated tolerance or bound; a remark says if its 95%
interval does not contain the expected number. Times are of one core.

Main Figs. 1a to 1c and SI Figs. S-1 to S-3 are drawings and are not computed. SI Fig. S-4 is on the
page of [boundary elements](boundary-elements.md#at-weak-roughness-both-agree), at 512 x 512 points
instead of the paper's 1024 x 1024. The measured data of main Fig. 5 and SI Fig. S-6 are not in this
repository.

The tile repeats under the contact in two figures. In main Fig. 3c, d its side is 0.2 under a
contact 3.4 wide (reduced lengths). In the sweep of SI Fig. S-5 it is four roll-offs or 200 short
cutoffs under a contact 3.8 wide.

```sh
make figures SCALE=paper          # computes the figures
python -m studies paper gallery   # stores them with their checks
python -m studies pages           # writes this page
```"""

_TABLES = """\
# Tables of the study {}

{} `python -m studies pages` writes this page."""

_ABOUT_TABLES = {
    "accuracy": "Errors of the numerics and of stated intervals. Columns are explained on the "
    "pages of [numerics](../numerics.md), [hard cases](../hard-cases.md), [scans](../scans.md) and "
    "[measured loops](../../loops.md).",
    "boundary-elements": "The crack front against boundary elements on the same rough spheres "
    "([explanation](../boundary-elements.md)). Lengths are in reduced units, and e_el is in units "
    "of w_int. The command `crackfront validate` of the last line is now `python -m studies "
    "boundary-elements validate`.",
    "law": "[The law of k](../../law.md): its coefficients, and its differences from straight "
    "fronts and [spheres](../spheres.md).",
    "paper": "Every check of the [gallery](../gallery.md), and the hysteresis on nanodiamond, "
    "measured and computed ([conclusions](../../accuracy.md)).",
    "speed": "Times of requests, solvers and sweeps ([explanation](../performance.md)).",
}
"""What the page of each study shows, and where it is explained."""

_AGREES = "agrees"


def written_pages(studies: Mapping[str, Stored]) -> dict[Path, str]:
    """Text of every page that is written from stored tables alone, by its path."""
    pages = {}
    for study, record in studies.items():
        figures = {name: record.figures[name] for name in FIGURES if name in record.figures}
        if figures:
            pages[GALLERY] = _gallery(figures, record.tables[_COUNTS])
        tables = {name: table for name, table in sorted(record.tables.items()) if name != _COUNTS}
        checks = (_checks_section(name, figure) for name, figure in figures.items())
        sections = [*(_section(name, table) for name, table in tables.items()), *checks]
        if sections:
            pages[TABLES / f"{study}.md"] = _page(
                [_TABLES.format(study, _ABOUT_TABLES[study]), *sections],
                [*tables.values(), *figures.values()],
            )
    return pages


def _gallery(figures: Mapping[str, StoredFigure], counts: Table) -> str:
    """Page of the counts, the checks that do not agree, and all figures."""
    differing = [row for name, figure in figures.items() for row in _differing(name, figure)]
    header = "figure | claim | expected | found | result"
    parts = [
        "# Gallery",
        counts.text,
        f"These checks do not agree:\n\n{markdown_table(header, differing)}",
        _ABOUT_GALLERY,
        *(_picture(name, figure) for name, figure in figures.items()),
    ]
    return _page(parts, [counts, *figures.values()])


def _differing(name: str, figure: StoredFigure) -> list[list[str]]:
    """Cells of the checks of a figure that do not agree, without remarks."""
    link = f"[{name}](tables/paper.md#checks-{name})"
    return [[link, *row[:4]] for row in _check_rows(figure.checks) if row[3] != _AGREES]


def _picture(name: str, figure: StoredFigure) -> str:
    """Picture of a figure, with its name as its text, below its title and above its checks."""
    rows = _check_rows(figure.checks)
    agreeing = sum(row[3] == _AGREES for row in rows)
    link = f"[checks](tables/paper.md#checks-{name})"
    cost = f"scale {figure.scale}, {figure.cpu_seconds:.0f} s"
    caption = f"*{agreeing} of {len(rows)} {link} agree ({cost}).*"
    picture = f"![{name}](figures/{figure.picture})"
    return f"## {figure.title}\n\n{picture}\n\n{caption}"


def _checks_section(name: str, figure: StoredFigure) -> str:
    """Checks of a figure below its name and its title."""
    return f"## Checks, {name}\n\n{figure.title}.\n\n{figure.checks}"


def _check_rows(checks: str) -> list[list[str]]:
    """Cells of all checks of a figure: claim, expected, found, result and remark."""
    rows = [line[2:-2].split(" | ") for line in checks.splitlines() if line.startswith("| ")]
    return [row for row in rows if row[0] not in ("claim", "---")]


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
        typed = re.sub("^studies ", "python -m studies ", origin.command)
        commands.setdefault(place, {})[f"`{typed}`"] = None
    parts = (f"{', '.join(names)} ({commit}, {date})" for (commit, date), names in commands.items())
    return f"*Numbers of this page: {'; '.join(parts)}.*"
