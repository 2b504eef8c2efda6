"""From measured errors to laws."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from crackfront.accuracy.study import Errors, SceneErrors
from crackfront.laws import KNOBS, Knob, Law, abscissa

Array = NDArray[np.float64]

_LEAST = 3e-4
"""Errors of k below this count as this: nobody asks for less, and they would bend the laws."""

_NO_BIAS = (-99.0, 0.0)
"""Coefficients of a bias that is not seen."""


_QUANTILE, _NORMAL_QUANTILE = 0.9, 1.645
"""A scatter is that of the normal distribution of which so many errors are smaller: avalanches
make rare large errors, of which eight surfaces hold one or none."""


def fit_laws(studies: Iterable[SceneErrors]) -> Iterator[Law]:
    """Law of every knob, amplitude and branch, fitted to the errors of scenes.

    A bias counts where it is twice its standard error; elsewhere only scatter is seen, that of
    both branches together. Both are fitted by least squares of their logarithms.

    Parameters
    ----------
    studies : iterable of SceneErrors
        Scenes in which every knob was varied by itself.
    """
    for study in studies:
        for knob in KNOBS:
            tried = [errors for errors in study.errors if errors.knob == knob]
            yield from _laws(study, knob, tried)


def _laws(study: SceneErrors, knob: Knob, tried: list[Errors]) -> Iterator[Law]:
    """Laws of one knob, of both branches."""
    x = np.array([abscissa(knob, errors.value) for errors in tried])
    values = np.array([errors.adhesion for errors in tried]) / study.scene.elastic_energy
    n_setting, n_realisation, _ = values.shape
    bias = np.abs(values.mean(axis=1))
    uncertainty = values.std(axis=1, ddof=1) / np.sqrt(n_realisation)
    deviation = np.abs(values - values.mean(axis=1, keepdims=True)).reshape(n_setting, -1)
    deviation *= np.sqrt(n_realisation / (n_realisation - 1))
    scatter = np.quantile(deviation, _QUANTILE, axis=1) / _NORMAL_QUANTILE
    finer = -1 if knob == "tolerance" else 1
    for branch, direction in enumerate((1, -1)):
        certain = bias[:, branch] > 2 * uncertainty[:, branch]
        yield Law(
            shape=study.scene.shape,
            elastic_energy=study.scene.elastic_energy,
            knob=knob,
            direction=direction,
            bias=_falling_line(x[certain], bias[certain, branch], finer),
            scatter=_falling_line(x, scatter, finer),
        )


def _falling_line(x: Array, values: Array, finer: int) -> tuple[float, float]:
    """Line through logarithms that falls towards finer numerics; none through less than two."""
    if x.size < 2:
        return _NO_BIAS
    y = np.log(np.maximum(values, _LEAST))
    slope, start = np.polyfit(x, y, 1)
    if finer * slope > 0:
        return float(np.mean(y)), 0.0
    return float(start), float(slope)
