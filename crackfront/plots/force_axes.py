"""Contact radius against force of a sphere by JKR, with the intervals of its works of adhesion."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from crackfront.analysis.estimate import Estimate
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.plots.axis_units import scaled_unit
from crackfront.plots.style import BLUE, VERMILION

_LEAST_RADIUS = 1e-3
"""Contact radius at which the curves begin. (Units: reduced)"""

_LARGEST_RADIUS = 1.15
"""End of the axis over the contact radius of the strongest branch without load."""


def draw_forces(
    axes: Axes, scales: Scales, w_appr: Estimate[float], w_retr: Estimate[float]
) -> None:
    """Draw both branches with their 95% intervals, and a smooth sphere.

    Scales are in SI units, works of adhesion in J / m^2; a branch that is NaN is left out.
    """
    w_int = scales.work_of_adhesion
    radius = _radii(scales, w_retr)
    micrometres = 1e6 * radius * scales.lateral
    unit, newtons = scaled_unit("N", scales.force)

    def force(adhesion: float) -> Array:
        return jkr.equilibrium_force(radius, max(adhesion, 0.0) / w_int) * scales.force / newtons

    def draw_branch(name: str, colour: str, adhesion: Estimate[float]) -> None:
        label = rf"{name}, $w = {1e3 * adhesion.value:.3g}$ mJ m$^{{-2}}$"
        axes.plot(force(adhesion.value), micrometres, color=colour, label=label, zorder=3)
        weakest, strongest = force(adhesion.low), force(adhesion.high)
        axes.fill_betweenx(micrometres, weakest, strongest, color=colour, alpha=0.2, linewidth=0)

    if not math.isnan(w_appr.value):
        draw_branch("approach", BLUE, w_appr)
    if not math.isnan(w_retr.value):
        draw_branch("retraction", VERMILION, w_retr)
    smooth = rf"smooth, $w_\mathrm{{int}} = {1e3 * w_int:.3g}$ mJ m$^{{-2}}$"
    axes.plot(force(w_int), micrometres, color="0.35", dashes=(4, 2), label=smooth)
    axes.axvline(0.0, color="0.6", linewidth=0.5, zorder=1)
    axes.set_ylim(0, micrometres[-1])
    axes.set_xlabel(f"normal force ({unit})")
    axes.set_ylabel("contact radius (µm)")
    title = "nothing is predicted" if math.isnan(w_retr.value) else "95% intervals shaded"
    axes.legend(loc="lower right", title=title)


def _radii(scales: Scales, w_retr: Estimate[float]) -> Array:
    """Reduced contact radii that show the strongest of the branches and a smooth sphere."""
    w_int = scales.work_of_adhesion
    strongest = w_int if math.isnan(w_retr.high) else max(w_retr.high, w_int)
    end = _LARGEST_RADIUS * jkr.radius_at_force(0.0, strongest / w_int)
    return np.linspace(_LEAST_RADIUS, end, 400)
