"""Roughness of the fronts: spectra, spectra over the perturbative law, height differences."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter
from numpy.typing import NDArray

from crackfront.plots.parts import legend_entries
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.contact import STRONG, WEAK
from crackfront.studies.paper.roughness import RoughnessRecord
from crackfront.studies.paper.roughness_checks import (
    DEPINNING_EXPONENT,
    LARKIN_EXPONENT,
    fitted_roughness,
    stiffness_wavevector,
)

Array = NDArray[np.float64]

_KINDS = ((STRONG, "strong", BLUE), (WEAK, "weak", VERMILION))

_BINS_A_DECADE = 12
"""Bins over which the drawn spectra are averaged."""


def roughness_figure(record: RoughnessRecord) -> Figure:
    """Spectra with their fits, the same over those of perturbation theory, height differences.

    Parameters
    ----------
    record : RoughnessRecord
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.37 * PAGE)
        panels = figure.subplots(1, 3)
        _draw_spectra(panels[0], record)
        _draw_compensated(panels[1], record)
        _draw_differences(panels[2], record)
        for axes, letter in zip(panels, "abc", strict=True):
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_title(letter, loc="left", fontweight="bold")
        panels[1].yaxis.set_major_locator(FixedLocator([0.3, 0.5, 1.0, 2.0]))
        panels[1].yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        panels[1].yaxis.set_minor_formatter(NullFormatter())
        handles, labels = legend_entries(panels[0])
        figure.legend(handles, labels, loc="outside upper center", ncols=4, columnspacing=1.2)
        return figure


def _binned(record: RoughnessRecord, index: int) -> tuple[Array, Array, Array]:
    """Wavevector, and mean and standard error of the power over surfaces, in bins."""
    wavevector, power = stiffness_wavevector(record, index), record.power[index]
    place = np.floor(_BINS_A_DECADE * np.log10(wavevector)).astype(int)
    bins = [place == value for value in np.unique(place)]
    means = np.array([power[:, one].mean(axis=1) for one in bins])
    abscissa = np.array([np.exp(np.log(wavevector[one]).mean()) for one in bins])
    error = means.std(axis=1, ddof=1) / np.sqrt(power.shape[0])
    return abscissa, means.mean(axis=1), error


def _draw_spectra(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra against stiffness, and their fits."""
    cutoff = record.short_cutoff
    for index, name, colour in _KINDS:
        wavevector, power, error = _binned(record, index)
        disorder = rf"$w_\mathrm{{rms}} = {record.rms[index]:.2g}\,w_\mathrm{{int}}$"
        axes.errorbar(
            wavevector * cutoff / (2 * np.pi),
            power / cutoff**3,
            yerr=error / cutoff**3,
            color=colour,
            linestyle="none",
            marker="o",
            markersize=2.2,
            elinewidth=0.6,
            label=f"{name} disorder, " + disorder,
        )
        fit = fitted_roughness(record, index)
        axes.plot(
            fit.wavevector * cutoff / (2 * np.pi),
            fit.power / cutoff**3,
            color=colour,
            linewidth=1.2,
            label=rf"fit ({name}), $\zeta = {fit.exponent:.3f} \pm {fit.reach:.3f}$",
        )
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"spectrum of the front $C/\lambda_\mathrm{s}^3$")


def _draw_compensated(axes: Axes, record: RoughnessRecord) -> None:
    """Spectra over kappa^-2, each relative to its value at the short end of its fit."""
    cutoff = record.short_cutoff
    for index, _, colour in _KINDS:
        wavevector, power, error = _binned(record, index)
        fit = fitted_roughness(record, index)
        level = fit.power[1] * fit.wavevector[1] ** 2
        axes.errorbar(
            wavevector * cutoff / (2 * np.pi),
            power * wavevector**2 / level,
            yerr=error * wavevector**2 / level,
            color=colour,
            linestyle="none",
            marker="o",
            markersize=2.2,
            elinewidth=0.6,
        )
        larkin = cutoff / record.larkin_length[index] / (2 * np.pi)
        axes.axvline(
            larkin,
            color=colour,
            linewidth=0.7,
            linestyle=(0, (1, 1.5)),
            zorder=0,
            label=r"$\kappa = 1/\ell$" if index == STRONG else None,
        )
    ends = np.array([0.004, 1.0])
    for exponent, dashes in ((DEPINNING_EXPONENT, (4, 2)), (LARKIN_EXPONENT, (None, None))):
        end = fitted_roughness(record, STRONG).wavevector[1] * cutoff / (2 * np.pi)
        axes.plot(
            ends,
            (ends / end) ** (1 - 2 * exponent),
            color="0.35",
            linewidth=0.7,
            dashes=dashes,
            zorder=0,
            label=rf"$\zeta = {exponent:g}$",
        )
    axes.set_ylim(0.3, 2.5)
    axes.legend(loc="upper left", frameon=True, facecolor="white", framealpha=1, edgecolor="none")
    axes.set_xlabel(r"stiffness $\kappa\lambda_\mathrm{s}/2\pi$")
    axes.set_ylabel(r"$C\,\kappa^2$ (relative)")


def _draw_differences(axes: Axes, record: RoughnessRecord) -> None:
    """Height differences over distances, with the two power laws."""
    cutoff = record.short_cutoff
    for index, _, colour in _KINDS:
        lag, difference = record.lag / cutoff, record.difference[index] / cutoff
        axes.plot(lag, difference, color=colour)
        exponent = DEPINNING_EXPONENT if index == STRONG else LARKIN_EXPONENT
        part = (lag > 3) & (lag < 60)
        start = np.flatnonzero(part)[0]
        axes.plot(
            lag[part],
            1.25 * difference[start] * (lag[part] / lag[start]) ** exponent,
            color="0.35",
            linewidth=0.7,
            dashes=(4, 2) if index == STRONG else (None, None),
            label=rf"$\zeta = {exponent:g}$",
        )
        axes.axvline(
            record.larkin_length[index] / cutoff,
            color=colour,
            linewidth=0.7,
            linestyle=(0, (1, 1.5)),
            zorder=0,
            label=r"Larkin length $\ell$" if index == STRONG else None,
        )
    axes.legend(loc="lower right", frameon=True, facecolor="white", framealpha=1, edgecolor="none")
    axes.set_xlabel(r"distance along the front $s/\lambda_\mathrm{s}$")
    axes.set_ylabel(r"rms difference of radii $/\lambda_\mathrm{s}$")
