"""From measured errors to laws: how they are fitted and written."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

import numpy as np
from scipy.optimize import minimize_scalar

from crackfront.core.arrays import Array
from crackfront.simulate.laws import SETTINGS, ErrorLaw, SettingName, abscissa
from studies.accuracy.study import SceneErrors

_LEAST = 3e-4
"""Least error of k that counts, as nobody asks for less."""

_SLOWEST: dict[SettingName, float] = {
    "sites": -0.6,
    "cubic": -2.0,
    "linear": -1.0,
    "pixels": -2.0,
    "tolerance": 0.5,
}
"""Slopes that a law of scatter has at least: half the order of the setting.

An avalanche that one discretisation triggers and another does not is of a size of its own; only its
chance falls with the error of the field, and the rms with the root of that. Among a few surfaces a
single such event can hide the slope.
"""

_STEEPEST = 10.0
"""Slope that no law exceeds, relative to the slowest one."""

_NO_BIAS = (-99.0, 0.0)
"""Coefficients of a bias that is not seen."""


def fit_laws(studies: Iterable[SceneErrors]) -> Iterator[ErrorLaw]:
    """Law of every setting, amplitude and branch, fitted to the errors of scenes.

    A bias counts if it is twice its standard error; else only scatter is seen, of both branches
    together. The mean of measured over fitted mean squares is one: few surfaces have
    an avalanche that changes, and logarithms would count those without one as much.
    """
    for study in studies:
        for setting in SETTINGS:
            yield from _laws(study, setting)


def setting_errors(study: SceneErrors, setting: SettingName) -> tuple[Array, Array]:
    """Values of a setting, and the errors of k that it adds, (value, realisation, branch)."""
    tried = [errors for errors in study.errors if errors.setting == setting]
    without = {
        errors.value: errors.adhesion for errors in study.errors if errors.setting == "sites"
    }
    added = [
        errors.adhesion - (0.0 if setting == "sites" else without[errors.angles_per_cutoff])
        for errors in tried
    ]
    values = np.array([errors.value for errors in tried])
    return values, np.array(added) / study.scene.elastic_energy


def _laws(study: SceneErrors, setting: SettingName) -> Iterator[ErrorLaw]:
    """Laws of one setting, the approach before the retraction."""
    tried, values = setting_errors(study, setting)
    x = abscissa(setting, tried)
    n_realisation = values.shape[1]
    bias = np.abs(values.mean(axis=1))
    uncertainty = values.std(axis=1, ddof=1) / np.sqrt(n_realisation)
    scatter = np.sqrt(np.mean(values.var(axis=1, ddof=1), axis=1))
    slowest = _SLOWEST[setting]
    scatter_line = _falling_line(x, scatter, slowest)
    for branch, direction in enumerate((1, -1)):
        certain = bias[:, branch] > 2 * uncertainty[:, branch]
        seen = np.count_nonzero(certain) > 1
        bias_line = _falling_line(x[certain], bias[certain, branch], slowest) if seen else _NO_BIAS
        shape, energy = study.scene.shape, study.scene.elastic_energy
        yield ErrorLaw(shape, energy, setting, direction, bias_line, scatter_line)


def _falling_line(x: Array, values: Array, slowest: float) -> tuple[float, float]:
    """Likeliest line ln(value) = c_0 + c_1 x of a least slope, from the coarsest value on."""
    # The squares have a gamma distribution about the line.
    # The first of the values at the end that are too small counts.
    counted = 2 + np.max(np.flatnonzero(values >= _LEAST), initial=0)
    x, square = x[:counted], np.maximum(values[:counted], _LEAST) ** 2

    def start(slope: float) -> float:
        return float(np.log(np.mean(square * np.exp(-2 * slope * x))) / 2)

    slope = minimize_scalar(
        lambda slope: start(slope) + slope * np.mean(x),
        bounds=sorted((slowest, _STEEPEST * slowest)),
        method="bounded",
    ).x
    return start(slope), float(slope)


def laws_text(laws: Iterable[ErrorLaw]) -> str:
    """Laws as the lines of `laws.csv`, five digits each."""
    text = io.StringIO()
    columns = ("shape", "elastic_energy", "setting", "direction")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*columns, "bias_0", "bias_1", "scatter_0", "scatter_1"])
    for law in laws:
        coefficients = [f"{value:.4f}" for value in (*law.bias, *law.scatter)]
        writer.writerow([*(getattr(law, name) for name in columns), *coefficients])
    return text.getvalue()
