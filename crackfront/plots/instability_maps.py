"""Maps of instabilities: swept areas as patches, coloured by the dissipated energy."""

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
    """The instabilities of a branch, at least one, with a colour bar.

    Fronts before and after (Units: reduced lateral length) at n_angle angles (Units: rad) have the
    shape (n_jump, n_angle), dissipated energies (n_jump,) (Units: pi w_int R times a reduced
    vertical length). Sites that moved by less than `travel` are not drawn.
    """
    shades = energy_shades(units.scale(ENERGY) * energy)
    # Start at the site that moved least, so that no patch spans the ends of the array.
    start = np.argmin(np.abs(after - before), axis=1)
    site = (start[:, None] + np.arange(angle.size + 1)) % angle.size
    length = units.scale(LATERAL)
    fronts = [length * np.take_along_axis(values, site, axis=1) for values in (before, after)]
    draw_patches(axes, angle[site], fronts, units.scale(ENERGY) * energy, length * travel, shades)
    bar = axes.figure.colorbar(shades, ax=axes, pad=0.02, extend="min")
    units.name(bar.ax.yaxis, "dissipated energy", ENERGY)
    frame_plane(axes, 1.05 * max(float(np.max(before)), float(np.max(after))), units)


def energy_shades(energy: Array) -> ScalarMappable:
    """Logarithmic colours of energies; the smallest 2% share a colour."""
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

    Arguments are as for :func:`draw_instabilities`, but angles have the shape of the fronts, which
    are a pair (before, after). `apex` is the abscissa of the apex (Units: reduced lateral length).
    """
    patches, energies = [], []
    for angles, before, after, lost in zip(angle, *fronts, energy, strict=True):
        rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        moved = np.abs(after - before) > travel
        edges = np.flatnonzero(np.diff(moved.astype(int), prepend=0, append=0))
        for first, last in edges.reshape(-1, 2):
            # Add a point at each end, because the two fronts meet there.
            part = slice(max(first - 1, 0), last + 1)
            start, end = before[part, None] * rays[part], after[part, None] * rays[part]
            patches.append(np.concatenate([start, end[::-1]]) + np.array([apex, 0.0]))
            energies.append(lost)
    collection = PolyCollection(patches, norm=shades.norm, cmap=shades.cmap)
    collection.set(array=np.array(energies), edgecolors="black", linewidths=0.2)
    axes.add_collection(collection)
