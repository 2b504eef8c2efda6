"""Pages of HTML with tables and pictures that need no other file."""

from __future__ import annotations

from base64 import encodebytes
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from crackfront.simulate.provenance import provenance, utc_now

_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:90%}"
    "th,td{border:1px solid #bbb;padding:.25em .6em;text-align:left;vertical-align:top}"
    "th{background:#eee}pre{background:#f5f5f5;padding:1em;overflow-x:auto}"
    "section p{max-width:50em}figure{margin:1.5em 0}img{max-width:100%;max-height:34em}"
)


def html_page(title: str, parts: Iterable[str]) -> str:
    """A whole page of parts that are HTML already; the title is plain text."""
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}'
            f"</title><style>{_STYLE}</style></head><body>",
            *parts,
            "</body></html>\n",
        ]
    )


def html_picture(png: bytes, name: str, caption: str) -> str:
    """A picture that is embedded in the page, with its caption."""
    # In short lines, which the report of the workflow needs, as it shows such a part of the page.
    data = encodebytes(png).decode()
    return (
        f'<figure><img src="data:image/png;base64,{data}" alt="{escape(name)}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def html_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; without a head if all its texts are empty."""
    cells = [f"<tr>{_cells('th', head)}</tr>"] if any(head) else []
    cells += [f"<tr>{_cells('td', row)}</tr>" for row in rows]
    return f"<table>{''.join(cells)}</table>"


def html_pairs(head: tuple[str, str], rows: Mapping[str, str]) -> str:
    """A table of two columns."""
    return html_table(head, rows.items())


def html_list(sentences: Iterable[str]) -> str:
    """A list of plain sentences."""
    return f"<ul>{''.join(f'<li>{escape(sentence)}</li>' for sentence in sentences)}</ul>"


def html_origin() -> str:
    """Version, command and moment of a page, below a heading."""
    origin = provenance()
    rows = {
        "crackfront": origin.crackfront_version,
        "commit": origin.git_commit,
        "command": origin.command,
        "date": utc_now(),
    }
    return f"<h2>Origin</h2>\n{html_pairs(('', ''), rows)}"


def _cells(tag: str, texts: Iterable[str]) -> str:
    """Cells of a row."""
    return "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts)
