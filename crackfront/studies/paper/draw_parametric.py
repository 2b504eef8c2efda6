"""SI Fig. S-5: the law, and how k depends on disorder and on size, on one page."""

from __future__ import annotations

from matplotlib.figure import Figure

from crackfront.plots.style import PAGE, blank_figure, house_style
from crackfront.plots.sweep import (
    draw_factor_by_disorder,
    draw_factor_by_length,
    draw_hysteresis,
    draw_spectra,
    set_factor_limits,
)
from crackfront.studies.paper.parametric import ParametricStudy, study_fit


def parametric_study_figure(study: ParametricStudy) -> Figure:
    """Hysteresis against disorder with the spectra, k against disorder, k against size.

    Parameters
    ----------
    study : ParametricStudy
        Data of the figure.
    """
    fit = study_fit(study)
    with house_style():
        figure = blank_figure(PAGE, 0.62 * PAGE)
        panels = figure.subplot_mosaic([["a", "b"], ["a", "c"]], width_ratios=(1.2, 1))
        draw_hysteresis(panels["a"], fit.table, fit)
        draw_spectra(panels["a"].inset_axes((0.7, 0.12, 0.28, 0.26)), fit.table, fit.kind)
        draw_factor_by_disorder(panels["b"], fit.table, fit)
        draw_factor_by_length(panels["c"], fit.table, fit)
        for name in ("b", "c"):
            set_factor_limits(panels[name], fit)
        panels["c"].set_ylabel("mean $k$")
        for name, axes in panels.items():
            axes.set_title(name, loc="left", fontweight="bold")
        return figure
