"""What studies write into pages: tables, marked blocks, and the machine that measured."""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Iterable, Mapping, Sequence

from crackfront.data.provenance import provenance

_BLOCK = re.compile(r"<!-- (?P<study>[\w-]+): (?P<name>.*?) -->.*?<!-- end -->", re.DOTALL)


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


def renewed(page: str, study: str, parts: Mapping[str, str]) -> str:
    r"""Page with the blocks of a study written anew; those of others are kept.

    A block stands between `<!-- STUDY: PART -->` and `<!-- end -->`; the parts are what the study
    has measured, in Markdown. A block of a part that there is not is a ValueError.

    Examples
    --------
    >>> renewed("<!-- speed: ratio -->\n7\n<!-- end -->", "speed", {"ratio": "8"}).split("\n\n")
    ['<!-- speed: ratio -->', '8', '<!-- end -->']
    """

    def block(found: re.Match[str]) -> str:
        name = found["name"]
        if found["study"] != study:
            return found[0]
        if name not in parts:
            raise ValueError(
                f"the page has a block {name!r}, which the study {study} has not measured; there "
                f"are {', '.join(parts)}"
            )
        return f"<!-- {study}: {name} -->\n\n{parts[name]}\n\n<!-- end -->"

    return _BLOCK.sub(block, page)


def described_machine() -> str:
    """One sentence: processor, cores, Python, version and commit."""
    origin = provenance()
    return (
        f"Machine: {origin.processor}, {os.cpu_count()} cores, Python {platform.python_version()}; "
        f"crackfront {origin.crackfront_version}, commit {origin.git_commit}."
    )
