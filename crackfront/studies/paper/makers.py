"""What draws the data of each figure."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from crackfront.plots.animation import Animation
from crackfront.plots.densities import film_scales_figure, synthetic_film_figure
from crackfront.plots.instabilities import instability_figure
from crackfront.studies.paper.draw_avalanches import avalanche_figure
from crackfront.studies.paper.draw_mapping import mapping_figure
from crackfront.studies.paper.draw_motion import motion_animation, motion_figure
from crackfront.studies.paper.draw_nanodiamond import nanodiamond_figure
from crackfront.studies.paper.draw_parametric import parametric_study_figure
from crackfront.studies.paper.draw_pinned_loop import pinned_loop_figure
from crackfront.studies.paper.draw_rings import rings_figure
from crackfront.studies.paper.draw_roughness import roughness_figure
from crackfront.studies.paper.draw_smooth import smooth_loop_figure

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
"""What draws the data of each figure in :data:`crackfront.studies.paper.figures.FIGURES`."""

ANIMATION_MAKERS: dict[str, Callable[[Any], Animation]] = {
    "beyond-animation": motion_animation,
}
"""What draws those that are animated."""
