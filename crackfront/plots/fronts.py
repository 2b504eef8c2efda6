"""Fronts over the field that pins them, and surfaces."""

from __future__ import annotations

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
"""Shades of the field; few, so that frames of an animation compress well."""

RETRACTION = (0, (6, 1, 1, 1))
"""Style of the line of a front in retraction, which grey print tells from one in approach."""

_FORWARD: dict[str, Any] = {"color": BLUE, "linewidth": 0.7}
_BACK: dict[str, Any] = {"color": VERMILION, "linewidth": 0.7, "linestyle": RETRACTION}

_MARGIN = 1.15
"""How far the axes reach, over the largest radius."""


def draw_field(
    axes: Axes,
    x: Array,
    y: Array,
    adhesion: NDArray[np.floating],
    mean: float,
    reach: float,
    units: AxisUnits = REDUCED,
) -> None:
    """Work of adhesion in a few shades, mean - reach to mean + reach, with a colour bar.

    Values at n_x abscissae and n_y ordinates (units: reduced lateral length) have the shape
    (n_x, n_y) (units: w_int, as of mean and reach).
    """
    ends = units.scale(ADHESION) * (mean - reach), units.scale(ADHESION) * (mean + reach)
    levels = MaxNLocator(_MOST_GREYS).tick_values(*ends)
    shades = ScalarMappable(BoundaryNorm(levels, field_colours().N), field_colours())
    # Coloured once, not once a frame.
    _draw_image(axes, x, y, shades.to_rgba(units.scale(ADHESION) * adhesion.T, bytes=True), units)
    bar = axes.figure.colorbar(shades, ax=axes, pad=0.02, format="{x:.1f}", extend="both")
    units.name(bar.ax.yaxis, "local work of adhesion", ADHESION)


def draw_heights(axes: Axes, x: Array, y: Array, heights: Array, units: AxisUnits) -> None:
    """Heights in colours, peaks bright, with a colour bar; arrays as of :func:`draw_field`."""
    image = _draw_image(axes, x, y, units.scale(VERTICAL) * heights.T, units)
    bar = axes.figure.colorbar(image, ax=axes, pad=0.02)
    units.name(bar.ax.yaxis, "height", VERTICAL)


def _draw_image(axes: Axes, x: Array, y: Array, values: Array, units: AxisUnits) -> AxesImage:
    """Draw values, or their colours, at their places in the plane, and name the axes."""
    # Pixels reach half of their width beyond the places of their values.
    left, right, bottom, top = (
        float(units.scale(LATERAL) * (places[end] + side * (places[1] - places[0]) / 2))
        for places in (x, y)
        for end, side in ((0, -1), (-1, 1))
    )
    look: dict[str, Any] = {"origin": "lower", "interpolation": "nearest", "cmap": "cividis"}
    image = axes.imshow(values, extent=(left, right, bottom, top), **look)
    label_plane(axes, units)
    return image


def draw_fronts(
    axes: Axes,
    angle: Array,
    radius: Array,
    direction: NDArray[np.int64],
    most: int = 24,
    units: AxisUnits = REDUCED,
) -> None:
    """Fronts of both branches as closed curves, at most so many of a branch, its last among them.

    Radii (units: reduced lateral length) at n_angle angles (units: rad) have the shape
    (n_step, n_angle); n_step directions are +1 in approach, -1 in retraction.
    """
    for sign, look, label in ((1, _FORWARD, "approach"), (-1, _BACK, "retraction")):
        for count, front in enumerate(_few(radius[direction == sign], most)):
            name = label if count == 0 else None
            axes.plot(*closed_front(angle, units.scale(LATERAL) * front), label=name, **look)
    frame_plane(axes, _MARGIN * float(np.max(radius)), units)
    axes.legend(loc="upper left", **ON_WHITE)


def draw_straight_fronts(
    axes: Axes, y: Array, position: Array, direction: NDArray[np.int64], most: int = 24
) -> None:
    """Straight fronts of both branches, at most so many of a branch, its last among them.

    Positions at n_site ordinates (units: length of the tile) have the shape (n_step, n_site);
    n_step directions are +1 where the load advances, -1 where it recedes.
    """
    for sign, look, label in ((1, _FORWARD, "forward"), (-1, _BACK, "back")):
        for count, front in enumerate(_few(position[direction == sign], most)):
            name = label if count == 0 else None
            axes.plot(front, y, label=name, **look)
    axes.set_xlabel("$x$, along the motion (unit of the tile)")
    axes.set_ylabel("$y$, along the front (unit of the tile)")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _few(fronts: Array, most: int) -> Array:
    """At most so many fronts of a branch, from its last backwards."""
    return fronts[::-1][:: -(-len(fronts) // most) or 1]


def frame_plane(axes: Axes, reach: float, units: AxisUnits = REDUCED) -> None:
    """A square of the plane around the apex, with its names and units."""
    ends = -units.scale(LATERAL) * reach, units.scale(LATERAL) * reach
    axes.set(xlim=ends, ylim=ends, aspect="equal")
    label_plane(axes, units)


def label_plane(axes: Axes, units: AxisUnits = REDUCED) -> None:
    """Names and units of both lateral axes."""
    units.name(axes.xaxis, "$x$", LATERAL)
    units.name(axes.yaxis, "$y$", LATERAL)


def closed_front(angle: Array, radius: Array) -> tuple[Array, Array]:
    """Abscissae and ordinates of a front, the first point repeated at the end."""
    around, out = np.append(angle, angle[0]), np.append(radius, radius[0])
    return out * np.cos(around), out * np.sin(around)
