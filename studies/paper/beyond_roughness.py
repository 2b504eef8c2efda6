"""Beyond the paper: roughness of fronts, for strong and weak disorder.

Fronts of a sphere in steady retraction, and straight ones on springs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator

from crackfront.analysis.estimate import with_error
from crackfront.core.arrays import Array
from crackfront.plots.parts import ON_WHITE, label_decimals
from crackfront.plots.style import (
    BLUE,
    GREEN,
    PAGE,
    PURPLE,
    VERMILION,
    blank_figure,
    explain,
    house_style,
)
from studies.paper.checks import Check
from studies.paper.drawing import THEORY, name_panels, write_next_to
from studies.paper.figure import Figure
from studies.paper.front_spectra import (
    RoughnessFit,
    RoughnessRecord,
    binned_spectrum,
    fitted_roughness,
)
from studies.paper.rough import STRONG, WEAK
from studies.paper.roughness import SPHERE, STRONG_LINE, WEAK_LINE, roughness_record

_EXPONENTS = (0.388, 0.5, 0.388, 0.5)
"""Roughness exponents of a line with long-range elasticity at its threshold (Rosso and Krauth,
Phys. Rev. E 65, 025101), and where disorder is a perturbation: strong and weak disorder."""

_EXPECTATION = (
    "Roughness of fronts: beyond the Larkin length a line with long-range elasticity has the "
    "exponent 0.388 of its depinning threshold (Rosso and Krauth, Phys. Rev. E 65, 025101), below "
    "it 0.5, where disorder is a perturbation. The range of a fit may contain the crossover."
)
"""Source of the expectations, and why exponents may differ."""

_TOLERANCE = 0.05
"""Largest deviation of an exponent, about as large as by a crossover in the range of the fit."""


def roughness_checks(record: RoughnessRecord) -> tuple[Check, ...]:
    """Exponents above and below the Larkin length."""
    fits = [fitted_roughness(record, index) for index in range(len(_EXPONENTS))]
    strong, weak = (fits[index] for index in SPHERE)
    claims = (
        "sphere, strong disorder, beyond the Larkin length: depinning exponent",
        "sphere, weak disorder, below the Larkin length: perturbation theory",
        "straight front, beyond the Larkin length: depinning exponent",
        "straight front, below the Larkin length: perturbation theory",
    )
    return (
        *(_exponent_check(record, index, fits[index], claim) for index, claim in enumerate(claims)),
        Check(
            "sphere: the two exponents differ by more than their intervals",
            f"> {np.hypot(strong.reach, weak.reach):.3f}",
            f"{weak.exponent - strong.exponent:.3f}",
            weak.exponent - strong.exponent > float(np.hypot(strong.reach, weak.reach)),
            "intervals over surfaces alone, not of the choice of the range",
            expectation=_EXPECTATION,
        ),
    )


def _exponent_check(record: RoughnessRecord, index: int, fit: RoughnessFit, claim: str) -> Check:
    """One exponent against the exponent of the theory."""
    expected = _EXPONENTS[index]
    low, high = record.shortest[index], record.longest[index]
    middle = np.full(record.longest.size, np.sqrt(low * high))
    halves = [
        fitted_roughness(part, index).exponent
        for part in (replace(record, longest=middle), replace(record, shortest=middle))
    ]
    contained = "contains it" if abs(fit.exponent - expected) <= fit.reach else "leaves it out"
    restoring = "sphere's circle" if index in SPHERE else "springs"
    return Check(
        claim,
        with_error(expected, _TOLERANCE),
        with_error(fit.exponent, fit.reach),
        abs(fit.exponent - expected) <= _TOLERANCE,
        f"the 95% interval of {record.power.shape[1]} tiles {contained}; wavelengths "
        f"{low:.3g} to {high:.3g} ({np.log10(high / low):.2f} decades), their shorter half "
        f"{halves[0]:.3f}, longer half {halves[1]:.3f}; Larkin length "
        f"{record.larkin_length[index]:.3g}; the stiffness of the {restoring}, "
        f"{record.ring_stiffness[index]:.2g} next to n, is in the abscissa",
        expectation=_EXPECTATION,
    )


_COLOURS = (BLUE, VERMILION, GREEN, PURPLE)
"""Colours of the fronts in the order of their records."""

_MARKERS = ("o", "s", "^", "D")
"""Markers of the fronts in the order of their records."""

_KINDS = ((STRONG, "strong", _COLOURS[STRONG]), (WEAK, "weak", _COLOURS[WEAK]))


def roughness_figure(record: RoughnessRecord) -> Drawing:
    """Spectra over perturbation theory with their fits, height differences, straight fronts."""
    with house_style():
        figure = blank_figure(PAGE, 0.81 * PAGE)
        panels = figure.subplots(2, 2).ravel()
        for axes in panels:
            axes.set(xscale="log", yscale="log")
        _draw_spectra(panels[0], record)
        _draw_compensated(panels[1], record)
        _draw_differences(panels[2], record)
        _draw_lines(panels[3], record)
        name_panels(panels, "abcd")
        for axes in panels[:3]:
            axes.set_title("fronts of a sphere in retraction")
        panels[3].set_title("straight fronts on springs")
        for axes in panels[[1, 3]]:
            label_decimals(axes.yaxis, FixedLocator([0.1, 0.2, 0.3, 0.5, 1.0, 2.0]))
        explain(
            figure,
            "$\\kappa$: wavevector of a straight line as stiff as the mode of the front; "
            "$\\ell$: Larkin length; $\\zeta$: roughness exponent; b, d: relative to a fit at its "
            "largest $\\kappa$; bars: standard errors over surfaces, ±: 95% intervals",
        )
        return figure


def _draw_spectra(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra against stiffness, and their fits."""
    cutoff = record.short_cutoff
    for index, name, colour in _KINDS:
        _draw_points(axes, record, index, cutoff**3)
        fit = fitted_roughness(record, index)
        line = fit.wavevector * cutoff / (2 * np.pi), fit.power / cutoff**3
        axes.plot(*line, color=colour, linewidth=1.2)
        text = (
            f"{name} disorder,\n"
            rf"$w_\mathrm{{rms}} = {record.rms[index]:.2g}\,w_\mathrm{{int}}$,"
            f"\n$\\zeta = {fit.exponent:.3f} \\pm {fit.reach:.3f}$"
        )
        middle = np.exp(np.mean(np.log(line), axis=1))
        aside = (8, 6) if index == STRONG else (-8, -6)
        look = {"ha": "left", "va": "bottom"} if index == STRONG else {"ha": "right", "va": "top"}
        write_next_to(axes, text, (middle[0], middle[1]), aside, color=colour, **look)
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"spectrum of the front $C/\lambda_\mathrm{s}^3$")


def _draw_compensated(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra over kappa^-2, each relative to its value at the short end of its fit."""
    cutoff = record.short_cutoff
    for index, *_ in _KINDS:
        fit = fitted_roughness(record, index)
        level = fit.power[1] * fit.wavevector[1] ** 2
        _draw_points(axes, record, index, level, 2)
        _mark_length(axes, index, cutoff / record.larkin_length[index] / (2 * np.pi), r"$1/\ell$")
    ends = np.array([0.004, 1.0])
    end = fitted_roughness(record, STRONG).wavevector[1] * cutoff / (2 * np.pi)
    for index, exponent in enumerate(_EXPONENTS[:STRONG_LINE]):
        _draw_law(axes, index, ends, (ends / end) ** (1 - 2 * exponent), zorder=0)
    axes.set_ylim(0.2, 2.5)
    axes.legend(loc="lower right", **ON_WHITE)
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"$C\,\kappa^2$ (relative)")


def _draw_differences(axes: Axes, record: RoughnessRecord) -> None:
    """Height differences over distances, with the two power laws."""
    cutoff = record.short_cutoff
    for index, name, colour in _KINDS:
        lag, difference = record.lag / cutoff, record.difference[index] / cutoff
        axes.plot(lag, difference, color=colour)
        end = lag[-1], difference[-1]
        write_next_to(axes, f"{name} disorder", end, (0, -12), color=colour, ha="right")
        part = (lag > 3) & (lag < 60)
        start = np.flatnonzero(part)[0]
        law = 1.25 * difference[start] * (lag[part] / lag[start]) ** _EXPONENTS[index]
        _draw_law(axes, index, lag[part], law)
        _mark_length(axes, index, record.larkin_length[index] / cutoff, r"$\ell$")
    axes.legend(loc="lower right", **ON_WHITE)
    axes.set_xlabel(r"distance along the front $s/\lambda_\mathrm{s}$")
    axes.set_ylabel(r"rms difference of radii $/\lambda_\mathrm{s}$")


def _draw_lines(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra of straight fronts over kappa^-2 / Larkin length, the weak one's level 1."""
    weak = fitted_roughness(record, WEAK_LINE)
    unit = weak.power[1] * weak.wavevector[1] ** 2 * record.larkin_length[WEAK_LINE]
    for index, name in ((STRONG_LINE, "beyond"), (WEAK_LINE, "below")):
        fit, larkin = fitted_roughness(record, index), float(record.larkin_length[index])
        label = rf"{name} $\ell$, $\zeta = {fit.exponent:.3f} \pm {fit.reach:.3f}$"
        _draw_points(axes, record, index, unit / larkin, 2, label, larkin)
        line = fit.wavevector * larkin / (2 * np.pi), fit.power * fit.wavevector**2 * larkin / unit
        axes.plot(*line, color=_COLOURS[index], linewidth=1.2)
    _mark_length(axes, None, 1 / (2 * np.pi), r"$1/\ell$")
    axes.legend(loc="lower right")
    axes.set_xlabel(r"stiffness $\kappa\ell/2\pi$")
    axes.set_ylabel(r"$C\,\kappa^2\ell$ (relative)")


_MIDDLE = 100.0
"""Abscissa beyond which the name of a Larkin length is to the left of its line."""


def _mark_length(axes: Axes, index: int | None, place: float, name: str) -> None:
    """Dotted line at a Larkin length, with its name at the upper end; grey for all fronts."""
    colour = "0.35" if index is None else _COLOURS[index]
    axes.axvline(place, color=colour, linewidth=0.7, linestyle=(0, (1, 1.5)), zorder=0)
    look: dict[str, Any] = {"xycoords": axes.get_xaxis_transform(), "color": colour, "va": "top"}
    side = {"ha": "left"} if place < _MIDDLE else {"ha": "right"}
    write_next_to(axes, name, (place, 1.0), (3 if place < _MIDDLE else -3, -4), **look, **side)


def _draw_points(
    axes: Axes,
    record: RoughnessRecord,
    index: int,
    level: float,
    exponent: int = 0,
    label: str | None = None,
    unit: float | None = None,
) -> None:
    """Power times a power of the wavevector over a level, in bins, with its error over surfaces."""
    unit = record.short_cutoff if unit is None else unit
    middle, power, error = binned_spectrum(record, index)
    axes.errorbar(
        middle * unit / (2 * np.pi),
        power * middle**exponent / level,
        yerr=error * middle**exponent / level,
        color=_COLOURS[index],
        linestyle="none",
        marker=_MARKERS[index],
        markersize=2.2,
        elinewidth=0.6,
        label=label,
    )


def _draw_law(axes: Axes, index: int, abscissa: Array, ordinate: Array, zorder: float = 2) -> None:
    """Power law of the theory of one disorder."""
    style = THEORY if index == STRONG else THEORY | {"dashes": (None, None)}
    theory = "depinning" if index == STRONG else "perturbation theory"
    label = rf"$\zeta = {_EXPONENTS[index]:g}$, {theory}"
    axes.plot(abscissa, ordinate, zorder=zorder, label=label, **style)


FIGURE = Figure(
    title="Beyond the paper: roughness of the front",
    compute=roughness_record,
    checks=roughness_checks,
    draw=roughness_figure,
    # As measured with 64 surfaces.
    seconds=lambda parameters: 10.0 * parameters.n_surface,
)
