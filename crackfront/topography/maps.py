"""Scans as they were used: levelled, cropped, without gaps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from crackfront.plots.style import BLUE
from crackfront.topography.reading import Measurement

_MOST_PIXELS = 512
"""Points along a side that a drawn map has at most; others are left out."""

_SHOWN = (0.002, 0.998)
"""Quantiles of the heights between which colours are spread."""

_LENGTHS = (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9), ("pm", 1e-12))


def draw_scan(axes: Axes, measurement: Measurement, stripes: Sequence[int] = ()) -> None:
    """A map in colours with their scale, or the heights along a line, with what was done to it.

    `stripes` are the axes along which its density leaves waves out.
    """
    low, high = (float(end) for end in np.quantile(measurement.heights, _SHOWN))
    unit, scale = _length_unit(max(abs(low), abs(high)))
    lateral, side = _length_unit(max(measurement.size))
    axes.set_title(_title(measurement, stripes), fontsize=6)
    axes.set_xlabel(f"x ({lateral})")
    label = f"height ({unit})"
    if measurement.is_line:
        places = np.arange(measurement.heights.size) * measurement.pixels[0] / side
        axes.plot(places, measurement.heights / scale, color=BLUE, linewidth=0.5)
        axes.set_xlim(0, measurement.size[0] / side)
        axes.set_ylabel(label)
        return
    width, height = (length / side for length in measurement.size)
    image = axes.imshow(
        _thinned(measurement.heights).T / scale,
        origin="lower",
        extent=(0.0, width, 0.0, height),
        cmap="viridis",
        vmin=low / scale,
        vmax=high / scale,
    )
    axes.set_ylabel(f"y ({lateral})")
    bar = axes.get_figure().colorbar(image, ax=axes, extend="both", shrink=0.9)  # type: ignore[union-attr]
    bar.set_label(label)


def _title(measurement: Measurement, stripes: Sequence[int]) -> str:
    """Name of the file and its channel, what was taken off, and what (a) leaves out."""
    channel = f", channel {measurement.channel}" if measurement.channel else ""
    levelling = f"without {measurement.levelling}" if measurement.levelling else "as it is"
    left_out = " and ".join("xy"[axis] for axis in stripes)
    waves = f"\n(a) without waves along {left_out} alone" if stripes else ""
    return f"{measurement.path.name}{channel}\n{levelling}{waves}"


def _thinned(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Every so many points of a map."""
    return heights[tuple(slice(None, None, -(-count // _MOST_PIXELS)) for count in heights.shape)]


def _length_unit(length: float) -> tuple[str, float]:
    """Unit in which a length is a number above one, and its value in metres."""
    return next(
        (found for found in _LENGTHS if length >= found[1] * (1 - 1e-9) and math.isfinite(length)),
        _LENGTHS[-1],
    )
