"""Fronts over the field that pins them, and surfaces."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, LATERAL, VERTICAL
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.parts import ON_WHITE, field_colours
from crackfront.plots.style import BLUE, VERMILION

_MOST_GREYS = 10
"""Largest number of shades of the field; few, so that frames of an animation compress well."""

RETRACTION = (0, (6, 1, 1, 1))
"""Line style of fronts in retraction, which differ from approach in grey print too."""

_APPROACH_LOOK: dict[str, Any] = {"color": BLUE, "linewidth": 0.7}
_RETRACTION_LOOK: dict[str, Any] = {"color": VERMILION, "linewidth": 0.7, "linestyle": RETRACTION}

_MARGIN = 1.15
"""Half of the width of the axes. (Units: largest radius)"""


def draw_field(
    axes: Axes,
    x: Array,
    y: Array,
    adhesion: NDArray[np.floating],
    mean: float,
    reach: float,
    units: AxisUnits = REDUCED,
) -> None:
    """Work of adhesion in a few shades from mean - reach to mean + reach, with a colour bar.

    `adhesion` has the shape (n_x, n_y) (Units: w_int, as mean and reach) at n_x abscissae and n_y
    ordinates (Units: reduced lateral length).
    """
    ends = units.scale(ADHESION) * (mean - reach), units.scale(ADHESION) * (mean + reach)
    levels = MaxNLocator(_MOST_GREYS).tick_values(*ends)
    shades = ScalarMappable(BoundaryNorm(levels, field_colours().N), field_colours())
    # Animations draw the colours in every frame, so that they are computed here, once.
    _draw_image(axes, x, y, shades.to_rgba(units.scale(ADHESION) * adhesion.T, bytes=True), units)
    bar = axes.figure.colorbar(shades, ax=axes, pad=0.02, format="{x:.1f}", extend="both")
    units.name(bar.ax.yaxis, "local work of adhesion", ADHESION)


def draw_heights(axes: Axes, x: Array, y: Array, heights: Array, units: AxisUnits) -> None:
    """Heights in colours, peaks bright, with a colour bar; arrays as for :func:`draw_field`."""
    image = _draw_image(axes, x, y, units.scale(VERTICAL) * heights.T, units)
    bar = axes.figure.colorbar(image, ax=axes, pad=0.02)
    units.name(bar.ax.yaxis, "height", VERTICAL)


def _draw_image(axes: Axes, x: Array, y: Array, values: Array, units: AxisUnits) -> AxesImage:
    """Draw values, or their colours, at points of a plane, and name the axes."""
    extent = (*_pixel_edges(x, units), *_pixel_edges(y, units))
    look: dict[str, Any] = {"origin": "lower", "interpolation": "nearest", "cmap": "cividis"}
    image = axes.imshow(values, extent=extent, **look)
    label_plane(axes, units)
    return image


def _pixel_edges(centres: Array, units: AxisUnits) -> tuple[float, float]:
    """Outer edges of the first and the last pixel along an axis, from the centres of all."""
    half_pixel = (centres[1] - centres[0]) / 2
    edges = units.scale(LATERAL) * np.array([centres[0] - half_pixel, centres[-1] + half_pixel])
    return float(edges[0]), float(edges[1])


def draw_fronts(
    axes: Axes,
    angle: Array,
    radius: Array,
    direction: NDArray[np.int64],
    most: int = 24,
    units: AxisUnits = REDUCED,
) -> None:
    """Fronts of both branches as closed curves, at most `most` of each branch.

    Radii (Units: reduced lateral length) at n_angle angles (Units: rad) have the shape
    (n_step, n_angle); n_step directions are +1 in approach, -1 in retraction.
    """
    branches = (1, _APPROACH_LOOK, "approach"), (-1, _RETRACTION_LOOK, "retraction")
    for sign, look, label in branches:
        for count, front in enumerate(_thinned(radius[direction == sign], most)):
            name = label if count == 0 else None
            axes.plot(*closed_front(angle, units.scale(LATERAL) * front), label=name, **look)
    frame_plane(axes, _MARGIN * float(np.max(radius)), units)
    axes.legend(loc="upper left", **ON_WHITE)


def draw_straight_fronts(
    axes: Axes, y: Array, position: Array, direction: NDArray[np.int64], most: int = 24
) -> None:
    """Straight fronts of both branches, at most `most` of each branch.

    Positions at n_site ordinates (Units: length of the tile) have the shape (n_step, n_site);
    n_step directions are +1 if the load advances, -1 if it recedes.
    """
    for sign, look, label in ((1, _APPROACH_LOOK, "forward"), (-1, _RETRACTION_LOOK, "back")):
        for count, front in enumerate(_thinned(position[direction == sign], most)):
            name = label if count == 0 else None
            axes.plot(front, y, label=name, **look)
    axes.set_xlabel("$x$, along the motion (unit of the tile)")
    axes.set_ylabel("$y$, along the front (unit of the tile)")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _thinned(fronts: Array, most: int) -> Array:
    """At most `most` evenly chosen fronts of a branch, the last one first."""
    step = max(1, math.ceil(len(fronts) / most))
    return fronts[::-1][::step]


def frame_plane(axes: Axes, reach: float, units: AxisUnits = REDUCED) -> None:
    """Limit the axes to a square around the apex, and name them."""
    ends = -units.scale(LATERAL) * reach, units.scale(LATERAL) * reach
    axes.set(xlim=ends, ylim=ends, aspect="equal")
    axes.locator_params(nbins=5)  # on both axes; an automatic number could change after the layout
    label_plane(axes, units)


def label_plane(axes: Axes, units: AxisUnits = REDUCED) -> None:
    """Name both lateral axes, with their units."""
    units.name(axes.xaxis, "$x$", LATERAL)
    units.name(axes.yaxis, "$y$", LATERAL)


def closed_front(angle: Array, radius: Array) -> tuple[Array, Array]:
    """Abscissae and ordinates of a front, the first point repeated at the end."""
    around, out = np.append(angle, angle[0]), np.append(radius, radius[0])
    return out * np.cos(around), out * np.sin(around)
