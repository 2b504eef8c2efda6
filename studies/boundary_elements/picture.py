"""SI Fig. cf-bem: forces and contacts of one case by boundary elements and by the front."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crackfront.core.variables import FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.parts import FORCE_LABEL, HEIGHT_LABEL, PENETRATION_LABEL, label_panel
from crackfront.plots.style import BLACK, BLUE, PAGE, VERMILION, blank_figure, house_style
from studies.boundary_elements.cycle import N_ANGLE, BoundaryCycle
from studies.boundary_elements.front import FrontCycle, perimeter_at
from studies.boundary_elements.parameters import Case

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_MOST_POINTS = 320
"""Points along a side of the part that is kept."""

_MARGIN = 0.15
"""What is shown beyond the contact (Units: reduced lateral length)."""


_TENSION = "#009E7300", "#009E73C0", "#003D2C"
"""Colours from no tension, which is transparent, to the largest."""

_DASHES = (3, 1.5)
_DOTS = (0.8, 1.6)
_BRANCHES = ((1, "approach", BLUE), (-1, "retraction", VERMILION))


@dataclass(frozen=True, slots=True)
class ValidationPicture:
    """Force against penetration of both models, and their contacts at one penetration."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity that was asked for", "w_int")
    short_cutoff: float = variable("shortest wavelength", LATERAL)
    boundary_penetration: Array = variable("penetration", VERTICAL, "boundary")
    boundary_direction: NDArray[np.int64] = variable("+1 in approach, else -1", "1", "boundary")
    boundary_force: Array = variable("force, boundary elements", FORCE, "boundary")
    boundary_area: Array = variable("contact area", f"({LATERAL})^2", "boundary")
    front_penetration: Array = variable("penetration", VERTICAL, "front")
    front_direction: NDArray[np.int64] = variable("+1 in approach, else -1", "1", "front")
    front_force: Array = variable("force, crack front", FORCE, "front")
    front_area: Array = variable("contact area", f"({LATERAL})^2", "front")
    front_end: float = variable("penetration at which the front loses contact", VERTICAL)
    shown_penetration: float = variable("penetration of the contacts", VERTICAL)
    angle: Array = variable("angle of a ray", "rad", "angle")
    boundary_radius: Array = variable(
        "perimeters, approach and retraction", LATERAL, "branch", "angle"
    )
    front_radius: Array = variable("fronts, approach and retraction", LATERAL, "branch", "angle")
    fixed_radius: Array = variable(
        "fronts whose crack does not turn, approach and retraction", LATERAL, "branch", "angle"
    )
    position: Array = variable("distance from the apex", LATERAL, "x")
    heights: NDArray[np.float32] = variable("roughness", VERTICAL, "x", "y")
    pressure: NDArray[np.float32] = variable(
        "pressure in approach", f"{FORCE} / ({LATERAL})^2", "x", "y"
    )


def validation_picture(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, fixed: FrontCycle
) -> ValidationPicture:
    """Picture of one case by boundary elements and by fronts whose crack turns, and does not."""
    states = front.states
    shown, turning, still = (
        np.stack([perimeter_at(case.shown_penetration, sign, *model) for sign in (1, -1)])
        for model in (
            (boundary, boundary.radius),
            (states, front.radius),
            (fixed.states, fixed.radius),
        )
    )
    reach = float(np.max(shown)) + _MARGIN
    position: Array = np.arange(float(case.n_point)) * case.pixel - case.side / 2
    inside = np.flatnonzero(np.abs(position) <= reach)
    kept = inside[:: max(1, -(-inside.size // _MOST_POINTS))]
    part = np.ix_(kept, kept)
    return ValidationPicture(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=case.elastic_energy,
        short_cutoff=case.short_cutoff,
        boundary_penetration=boundary.penetration,
        boundary_direction=boundary.direction,
        boundary_force=boundary.force,
        boundary_area=boundary.contact_area,
        front_penetration=states.penetration,
        front_direction=states.direction,
        front_force=states.force,
        front_area=states.contact_area,
        front_end=front.end,
        shown_penetration=case.shown_penetration,
        angle=2 * np.pi * np.arange(N_ANGLE) / N_ANGLE,
        boundary_radius=shown,
        front_radius=turning,
        fixed_radius=still,
        position=position[kept],
        heights=case.heights()[part].astype(np.float32),
        pressure=boundary.shown_pressure[0][part],
    )


def validation_figure(picture: ValidationPicture) -> Figure:
    """Force against penetration with its jumps, and the contacts at one penetration."""
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        grid = figure.add_gridspec(1, 2, width_ratios=[1, 1.06])
        parts = grid[0].subgridspec(2, 1, height_ratios=[3.2, 1])
        upper = figure.add_subplot(parts[0])
        lower = figure.add_subplot(parts[1], sharex=upper)
        contact = figure.add_subplot(grid[1])
        _draw_forces(upper, picture)
        _draw_differences(lower, picture)
        _draw_contact(contact, picture)
        label_panel(upper, "a")
        label_panel(contact, "b")
        return figure


def _draw_forces(axes: Axes, picture: ValidationPicture) -> None:
    """Forces of both models, their jumps in and out of contact, and the shown states."""
    axes.axhline(0.0, color="0.7", linewidth=0.4, zorder=1)
    for sign, name, colour in _BRANCHES:
        branch = (picture.boundary_direction == sign) & (picture.boundary_area > 0)
        axes.plot(
            picture.boundary_penetration[branch],
            picture.boundary_force[branch],
            color=colour,
            linewidth=1.6,
            alpha=0.55,
            label=f"boundary elements, {name}",
        )
        branch = picture.front_direction == sign
        penetration, force = picture.front_penetration[branch], picture.front_force[branch]
        axes.plot(
            penetration, force, color=colour, linewidth=0.8, dashes=_DASHES, label=f"front, {name}"
        )
        here = np.isclose(penetration, picture.shown_penetration, atol=1e-9)
        axes.plot(penetration[here], force[here], "o", color=colour, markersize=3.6, zorder=4)
    for dashed, (place, start, end) in _jumps(picture):
        axes.annotate(
            "",
            xy=(place, end),
            xytext=(place, start),
            arrowprops={
                "arrowstyle": "-|>",
                "color": "0.25",
                "linewidth": 0.8,
                "linestyle": (0, _DASHES) if dashed else "-",
                "mutation_scale": 7,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )
    axes.tick_params(labelbottom=False)
    axes.set_ylabel(FORCE_LABEL)
    axes.legend(loc="upper left")
    low = min(picture.boundary_force.min(), picture.front_force.min())
    axes.set_ylim(1.1 * low, max(0.75, 1.2 * picture.boundary_force.max()))


def _jumps(picture: ValidationPicture) -> list[tuple[bool, tuple[float, float, float]]]:
    """Penetration, force before and force after the first and the last jump of both models."""
    touching = np.flatnonzero(picture.boundary_area > 0)
    first, last = touching[0], touching[-1]
    end = min(last + 1, picture.boundary_penetration.size - 1)
    return [
        (False, (picture.boundary_penetration[first], 0.0, picture.boundary_force[first])),
        (False, (picture.boundary_penetration[end], picture.boundary_force[last], 0.0)),
        (True, (picture.front_penetration[0], 0.0, picture.front_force[0])),
        (True, (picture.front_end, picture.front_force[-1], 0.0)),
    ]


def _draw_differences(axes: Axes, picture: ValidationPicture) -> None:
    """Differences of the forces where both models have contact."""
    from matplotlib.ticker import MaxNLocator

    axes.axhline(0.0, color="0.7", linewidth=0.4, zorder=1)
    for sign, _, colour in _BRANCHES:
        mine = picture.front_direction == sign
        other = (picture.boundary_direction == sign) & (picture.boundary_area > 0)
        shared, here, there = np.intersect1d(
            np.round(picture.boundary_penetration[other], 9),
            np.round(picture.front_penetration[mine], 9),
            return_indices=True,
        )
        difference = picture.boundary_force[other][here] - picture.front_force[mine][there]
        axes.plot(shared, difference, color=colour, linewidth=0.8)
    axes.set_xlabel(PENETRATION_LABEL)
    axes.set_ylabel("difference /\n$\\pi w_\\mathrm{int} R$", fontsize=7)
    axes.yaxis.set_major_locator(MaxNLocator(3, symmetric=True))


def _draw_contact(axes: Axes, picture: ValidationPicture) -> None:
    """Topography, tension in approach, and the fronts of both branches."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.lines import Line2D

    from crackfront.plots.fronts import closed_front, label_plane

    reach = float(picture.position[-1])
    extent = (float(picture.position[0]), reach, float(picture.position[0]), reach)
    relief = axes.imshow(
        picture.heights.T, extent=extent, origin="lower", cmap="gray", interpolation="bilinear"
    )
    tension = np.maximum(-picture.pressure, 0.0)
    axes.imshow(
        tension.T,
        extent=extent,
        origin="lower",
        cmap=LinearSegmentedColormap.from_list("tension", _TENSION),
        vmin=0.0,
        vmax=float(tension.max()),
        interpolation="nearest",
    )
    # Where both branches have one contact, that of the approach is seen on both sides of the other.
    for line, ((_, _, colour), width) in enumerate(zip(_BRANCHES, (2.0, 0.8), strict=True)):
        for radius, style in ((picture.front_radius, _DASHES), (picture.fixed_radius, _DOTS)):
            # Dashes are in widths of the line: those of both branches have one length.
            dashes = [part / width for part in style]
            curve = closed_front(picture.angle, radius[line])
            axes.plot(*curve, color=colour, linewidth=width, dashes=dashes)
    handles = [
        Line2D([], [], color=_TENSION[-1], linewidth=3, label="tension in approach"),
        Line2D([], [], color=BLACK, dashes=_DASHES, label="front, crack turns"),
        Line2D([], [], color=BLACK, dashes=_DOTS, label="front, crack fixed"),
        *(Line2D([], [], color=colour, label=f"in {name}") for _, name, colour in _BRANCHES),
    ]
    axes.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.55, 1.0),
        ncols=2,
        columnspacing=1.2,
        title=rf"$b = {picture.shown_penetration:g}$",
    )
    label = HEIGHT_LABEL.format("roughness")
    axes.figure.colorbar(relief, cax=axes.inset_axes((1.03, 0.0, 0.04, 1.0)), label=label)
    axes.set_xlim(extent[:2])
    axes.set_ylim(extent[2:])
    label_plane(axes)
