"""Animations: what moves on a figure, and how they are written."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from crackfront.data.files import replace_atomically
from crackfront.plots.style import house_style

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
    first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    milliseconds = 1000 / _FRAMES_PER_SECOND
    written = functools.partial(
        first.save,
        format="GIF",
        save_all=True,
        append_images=others,
        duration=milliseconds,
        loop=0,
    )
    replace_atomically(path, written, sealed=True)
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
