"""Style of every figure: sizes, colours, fonts, and how a figure is written.

matplotlib is imported by the functions that draw, so that who only computes does without it.
"""

from __future__ import annotations

import functools
import logging
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crackfront.simulate.storage import replace_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, PAGE = 85 / 25.4, 170 / 25.4
"""Widths in print of one column and of a page (Units: inch)."""

BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
"""Colours of Okabe and Ito, which the colour-blind tell apart."""

COLOURS = (GREEN, BLUE, PURPLE, VERMILION, ORANGE, SKY, BLACK)
MARKERS = ("s", "o", "^", "D", "v", "P", "X")
"""One colour and marker a spectrum; after seven both repeat, out of step."""

_SMALL = 6.5
"""Size of the font of explanations."""

_SHOWN = 4.0
"""Width of a figure on a screen (Units: inch)."""

_SCREEN = 144
"""Pixels an inch of pictures for a screen."""

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.0,
    "mathtext.fontset": "dejavusans",
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 8.0,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "legend.fontsize": 6.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.labelspacing": 0.35,
    "legend.borderaxespad": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.6,
    "lines.markeredgewidth": 0.8,
    "errorbar.capsize": 1.5,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "crackfront",
    "pdf.fonttype": 42,
    "savefig.dpi": 300,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Style of all figures, whatever the user's own settings; left as it was found."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def blank_figure(width: float, height: float) -> Figure:
    """Empty figure on a canvas of its own; width and height in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def explain(figure: Figure, text: str) -> None:
    """Lines below a figure that say what its legend does not: bars, open symbols, grey lines."""
    per_inch = 72 / (0.56 * _SMALL)
    lines = textwrap.fill(text, int(per_inch * figure.get_figwidth()))
    figure.supxlabel(lines, fontsize=_SMALL, color="0.25")


@contextmanager
def shown_axes() -> Iterator[Axes]:
    """Axes of a new figure that a notebook shows, unless drawing on them fails."""
    from matplotlib import pyplot

    with house_style():
        figure = pyplot.figure(figsize=(_SHOWN, 0.8 * _SHOWN), dpi=_SCREEN)
        try:
            yield figure.add_subplot()
        except BaseException:
            pyplot.close(figure)
            raise


_DATES = {".pdf": "CreationDate", ".png": "Software", ".svg": "Date"}
"""Metadata in which each format states the date or the program of a figure; they are left out."""


_SUBJECTS = {".pdf": "Subject", ".png": "Description", ".svg": "Description"}
"""Metadata in which each format states what it is a figure of."""


def save_figure(figure: Figure, stem: Path, subject: str = "") -> tuple[Path, ...]:
    """Write a figure as PDF and PNG (300 dpi), its folder too; equal figures give equal bytes.

    A name that ends in .pdf, .png or .svg is that of the one file to write. Each file states a
    subject, which :func:`picture_subject` reads.
    """
    paths = [stem.with_name(stem.name + suffix) for suffix in (".pdf", ".png")]
    if stem.suffix in _DATES:
        paths = [stem]
    # It warns, once a font, that the fonts of matplotlib carry no date.
    logger = logging.getLogger("fontTools.ttLib.tables._h_e_a_d")
    disabled, logger.disabled = logger.disabled, True
    try:
        for path in paths:
            metadata = {_DATES[path.suffix]: None, _SUBJECTS[path.suffix]: subject or None}
            look: dict[str, Any] = {"format": path.suffix[1:], "metadata": metadata}
            with house_style():
                replace_atomically(path, functools.partial(figure.savefig, **look))
    finally:
        logger.disabled = disabled
    return tuple(paths)


def picture_subject(path: Path) -> str:
    """Subject that a PNG states; empty where it states none, or is no picture."""
    from PIL import Image

    try:
        with Image.open(path) as picture:
            return str(picture.info.get(_SUBJECTS[".png"], ""))
    except OSError:
        return ""


def save_picture(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG for a screen, a third as large as that for print."""
    with house_style():
        figure.savefig(path, dpi=_SCREEN, metadata={"Software": None})
