"""Main Fig. 3a, b: instabilities of a retraction as patches, and the cycle with its jumps."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.signal import resample

from crackfront.core import jkr
from crackfront.plots.fronts import frame_plane
from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL
from crackfront.plots.style import BLUE, PAGE, PURPLE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.contact import STRONG, WEAK
from crackfront.studies.paper.instabilities import InstabilityRecord
from crackfront.studies.paper.instability_checks import radii_at_zero

Array = NDArray[np.float64]

_COLOURS = "viridis"

_ENERGY_LABEL = r"dissipated energy / $(9\pi^5 w_\mathrm{int}^5R^4/16E'^2)^{1/3}$"

_FINER = 4
"""Points of a drawn front per site; the front is smooth between its sites."""

_GAP = 0.05
"""Distance of the two quarters from the middle between them."""


def instability_figure(record: InstabilityRecord) -> Figure:
    """Patches of both retractions, and force against radius of the cycle.

    Parameters
    ----------
    record : InstabilityRecord
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.41 * PAGE)
        left, right = figure.subplots(1, 2, width_ratios=(1.6, 1))
        norm = LogNorm(np.quantile(record.energy, 0.02), record.energy.max())
        for index in (STRONG, WEAK):
            _draw_quarter(left, record, index, norm)
            _draw_larkin_length(left, record, index)
        _finish_quarters(left, record)
        bar = figure.colorbar(
            ScalarMappable(norm, _COLOURS),
            cax=left.inset_axes((0.42, 0.155, 0.5, 0.028)),
            orientation="horizontal",
            extend="min",
        )
        bar.set_label(_ENERGY_LABEL, fontsize=7, labelpad=1)
        _draw_cycle(right, record)
        left.set_title("a", loc="left", fontweight="bold")
        right.set_title("b", loc="left", fontweight="bold")
        return figure


def _draw_quarter(axes: Axes, record: InstabilityRecord, index: int, norm: LogNorm) -> None:
    """Patches of one disorder on its quarter of the contact, outlined by the pinned fronts."""
    chosen = record.disorder_index == index
    fronts = [_quarter(values[chosen], index) for values in (record.before, record.after)]
    angle = np.pi / 2 * np.linspace(0, 1, fronts[0].shape[1]) + (
        np.pi / 2 if index == STRONG else 0
    )
    middle = np.array([_GAP if index == WEAK else -_GAP, 0.0])
    patches, energies = [], []
    for before, after, energy in zip(*fronts, record.energy[chosen], strict=True):
        for patch in _patches(before, after, angle, record.travel):
            patches.append(patch + middle)
            energies.append(energy)
    _add_patches(axes, patches, energies, norm)


def draw_instabilities(
    axes: Axes, angle: Array, before: Array, after: Array, energy: Array, travel: float
) -> None:
    """What each instability has swept, coloured by the energy that it dissipated.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    angle : (n_angle,) array
        Angles of the sites. (Units: rad)
    before, after : (n_jump, n_angle) array
        Fronts before and after. (Units: reduced lateral length)
    energy : (n_jump,) array
        Dissipated energies. (Units: pi w_int R times a reduced vertical length)
    travel : float
        Smallest motion of a site that is drawn. (Units: reduced lateral length)

    Raises
    ------
    ValueError
        If there is no instability.
    """
    if energy.size == 0:
        raise ValueError("the branch has no instability; there is none to draw")
    norm = LogNorm(np.quantile(energy, 0.02), energy.max())
    patches, energies = [], []
    for one, other, lost in zip(before, after, energy, strict=True):
        # Begin on the site that moved least, so that no patch spans the ends of the array.
        turn = -int(np.argmin(np.abs(other - one)))
        first, last, around = (_closed(np.roll(values, turn)) for values in (one, other, angle))
        for patch in _patches(first, last, around, travel):
            patches.append(patch)
            energies.append(lost)
    _add_patches(axes, patches, energies, norm)
    bar = axes.figure.colorbar(ScalarMappable(norm, _COLOURS), ax=axes, pad=0.02, extend="min")
    bar.set_label(_ENERGY_LABEL)
    frame_plane(axes, 1.05 * max(float(np.max(before)), float(np.max(after))))


def _closed(values: Array) -> Array:
    """Values around the perimeter, the first repeated at the end."""
    return np.append(values, values[0])


def _patches(before: Array, after: Array, angle: Array, travel: float) -> list[Array]:
    """Outlines of the contiguous parts of a perimeter that moved."""
    compass = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    moved = np.abs(after - before) > travel
    edges = np.flatnonzero(np.diff(moved.astype(int), prepend=0, append=0))
    found = []
    for first, last in edges.reshape(-1, 2):
        # One point more at each end, where the two fronts meet.
        part = slice(max(first - 1, 0), last + 1)
        there, back = before[part, None] * compass[part], after[part, None] * compass[part]
        found.append(np.concatenate([there, back[::-1]]))
    return found


def _add_patches(axes: Axes, patches: list[Array], energies: list[float], norm: LogNorm) -> None:
    """Patches in the colours of their energies."""
    axes.add_collection(
        PolyCollection(
            patches,
            array=np.array(energies),
            norm=norm,
            cmap=_COLOURS,
            edgecolors="black",
            linewidths=0.2,
        )
    )


def _quarter(fronts: Array, index: int) -> Array:
    """Finely drawn part of fronts that lies in the quarter of a disorder."""
    count = fronts.shape[1] * _FINER
    first = count // 4 if index == STRONG else 0
    return np.asarray(resample(fronts, count, axis=1)[:, first : first + count // 4 + 1])


def _draw_larkin_length(axes: Axes, record: InstabilityRecord, index: int) -> None:
    """Bar of the Larkin length outside the perimeter."""
    length, side = float(record.larkin_length[index]), 1 if index == WEAK else -1
    radius = 1.06 * record.before.max()
    middle = np.pi / 2 - side * 0.3 * np.pi
    angle = middle + np.linspace(-0.5, 0.5, 20) * length / radius
    axes.plot(
        side * _GAP + radius * np.cos(angle),
        radius * np.sin(angle),
        color=VERMILION,
        linewidth=2.5,
        solid_capstyle="butt",
    )
    axes.annotate(
        r"$\ell$",
        (side * _GAP + radius * np.cos(middle), radius * np.sin(middle)),
        xytext=(6 * side, 4),
        textcoords="offset points",
        ha="center",
        color=VERMILION,
    )


def _finish_quarters(axes: Axes, record: InstabilityRecord) -> None:
    """Limits, names and a scale."""
    reach = 1.04 * record.before.max() + _GAP
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-0.6, 1.28 * reach)
    axes.set_aspect("equal")
    axes.set_axis_off()
    for index, name, side in ((STRONG, "strong", -1), (WEAK, "weak", 1)):
        axes.annotate(
            f"{name} disorder\n"
            rf"$w_\mathrm{{rms}} = {record.rms[index]:.2f}\,w_\mathrm{{int}}$" + "\n"
            rf"Larkin length $\ell = {record.larkin_length[index]:.3f}$",
            (side * reach, 1.28 * reach),
            ha="left" if side < 0 else "right",
            va="top",
        )
    axes.plot(
        [-reach, 0.5 - reach], [-0.12, -0.12], color="black", linewidth=1.2, solid_capstyle="butt"
    )
    axes.annotate(
        r"$0.5\,(3\pi w_\mathrm{int}R^2/4E')^{1/3}$", (-reach, -0.17), va="top", fontsize=6
    )


def _draw_cycle(axes: Axes, record: InstabilityRecord) -> None:
    """Force against radius of the stronger disorder."""
    for direction, colour, name in ((1, BLUE, "approach"), (-1, VERMILION, "retraction")):
        branch = record.state_direction == direction
        radius, force = record.state_radius[branch], record.state_force[branch]
        axes.plot(radius, force, color=colour, linewidth=0.8, label=name)
        ends = [(0.0, 0.0), (radius[0], force[0])]
        if direction < 0:
            ends = [(radius[-1], force[-1]), (0.0, 0.0)]
        _draw_jump(axes, *ends)
    axes.plot([], [], color=PURPLE, linewidth=0.9, label="jumps in and out")
    radius = np.linspace(0.0, 1.6, 200)
    axes.plot(
        radius, jkr.force(radius, 0.0), color="black", linewidth=0.7, label="$b = 0$", zorder=1
    )
    for letter, place, aside in zip("AB", radii_at_zero(record), ((-9, -7), (4, 1)), strict=True):
        force = float(jkr.force(place, 0.0))
        axes.plot(place, force, "o", color="black", markersize=2.8, zorder=5)
        axes.annotate(
            letter, (place, force), xytext=aside, textcoords="offset points", fontweight="bold"
        )
    axes.axhline(0.0, color="0.6", linewidth=0.4, zorder=0)
    axes.set_xlim(0.0, 1.08 * record.state_radius.max())
    axes.set_ylim(1.25 * record.state_force.min(), 0.1)
    axes.legend(loc="lower left")
    axes.set_xlabel(RADIUS_LABEL, fontsize=7)
    axes.set_ylabel(FORCE_LABEL, fontsize=7)


def _draw_jump(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Arrow of an instability of the whole contact."""
    axes.annotate(
        "",
        xy=end,
        xytext=start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": PURPLE,
            "linewidth": 0.9,
            "mutation_scale": 7,
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )
