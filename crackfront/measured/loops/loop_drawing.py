"""Figure of a loop: its rows, the JKR curves of its works of adhesion, and predicted bands."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.core import jkr
from crackfront.core.units import WORK_OF_ADHESION, Scales
from crackfront.core.variables import FORCE, LATERAL
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.plots.axis_units import AxisUnits
from crackfront.plots.style import (
    BLUE,
    COLUMN,
    VERMILION,
    axes_to_draw_on,
    blank_figure,
    house_style,
)


def plot_measured_loop(loop: MeasuredLoop, axes: Axes | None = None) -> Axes:
    """Draw a loop on the user's axes, or on new ones."""
    with axes_to_draw_on(axes) as drawn:
        _draw_measured(drawn, loop, None)
        drawn.legend()
    return drawn


def loop_figure(loop: MeasuredLoop, prediction: Prediction | None = None) -> Figure:
    """Contact radius against force, with the measured and the predicted JKR curves of each branch.

    It is in the units of the loop, SI or reduced.
    """
    with house_style():
        figure = blank_figure(COLUMN, 0.9 * COLUMN)
        _draw_measured(figure.add_subplot(), loop, prediction)
        figure.legend(loc="outside upper center", ncols=2)
        return figure


def _draw_measured(axes: Axes, loop: MeasuredLoop, prediction: Prediction | None) -> None:
    """Draw rows, JKR curves and the averaged contact radii, without a legend."""
    # Works of adhesion are in J/m^2 or w_int.
    unit = WORK_OF_ADHESION if loop.reduced else 1.0
    scales = Scales(loop.sphere_radius, unit, loop.contact_modulus.value)
    units = AxisUnits() if loop.reduced else AxisUnits(scales)
    radius = np.linspace(0.0, 1.05 * float(np.nanmax(loop.contact_radius)), 300) / scales.lateral
    for direction, work, name, colour, marker in (
        (1, "w_appr", "approach", BLUE, "o"),
        (-1, "w_retr", "retraction", VERMILION, "s"),
    ):
        rows = loop.direction == direction
        if not np.any(rows):
            continue
        axes.plot(
            loop.force[rows],
            loop.contact_radius[rows],
            linestyle="none",
            marker=marker,
            markersize=2,
            markerfacecolor="none",
            markeredgewidth=0.4,
            color=colour,
            label=name,
        )
        measured = getattr(loop, work).value
        axes.plot(
            scales.force * jkr.equilibrium_force(radius, measured),
            radius * scales.lateral,
            color=colour,
            label=f"JKR, ${units.adhesion_text(measured)}$",
        )
        if prediction is not None:
            predicted = getattr(prediction, work)
            axes.fill_betweenx(
                radius * scales.lateral,
                scales.force * jkr.equilibrium_force(radius, max(predicted.low, 0.0)),
                scales.force * jkr.equilibrium_force(radius, max(predicted.high, 0.0)),
                color=colour,
                alpha=0.15,
                linewidth=0,
                label=f"predicted, {name}",
            )
    low, high = float(np.nanmin(loop.force)), float(np.nanmax(loop.force))
    axes.set_xlim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    axes.axhspan(*loop.window, color="0.93", linewidth=0, zorder=0, label="averaged")
    units.name(axes.xaxis, "normal force", FORCE)
    units.name(axes.yaxis, "contact radius", LATERAL)
