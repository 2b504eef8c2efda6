"""Figures of the measured errors: time against error, and the laws of the errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from crackfront.plots import style
from crackfront.plots.parts import label_decimals, label_panel
from crackfront.simulate.laws import LAW_CUTOFFS, SETTINGS, ErrorLaw, SettingName
from studies.accuracy.fitting import setting_errors
from studies.accuracy.report import Measured
from studies.accuracy.scenes import Scene
from studies.accuracy.study import SceneErrors, pareto_front, rms

_SHOWN = ("chemical-0.0025", "chemical-0.04", "flat-0.16", "h03-0.04")
"""Scenes of the figure of time against error."""

_OTHERS = "samples, pixels or tolerance varied"
_NAMES = {
    "sites": "sites of the front varied",
    "cubic": _OTHERS,
    "linear": _OTHERS,
    "pixels": _OTHERS,
    "tolerance": _OTHERS,
    "requested": "chosen for an error",
    "finer": "finer than the reference",
}
"""Name in the legend of every setting that is varied."""

_LOOKS: dict[str, dict[str, Any]] = {
    _OTHERS: {"color": "0.45", "marker": "o", "markerfacecolor": "white", "linestyle": "none"},
    _NAMES["sites"]: {"color": style.VERMILION, "marker": "s", "linestyle": "none"},
    _NAMES["requested"]: {"color": style.BLUE, "marker": "D", "linewidth": 1.2},
    _NAMES["finer"]: {"color": style.BLACK, "marker": "X", "markersize": 5, "linestyle": "none"},
}
"""Looks of the points, from the lowest layer to the highest."""

_AXES: dict[SettingName, str] = {
    "sites": "sites per short cutoff",
    "cubic": "cubic samples per short cutoff",
    "linear": "linear samples per short cutoff",
    "pixels": "pixels per short cutoff",
    "tolerance": r"tolerance / $w_\mathrm{int}$",
}


def figures(study_errors: Measured, laws: Sequence[ErrorLaw]) -> dict[str, Figure]:
    """Figures of what was measured, by the names of their files."""
    drawn, scenes = {}, study_errors.scenes
    if shown := [scenes[name] for name in _SHOWN if name in scenes]:
        drawn["work-precision"] = work_precision_figure(shown)
    if flat := [study for study in study_errors.fitted if study.scene.shape == "flat"]:
        drawn["laws"] = laws_figure(flat, laws)
    return drawn


def work_precision_figure(studies: Sequence[SceneErrors]) -> Figure:
    """Error of the hysteresis against time of up to four scenes; the Pareto front is marked."""
    with style.house_style():
        figure = style.blank_figure(style.PAGE, 1.25 * style.COLUMN)
        rows = (len(studies) + 1) // 2
        panels = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, study, letter in zip(panels, studies, "abcd", strict=False):
            _draw_work_precision(axes, study)
            label_panel(axes, letter)
        for axes in panels[len(studies) :]:
            axes.set_axis_off()
        for axes in panels[len(studies) - 2 : len(studies)]:
            axes.set_xlabel("CPU time of one realisation (s)")
        for axes in panels[::2]:
            axes.set_ylabel("rms error of the hysteresis (%)")
        entries = panels[0].get_legend_handles_labels()
        figure.legend(*entries, loc="outside upper center", ncols=3)
        return figure


def _draw_work_precision(axes: Axes, study: SceneErrors) -> None:
    """Draw the settings of one scene."""
    seconds, relative = study.work_and_precision()
    error, best = 100 * relative, pareto_front(seconds, relative)
    label = "fastest for its error (Pareto front)"
    axes.plot(seconds[best], error[best], color="0.85", linewidth=5, zorder=1, label=label)
    names = np.array([_NAMES[errors.setting] for errors in study.errors])
    for layer, (name, look) in enumerate(_LOOKS.items(), start=2):
        chosen = names == name
        axes.plot(seconds[chosen], error[chosen], label=name, zorder=layer, **look)
    axes.set(xscale="log", yscale="log")
    label_decimals(axes.xaxis)
    label_decimals(axes.yaxis, LogLocator())
    scene = study.scene
    axes.set_title(
        rf"{_spectrum(scene)}, $e_\mathrm{{el}} = {scene.elastic_energy:g}\,w_\mathrm{{int}}$"
    )


def _spectrum(scene: Scene) -> str:
    """Spectrum of a scene in a title."""
    if scene.spectrum.roll_off > scene.spectrum.short_cutoff:
        return rf"$H = {scene.spectrum.hurst:g}$"
    return "chemical" if scene.kind == "chemical" else "flat spectrum"


def laws_figure(studies: Sequence[SceneErrors], laws: Sequence[ErrorLaw]) -> Figure:
    """Measured errors of k of w_retr of one shape against every setting, and the fitted laws."""
    with style.house_style():
        figure = style.blank_figure(style.PAGE, 1.1 * style.COLUMN)
        panels = figure.subplots(2, 3).ravel()
        for axes, setting, letter in zip(panels, SETTINGS, "abcde", strict=False):
            _draw_laws(axes, setting, studies, laws)
            label_panel(axes, letter)
        for axes in panels[::3]:
            axes.set_ylabel(r"rms error of $w_\mathrm{retr}$ / $e_\mathrm{el}$")
        panels[-1].set_axis_off()
        entries = panels[0].get_legend_handles_labels()
        panels[-1].legend(*entries, loc="center left", title=r"$e_\mathrm{el}/w_\mathrm{int}$")
        style.explain(
            figure,
            r"lines: the fitted laws, bias of $w_\mathrm{retr}$ and scatter of both branches "
            "together; broken line: an error of 0.01",
        )
        return figure


def _draw_laws(
    axes: Axes, setting: SettingName, studies: Sequence[SceneErrors], laws: Sequence[ErrorLaw]
) -> None:
    """Draw the errors of one setting and their laws, a colour a scene."""
    tried: set[float] = set()
    for study, colour, marker in zip(studies, style.COLOURS, style.MARKERS, strict=False):
        scene = study.scene
        values, errors_by_value = setting_errors(study, setting)
        tried.update(values.tolist())
        axes.plot(
            values,
            [rms(errors[:, 1]) for errors in errors_by_value],
            marker=marker,
            linestyle="none",
            color=colour,
            label=f"{scene.elastic_energy:g}",
        )
        law = next(
            law
            for law in laws
            if (law.shape, law.elastic_energy, law.setting, law.direction)
            == (scene.shape, scene.elastic_energy, setting, -1)
        )
        between = np.geomspace(values.min(), values.max(), 60)
        axes.plot(between, [law.error(x, LAW_CUTOFFS) for x in between], color=colour)
    axes.axhline(0.01, color=style.BLACK, linewidth=0.4, dashes=(4, 2))
    axes.set_yscale("log")
    if setting != "sites":
        axes.set_xscale("log")
    if setting not in ("sites", "tolerance"):
        axes.set_xticks(sorted(tried), [f"{value:g}" for value in sorted(tried)])
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(_AXES[setting])
