"""What instabilities have swept, as patches in the colours of the energies that they dissipated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm

from crackfront.core.arrays import Array
from crackfront.core.variables import ENERGY, LATERAL
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.fronts import frame_plane

ENERGY_LABEL = f"dissipated energy / ${ENERGY.tex}$"


def draw_instabilities(
    axes: Axes,
    angle: Array,
    before: Array,
    after: Array,
    energy: Array,
    travel: float,
    units: AxisUnits = REDUCED,
) -> None:
    """The instabilities of a branch, with a colour bar.

    Fronts before and after (units: reduced lateral length) at n_angle angles (units: rad) have the
    shape (n_jump, n_angle), dissipated energies (n_jump,) (units: pi w_int R times a reduced
    vertical length). Motions of a site are drawn from `travel` on.

    Raises
    ------
    ValueError
        If there is no instability.
    """
    if energy.size == 0:
        raise ValueError("the branch has no instability; there is none to draw")
    shades = energy_shades(units.scale(ENERGY) * energy)
    # Around from the site that moved least, so that no patch spans the ends of the array.
    start = np.argmin(np.abs(after - before), axis=1)
    site = (start[:, None] + np.arange(angle.size + 1)) % angle.size
    length = units.scale(LATERAL)
    fronts = [length * np.take_along_axis(values, site, axis=1) for values in (before, after)]
    draw_patches(axes, angle[site], fronts, units.scale(ENERGY) * energy, length * travel, shades)
    bar = axes.figure.colorbar(shades, ax=axes, pad=0.02, extend="min")
    units.name(bar.ax.yaxis, "dissipated energy", ENERGY)
    frame_plane(axes, 1.05 * max(float(np.max(before)), float(np.max(after))), units)


def energy_shades(energy: Array) -> ScalarMappable:
    """Logarithmic colours of energies, one for the few smallest."""
    return ScalarMappable(LogNorm(np.quantile(energy, 0.02), energy.max()), "viridis")


def draw_patches(
    axes: Axes,
    angle: Array,
    fronts: Sequence[Array],
    energy: Array,
    travel: float,
    shades: ScalarMappable,
    apex: float = 0.0,
) -> None:
    """Outlines of the contiguous parts of fronts that moved, in colours of the energies.

    Arguments are as of :func:`draw_instabilities`, but for angles of the sites of each front, of
    the shape of the fronts, and the abscissa of the apex (units: reduced lateral length).
    """
    patches, energies = [], []
    for around, one, other, lost in zip(angle, *fronts, energy, strict=True):
        compass = np.stack([np.cos(around), np.sin(around)], axis=1)
        moved = np.abs(other - one) > travel
        edges = np.flatnonzero(np.diff(moved.astype(int), prepend=0, append=0))
        for first, last in edges.reshape(-1, 2):
            # One point more at each end, where the two fronts meet.
            part = slice(max(first - 1, 0), last + 1)
            there, back = one[part, None] * compass[part], other[part, None] * compass[part]
            patches.append(np.concatenate([there, back[::-1]]) + np.array([apex, 0.0]))
            energies.append(lost)
    collection = PolyCollection(patches, norm=shades.norm, cmap=shades.cmap)
    collection.set(array=np.array(energies), edgecolors="black", linewidths=0.2)
    axes.add_collection(collection)
