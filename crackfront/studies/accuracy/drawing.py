"""Time against error, and the laws of the knobs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from crackfront.plots.style import BLACK, COLOURS, COLUMN, MARKERS, PAGE, blank_figure, house_style
from crackfront.simulate.laws import KNOBS, LAW_SIZE, Knob, Law
from crackfront.studies.accuracy.study import SceneErrors, pareto_front, rms

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_NAMES: dict[str, str] = {
    "sites": "sites of the front",
    "cubic": "samples, cubic pieces",
    "linear": "samples, linear pieces",
    "pixels": "pixels of the tile",
    "tolerance": "tolerance of the force",
    "asked": "chosen for an error",
}

_AXES: dict[str, str] = {
    "sites": "sites per short cutoff",
    "cubic": "cubic samples per short cutoff",
    "linear": "linear samples per short cutoff",
    "pixels": "pixels per short cutoff",
    "tolerance": r"tolerance / $w_\mathrm{int}$",
}


def work_precision_figure(studies: Sequence[SceneErrors]) -> Figure:
    """Error of the hysteresis against time of up to four scenes; the Pareto front is marked."""
    with house_style():
        figure = blank_figure(PAGE, 1.25 * COLUMN)
        rows = (len(studies) + 1) // 2
        panels = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, study in zip(panels, studies, strict=False):
            _draw_work_precision(axes, study)
        for axes in panels[len(studies) :]:
            axes.set_axis_off()
        for axes in panels[len(studies) - 2 : len(studies)]:
            axes.set_xlabel("CPU time of one realisation / s")
        for axes in panels[::2]:
            axes.set_ylabel("rms error of the hysteresis / %")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", title="varied")
        return figure


def _draw_work_precision(axes: Axes, study: SceneErrors) -> None:
    """One scene."""
    from matplotlib.ticker import LogLocator, NullFormatter

    seconds, relative = study.work_and_precision()
    error, best = 100 * relative, pareto_front(seconds, relative)
    knobs = np.array([errors.knob for errors in study.errors])
    axes.plot(seconds[best], error[best], color="0.8", linewidth=4, zorder=1, label="Pareto front")
    for knob, colour, marker in zip(_NAMES, COLOURS, MARKERS, strict=False):
        chosen = knobs == knob
        axes.plot(
            seconds[chosen],
            error[chosen],
            marker=marker,
            linewidth=0.8,
            color=colour,
            label=_NAMES[knob],
            zorder=3 if knob == "asked" else 2,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    scene = study.scene
    axes.set_title(
        rf"{scene.shape}, $e_\mathrm{{el}} = {scene.elastic_energy:g}\,w_\mathrm{{int}}$"
    )


def laws_figure(studies: Sequence[SceneErrors], laws: Sequence[Law]) -> Figure:
    """Measured errors of k of w_retr of one shape against every knob, and the fitted laws."""
    with house_style():
        figure = blank_figure(PAGE, 1.1 * COLUMN)
        panels = figure.subplots(2, 3).ravel()
        for axes, knob in zip(panels, KNOBS, strict=False):
            _draw_laws(axes, knob, studies, laws)
        for axes in panels[::3]:
            axes.set_ylabel(r"rms error of $w_\mathrm{retr}$ / $e_\mathrm{el}$")
        panels[-1].set_axis_off()
        handles, labels = panels[0].get_legend_handles_labels()
        panels[-1].legend(
            handles, labels, loc="center left", title=r"$e_\mathrm{el}/w_\mathrm{int}$"
        )
        return figure


def _draw_laws(axes: Axes, knob: Knob, studies: Sequence[SceneErrors], laws: Sequence[Law]) -> None:
    """One knob."""
    from matplotlib.ticker import NullFormatter

    for study, colour, marker in zip(studies, COLOURS, MARKERS, strict=False):
        scene = study.scene
        tried = [errors for errors in study.errors if errors.knob == knob]
        values = np.array([errors.value for errors in tried])
        found = np.array([rms(errors.adhesion[:, 1]) for errors in tried])
        axes.plot(
            values,
            found / scene.elastic_energy,
            marker=marker,
            linestyle="none",
            color=colour,
            label=f"{scene.elastic_energy:g}",
        )
        law = next(
            law
            for law in laws
            if (law.shape, law.elastic_energy, law.knob, law.direction)
            == (scene.shape, scene.elastic_energy, knob, -1)
        )
        between = np.geomspace(values.min(), values.max(), 60)
        axes.plot(between, [law.error(x, LAW_SIZE) for x in between], color=colour)
    axes.axhline(0.01, color=BLACK, linewidth=0.4, dashes=(4, 2))
    axes.set_yscale("log")
    if knob != "sites":
        axes.set_xscale("log")
    if knob not in ("sites", "tolerance"):
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(_AXES[knob])
