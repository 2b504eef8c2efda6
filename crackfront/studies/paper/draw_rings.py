"""Main Fig. 2: rings of high and low work of adhesion, and the loops on them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.plots.parts import (
    FORCE_LABEL,
    HEIGHT_LABEL,
    LENGTH_LABEL,
    RADIUS_LABEL,
    draw_arrow,
    label_panel,
)
from crackfront.plots.style import (
    BLACK,
    BLUE,
    ORANGE,
    PAGE,
    SKY,
    VERMILION,
    blank_figure,
    house_style,
)
from crackfront.studies.paper.rings import RingLoops, ring_adhesion

Array = NDArray[np.float64]

_BRANCHES = ((1, "approach", "appr", "A"), (-1, "retraction", "retr", "B"))
_DARK, _LIGHT = {1: BLUE, -1: VERMILION}, {1: SKY, -1: ORANGE}

_REACH = 2.2
"""Half width of the cross-section (Units: reduced lateral length)."""


def rings_figure(loops: RingLoops) -> Figure:
    """Contact and rings, sampled works of adhesion for both wavelengths, force against radius.

    Parameters
    ----------
    loops : RingLoops
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.8 * PAGE)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.15, 1))
        left = grid[0, 0].subgridspec(2, 1, height_ratios=(1, 1.25), hspace=0.02)
        profile = figure.add_subplot(left[0])
        top = figure.add_subplot(left[1], sharex=profile)
        _draw_contact(profile, loops)
        _draw_rings(top, loops)
        long, short, force = (figure.add_subplot(grid[place]) for place in ((0, 1), (1, 0), (1, 1)))
        _draw_release(long, loops, 0, (0.4, 2.15), _DARK)
        _draw_release(short, loops, 1, (1.1, 1.8), _LIGHT)
        _draw_forces(force, loops)
        for name, axes in zip("abcd", (profile, long, short, force), strict=True):
            label_panel(axes, name)
        return figure


def _draw_contact(axes: Axes, loops: RingLoops) -> None:
    """Cross-section at b = 0: state A on the left, state B on the right."""
    distance = np.linspace(0, _REACH, 600)
    for side in (-1, 1):
        axes.plot(side * distance, distance**2 / 2, color="0.35")
    axes.annotate("sphere", (0.0, 1.0), ha="center", color="0.35")
    for (direction, name, _, state), side in zip(_BRANCHES, (-1, 1), strict=True):
        contact, colour = _closed(loops, 0, direction), _DARK[direction]
        height = -jkr.surface_displacement(distance, contact, 0.0)
        axes.fill_between(side * distance, height, -1, color="0.88", linewidth=0)
        axes.plot(side * distance, height, color=colour, label=f"{state}, {name}")
        _draw_state(axes, side * contact, contact**2 / 2, state, colour, (-7 * side, 3))
    axes.annotate("elastic body", (0.0, -0.4), ha="center")
    axes.set_ylim(-0.6, 1.7)
    axes.set_box_aspect(0.4)
    axes.set_ylabel(HEIGHT_LABEL.format("height").replace(" / ", " /\n"))
    axes.tick_params(labelbottom=False)


def _draw_rings(axes: Axes, loops: RingLoops) -> None:
    """Work of adhesion from above, half of it, with the contact edges of A and B."""
    along, across = np.linspace(-_REACH, _REACH, 801), np.linspace(-_REACH, 0, 401)
    distance = np.hypot(*np.meshgrid(along, across))
    image = axes.imshow(
        ring_adhesion(distance, loops.amplitude, loops.wavelength[0]),
        extent=(-_REACH, _REACH, -_REACH, 0),
        cmap="Greys",
        vmin=1 - 1.5 * loops.amplitude,
        vmax=1 + 2 * loops.amplitude,
        interpolation="bilinear",
        origin="lower",
    )
    angle = np.linspace(-np.pi, 0, 361)
    for direction, *_ in _BRANCHES:
        contact = _closed(loops, 0, direction)
        axes.plot(contact * np.cos(angle), contact * np.sin(angle), color=_DARK[direction])
    bar = axes.inset_axes((1.03, 0.0, 0.03, 1.0))
    axes.figure.colorbar(image, cax=bar, label=r"$w_\mathrm{loc}/w_\mathrm{int}$")
    bar.set_ylim(1 - loops.amplitude, 1 + loops.amplitude)
    axes.set_xlabel(LENGTH_LABEL.format("$x$"))
    axes.set_ylabel(LENGTH_LABEL.format("$y$").replace(" / ", " /\n"))


def _draw_release(
    axes: Axes,
    loops: RingLoops,
    index: int,
    limits: tuple[float, float],
    colours: dict[int, str],
) -> None:
    """Work of adhesion of the rings, G at b = 0, and what both branches sample of it."""
    radius = np.linspace(*limits, 3000)
    wavelength = loops.wavelength[index]
    adhesion = ring_adhesion(radius, loops.amplitude, wavelength)
    axes.plot(radius, adhesion, color="0.72", label=rf"$w_\mathrm{{loc}}(a)$, $d={wavelength:g}$")
    release = jkr.apparent_work_of_adhesion(radius, 0.0)
    axes.plot(radius, release, color=BLACK, linewidth=0.8, label=r"$G_\mathrm{JKR}(b=0,a)$")
    for direction, name, short, state in _BRANCHES:
        colour = colours[direction]
        _draw_branch(axes, loops, index, direction, jkr.apparent_work_of_adhesion, colour, name)
        level = 1 - direction * loops.amplitude
        axes.axhline(level, color="0.3", linewidth=0.6, dashes=(4, 2), zorder=1)
        axes.annotate(
            rf"$w_\mathrm{{{short}}}$",
            (limits[1], level),
            xytext=(-3, -3 * direction),
            textcoords="offset points",
            ha="right",
            va="top" if direction > 0 else "bottom",
        )
        if index == 0:
            closed = _closed(loops, index, direction)
            height = float(jkr.apparent_work_of_adhesion(closed, 0.0))
            _draw_state(axes, closed, height, state, colour, (8, -3) if direction > 0 else (-6, 4))
    axes.set_xlim(*limits)
    axes.set_ylim(0.35, 2.05)
    axes.set_xlabel(RADIUS_LABEL)
    axes.set_ylabel(r"energy release rate / $w_\mathrm{int}$")
    axes.legend(loc="upper left", ncols=2)


def _draw_forces(axes: Axes, loops: RingLoops) -> None:
    """Force against radius of both loops between the JKR curves of the extremes."""
    radius = np.linspace(0.0, _REACH, 400)
    for index, colours in ((1, _LIGHT), (0, _DARK)):
        for direction, name, _, state in _BRANCHES:
            label, colour = rf"{name}, $d={loops.wavelength[index]:g}$", colours[direction]
            _draw_branch(axes, loops, index, direction, jkr.force, colour, label)
            if index == 0:
                closed = _closed(loops, index, direction)
                height = float(jkr.force(closed, 0.0))
                _draw_state(
                    axes, closed, height, state, colour, (7, 3) if direction > 0 else (2, -8)
                )
    for direction, _, short, _ in _BRANCHES:
        adhesion = 1 - direction * loops.amplitude
        axes.plot(
            radius,
            jkr.equilibrium_force(radius, adhesion),
            color="0.3",
            linewidth=0.8,
            dashes=(4, 2) if direction > 0 else (1.5, 1.5),
            label=rf"JKR, $w_\mathrm{{{short}}}={adhesion:g}\,w_\mathrm{{int}}$",
            zorder=1,
        )
    axes.plot(radius, jkr.force(radius, 0.0), color=BLACK, linewidth=0.8, label="$b=0$", zorder=1)
    axes.set_xlim(0, _REACH)
    axes.set_ylim(-2.7, 2.7)
    axes.set_xlabel(RADIUS_LABEL)
    axes.set_ylabel(FORCE_LABEL)
    axes.legend(loc="upper left", ncols=2, columnspacing=1.0)


def _draw_state(
    axes: Axes, abscissa: float, ordinate: float, name: str, colour: str, aside: tuple[float, float]
) -> None:
    """Point with its letter beside it."""
    axes.plot(abscissa, ordinate, "o", color=colour, markersize=3, zorder=5)
    axes.annotate(
        name,
        (abscissa, ordinate),
        xytext=aside,
        textcoords="offset points",
        ha="center",
        va="center",
        color=colour,
        fontweight="bold",
    )


def _draw_branch(
    axes: Axes,
    loops: RingLoops,
    index: int,
    direction: int,
    value: Callable[[Array, Array], Array],
    colour: str,
    label: str,
) -> None:
    """Quantity of the contact on a branch: heavy where it is pinned, arrows where it jumps."""
    name: str | None = label
    for part in _parts(loops, index, direction):
        ordinate = value(part.radius, part.penetration)
        if not part.jump:
            axes.plot(part.radius, ordinate, color=colour, linewidth=1.4, label=name)
            name = None
            continue
        axes.plot(part.radius, ordinate, color=colour, linewidth=0.7)
        if index == 0:
            middle = slice(part.radius.size // 2, part.radius.size // 2 + 2)
            draw_arrow(axes, part.radius[middle], ordinate[middle], colour)


class _Part(NamedTuple):
    """Pinned part of a branch, or a jump at fixed penetration."""

    radius: Array
    penetration: Array
    jump: bool


def _parts(loops: RingLoops, index: int, direction: int) -> list[_Part]:
    """Parts of a branch in order, from making contact or to losing it."""
    branch = loops.branch(index, direction)
    radius, penetration = loops.radius[branch], loops.penetration[branch]
    starts = np.flatnonzero(loops.jump[branch])
    parts = [
        _Part(held, load, jump=False)
        for held, load in zip(np.split(radius, starts), np.split(penetration, starts), strict=True)
        if held.size
    ]
    before = np.r_[0.0, radius][starts]
    parts += map(_jump, before, radius[starts], penetration[starts])
    if direction < 0:
        parts.append(_jump(radius[-1], 0.0, penetration[-1]))
    return parts


def _jump(before: float, after: float, penetration: float) -> _Part:
    """Radii that a jump passes; zero itself has no energy release rate."""
    path = np.linspace(max(before, 1e-6), max(after, 1e-6), 40)
    return _Part(path, np.full(path.size, penetration), jump=True)


def _closed(loops: RingLoops, index: int, direction: int) -> float:
    """Radius of a branch at b = 0."""
    return float(loops.radius[loops.branch(index, direction) & (loops.penetration == 0)][0])
