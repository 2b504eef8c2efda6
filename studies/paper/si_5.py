"""SI Fig. S-5: hysteresis against disorder for several spectra, from the table of a sweep."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from crackfront.analysis.estimate import REACH, least_squares_slope, with_error, with_interval
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.fit_text import pooled_limits
from crackfront.analysis.result import SweepFit
from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.table import SweepTable
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, LATERAL, variable
from crackfront.plots.parts import legend_entries
from crackfront.plots.style import PAGE, blank_figure, explain, house_style
from crackfront.sweep.section import Section
from studies.paper.checks import Check
from studies.paper.drawing import name_panels
from studies.paper.figure import Figure, values_of
from studies.paper.rough import ONE_DIGIT
from studies.progress import Progress

_SAME = 0.1
"""Relative spread up to which spectra have one k: ten times the numerical errors of k."""

_spectrum, _amplitude = "spectrum", "amplitude"
_cell = (_spectrum, _amplitude, "realisation")


class ParametricStudyParameters(Section):
    """Which sweep the figure shows; its results must stand in `results/`."""

    sweep: str  # its configuration


@dataclass(frozen=True, slots=True)
class ParametricStudy:
    """Works of adhesion of a sweep and the range of its fit; the fit follows from them."""

    spectrum: NDArray[np.str_] = variable("name of the spectrum", "1", _spectrum)
    short_cutoff: Array = variable("shortest wavelength lambda_s", LATERAL, _spectrum)
    roll_off: Array = variable("roll-off wavelength lambda_r", LATERAL, _spectrum)
    hurst: Array = variable("Hurst exponent", "1", _spectrum)
    correlation_length: Array = variable("correlation length of w_loc", LATERAL, _spectrum)
    e_el_requested: Array = variable("requested e_el", ADHESION, _amplitude)
    e_el: Array = variable("energy of full conformity of the tile", ADHESION, *_cell)
    w_rms: Array = variable("rms of w_loc on the tile", ADHESION, *_cell)
    w_appr: Array = variable("apparent work of adhesion in approach", ADHESION, *_cell)
    w_retr: Array = variable("apparent work of adhesion in retraction", ADHESION, *_cell)
    w_appr_from_force: Array = variable("w_appr of a JKR fit", ADHESION, *_cell)
    w_retr_from_force: Array = variable("w_retr of a JKR fit", ADHESION, *_cell)
    w_appr_numerical_error: Array = variable("numerical error of w_appr", ADHESION, *_cell)
    w_retr_numerical_error: Array = variable("numerical error of w_retr", ADHESION, *_cell)
    kind: str = variable("roughness or chemical", "1")
    lowest_elastic_energy: float = variable("lowest e_el of the fit", ADHESION)
    highest_elastic_energy: float = variable("highest e_el of the fit", ADHESION)
    n_bootstrap: int = variable("bootstrap samples of the fit", "1")
    seed: int = variable("seed of the bootstrap", "1")
    contact_radius: Array | None = variable(
        "middle of the steady window", LATERAL, *_cell, default=None
    )

    @property
    def table(self) -> SweepTable:
        """The table of the sweep; k by the law needs contact radii."""
        names = {field.name for field in fields(SweepTable)} & {
            field.name for field in fields(self)
        }
        columns = values_of(self, *names) | {"amplitude": self.e_el_requested}
        columns["spectrum"] = self.spectrum.astype(np.str_)
        if self.contact_radius is None:
            columns["contact_radius"] = np.full(self.e_el.shape, np.nan)
        return SweepTable(**columns, spring=np.full(self.e_el.shape[:2], np.nan))


_FIT_FIELDS = ("kind", "lowest_elastic_energy", "highest_elastic_energy", "n_bootstrap", "seed")


def parametric_study(
    parameters: ParametricStudyParameters, progress: Progress, fit: SweepFit
) -> ParametricStudy:
    """Data of the figure from the fit of a sweep."""
    progress(f"{parameters.sweep}: {fit.table.finite.sum()} simulations with a value")
    table_fields = {field.name for field in fields(ParametricStudy)} - {
        *_FIT_FIELDS,
        "e_el_requested",
    }
    columns = values_of(fit.table, *table_fields) | values_of(fit, *_FIT_FIELDS)
    return ParametricStudy(**columns, e_el_requested=fit.table.amplitude)


def study_fit(study: ParametricStudy) -> SweepFit:
    """The fit of a sweep once more, from the data of the figure."""
    return fit_sweep(study.table, **values_of(study, *_FIT_FIELDS))


def parametric_study_checks(study: ParametricStudy) -> tuple[Check, ...]:
    """What the paper reads off the figure: k, the square law, one line, the onset."""
    fit = study_fit(study)
    factor, exponent = fit.pooled.factor, fit.pooled.exponent
    factors = fit.spectra.factor.value
    spread = float(np.ptp(factors) / np.mean(factors))
    law, largest = _by_law(fit), float(np.nanmax(fit.cells.factor.value))
    return (
        Check(
            f"k of all spectra, e_el from {study.lowest_elastic_energy:g} to "
            f"{study.highest_elastic_energy:g} w_int: about 3",
            with_error(PAPER_FACTOR, ONE_DIGIT),
            with_interval(factor),
            bool(abs(factor.value - PAPER_FACTOR) <= ONE_DIGIT),
            f"{', '.join(['95% interval', *pooled_limits(fit, fit.spectra.factor)])}; k grows with "
            "the size of the contact, and falls with disorder beyond the onset: panels b and c",
            law=_law_text(float(factor.value), *law.factor),
        ),
        Check(
            "k of any one spectrum and amplitude of the sweep: 3, which the paper draws as a line",
            f"{PAPER_FACTOR:g} or more",
            f"at most {largest:.2f}",
            largest >= PAPER_FACTOR,
            "for its dashed line the paper states one digit, no range, weights, resolution or "
            "number of surfaces; the authors' published code finds the states of this solver "
            "(docs/law.md, The paper's 3)",
            law=_law_text(largest, *law.largest),
        ),
        Check(
            "hysteresis in proportion to w_rms^2: exponent 2",
            "2 in the 95% interval",
            with_interval(exponent),
            bool(exponent.low <= 2 <= exponent.high),
            "over the range of the fit, where k falls with disorder",
            law=_law_text(float(exponent.value), *law.exponent),
        ),
        Check(
            "independent of the shape of the spectrum: spread of k among the spectra",
            f"at most {100 * _SAME:.0f}%",
            f"{100 * spread:.1f}%",
            spread <= _SAME,
            ", ".join(f"{name} {k:.2f}" for name, k in zip(study.spectrum, factors, strict=True)),
            law=_law_text(100 * spread, *law.spread, units="%"),
        ),
        _onset_check(study, fit),
    )


class _ByLaw(NamedTuple):
    """What the law gives for what the paper reads off, with half of its interval; spread in %."""

    factor: tuple[float, float]
    exponent: tuple[float, float]
    spread: tuple[float, float]
    largest: tuple[float, float]


def _by_law(fit: SweepFit) -> _ByLaw:
    """Pooled and largest k, exponent and spread among spectra by the law, NaN if unknown."""
    law = fit.cells.law_factor
    k, error = law.value[:, fit.in_range], law.standard_error[:, fit.in_range]
    if not np.all(np.isfinite(k)):
        return _ByLaw(*[(math.nan, math.nan)] * 4)
    strength = np.log(fit.cells.w_rms[:, fit.in_range])
    along, weight = least_squares_slope(strength, np.log(k))
    # Errors of different amplitudes and spectra count as independent.
    relative = float(np.mean(error / k))
    mean = np.mean(k, axis=1)
    return _ByLaw(
        (float(np.mean(k)), REACH * float(np.mean(error))),
        (2 + float(np.mean(along)), REACH * relative / math.sqrt(float(np.mean(weight)))),
        (float(100 * np.ptp(mean) / np.mean(mean)), 100 * REACH * relative * math.sqrt(2)),
        (float(np.max(k)), REACH * relative * float(np.max(k))),
    )


def _law_text(measured: float, value: float, reach: float, units: str = "") -> str:
    """The law's number if the measured one agrees with it, else nothing."""
    return f"{with_error(value, reach)}{units}" if abs(measured - value) <= reach else ""


class _Onset(NamedTuple):
    """Amplitudes between which k rises to half of its mean over the range (w_int).

    The lower one is 0 if k is above the half at every amplitude.
    """

    above: float
    reached: float


def _onsets(fit: SweepFit) -> list[_Onset]:
    """Onsets of hysteresis of all spectra."""
    onsets, edges = [], np.concatenate([[0.0], fit.table.amplitude])
    for factors, mean in zip(fit.cells.factor.value, fit.spectra.factor.value, strict=True):
        below = np.flatnonzero(factors < mean / 2)
        last = int(below[-1]) + 1 if below.size else 0
        onsets.append(_Onset(float(edges[last]), float(edges[last + 1])))
    return onsets


def _onset_check(study: ParametricStudy, fit: SweepFit) -> Check:
    """Onsets in the order of the correlation lengths, where the amplitudes decide it."""
    onsets, lengths = _onsets(fit), study.correlation_length
    in_order = decided = undecided = 0
    for first, second in itertools.combinations(np.argsort(lengths), 2):
        if lengths[first] == lengths[second]:
            continue
        is_lower = onsets[first].reached <= onsets[second].above
        is_higher = onsets[second].reached <= onsets[first].above
        decided += is_lower or is_higher
        undecided += not (is_lower or is_higher)
        in_order += is_lower
    rows = zip(study.spectrum, lengths, onsets, strict=True)
    text = ", ".join(
        f"{name} {length:.3g}: {onset.above:.2g} to {onset.reached:.2g}"
        for name, length, onset in rows
    )
    return Check(
        "onset of hysteresis at larger e_el for a longer correlation length",
        "all pairs of spectra that the amplitudes decide",
        f"{in_order} of {decided}",
        decided > 0 and in_order == decided,
        f"correlation length: e_el / w_int between which k rises to half of its mean over the fit "
        f"({text}); the onsets of {undecided} other pairs lie between the same amplitudes",
        undecided="" if decided else "all onsets lie between the same two amplitudes",
    )


def parametric_study_figure(study: ParametricStudy) -> Drawing:
    """Hysteresis against disorder with the spectra, k against disorder, k against size."""
    from crackfront.plots.sweep_figures import (
        SHIFTS_EXPLAINED,
        arrows_explained,
        draw_factor_by_disorder,
        draw_factor_by_length,
        draw_hysteresis,
        points_explained,
        pooled_explained,
        set_factor_limits,
        shapes_explained,
    )

    fit = study_fit(study)
    with house_style():
        figure = blank_figure(PAGE, 0.68 * PAGE)
        panels = figure.subplot_mosaic([["a", "b"], ["a", "c"]], width_ratios=(1.2, 1))
        draw_hysteresis(panels["a"], fit)
        _draw_inset(panels["a"], fit)
        draw_factor_by_disorder(panels["b"], fit)
        draw_factor_by_length(panels["c"], fit)
        for name in ("b", "c"):
            set_factor_limits(panels[name], fit)
        panels["c"].set_ylabel("mean $k$")
        # The legend of panel b serves for all panels: it also contains the pooled k.
        figure.legend(*legend_entries(panels["b"]), loc="outside upper center", ncols=3)
        texts = [
            *points_explained(fit),
            *arrows_explained(fit),
            "inset: spectra",
            f"{SHIFTS_EXPLAINED} (b)",
        ]
        texts += [*pooled_explained(fit), *(f"{text} (c)" for text in shapes_explained(fit))]
        explain(figure, "; ".join(texts))
        name_panels(panels.values(), "abc")
        return figure


def _draw_inset(axes: Axes, fit: SweepFit) -> None:
    """Spectra in small print, below the points of hysteresis."""
    from crackfront.plots.sweep_figures import draw_spectra

    inset = axes.inset_axes((0.68, 0.12, 0.3, 0.27))
    draw_spectra(inset, fit)
    inset.tick_params(labelsize=6, pad=1.5)
    inset.set_xlabel("$q$ (reduced)", labelpad=0, fontsize=6)
    inset.yaxis.label.set_fontsize(6)


FIGURE = Figure(
    title="SI Fig. S-5: hysteresis against disorder, and k against disorder and size",
    compute=parametric_study,
    checks=parametric_study_checks,
    draw=parametric_study_figure,
)
