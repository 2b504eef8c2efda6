"""What the drawings of several figures share: lines, texts, legends, ticks, animations."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from crackfront.plots.style import BLUE, VERMILION, house_style
from crackfront.simulate.storage import replace_atomically

BRANCHES = ((1, "approach", "appr", BLUE), (-1, "retraction", "retr", VERMILION))
"""Direction, name, index of the work of adhesion and colour of both branches."""

DASHED: dict[str, Any] = {"linewidth": 0.7, "dashes": (4, 2)}
"""Style of broken lines."""

DOTTED: dict[str, Any] = {"linewidth": 0.6, "dashes": (1.5, 1.5)}
"""Style of dotted lines."""

THEORY: dict[str, Any] = {"color": "0.35", **DASHED}
"""Style of lines that a theory gives."""


def write_next_to(
    axes: Axes, text: str, place: tuple[float, float], aside: tuple[float, float], **style: Any
) -> None:
    """Text that stands so many points to the right of a place, and above it."""
    axes.annotate(text, place, xytext=aside, textcoords="offset points", **style)


def draw_jump(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str, **style: Any
) -> None:
    """Arrow from a place to another."""
    ends = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=end, xytext=start, arrowprops=ends | style)


def name_panels(panels: Iterable[Axes], letters: str) -> None:
    """Bold letters on the upper left corners of panels."""
    for axes, letter in zip(panels, letters, strict=True):
        axes.set_title(letter, loc="left", fontweight="bold")


_FRAMES_PER_SECOND = 12


@dataclass(frozen=True, slots=True)
class Animation:
    """A figure of which parts are `moving`; `show` puts them where they are in a frame."""

    figure: Figure
    moving: tuple[Artist, ...]
    n_frame: int
    show: Callable[[int], None]


def save_animation(animation: Animation, stem: Path) -> Path:
    """Write a GIF (100 dpi, 12 frames a second) that runs for ever; equal ones give equal bytes."""
    path = stem.with_name(stem.name + ".gif")
    with house_style():
        frames = _frames(animation)
    # One palette for all, so that only what moves differs from frame to frame.
    palette = frames[-1].quantize()
    first, *following = [
        frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames
    ]
    written = functools.partial(
        first.save,
        format="GIF",
        save_all=True,
        append_images=following,
        duration=1000 / _FRAMES_PER_SECOND,
        loop=0,
    )
    replace_atomically(path, written)
    return path


def _frames(animation: Animation) -> list[Image.Image]:
    """All frames; the parts at rest, which take most of the time, are drawn once."""
    canvas: Any = FigureCanvasAgg(animation.figure)
    for artist in animation.moving:
        artist.set_animated(True)
    canvas.draw()
    at_rest = canvas.copy_from_bbox(animation.figure.bbox)
    frames = []
    for number in range(animation.n_frame):
        animation.show(number)
        canvas.restore_region(at_rest)
        for artist in animation.moving:
            animation.figure.draw_artist(artist)
        frames.append(Image.fromarray(np.array(canvas.buffer_rgba())[..., :3]))
    return frames
