"""The page that shows a sweep to a reader: result, figures, fit, configuration, origin."""

from __future__ import annotations

from base64 import encodebytes
from collections.abc import Mapping
from html import escape
from pathlib import Path

from markdown_it import MarkdownIt

from crackfront.sweep.rows import COMPLETE

_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:90%}"
    "th,td{border:1px solid #bbb;padding:.25em .6em;text-align:left;vertical-align:top}"
    "th{background:#eee}pre{background:#f5f5f5;padding:1em;overflow-x:auto}"
    "section p{max-width:50em}figure{margin:1.5em 0}img{max-width:100%;max-height:34em}"
)


def summary_page(
    title: str,
    fit: str,
    figures: Mapping[str, Path],
    statuses: Mapping[str, int],
    configuration: str,
    origin: Mapping[str, str],
) -> str:
    """A page of HTML that needs no other file and opens on the result, in an element `section`.

    The fit is its tables in Markdown; the text before their second heading is the result. Figures
    are PNG files under their captions, statuses the number of simulations of each.
    """
    # Raw HTML in the text stays text.
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    result, heading, rest = fit.partition("\n## ")
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}'
            f"</title><style>{_STYLE}</style></head><body>",
            f"<section>{markdown.render(result)}",
            *(_picture(caption, path) for caption, path in figures.items()),
            "</section>",
            markdown.render(heading + rest),
            "<h2>Simulations</h2>",
            _table(("status", "simulations"), _endings(statuses)),
            "<h2>Origin</h2>",
            _table(("", ""), origin),
            "<h2>Configuration</h2>",
            f"<pre>{escape(configuration)}</pre>",
            "</body></html>\n",
        ]
    )


def _endings(statuses: Mapping[str, int]) -> dict[str, str]:
    """Numbers of simulations by how they ended; a complete cycle ends when contact is lost."""
    return {
        f"{status} (complete)" if status in COMPLETE else status: str(number)
        for status, number in sorted(statuses.items())
    }


def _picture(caption: str, path: Path) -> str:
    """A picture that is embedded in the page, with its caption."""
    # In short lines, which the report of the workflow needs, as it shows this part of the page.
    data = encodebytes(path.read_bytes()).decode()
    return (
        f'<figure><img src="data:image/png;base64,{data}" alt="{escape(path.stem)}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _table(head: tuple[str, str], rows: Mapping[str, str]) -> str:
    """A table of two columns."""
    cells = [f"<tr><th>{head[0]}</th><th>{head[1]}</th></tr>"] if any(head) else []
    cells += [
        f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>" for name, value in rows.items()
    ]
    return f"<table>{''.join(cells)}</table>"
