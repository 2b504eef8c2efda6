"""Main Fig. 5b, c: perimeters of the approach, and force against radius, in SI units."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.analysis.report import PAPER_FACTOR
from crackfront.core import jkr
from crackfront.plots.style import BLACK, BLUE, ORANGE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.nanodiamond import NanodiamondContact

Array = NDArray[np.float64]

_MICRO, _MILLI = 1e6, 1e3


def nanodiamond_figure(contact: NanodiamondContact) -> Figure:
    """Perimeters of the approach beside the loop.

    Parameters
    ----------
    contact : NanodiamondContact
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        left, right = figure.subplots(1, 2, width_ratios=[1, 1])
        _draw_perimeters(left, contact)
        _draw_loop(right, contact)
        for axes, letter in ((left, "b"), (right, "c")):
            axes.set_title(letter, loc="left", fontweight="bold")
        return figure


def _draw_perimeters(axes: Axes, contact: NanodiamondContact) -> None:
    """Perimeters in approach, and the area that the widest instability closes."""
    directions = np.stack([np.cos(contact.angle), np.sin(contact.angle)], axis=-1)
    lines = contact.line[..., None] * directions * _MICRO
    closed = np.concatenate([lines, lines[:, :1]], axis=1)
    axes.add_collection(LineCollection(list(closed), colors=BLACK, linewidths=0.3))
    around = np.concatenate([contact.arc_angle, contact.arc_angle[::-1]])
    radius = np.concatenate([contact.arc_inner, contact.arc_outer[::-1]]) * _MICRO
    axes.fill(
        radius * np.cos(around),
        radius * np.sin(around),
        color=ORANGE,
        linewidth=0.6,
        zorder=3,
        label=f"widest instability:\n{contact.extent[0] * _MICRO:.0f} µm along the perimeter",
    )
    reach = 1.03 * float(np.abs(lines).max())
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.set_xlabel("x (µm)")
    axes.set_ylabel("y (µm)")
    axes.legend(loc="center", handlelength=0.8)


def _draw_loop(axes: Axes, contact: NanodiamondContact) -> None:
    """Force against radius: simulation, its JKR curves, those of k = 3, and measured points."""
    scales = contact.reduced
    energy, surface = contact.elastic_energy, contact.work_of_adhesion
    radius = np.linspace(0, 1.08 * contact.radius.max(), 300)

    def smooth(adhesion: float) -> Array:
        reduced = jkr.equilibrium_force(radius / scales.lateral, adhesion / surface)
        return reduced * scales.force * _MILLI

    for direction, name, short, colour, adhesion, predicted in (
        (1, "approach", "appr", BLUE, contact.approach[0], -1),
        (-1, "retraction", "retr", VERMILION, contact.retraction[0], 1),
    ):
        branch = (contact.direction == direction) & (
            (direction < 0) | (contact.penetration >= contact.jump_in)
        )
        axes.plot(
            contact.radius[branch] * _MICRO,
            contact.force[branch] * _MILLI,
            color=colour,
            linewidth=1.4,
            label=name,
            zorder=3,
        )
        axes.plot(
            radius * _MICRO,
            smooth(adhesion),
            color=colour,
            linewidth=0.7,
            linestyle=(0, (1, 1.2)),
            label=rf"JKR, $w_\mathrm{{{short}}}$ = {adhesion * _MILLI:.1f} mJ/m$^2$",
        )
        theory = surface - energy + predicted * PAPER_FACTOR * energy
        axes.plot(
            radius * _MICRO,
            smooth(max(theory, 0.0)),
            color="0.35",
            linewidth=0.7,
            linestyle=(0, (4, 2)),
            label=rf"JKR, $k = {PAPER_FACTOR:g}$: {theory * _MILLI:.1f} mJ/m$^2$",
            zorder=1,
        )
        measured = contact.measured_direction == direction
        if np.any(measured):
            axes.plot(
                contact.measured_radius[measured] * _MICRO,
                contact.measured_force[measured] * _MILLI,
                linestyle="none",
                marker="D",
                color=colour,
                markerfacecolor="white",
                label=f"measured, {name}",
                zorder=4,
            )
    axes.axhline(0, color="0.6", linewidth=0.4, zorder=0)
    axes.set_xlim(0.75 * contact.radius[contact.direction < 0].min() * _MICRO, radius[-1] * _MICRO)
    low, high = contact.force.min() * _MILLI, contact.force.max() * _MILLI
    axes.set_ylim(low - 0.15 * (high - low), high + 0.08 * (high - low))
    axes.set_xlabel("mean contact radius (µm)")
    axes.set_ylabel("normal force (mN)")
    axes.legend(loc="upper left")
