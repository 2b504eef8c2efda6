"""Figures of a sweep and of one cycle; the only owner of matplotlib.

The makers return a figure, the `draw_*` functions draw on axes that exist. Everything is in
reduced units (R = 1, w_int = 1/pi, E' = 3/4).
"""

from crackfront.plots.accuracy import laws_figure, work_precision_figure
from crackfront.plots.loop import draw_loop, loop_figure
from crackfront.plots.style import house_style, save_figure
from crackfront.plots.sweep import (
    draw_factor_by_disorder,
    draw_factor_by_length,
    draw_hysteresis,
    draw_spectra,
    factor_figure,
    hysteresis_figure,
)

__all__ = [
    "draw_factor_by_disorder",
    "draw_factor_by_length",
    "draw_hysteresis",
    "draw_loop",
    "draw_spectra",
    "factor_figure",
    "house_style",
    "hysteresis_figure",
    "laws_figure",
    "loop_figure",
    "save_figure",
    "work_precision_figure",
]
