"""A loop as a page of HTML to send: numbers, reservations, figure and origin."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from crackfront.measured.loops.comparison import comparison_lines
from crackfront.measured.loops.loop_drawing import loop_figure
from crackfront.measured.loops.loop_page import INTERVALS, loop_numbers
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.plots.html_page import (
    html_list,
    html_origin,
    html_page,
    html_pairs,
    html_picture,
)
from crackfront.plots.style import figure_png

_CAPTION = (
    "Contact radius against force of each row, the JKR curves of both works of adhesion, and the "
    "contact radii that are averaged."
)


def loop_report(
    loop: MeasuredLoop, prediction: Prediction | None = None, name: str = "a loop"
) -> str:
    """A page in HTML that needs no other file.

    Parameters
    ----------
    loop : MeasuredLoop
    prediction : Prediction, optional
        Prediction for scans of the surface, which the page compares with the loop.
    name : str, optional
        Name of the loop in the title, as its file.
    """
    title = f"Works of adhesion of {name}"
    return html_page(title, _parts(loop, prediction, title))


def _parts(loop: MeasuredLoop, prediction: Prediction | None, title: str) -> Iterator[str]:
    """Parts of the page, the numbers first."""
    yield f"<section><h1>{escape(title)}</h1>"
    yield html_pairs(("", ""), dict(loop_numbers(loop)))
    yield f"<p>{INTERVALS}</p>"
    yield html_list(loop.remarks)
    yield "</section>"
    yield html_picture(figure_png(loop_figure(loop, prediction)), "loop", _CAPTION)
    if prediction is not None:
        heading, *lines = comparison_lines(loop, prediction)
        numbers = [line for line in lines if line.startswith(" ")]
        yield f"<h2>{escape(heading)}</h2><pre>{escape(chr(10).join(numbers))}</pre>"
        yield html_list(line for line in lines if line not in numbers)
    yield html_origin()
