"""Figures of a sweep: hysteresis, and k against disorder and size, with the law of k.

Error bars are 95% intervals of the mean over realisations. Filled symbols are in the range of the
fit, open symbols outside. An arrow at the lower edge marks a mean below the axes. Straight fronts
of one spectrum share a colour; the marker shows their springs.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from crackfront.analysis.finding import PAPER_FACTOR, PERTURBATION_FACTOR
from crackfront.analysis.fit_text import pooled_limits
from crackfront.analysis.law import (
    WEAKEST,
    law_value,
    pinning_factors,
    shipped_law,
)
from crackfront.analysis.result import SweepFit
from crackfront.analysis.sweep_law import LARGE, SweepLaw
from crackfront.core.adhesion import adhesion_rms
from crackfront.core.arrays import Array
from crackfront.core.spectrum import Spectrum
from crackfront.plots.parts import (
    PointStyle,
    draw_below,
    draw_estimates,
    draw_fit,
    draw_law,
    draw_theory,
    label_decimals,
    legend_entries,
    spectrum_colour,
    spectrum_families,
    spectrum_label,
    spectrum_marker,
    spectrum_styles,
    spring_label,
    springs_explained,
    title_letters,
)
from crackfront.plots.style import BLACK, PAGE, blank_figure, explain, house_style

SHIFTS_EXPLAINED = "points of one amplitude are shifted sideways by up to 6%"
"""Explanation below figures of k against disorder."""

_MOST_FOR_DECIMALS = 100.0
"""Ratio of the ends of a logarithmic axis up to which its labels are decimal numbers."""

_VARIANCE_MARGIN = 1.8
"""Ratio of an end of the axis of the variance to the outermost point."""

_HYSTERESIS_MARGIN = 1.6
"""Ratio of the lowest point or theory to the lower end of the axis of the hysteresis."""

_SIZE_MARGIN = 1.5
"""Ratio of an end of the axis of g to the outermost point."""

_SMALLEST_POINT = 0.05
"""Smallest hysteresis that is drawn as a point, relative to the paper's k at the weakest disorder:
hysteresis vanishes below its onset, and such points must not stretch the axes."""

_FACTOR_LABEL = r"$k = (w_\mathrm{retr}-w_\mathrm{appr})\,/\,2e_\mathrm{el}$"


def points_explained(fit: SweepFit) -> list[str]:
    """Explanation of bars and open symbols, if a sweep has them."""
    hysteresis, texts = fit.cells.hysteresis, []
    if np.any(np.isfinite(hysteresis.high)):
        texts.append("bars: 95% intervals over realisations")
    if np.any(np.isfinite(hysteresis.value[:, ~fit.in_range])):
        texts.append("open symbols: amplitudes outside the range of the fit")
    return texts


def arrows_explained(fit: SweepFit) -> list[str]:
    """Explanation of the arrows of :func:`draw_hysteresis`, if it draws any."""
    return ["arrows: means below the lower edge"] if np.any(_below(fit)) else []


def pooled_explained(fit: SweepFit) -> list[str]:
    """Errors that the interval of the pooled k does not include."""
    limits = pooled_limits(fit, fit.spectra.factor)
    return [f"pooled $k$: {', '.join(limits)}"] if limits else []


def shapes_explained(fit: SweepFit) -> list[str]:
    """Explanation of the lines of :func:`draw_factor_by_length`, if spectra share a shape."""
    shared = np.unique(fit.table.shape).size < fit.table.shape.size
    return ["grey line: spectra of one shape"] if shared else []


def hysteresis_figure(fit: SweepFit) -> Figure:
    """Hysteresis against the variance of w_loc, and the spectra (SI Fig. S-5)."""
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        left_axes, right_axes = figure.subplots(1, 2, width_ratios=(1.5, 1))
        draw_hysteresis(left_axes, fit)
        draw_spectra(right_axes, fit)
        figure.legend(*legend_entries(left_axes), loc="outside upper center", ncols=3)
        title_letters(left_axes, right_axes)
        texts = [*points_explained(fit), *arrows_explained(fit)]
        if fit.table.on_springs:
            texts.append(springs_explained(fit))
        explain(figure, "; ".join(texts))
        return figure


def factor_figure(fit: SweepFit) -> Figure:
    """Factors k against disorder and, averaged over the range, against correlation length.

    For straight fronts: k against size at every amplitude, and k of the infinite contact against
    disorder.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.45 * PAGE)
        left_axes, right_axes = figure.subplots(1, 2, sharey=True, width_ratios=(1.35, 1))
        texts = points_explained(fit)
        if fit.table.on_springs:
            _draw_line_factors(left_axes, right_axes, fit)
            texts += ["colours: amplitudes (a), spectra (b, with the symbols of a)"]
        else:
            draw_factor_by_disorder(left_axes, fit)
            draw_factor_by_length(right_axes, fit)
            set_factor_limits(left_axes, fit)
            figure.legend(*legend_entries(left_axes), loc="outside upper center", ncols=3)
            texts += [f"{SHIFTS_EXPLAINED} (a)", *pooled_explained(fit)]
            texts += [f"{text} (b)" for text in shapes_explained(fit)]
        title_letters(left_axes, right_axes)
        explain(figure, "; ".join(texts))
        return figure


def _draw_line_factors(left_axes: Axes, right_axes: Axes, fit: SweepFit) -> None:
    """Draw k of straight fronts against size, and k of the infinite contact against disorder.

    Both panels share the markers, which the legend of the first explains.
    """
    draw_factor_by_size(left_axes, fit)
    draw_infinite_law(right_axes)
    table, cells = fit.table, fit.cells
    families = spectrum_families(table)
    for index, family in enumerate(families):
        style = PointStyle(spectrum_colour(family), spectrum_marker(family), "")
        s = np.zeros_like(cells.w_rms[index]) if fit.uncorrelated else cells.w_rms[index]
        shown = np.nan_to_num(cells.size[index]) > LARGE
        row = cells.infinite_factor.at(index).where(shown)
        draw_estimates(right_axes, style, s, row, fit.in_range)
    right_axes.legend(*legend_entries(right_axes), loc="lower left")
    right_axes.set_ylabel(r"$k$, infinite contact (points: $g>1$)")
    left_axes.set_ylim(0.0, 1.1 * PERTURBATION_FACTOR)


def draw_factor_by_size(axes: Axes, fit: SweepFit) -> None:
    """Draw mean k of straight fronts against g; colours are amplitudes, markers are spectra."""
    table = fit.table
    shades = colormaps["viridis"](np.linspace(0, 0.88, table.amplitude.size))
    for amplitude, energy in enumerate(table.amplitude):
        colour = to_hex(shades[amplitude])
        _draw_amplitude_by_size(axes, fit, amplitude, colour)
        if fit.uncorrelated:
            label = rf"$e_\mathrm{{el}}={energy:.3g}\,w_\mathrm{{int}}$"
            axes.plot([], [], color=colour, linewidth=3.0, label=label)
        else:
            _draw_law_by_size(axes, fit, adhesion_rms(energy), colour)
    if fit.uncorrelated:
        # The law of weak disorder is the same at all amplitudes.
        _draw_law_by_size(axes, fit, 0.0, BLACK)
    families = spectrum_families(table)
    for family in dict.fromkeys(families):
        label = spectrum_label(table, families.index(family))
        axes.plot([], [], spectrum_marker(family), color="0.4", label=label)
    axes.set(xscale="log", xlim=_ends(fit.cells.size, _SIZE_MARGIN), ylabel=_FACTOR_LABEL)
    label_decimals(axes.xaxis)
    axes.set_xlabel(r"size $g=L_\kappa/\ell$, springs over Larkin length")
    axes.legend(loc="upper left", ncols=2)


def _draw_amplitude_by_size(axes: Axes, fit: SweepFit, amplitude: int, colour: str) -> None:
    """Draw a point for k of each spectrum at one amplitude against its g."""
    for index, family in enumerate(spectrum_families(fit.table)):
        style = PointStyle(colour, spectrum_marker(family), "")
        factor = fit.cells.factor.at(([index], amplitude))
        size = fit.cells.size[[index], amplitude]
        draw_estimates(axes, style, size, factor, fit.in_range[[amplitude]])


def _draw_law_by_size(axes: Axes, fit: SweepFit, s: float, colour: str) -> None:
    """Draw k by the law against g at a disorder s, for the mean breadth of the spectra."""
    law, ends = shipped_law(), _ends(fit.cells.size, _SIZE_MARGIN)
    breadth = float(np.nanmean(SweepLaw(fit.table, fit.kind).breadths))
    abscissa = np.geomspace(max(law.size[0], ends[0]), ends[1], 100)
    curve = law_value(law.coefficients, s, abscissa, breadth)
    axes.plot(abscissa, curve, color=colour, linewidth=0.8, label=rf"law, $s={s:.3g}$")


def set_factor_limits(axes: Axes, fit: SweepFit) -> None:
    """Limit the ordinate so that it shows all k of a sweep and of the theories."""
    factor = fit.cells.factor.value
    highest = max(PERTURBATION_FACTOR, float(np.nanmax(factor)))
    axes.set_ylim(min(0.0, float(np.nanmin(factor))) - 0.05 * highest, 1.1 * highest)


def _ends(values: Array, margin: float) -> Array:
    """Ends of a logarithmic axis around some values."""
    return np.array([np.nanmin(values) / margin, np.nanmax(values) * margin])


def draw_hysteresis(axes: Axes, fit: SweepFit) -> None:
    """Draw mean hysteresis against (w_rms / w_int)^2 on log-log axes, with law, fit and theory."""
    variance, hysteresis, below = _variance(fit), fit.cells.hysteresis, _below(fit)
    for index, style in enumerate(spectrum_styles(fit.table)):
        draw_below(axes, index, style.colour, variance[index, below[index]])
        shown = hysteresis.at(index).where(~below[index])
        draw_estimates(axes, style, variance[index], shown, fit.in_range)
    draw_law(axes, fit, _hysteresis_points)
    if not fit.table.on_springs:
        draw_fit(axes, fit, _hysteresis_points)
    ends = _ends(variance, _VARIANCE_MARGIN)
    # Hysteresis is 2 k e_el, and the variance 4 e_el.
    draw_theory(axes, ends, ends / 2)
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=_hysteresis_limits(fit))
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if limits[1] < _MOST_FOR_DECIMALS * limits[0]:
            label_decimals(axis)
    disorder = r"(w_\mathrm{rms}/w_\mathrm{int})^2"
    if fit.uncorrelated:
        disorder = r"4e_\mathrm{el}/w_\mathrm{int}"
    axes.set_xlabel(f"disorder ${disorder}$")
    axes.set_ylabel(r"hysteresis $(w_\mathrm{retr}-w_\mathrm{appr})/w_\mathrm{int}$")
    _add_spring_entries(axes, fit)


def _hysteresis_points(energy: Array, factor: Array) -> tuple[Array, Array]:
    """Variance of w_loc and hysteresis at some e_el and k."""
    return 4 * energy, 2 * factor * energy


def _hysteresis_limits(fit: SweepFit) -> tuple[float, float]:
    """Ends of the axis of the hysteresis, which show its intervals and the theories."""
    variance, hysteresis = _variance(fit), fit.cells.hysteresis
    weakest, strongest = _ends(variance, _VARIANCE_MARGIN)
    # The mean of one realisation lacks an interval.
    low_ends = np.fmax(np.fmin(hysteresis.low, hysteresis.value), _floor(variance))
    least = float(np.min(low_ends, where=~_below(fit), initial=np.inf))
    lowest = min(least, PAPER_FACTOR / 2 * float(weakest)) / _HYSTERESIS_MARGIN
    return lowest, PERTURBATION_FACTOR / 2 * float(strongest)


def _add_spring_entries(axes: Axes, fit: SweepFit) -> None:
    """Add the springs of the first spectrum of straight fronts to the legend, by their markers."""
    styles = spectrum_styles(fit.table)
    for index, family in enumerate(spectrum_families(fit.table)):
        if family == 0 and np.all(np.isfinite(fit.table.spring[index])):
            axes.plot([], [], styles[index].marker, color="0.4", label=spring_label(fit, index))


def _variance(fit: SweepFit) -> Array:
    """Variance of w_loc at every spectrum and amplitude (Units: w_int^2)."""
    # For uncorrelated sites w_rms is the rms of the pixels; law and theory depend on e_el.
    return 4 * fit.cells.e_el if fit.uncorrelated else fit.cells.w_rms**2


def _floor(variance: Array) -> float:
    """Smallest hysteresis that is drawn as a point (Units: w_int)."""
    weakest = float(_ends(variance, _VARIANCE_MARGIN)[0])
    return _SMALLEST_POINT * PAPER_FACTOR / 2 * weakest


def _below(fit: SweepFit) -> NDArray[np.bool_]:
    """Spectra and amplitudes whose mean hysteresis is too small for a point."""
    return np.nan_to_num(fit.cells.hysteresis.value, nan=np.inf) <= _floor(_variance(fit))


def draw_spectra(axes: Axes, fit: SweepFit) -> None:
    """Draw the spectra (of heights or of w_loc), all scaled to one variance of w_loc."""
    table = fit.table
    is_rough = fit.kind == "roughness"
    lowest = np.pi / np.max(table.roll_off)
    families = spectrum_families(table)
    densities = []
    for family in dict.fromkeys(families):
        spectrum = table.shape_of(families.index(family))
        scale = spectrum.elastic_energy if is_rough else spectrum.mean_square(0)
        densities.append(_draw_density(axes, spectrum, scale, lowest, spectrum_colour(family)))
    axes.set(xscale="log", yscale="log")
    axes.set_xlim(lowest, 2.5 * 2 * np.pi / np.min(table.short_cutoff))
    # The mean density of an anisotropic spectrum falls to zero at its cutoff.
    least = np.min(densities, where=np.array(densities) > 0, initial=np.inf)
    axes.set_ylim(least / 10, np.max(densities) * 5)
    axes.set_xlabel("wavevector $q$ (reduced)")
    unit = r"w_\mathrm{int}/e_\mathrm{el}" if is_rough else r"/ w_\mathrm{rms}^2"
    axes.set_ylabel(rf"$C(q)\,{unit}$")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=4))
        axis.set_minor_formatter(NullFormatter())


def _draw_density(
    axes: Axes, spectrum: Spectrum, scale: float, lowest: float, colour: str
) -> Array:
    """Draw a spectral density over a scale, from the lowest wavevector on; its values."""
    cutoff = 2 * np.pi / spectrum.short_cutoff
    wavevector = np.geomspace(lowest, cutoff, 200)
    density = spectrum.density(wavevector) / scale
    # The last point draws the fall to zero at the cutoff.
    abscissa = np.append(wavevector, cutoff)
    ordinate = np.append(density, np.finfo(float).tiny)
    axes.plot(abscissa, ordinate, color=colour, linewidth=0.8)
    return density


def draw_factor_by_disorder(axes: Axes, fit: SweepFit) -> None:
    """Draw mean k against measured e_el, with the law, the pooled mean and the theory.

    Points of different spectra are shifted sideways by up to 6%, so that their bars do not hide
    each other.
    """
    energy, n_spectrum = fit.cells.e_el, fit.table.spectrum.size
    shifts = 0.12 * (np.arange(n_spectrum) - (n_spectrum - 1) / 2) / max(n_spectrum - 1, 1)
    for index, style in enumerate(spectrum_styles(fit.table)):
        abscissa = energy[index] * (1 + shifts[index])
        draw_estimates(axes, style, abscissa, fit.cells.factor.at(index), fit.in_range)
    draw_law(axes, fit, _factor_points)
    ends = _ends(energy, 1.4)
    draw_fit(axes, fit, _factor_points)
    draw_theory(axes, ends)
    axes.set(xscale="log", xlim=ends, ylabel=_FACTOR_LABEL)
    label_decimals(axes.xaxis)
    axes.set_xlabel(r"energy of full conformity $e_\mathrm{el}/w_\mathrm{int}$")


def _factor_points(energy: Array, factor: Array) -> tuple[Array, Array]:
    """Values of e_el and k as they are."""
    return energy, factor


def draw_factor_by_length(axes: Axes, fit: SweepFit) -> None:
    """Draw k, averaged over the range, against the correlation length.

    A line connects the spectra of one shape.
    """
    length, factor, shapes = fit.table.correlation_length, fit.spectra.factor, fit.table.shape
    for shape in np.unique(shapes):
        family = np.flatnonzero(shapes == shape)
        family = family[np.argsort(length[family])]
        axes.plot(length[family], factor.value[family], color="0.6", linewidth=0.6, zorder=1)
    for index, style in enumerate(spectrum_styles(fit.table)):
        point = factor.at([index])
        draw_estimates(axes, replace(style, label=""), length[[index]], point, np.array([True]))
    ends = _ends(length, 1.6)
    draw_theory(axes, ends)
    axes.set(xscale="log", xlim=ends)
    label_decimals(axes.xaxis)
    axes.set_xlabel("correlation length of $w_\\mathrm{loc}$ (reduced length)")
    axes.set_title(
        rf"mean over ${fit.lowest_elastic_energy:g}\leq e_\mathrm{{el}}/w_\mathrm{{int}}"
        rf"\leq {fit.highest_elastic_energy:g}$",
        fontsize=7,
    )


def draw_infinite_law(axes: Axes) -> None:
    """Draw k of the infinite contact against disorder with its 95% band, and with theory."""
    strongest = shipped_law().disorder[1]
    disorder = np.linspace(WEAKEST, strongest, 100)
    factor, label = pinning_factors(disorder, math.inf).factor, "95% interval, all breadths"
    axes.fill_between(
        disorder, factor.low, factor.high, color="0.85", lw=0, label=label, zorder=0.5
    )
    axes.plot(
        disorder, factor.value, color=BLACK, linewidth=1.0, label=r"law, $g\to\infty$", zorder=2
    )
    ends = strongest * np.array([-0.05, 1.10])
    draw_theory(axes, ends)
    axes.set(xlim=ends, ylabel=r"$k$ of the infinite contact")
    axes.set_xlabel(r"disorder $s=w_\mathrm{rms}/w_\mathrm{int}$")
