"""Figures of a sweep and of one cycle; the only owner of matplotlib.

The makers return a figure, the `draw_*` functions draw on axes that exist. Everything is in
reduced units (R = 1, w_int = 1/pi, E' = 3/4).
"""

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.plots.accuracy import laws_figure, work_precision_figure
from crackfront.plots.animation import Animation, save_animation
from crackfront.plots.avalanches import avalanche_figure
from crackfront.plots.densities import (
    draw_spectrum,
    film_scales_figure,
    synthetic_film_figure,
)
from crackfront.plots.fronts import draw_field, draw_fronts, draw_heights
from crackfront.plots.instabilities import draw_instabilities, instability_figure
from crackfront.plots.loop import draw_loop, loop_figure
from crackfront.plots.mapping import mapping_figure
from crackfront.plots.motion import motion_animation, motion_figure
from crackfront.plots.nanodiamond import nanodiamond_figure
from crackfront.plots.parametric import parametric_study_figure
from crackfront.plots.pinned_loop import pinned_loop_figure
from crackfront.plots.prediction import prediction_figure
from crackfront.plots.rings import rings_figure
from crackfront.plots.roughness import roughness_figure
from crackfront.plots.smooth import smooth_loop_figure
from crackfront.plots.style import house_style, save_figure, save_picture, shown_axes
from crackfront.plots.sweep import (
    draw_factor_by_disorder,
    draw_factor_by_length,
    draw_hysteresis,
    draw_spectra,
    factor_figure,
    hysteresis_figure,
)
from crackfront.plots.validation import validation_figure

__all__ = [
    "ANIMATION_MAKERS",
    "FIGURE_MAKERS",
    "Axes",
    "draw_factor_by_disorder",
    "draw_factor_by_length",
    "draw_field",
    "draw_fronts",
    "draw_heights",
    "draw_hysteresis",
    "draw_instabilities",
    "draw_loop",
    "draw_spectra",
    "draw_spectrum",
    "factor_figure",
    "house_style",
    "hysteresis_figure",
    "laws_figure",
    "loop_figure",
    "prediction_figure",
    "save_animation",
    "save_figure",
    "save_picture",
    "shown_axes",
    "validation_figure",
    "work_precision_figure",
]

FIGURE_MAKERS: dict[str, Callable[[Any], Figure]] = {
    "main-1d": smooth_loop_figure,
    "main-2": rings_figure,
    "main-3ab": instability_figure,
    "main-3cd": pinned_loop_figure,
    "main-4": mapping_figure,
    "main-5a": film_scales_figure,
    "main-5bc": nanodiamond_figure,
    "si-5": parametric_study_figure,
    "si-6": synthetic_film_figure,
    "beyond-avalanches": avalanche_figure,
    "beyond-roughness": roughness_figure,
    "beyond-animation": motion_figure,
}
"""What draws the data of each figure in :data:`crackfront.figures.FIGURES`."""

ANIMATION_MAKERS: dict[str, Callable[[Any], Animation]] = {
    "beyond-animation": motion_animation,
}
"""What draws those that are animated."""
