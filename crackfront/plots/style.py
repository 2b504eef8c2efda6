"""Style of every figure: sizes, colours, fonts, and the writing of files.

Functions import matplotlib only when they draw, because it is slow to import.
"""

from __future__ import annotations

import functools
import io
import logging
import textwrap
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crackfront.core.arguments import check_type
from crackfront.simulate.storage import replace_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN = 85 / 25.4
"""Width of a column in print. (Units: inch)"""

PAGE = 170 / 25.4
"""Width of a page in print. (Units: inch)"""

# Colours of Okabe and Ito, which colour-blind readers can distinguish.
BLUE = "#0072B2"
VERMILION = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
ORANGE = "#E69F00"
SKY = "#56B4E9"
BLACK = "#000000"

COLOURS = (GREEN, BLUE, PURPLE, VERMILION, ORANGE, SKY, BLACK)
"""Colours of the spectra."""

MARKERS = ("s", "o", "^", "D", "v", "P", "X")
"""Markers of the spectra."""

SMALLEST_FONT = 7.25
"""Size of the smallest font. A page of the documentation shows a figure of the width `PAGE` at 0.97
of its size, so that this is 7 there. (Units: point)"""

_SCREEN_WIDTH = 4.0
"""Width of a figure on a screen. (Units: inch)"""

_PAGE_RESOLUTION = 200
"""Resolution of figures in pages of HTML. (Units: pixels per inch)"""

_SCREEN_RESOLUTION = 144
"""Resolution of pictures for a screen. (Units: pixels per inch)"""

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": SMALLEST_FONT,
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
    "legend.fontsize": SMALLEST_FONT,
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
    """Use the style of all figures, whatever the user's settings, and restore these afterwards."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def blank_figure(width: float, height: float) -> Figure:
    """Empty figure that no window shows; width and height in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def explain(figure: Figure, text: str) -> None:
    """Write lines below a figure that explain what is missing in its legend."""
    per_inch = 72 / (0.56 * SMALLEST_FONT)
    lines = textwrap.fill(text, int(per_inch * figure.get_figwidth()))
    figure.supxlabel(lines, fontsize=SMALLEST_FONT, color="0.25")


@contextmanager
def shown_axes() -> Iterator[Axes]:
    """Axes of a new figure for pyplot or a notebook; closed again if drawing fails."""
    from matplotlib import pyplot

    with house_style():
        figure = pyplot.figure(figsize=(_SCREEN_WIDTH, 0.8 * _SCREEN_WIDTH), dpi=_SCREEN_RESOLUTION)
        try:
            yield figure.add_subplot()
        except BaseException:
            pyplot.close(figure)
            raise


def axes_to_draw_on(axes: Axes | None) -> AbstractContextManager[Axes]:
    """The user's axes as they are, or new ones in the package's style; TypeError for others."""
    from matplotlib.axes import Axes

    check_type("axes", axes, (Axes, type(None)), "one Axes of matplotlib, as axes[0] of several")
    return shown_axes() if axes is None else nullcontext(axes)


_DATES = {".pdf": "CreationDate", ".png": "Software", ".svg": "Date"}
"""Metadata with the date or the program, left out so that equal figures have equal bytes."""


def save_figure(figure: Figure, stem: Path) -> tuple[Path, ...]:
    """Write a figure as PDF and PNG (300 dpi) and return their paths.

    If `stem` ends in .pdf, .png or .svg, only that file is written. Missing folders are made, and
    equal figures give equal bytes.
    """
    paths = [stem.with_name(stem.name + suffix) for suffix in (".pdf", ".png")]
    if stem.suffix in _DATES:
        paths = [stem]
    # fontTools warns that the fonts of matplotlib have no date.
    logger = logging.getLogger("fontTools.ttLib.tables._h_e_a_d")
    disabled, logger.disabled = logger.disabled, True
    try:
        for path in paths:
            look: dict[str, Any] = {
                "format": path.suffix[1:],
                "metadata": {_DATES[path.suffix]: None},
            }
            with house_style():
                replace_atomically(path, functools.partial(figure.savefig, **look))
            figure.set_layout_engine("none")  # laid out once: both files have the same axes
    finally:
        logger.disabled = disabled
    return tuple(paths)


def figure_png(figure: Figure) -> bytes:
    """A figure as a PNG that a page embeds."""
    stream = io.BytesIO()
    with house_style():
        figure.savefig(stream, format="png", dpi=_PAGE_RESOLUTION)
    return stream.getvalue()


def save_picture(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG for a screen."""
    with house_style():
        figure.savefig(path, dpi=_SCREEN_RESOLUTION, metadata={"Software": None})
