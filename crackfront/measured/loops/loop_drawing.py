"""Figure of a measured loop: its rows, the curves of its works of adhesion, predicted bands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crackfront.core import jkr
from crackfront.core.units import WORK_OF_ADHESION, Scales
from crackfront.core.variables import FORCE, LATERAL
from crackfront.measured.loops.loop import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.plots.axis_units import AxisUnits
from crackfront.plots.style import BLUE, COLUMN, VERMILION, blank_figure, house_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def loop_figure(found: MeasuredLoop, predicted: Prediction | None = None) -> Figure:
    """Force against contact radius, the JKR curve of each branch, and those that are predicted.

    It is in the units of the loop, SI or reduced.
    """
    # Works of adhesion are in J/m^2 or w_int.
    unit = WORK_OF_ADHESION if found.reduced else 1.0
    scales = Scales(found.sphere_radius, unit, found.contact_modulus.value)
    units = AxisUnits() if found.reduced else AxisUnits(scales)
    reach = np.linspace(0.0, 1.05 * float(np.nanmax(found.contact_radius)), 300) / scales.lateral
    with house_style():
        figure = blank_figure(COLUMN, 0.9 * COLUMN)
        axes = figure.add_subplot()
        for sign, name, colour, marker in (
            (1, "approach", BLUE, "o"),
            (-1, "retraction", VERMILION, "s"),
        ):
            rows = found.direction == sign
            axes.plot(
                found.contact_radius[rows],
                found.force[rows],
                linestyle="none",
                marker=marker,
                markersize=2,
                markerfacecolor="none",
                markeredgewidth=0.4,
                color=colour,
                label=name,
            )
            work = found.w_appr if sign > 0 else found.w_retr
            axes.plot(
                reach * scales.lateral,
                scales.force * jkr.equilibrium_force(reach, work.value),
                color=colour,
                label=f"JKR, ${units.adhesion_text(work.value)}$",
            )
            if predicted is not None:
                band = predicted.w_appr if sign > 0 else predicted.w_retr
                least, most = (
                    scales.force * jkr.equilibrium_force(reach, max(end, 0.0))
                    for end in (band.low, band.high)
                )
                look: dict[str, Any] = {"color": colour, "alpha": 0.15, "linewidth": 0}
                label = f"predicted, {name}"
                axes.fill_between(reach * scales.lateral, least, most, label=label, **look)
        low, high = float(np.nanmin(found.force)), float(np.nanmax(found.force))
        axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
        axes.axvspan(*found.window, color="0.93", linewidth=0, zorder=0, label="averaged")
        units.name(axes.xaxis, "contact radius", LATERAL)
        units.name(axes.yaxis, "normal force", FORCE)
        figure.legend(loc="outside upper center", ncols=2)
        return figure
