"""A prediction as a page of HTML to send: numbers, reservations, figure and origin."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from crackfront.measured.page.prediction_figures import prediction_figure
from crackfront.measured.page.texts import ADHESIONS, number_rows, source_rows, surface_lines
from crackfront.measured.prediction.next_scan import measure_next
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.prediction_page import NOT_MODELLED, headline_rows
from crackfront.measured.prediction.remarks import remark_text
from crackfront.measured.prediction.works_by_source import reason_for_differences
from crackfront.measured.spectrum.stated import StatedSurface
from crackfront.plots.html_page import (
    html_list,
    html_origin,
    html_page,
    html_picture,
    html_table,
)
from crackfront.plots.style import figure_png

_CAPTION = (
    "Densities of the scans with the spectrum and the limits of the trusted waves, the predicted "
    "force of both branches with 95% intervals, and the scans as they were used."
)

_STATED_CAPTION = "The spectrum, and the predicted force of both branches with 95% intervals."


_ABOVE = ("next scan", "hysteresis")
"""Subjects of notes that the page has next to the result."""


def prediction_report(
    prediction: Prediction, simulation: str = "", *, with_figure: bool = True
) -> str:
    """A page that needs no other file.

    Parameters
    ----------
    prediction : Prediction
        Also of a surface to which the theory does not apply; the page then has the reasons.
    simulation : str, optional
        Text of simulations that were run for comparison.
    with_figure : bool, optional
        Whether the page has the figure, which takes most of the time.

    Returns
    -------
    str
        The page in HTML.
    """
    title = f"Adhesion of a sphere on {_name(prediction)}"
    return html_page(title, _parts(prediction, title, simulation, with_figure=with_figure))


def _parts(
    prediction: Prediction, title: str, simulation: str, *, with_figure: bool
) -> Iterator[str]:
    """Parts of the page, the result first."""
    verdict = prediction.verdict
    yield f"<section><h1>{escape(title)}</h1><p>{escape(verdict.heading)}.</p>"
    if prediction.applies:
        yield html_table(("", ""), headline_rows(prediction))
    yield html_list(map(remark_text, verdict.with_severity("fails", "undecided", "reservation")))
    if prediction.applies:
        yield f"<p>{escape(prediction.excess.sentence)}</p>"
    yield f"<p>{escape(remark_text(measure_next(prediction.surface)))}</p>"
    yield f"<p>{NOT_MODELLED}</p></section>"
    if with_figure:
        caption = _CAPTION if prediction.surface.scans else _STATED_CAPTION
        figure = prediction_figure(prediction.surface, prediction)
        yield html_picture(figure_png(figure), "prediction", caption)
    if prediction.applies:
        yield "<h2>Works of adhesion by source</h2>"
        yield html_table(("", *ADHESIONS), source_rows(prediction))
        yield f"<p>{escape(reason_for_differences(prediction))}</p>"
    if simulation:
        yield f"<h2>Simulations</h2><pre>{escape(simulation)}</pre>"
    yield "<h2>All numbers, with 95% intervals</h2>"
    yield html_table(("", ""), number_rows(prediction))
    yield "<h2>Conditions that are met, and notes</h2>"
    further = verdict.with_severity("holds", "note")
    yield html_list(remark_text(item) for item in further if item.concerns not in _ABOVE)
    surface = "\n".join(surface_lines(prediction.surface))
    yield f"<h2>Surface</h2><pre>{escape(surface)}</pre>"
    yield html_origin()


def _name(prediction: Prediction) -> str:
    """Name of the surface: its files, or its numbers in words."""
    surface = prediction.surface
    if isinstance(surface, StatedSurface):
        return surface.origin
    return " and ".join(dict.fromkeys(scan.measurement.path.name for scan in surface.scans))
