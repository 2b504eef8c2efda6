"""Beyond the paper: roughness of fronts, for strong and weak disorder.

Those of a sphere in steady retraction, and straight ones on springs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator
from pydantic import model_validator
from scipy.fft import rfft
from scipy.stats import t as student

from crackfront.analysis.estimate import with_error
from crackfront.core.variables import ADHESION, LATERAL, variable
from crackfront.data.section import Count, Positive, refusal
from crackfront.plots.parts import legend_entries
from crackfront.plots.style import BLUE, GREEN, PAGE, PURPLE, VERMILION, blank_figure, house_style
from studies.paper.drawing import ON_WHITE, label_plain_numbers, name_panels
from studies.paper.figure import Array, Check, Figure, Integers, Progress
from studies.paper.rough import (
    STRONG,
    WEAK,
    RetractionParameters,
    circle_stiffness,
    surface_means,
)
from studies.paper.straight import StraightParameters

_DISORDER, _SURFACE, _MODE, _LAG = "disorder", "surface", "mode", "lag"

_N_LAG = 60

_SPHERE, STRONG_LINE, WEAK_LINE = (STRONG, WEAK), 2, 3
"""Places of the fronts in a record."""

_PRECISION, _WAY = 1e-3, 0.5
"""Load that the solver may cost a straight front, in correlation lengths of the force, and the
share of a tile's period over which its fronts are taken."""


class LineParameters(StraightParameters):
    """Straight fronts on one spring and the range of their fit."""

    spring: Positive  # L_kappa over the Larkin length
    fit_from: Positive  # wavelengths of the fit, over the Larkin length
    fit_to: Positive

    @model_validator(mode="after")
    def _usable(self) -> LineParameters:
        low, high = self.fit_from, self.fit_to
        if low >= high:
            raise refusal(f"fit_from is {low:g}; it must be below fit_to, {high:g}")
        return self


class RoughnessParameters(RetractionParameters):
    """Fronts to take and ranges to fit."""

    n_front: Count  # on each surface, at equal distances in penetration; of a line, in load
    first_penetration: Positive
    last_penetration: Positive
    strong_from: Positive  # wavelengths of the fits, over the short cutoff
    strong_to: Positive
    weak_from: Positive
    weak_to: Positive
    strong_line: LineParameters  # straight fronts, on as many tiles as the sphere has surfaces
    weak_line: LineParameters

    @model_validator(mode="after")
    def _usable(self) -> RoughnessParameters:
        for name in ("strong", "weak"):
            low, high = getattr(self, f"{name}_from"), getattr(self, f"{name}_to")
            if low >= high:
                raise refusal(f"{name}_from is {low:g}; it must be below {name}_to, {high:g}")
        if self.n_surface < 2:
            raise refusal("n_surface is 1; an interval needs 2 surfaces or more")
        return self


@dataclass(frozen=True, slots=True)
class RoughnessRecord:
    """Power and height differences of fronts: of a sphere, then straight ones.

    A straight front counts as the perimeter of a circle, and its springs as the stiffness of one;
    its short cutoff is that of the sphere.
    """

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms, of the sphere the mean of its tiles", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    radius: Array = variable("mean radius of the fronts", LATERAL, _DISORDER)
    ring_stiffness: Array = variable(
        "stiffness of the circle, a dG/da; that of mode n is larger by n", ADHESION, _DISORDER
    )
    longest: Array = variable("longest wavelength of the fit", LATERAL, _DISORDER)
    shortest: Array = variable("shortest wavelength of the fit", LATERAL, _DISORDER)
    mode: Integers = variable("waves around the perimeter", "1", _MODE)
    power: Array = variable(
        "power spectral density along the front, mean of the fronts of a surface",
        f"({LATERAL})^3",
        _DISORDER,
        _SURFACE,
        _MODE,
    )
    lag: Array = variable("distance along the front", LATERAL, _LAG)
    difference: Array = variable("rms difference of the radius", LATERAL, _DISORDER, _LAG)


@dataclass(frozen=True, slots=True)
class _Surface:
    """What is measured on one surface."""

    power: Array
    radius: float
    ring_stiffness: float
    rms: float
    larkin_length: float


def roughness_record(parameters: RoughnessParameters, progress: Progress) -> RoughnessRecord:
    """Fronts of a retraction, and straight ones, on several surfaces or tiles."""
    cutoff, surfaces = parameters.short_cutoff, range(parameters.n_surface)
    spheres, lines = (parameters.strong, parameters.weak), _lines(parameters)
    measured = []
    for name, energy in zip(("strong", "weak"), spheres, strict=True):
        measured.append([_surface(parameters, energy, one) for one in surfaces])
        progress(f"{name} disorder: {parameters.n_surface} times {parameters.n_front} fronts")
    for line in lines:
        measured.append([_tile(parameters, line, one) for one in surfaces])
        progress(f"straight, spring of {line.spring:g} Larkin lengths: as many fronts")
    count = min(surface.power.size for kind in measured for surface in kind)
    power = np.array([[surface.power[:count] for surface in kind] for kind in measured])
    mode, radius = np.arange(1, count + 1), surface_means(measured, "radius")
    larkin = surface_means(measured, "larkin_length")
    circle = 2 * np.pi * radius
    lag = np.geomspace(cutoff / 2, np.min(circle) / 2, _N_LAG)
    units = np.array([cutoff, cutoff, *larkin[STRONG_LINE:]])
    longest = [parameters.strong_to, parameters.weak_to, *(line.fit_to for line in lines)]
    shortest = [parameters.strong_from, parameters.weak_from, *(line.fit_from for line in lines)]
    return RoughnessRecord(
        short_cutoff=cutoff,
        elastic_energy=np.array([*spheres, *(line.elastic_energy for line in lines)]),
        larkin_length=larkin,
        radius=radius,
        **{name: surface_means(measured, name) for name in ("rms", "ring_stiffness")},
        longest=units * longest,
        shortest=units * shortest,
        mode=mode,
        power=power,
        lag=lag,
        difference=np.array(
            [_difference(*pair, mode, lag) for pair in zip(power.mean(axis=1), circle, strict=True)]
        ),
    )


def expected_seconds(parameters: RoughnessParameters) -> float:
    """Processor time as measured with 64 surfaces, for any number of them (Units: s)."""
    return 10.0 * parameters.n_surface


def _lines(parameters: RoughnessParameters) -> tuple[LineParameters, LineParameters]:
    """Straight fronts in the order of their records."""
    return parameters.strong_line, parameters.weak_line


def _tile(parameters: RoughnessParameters, line: LineParameters, realisation: int) -> _Surface:
    """Mean power of straight fronts on one tile."""
    pulled = line.front(line.spring, parameters.seed, realisation, _PRECISION)
    way = _WAY * pulled.period * np.arange(1, parameters.n_front + 1) / parameters.n_front
    fronts = np.stack([*pulled.moved(pulled.load + way)])
    radius = parameters.short_cutoff * pulled.field.geometry.length / (2 * np.pi)
    return _Surface(
        power=_power(fronts * parameters.short_cutoff, radius),
        radius=radius,
        ring_stiffness=pulled.field.geometry.length / (2 * np.pi * pulled.spring),
        rms=2 * math.sqrt(line.elastic_energy),
        larkin_length=parameters.short_cutoff * pulled.larkin_length,
    )


def _surface(parameters: RoughnessParameters, energy: float, realisation: int) -> _Surface:
    """Mean power of the fronts on one surface."""
    contact = parameters.contact(energy, 1e-6, realisation)
    ends = parameters.first_penetration, parameters.last_penetration
    loads = np.linspace(*ends, parameters.n_front)
    front, taken = contact.touched(parameters.max_penetration), []
    for load in loads:
        front = contact.moved(front, float(load), -1)
        taken.append(front)
    fronts = np.stack(taken)
    circles = np.mean(fronts, axis=1)
    return _Surface(
        power=_power(fronts, circles[:, None]),
        radius=float(circles.mean()),
        ring_stiffness=float(circle_stiffness(circles, loads).mean()),
        rms=contact.w_rms,
        larkin_length=contact.larkin_length,
    )


def _power(fronts: Array, radius: Array | float) -> Array:
    """Mean spectral density of fronts on circles."""
    modes = rfft(fronts, axis=1, norm="forward")[:, 1 : fronts.shape[1] // 2]
    return np.asarray(np.mean(2 * np.pi * radius * np.abs(modes) ** 2, axis=0))


def _difference(power: Array, circle: float, mode: Integers, lag: Array) -> Array:
    """Root mean square difference of the radius at two points of a front."""
    angle = 2 * np.pi * lag / circle
    return np.sqrt(4 * (1 - np.cos(np.outer(angle, mode))) @ (power / circle))


_EXPONENTS = (0.388, 0.5, 0.388, 0.5)
"""Roughness exponents of a line with long-range elasticity at its threshold (Rosso and Krauth,
Phys. Rev. E 65, 025101), and where disorder is a perturbation: strong and weak disorder."""

_TOLERANCE = 0.05
"""Largest deviation of an exponent, about that of a crossover within the range of the fit."""


@dataclass(frozen=True, slots=True)
class _Fit:
    """Roughness exponent zeta, half of its 95% interval over surfaces, both ends of the line."""

    exponent: float
    reach: float
    wavevector: Array
    power: Array


def stiffness_wavevector(record: RoughnessRecord, index: int) -> Array:
    """Wavevector of a straight line of the stiffness of each mode, (n + a dG/da) / a.

    The sphere pulls a front back to its circle, which a straight line does not know; so that
    the spectrum of a front is a power of this stiffness rather than of n alone.
    """
    return (record.mode + record.ring_stiffness[index]) / record.radius[index]


def fitted_roughness(record: RoughnessRecord, index: int) -> _Fit:
    r"""Fit of :math:`C \propto \kappa^{-(1 + 2\zeta)}` with kappa of `stiffness_wavevector`.

    Least squares of the logarithm, each surface by itself, all octaves of the same weight.
    """
    wavelength = 2 * np.pi * record.radius[index] / record.mode
    used = (wavelength >= record.shortest[index]) & (wavelength <= record.longest[index])
    wavevector = stiffness_wavevector(record, index)[used]
    weight = record.mode[used] ** -0.5
    power = record.power[index][:, used]
    slopes = np.polyfit(np.log(wavevector), np.log(power).T, 1, w=weight)[0]
    # The logarithm of a few fronts' mean lies below that of the mean over all surfaces.
    freed = np.log(power.mean(axis=0)) - slopes.mean() * np.log(wavevector)
    level = np.average(freed, weights=weight**2)
    exponents = -(1 + slopes) / 2
    error = np.std(exponents, ddof=1) / np.sqrt(exponents.size)
    ends = wavevector[[0, -1]]
    return _Fit(
        exponent=float(exponents.mean()),
        reach=float(student.ppf(0.975, exponents.size - 1) * error),
        wavevector=ends,
        power=np.exp(level + slopes.mean() * np.log(ends)),
    )


def roughness_checks(record: RoughnessRecord) -> tuple[Check, ...]:
    """Exponents above and below the Larkin length."""
    fits = [fitted_roughness(record, index) for index in range(len(_EXPONENTS))]
    strong, weak = (fits[index] for index in _SPHERE)
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
        ),
    )


def _exponent_check(record: RoughnessRecord, index: int, fit: _Fit, claim: str) -> Check:
    """One exponent against that of the theory."""
    expected = _EXPONENTS[index]
    low, high = record.shortest[index], record.longest[index]
    middle = np.full(record.longest.size, np.sqrt(low * high))
    halves = [
        fitted_roughness(part, index).exponent
        for part in (replace(record, longest=middle), replace(record, shortest=middle))
    ]
    contained = "contains it" if abs(fit.exponent - expected) <= fit.reach else "leaves it out"
    held = "sphere's circle" if index in _SPHERE else "springs"
    return Check(
        claim,
        with_error(expected, _TOLERANCE),
        with_error(fit.exponent, fit.reach),
        abs(fit.exponent - expected) <= _TOLERANCE,
        f"the 95% interval of {record.power.shape[1]} tiles {contained}; wavelengths "
        f"{low:.3g} to {high:.3g} ({np.log10(high / low):.2f} decades), their shorter half "
        f"{halves[0]:.3f}, longer half {halves[1]:.3f}; Larkin length "
        f"{record.larkin_length[index]:.3g}; the stiffness of the {held}, "
        f"{record.ring_stiffness[index]:.2g} beside n, is in the abscissa",
    )


_COLOURS = (BLUE, VERMILION, GREEN, PURPLE)

_KINDS = ((STRONG, "strong", _COLOURS[STRONG]), (WEAK, "weak", _COLOURS[WEAK]))

_BINS_A_DECADE = 12
"""Bins over which the drawn spectra are averaged."""


def roughness_figure(record: RoughnessRecord) -> Drawing:
    """Spectra with their fits, over those of perturbation theory, differences, straight fronts."""
    with house_style():
        figure = blank_figure(PAGE, 0.74 * PAGE)
        panels = figure.subplots(2, 2).ravel()
        _draw_spectra(panels[0], record)
        _draw_compensated(panels[1], record)
        _draw_differences(panels[2], record)
        _draw_lines(panels[3], record)
        for axes in panels:
            axes.set(xscale="log", yscale="log")
        name_panels(panels, "abcd")
        for axes in panels[[1, 3]]:
            label_plain_numbers(axes.yaxis, FixedLocator([0.1, 0.2, 0.3, 0.5, 1.0, 2.0]))
        handles, labels = legend_entries(panels[0])
        figure.legend(handles, labels, loc="outside upper center", ncols=4, columnspacing=1.2)
        return figure


def _draw_spectra(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra against stiffness, and their fits."""
    cutoff = record.short_cutoff
    for index, name, colour in _KINDS:
        disorder = rf"$w_\mathrm{{rms}} = {record.rms[index]:.2g}\,w_\mathrm{{int}}$"
        label = f"{name} disorder, {disorder}"
        _draw_points(axes, record, index, cutoff**3, label=label)
        fit = fitted_roughness(record, index)
        line = fit.wavevector * cutoff / (2 * np.pi), fit.power / cutoff**3
        label = rf"fit ({name}), $\zeta = {fit.exponent:.3f} \pm {fit.reach:.3f}$"
        axes.plot(*line, color=colour, linewidth=1.2, label=label)
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"spectrum of the front $C/\lambda_\mathrm{s}^3$")


def _draw_compensated(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra over kappa^-2, each relative to its value at the short end of its fit."""
    cutoff = record.short_cutoff
    for index, *_ in _KINDS:
        fit = fitted_roughness(record, index)
        level = fit.power[1] * fit.wavevector[1] ** 2
        _draw_points(axes, record, index, level, 2)
        place = cutoff / record.larkin_length[index] / (2 * np.pi)
        _draw_larkin_length(axes, index, place, r"$\kappa = 1/\ell$")
    ends = np.array([0.004, 1.0])
    end = fitted_roughness(record, STRONG).wavevector[1] * cutoff / (2 * np.pi)
    for index, exponent in enumerate(_EXPONENTS[:STRONG_LINE]):
        _draw_law(axes, index, ends, (ends / end) ** (1 - 2 * exponent), zorder=0)
    axes.set_ylim(0.3, 2.5)
    axes.legend(loc="upper left", **ON_WHITE)
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"$C\,\kappa^2$ (relative)")


def _draw_differences(axes: Axes, record: RoughnessRecord) -> None:
    """Height differences over distances, with the two power laws."""
    cutoff = record.short_cutoff
    for index, _, colour in _KINDS:
        lag, difference = record.lag / cutoff, record.difference[index] / cutoff
        axes.plot(lag, difference, color=colour)
        part = (lag > 3) & (lag < 60)
        start = np.flatnonzero(part)[0]
        law = 1.25 * difference[start] * (lag[part] / lag[start]) ** _EXPONENTS[index]
        _draw_law(axes, index, lag[part], law)
        place = record.larkin_length[index] / cutoff
        _draw_larkin_length(axes, index, place, r"Larkin length $\ell$")
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
    axes.axvline(1 / (2 * np.pi), color="0.35", **_AT_LENGTH)
    axes.legend(loc="lower right")
    axes.set_xlabel(r"stiffness $\kappa\ell/2\pi$")
    axes.set_ylabel(r"$C\,\kappa^2\ell$ of straight fronts (relative)")


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
    wavevector, power = stiffness_wavevector(record, index), record.power[index]
    place = np.floor(_BINS_A_DECADE * np.log10(wavevector)).astype(int)
    bins = [place == value for value in np.unique(place)]
    means = np.array([power[:, one].mean(axis=1) for one in bins])
    middle = np.array([np.exp(np.log(wavevector[one]).mean()) for one in bins])
    error = means.std(axis=1, ddof=1) / np.sqrt(power.shape[0])
    axes.errorbar(
        middle * unit / (2 * np.pi),
        means.mean(axis=1) * middle**exponent / level,
        yerr=error * middle**exponent / level,
        color=_COLOURS[index],
        linestyle="none",
        marker="o",
        markersize=2.2,
        elinewidth=0.6,
        label=label,
    )


def _draw_law(axes: Axes, index: int, abscissa: Array, ordinate: Array, zorder: float = 2) -> None:
    """Power law of the theory of one disorder."""
    axes.plot(
        abscissa,
        ordinate,
        color="0.35",
        linewidth=0.7,
        dashes=(4, 2) if index == STRONG else (None, None),
        zorder=zorder,
        label=rf"$\zeta = {_EXPONENTS[index]:g}$",
    )


_AT_LENGTH: dict[str, Any] = {"linewidth": 0.7, "linestyle": (0, (1, 1.5)), "zorder": 0}


def _draw_larkin_length(axes: Axes, index: int, place: float, label: str) -> None:
    """Where the Larkin length of one disorder lies; the first line has the label of both."""
    name = label if index == STRONG else None
    axes.axvline(place, color=_COLOURS[index], label=name, **_AT_LENGTH)


FIGURE = Figure(
    title="Beyond the paper: roughness of the front",
    compute=roughness_record,
    checks=roughness_checks,
    draw=roughness_figure,
    seconds=expected_seconds,
)
