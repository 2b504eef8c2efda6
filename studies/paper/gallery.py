"""Gallery of the paper's figures, from what the study has stored."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from studies.numbers import Origin, StoredFigure, checks_path
from studies.paper.checks import counted
from studies.paper.figure import FIGURES
from studies.tables import make_table

GALLERY = Path("docs/experiments/gallery.md")
"""Page with the figures of the paper."""

_ABOUT_GALLERY = """\
- **Differs as the law of k says:** the paper has k = 3 everywhere; simulated k depends on disorder,
  spectrum and size of the contact. The number is from [the law](../law.md).
- **Cannot be decided:** the data are too few.
- **Is not met:** an expectation of this project, not of the paper; its table names the
  source.
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

_AGREES = "agrees"


def gallery_page(stored_figures: Mapping[str, StoredFigure]) -> str:
    """Page of the counts, the checks that do not agree, and all figures."""
    figures = {name: stored_figures[name] for name in FIGURES if name in stored_figures}
    counts = counted(figure.checks for figure in figures.values())
    differing = make_table(
        "figure | claim | expected | found | result",
        (row for name, figure in figures.items() for row in _differing(name, figure)),
    )
    parts = [
        "# Gallery",
        "\n".join(f"- {sentence}" for sentence in counts),
        f"These checks do not agree:\n\n{differing.markdown()}",
        _ABOUT_GALLERY,
        *(_picture(name, figure) for name, figure in figures.items()),
        _measured_line(figures.values()),
    ]
    return "\n\n".join(parts) + "\n"


def _differing(name: str, figure: StoredFigure) -> list[list[str]]:
    """Cells of the checks of a figure that do not agree, without remarks."""
    return [
        [_link(name, name), row["claim"], row["expected"], row["found"], _result(row, figure.scale)]
        for row in figure.checks.records()
        if row["result"] != _AGREES
    ]


def _result(row: Mapping[str, str], scale: str) -> str:
    """Result of a check with the reason for it."""
    result = row["result"]
    if result == "FAIL":
        return f"**{result}**"
    if result == "cannot be decided":
        result = f"{result} at {scale} scale"
    return f"{result}: {row['reason']}" if row["reason"] else result


def _picture(name: str, figure: StoredFigure) -> str:
    """Picture of a figure, with its name as its text, below its title and above its checks."""
    results = [row["result"] for row in figure.checks.records()]
    cost = f"scale {figure.scale}, {figure.cpu_seconds:.0f} s"
    counts = f"{results.count(_AGREES)} of {len(results)} {_link('checks', name)} agree"
    picture = f"![{name}](figures/{figure.picture})"
    return f"## {figure.title}\n\n{picture}\n\n*{counts} ({cost}).*"


def _link(text: str, figure: str) -> str:
    """Link from the gallery to the checks of a figure."""
    return f"[{text}](../{checks_path('paper', figure).relative_to('docs')})"


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
