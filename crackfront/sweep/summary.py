"""The page that shows a sweep to a reader: result, figures, fit, configuration, origin."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path

from markdown_it import MarkdownIt

from crackfront.plots.html_page import html_page, html_pairs, html_picture
from crackfront.sweep.rows import COMPLETE


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
    return html_page(
        title,
        [
            f"<section>{markdown.render(result)}",
            *(
                html_picture(path.read_bytes(), path.stem, caption)
                for caption, path in figures.items()
            ),
            "</section>",
            markdown.render(heading + rest),
            "<h2>Simulations</h2>",
            html_pairs(("status", "simulations"), _endings(statuses)),
            "<h2>Origin</h2>",
            html_pairs(("", ""), origin),
            "<h2>Configuration</h2>",
            f"<pre>{escape(configuration)}</pre>",
        ],
    )


def _endings(statuses: Mapping[str, int]) -> dict[str, str]:
    """Numbers of simulations by how they ended; a complete cycle ends when contact is lost."""
    return {
        f"{status} (complete)" if status in COMPLETE else status: str(number)
        for status, number in sorted(statuses.items())
    }
