"""Distributions of the avalanches: swept area, extent along the perimeter, dissipated energy."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.avalanches import SIZE_EXPONENT, AvalancheRecord, size_law
from crackfront.studies.paper.contact import STRONG, WEAK

Array = NDArray[np.float64]

_KINDS = ((STRONG, "strong", BLUE, "o"), (WEAK, "weak", VERMILION, "s"))

_BINS_A_DECADE = 5


def avalanche_figure(record: AvalancheRecord) -> Figure:
    """Densities of areas with their power laws, of extents, and of energies.

    Parameters
    ----------
    record : AvalancheRecord
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.38 * PAGE)
        panels = figure.subplots(1, 3)
        _draw_areas(panels[0], record)
        _draw_extents(panels[1], record)
        _draw_energies(panels[2], record)
        for axes, letter in zip(panels, "abc", strict=True):
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_title(letter, loc="left", fontweight="bold")
        handles, labels = panels[2].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
        return figure


def _draw_densities(axes: Axes, record: AvalancheRecord, values: Array) -> None:
    """Densities of both disorders in logarithmic bins, with the error of counting."""
    low, high = np.log10(values.min()), np.log10(values.max())
    edges = np.logspace(low, high, max(int((high - low) * _BINS_A_DECADE), 4) + 1)
    edges[-1] *= 1 + 1e-9
    for index, name, colour, marker in _KINDS:
        chosen = values[record.disorder_index == index]
        counts, _ = np.histogram(chosen, edges)
        filled = counts > 0
        density = counts / np.diff(edges) / chosen.size
        disorder = rf"$w_\mathrm{{rms}} = {record.rms[index]:.2f}\,w_\mathrm{{int}}$"
        axes.errorbar(
            np.sqrt(edges[1:] * edges[:-1])[filled],
            density[filled],
            # A bar that reached zero would have no end on a logarithmic axis.
            yerr=0.98 * (density / np.sqrt(np.maximum(counts, 1)))[filled],
            linestyle="none",
            marker=marker,
            markersize=2.6,
            elinewidth=0.6,
            color=colour,
            label=f"{name} disorder, {disorder}, {chosen.size} avalanches",
        )


def _draw_areas(axes: Axes, record: AvalancheRecord) -> None:
    """Swept areas with the laws that were fitted, and a line of the exponent of the theory."""
    unit = record.short_cutoff**2
    _draw_densities(axes, record, record.area / unit)
    for index, _, colour, _ in _KINDS:
        chosen = record.area[record.disorder_index == index]
        law = size_law(record, index)
        areas = np.geomspace(law.smallest, chosen.max(), 100)
        axes.plot(
            areas / unit,
            law.density(areas) * unit * law.n_value / chosen.size,
            color=colour,
            label=rf"$\tau = {law.exponent:.2f}$ ({law.low:.2f} to {law.high:.2f})",
        )
    start = record.smallest_area[STRONG] / unit
    ends = start * np.array([1.0, 40.0])
    level = 4 * float(size_law(record, STRONG).density(record.smallest_area[STRONG])) * unit
    axes.plot(
        ends,
        level * (ends / start) ** -SIZE_EXPONENT,
        color="0.35",
        linewidth=0.7,
        dashes=(4, 2),
        label=rf"$\tau = {SIZE_EXPONENT}$",
    )
    lines = [
        (handle, label)
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        if "tau" in label
    ]
    axes.legend(*zip(*lines, strict=True), loc="lower left")
    axes.set_xlabel(r"swept area $S/\lambda_\mathrm{s}^2$")
    axes.set_ylabel("probability density")


def _draw_extents(axes: Axes, record: AvalancheRecord) -> None:
    """Extents, with the Larkin lengths below and the length of the circle above."""
    unit = record.short_cutoff
    _draw_densities(axes, record, record.extent / unit)
    for index, _, colour, _ in _KINDS:
        axes.axvline(
            record.larkin_length[index] / unit,
            color=colour,
            linewidth=0.8,
            linestyle=(0, (1, 1.5)),
            zorder=0,
            label=r"Larkin length $\ell$" if index == STRONG else None,
        )
    axes.axvline(
        record.correlation_length / unit,
        color="0.5",
        linewidth=0.7,
        dashes=(4, 2),
        zorder=0,
        label=r"correlation length of $w_\mathrm{loc}$",
    )
    lines = [
        (handle, label)
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        if "length" in label
    ]
    legend = axes.legend(*zip(*lines, strict=True), loc="lower left", frameon=True)
    legend.get_frame().set(facecolor="white", alpha=1.0, edgecolor="none")
    axes.set_xlabel(r"extent along the perimeter $/\lambda_\mathrm{s}$")
    axes.set_ylabel("probability density")


def _draw_energies(axes: Axes, record: AvalancheRecord) -> None:
    """Dissipated energies, in units of w_int times the square of the cutoff."""
    # The reduced unit of energy is pi times w_int times the lateral unit squared.
    unit = record.short_cutoff**2 / np.pi
    _draw_densities(axes, record, record.energy / unit)
    axes.set_xlabel(r"dissipated energy $/\,w_\mathrm{int}\lambda_\mathrm{s}^2$")
    axes.set_ylabel("probability density")
