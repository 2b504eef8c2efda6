"""What studies write into pages: tables, marked blocks, and the machine that measured."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import click
from crackfront.core.fingerprint import fingerprint

from crackfront.cli.report import FILE
from crackfront.data.files import write_text
from crackfront.data.provenance import provenance

KEPT = Path("docs/reference/parts")
"""Folder of what studies keep for the pages, a file for each study."""

_BLOCK = re.compile(
    r"<!-- (?P<study>[\w-]+): (?P<name>.*?) -->(?P<text>.*?)<!-- end -->", re.DOTALL
)

keep_option = click.option("--keep", is_flag=True, help=f"Store the tables for pages in {KEPT}.")

output_option = functools.partial(click.option, "--output", type=FILE, show_default=True)
"""Option for the folder that a command writes into."""


@dataclass(frozen=True, slots=True)
class Part:
    """A table or a number of the pages, and where it was measured."""

    text: str
    command: str
    commit: str
    machine: str
    sources: Sequence[str]
    """Modules that it comes from."""
    fingerprint: str
    """:func:`sources_fingerprint` of them, as they were."""


def sources_fingerprint(*sources: str) -> str:
    """Twelve hexadecimal digits that change with the modules that a part comes from.

    Commands do not count: what they print decides no number.
    """
    return fingerprint(*sources, without=["crackfront.cli"])


def markdown_table(header: str, rows: Iterable[str | Sequence[str]]) -> str:
    """Table in Markdown; the header has a bar between columns, and so has a row that is one text.

    Examples
    --------
    >>> print(markdown_table("scene | time / s", [["flat", "3"], "h08 | 4"]))
    | scene | time / s |
    | --- | --- |
    | flat | 3 |
    | h08 | 4 |
    """
    lines = [header, ["---"] * len(header.split(" | ")), *rows]
    texts = (line if isinstance(line, str) else " | ".join(line) for line in lines)
    return "\n".join(f"| {text} |" for text in texts)


def keep_parts(
    study: str, texts: Mapping[str, str], *sources: str, data: Mapping[str, Any] | None = None
) -> None:
    """Keep what a study has measured, in Markdown; what it has kept else stays.

    The attributes of a file of data say where they were measured, if that is not here.
    """
    here = asdict(provenance())
    where = here if data is None else data
    is_here = where["git_commit"] == here["git_commit"]
    origin: dict[str, Any] = {
        "command": str(where["command"]),
        "commit": str(where["git_commit"]),
        "machine": str(where.get("processor", "unknown")),
        "sources": sources,
        "fingerprint": sources_fingerprint(*sources) if is_here else "",
    }
    known = kept_parts().get(study, {})
    known |= {name: Part(text, **origin) for name, text in texts.items()}
    listed = {name: asdict(known[name]) for name in sorted(known)}
    write_text(KEPT / f"{study}.json", json.dumps(listed, indent=1, ensure_ascii=False) + "\n")


def tell(
    study: str,
    texts: Mapping[str, str],
    *sources: str,
    keep: bool,
    data: Mapping[str, Any] | None = None,
) -> None:
    """Print what a study has measured, and keep it for the pages if that is asked for."""
    click.echo("\n\n".join(texts.values()))
    if keep:
        keep_parts(study, texts, *sources, data=data)
        click.echo("kept for the pages, which python -m studies pages writes")


def kept_parts() -> dict[str, dict[str, Part]]:
    """All parts by study and name."""
    files = {path.stem: json.loads(path.read_text("utf-8")) for path in KEPT.glob("*.json")}
    return {
        study: {name: Part(**one) for name, one in listed.items()}
        for study, listed in files.items()
    }


def stale(parts: Mapping[str, Mapping[str, Part]]) -> Iterator[str]:
    """Parts whose sources have changed since they were measured, a sentence for each command."""
    commands: dict[tuple[str, str], list[str]] = {}
    for study, listed in parts.items():
        for name, part in listed.items():
            if part.fingerprint != sources_fingerprint(*part.sources):
                commands.setdefault((part.command, part.commit[:7]), []).append(f"{study}: {name}")
    for (command, commit), names in commands.items():
        yield f"of other sources than today's, commit {commit}, `{command}`: {', '.join(names)}"


def renewed(page: str, parts: Mapping[str, Mapping[str, Part]]) -> str:
    r"""Page with all blocks written anew, each with its commit and command.

    A block stands between `<!-- STUDY: PART -->` and `<!-- end -->`, on lines of its own or within
    one, where it is a number alone. `<!-- STUDY: PART / ROW / COLUMN -->` is a cell of a table, in
    the row that begins with ROW, counted from 1. What was not measured is a ValueError.

    Examples
    --------
    >>> part = Part("8", "studies speed", "1a2b3c4d", "", (), "")
    >>> renewed("<!-- speed: ratio -->7<!-- end --> times", {"speed": {"ratio": part}})
    '<!-- speed: ratio -->8<!-- end --> times'
    """

    def block(found: re.Match[str]) -> str:
        study, (name, *place) = found["study"], found["name"].split(" / ")
        if name not in parts.get(study, {}):
            raise ValueError(
                f"there is a block {name!r} of the study {study}, which has not measured it; there "
                f"are {', '.join(parts.get(study, {})) or 'none'}"
            )
        part = parts[study][name]
        text = _cell(part.text, *place) if place else part.text
        if "\n" in found["text"]:
            machine = "" if part.machine == "unknown" else f", {part.machine}"
            text = f"\n\n{text}\n\n*Commit {part.commit[:7]}{machine}: `{part.command}`*\n\n"
        return f"<!-- {study}: {found['name']} -->{text}<!-- end -->"

    return _BLOCK.sub(block, page)


def _cell(table: str, row: str, column: str) -> str:
    """Text of a cell, in the row that begins with some cells; bold or not is the same."""
    for line in table.replace("**", "").splitlines():
        if line.startswith(f"| {row} |"):
            return line.split("|")[int(column)].strip()
    raise ValueError(f"no row of the table begins with {row!r}")
