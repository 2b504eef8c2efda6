"""Figures: SI Fig. S-4 of one case, and the hysteresis of both models against e_el."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.validity import excess_coefficient, shipped_validity
from crackfront.core.arrays import Array
from crackfront.core.variables import AREA, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.fronts import closed_front, label_plane
from crackfront.plots.parts import (
    FORCE_LABEL,
    HEIGHT_LABEL,
    PENETRATION_LABEL,
    label_decimals,
    label_panel,
)
from crackfront.plots.style import (
    BLACK,
    COLOURS,
    MARKERS,
    PAGE,
    blank_figure,
    explain,
    house_style,
)
from studies.boundary_elements.averages import Setting, limit_settings, rough_settings, settings
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import N_ANGLE, PRESSURE, BoundaryCycle
from studies.boundary_elements.edges import CLASSES, EdgeForces
from studies.boundary_elements.front import FrontCycle, shown_states
from studies.boundary_elements.hysteresis import Hysteresis
from studies.paper.drawing import BRANCHES, draw_jump
from studies.records import thinned

_MOST_POINTS = 320
"""Points along a side of the part that is stored; more are thinned out."""

_MARGIN = 0.15
"""Margin of this part around the contact. (Units: reduced lateral length)"""

_RELIEF = "0.78", "1.0"
"""Pale greys of the roughness, so that the tension on it is the darkest."""

_TENSION = "#009E7300", "#009E73C0", "#003D2C"
"""Colours from no tension, which is transparent, to half the largest, which the edge has alone."""

_DASHES = (3, 1.5)
_DOTS = (0.8, 1.6)

_ENERGY_LABEL = r"energy of full conformity $e_\mathrm{el}/w_\mathrm{int}$"

_ASIDE = 0.0025
"""How far ratios at one e_el are set off sideways from each other. (Units: w_int)"""

_LEGEND_ROOM = 1.3
"""Factor by which the axis of the ratios is extended for its legend."""

_RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
"""Labelled ratios of the front to boundary elements."""


@dataclass(frozen=True, slots=True)
class ValidationPicture:
    """Force against penetration of both models, and their contacts at one penetration."""

    short_cutoff: float = variable("shortest wavelength", LATERAL)
    boundary_penetration: Array = variable("penetration", VERTICAL, "boundary")
    boundary_direction: Array = variable("+1 in approach, else -1", "1", "boundary")
    boundary_force: Array = variable("force, boundary elements", FORCE, "boundary")
    boundary_area: Array = variable("contact area", AREA, "boundary")
    front_penetration: Array = variable("penetration", VERTICAL, "front")
    front_direction: Array = variable("+1 in approach, else -1", "1", "front")
    front_force: Array = variable("force, crack front", FORCE, "front")
    front_end: float = variable("penetration at which the front loses contact", VERTICAL)
    shown_penetration: float = variable("penetration of the contacts", VERTICAL)
    angle: Array = variable("angle of a ray", "rad", "angle")
    boundary_radius: Array = variable("perimeters of both branches", LATERAL, "branch", "angle")
    front_radius: Array = variable("fronts of both branches", LATERAL, "branch", "angle")
    fixed_radius: Array = variable("the same, crack does not turn", LATERAL, "branch", "angle")
    position: Array = variable("distance from the apex", LATERAL, "x")
    heights: Array = variable("roughness", VERTICAL, "x", "y")
    pressure: Array = variable("pressure in approach", PRESSURE, "x", "y")


def validation_picture(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, fixed: FrontCycle
) -> ValidationPicture:
    """Picture of one case by boundary elements and by fronts whose crack turns, and does not."""
    states = front.states
    shown = boundary.radius[shown_states(case, boundary)]
    reach = float(np.max(shown)) + _MARGIN
    position: Array = np.arange(float(case.n_point)) * case.pixel - case.side / 2
    inside = np.flatnonzero(np.abs(position) <= reach)
    shown_points = inside[thinned(inside.size, _MOST_POINTS)]
    part = np.ix_(shown_points, shown_points)
    return ValidationPicture(
        short_cutoff=case.short_cutoff,
        boundary_penetration=boundary.penetration,
        boundary_direction=boundary.direction,
        boundary_force=boundary.force,
        boundary_area=boundary.contact_area,
        front_penetration=states.penetration,
        front_direction=states.direction,
        front_force=states.force,
        front_end=front.end,
        shown_penetration=case.loads.shown_penetration,
        angle=2 * np.pi * np.arange(N_ANGLE) / N_ANGLE,
        boundary_radius=shown,
        front_radius=front.radius[shown_states(case, states)],
        fixed_radius=fixed.radius[shown_states(case, fixed.states)],
        position=position[shown_points],
        heights=case.heights()[part],
        pressure=boundary.shown_pressure[0][part],
    )


def validation_figure(picture: ValidationPicture) -> Figure:
    """Force against penetration with its jumps, and the contacts at one penetration."""
    with house_style():
        figure = blank_figure(PAGE, 0.5 * PAGE)
        forces, contact = figure.subplots(1, 2, width_ratios=[1, 1.06])
        _draw_forces(forces, picture)
        _draw_contact(contact, picture)
        label_panel(forces, "a")
        label_panel(contact, "b")
        return figure


def _draw_forces(axes: Axes, picture: ValidationPicture) -> None:
    """Forces of both models, their jumps in and out of contact, and the shown states."""
    axes.axhline(0.0, color="0.7", linewidth=0.4, zorder=1)
    for sign, name, _, colour in BRANCHES:
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
        is_shown = np.isclose(penetration, picture.shown_penetration, atol=1e-9)
        axes.plot(
            penetration[is_shown], force[is_shown], "o", color=colour, markersize=3.6, zorder=4
        )
    _draw_jumps(axes, picture)
    axes.set(xlabel=PENETRATION_LABEL, ylabel=FORCE_LABEL)
    axes.legend(loc="upper left")
    low = min(picture.boundary_force.min(), picture.front_force.min())
    axes.set_ylim(1.1 * low, max(0.75, 1.2 * picture.boundary_force.max()))


def _draw_jumps(axes: Axes, picture: ValidationPicture) -> None:
    """Arrows for the first and the last jump of both models, dashed for the front, in a loop."""
    first, last = np.flatnonzero(picture.boundary_area > 0)[[0, -1]]
    end = last + 1
    if end == picture.boundary_penetration.size:
        return
    theirs, ours = picture.boundary_force, picture.front_force
    for line, place, start, force in (
        ("-", picture.boundary_penetration[first], 0.0, theirs[first]),
        ("-", picture.boundary_penetration[end], theirs[last], 0.0),
        ((0, _DASHES), picture.front_penetration[0], 0.0, ours[0]),
        ((0, _DASHES), picture.front_end, ours[-1], 0.0),
    ):
        style: dict[str, Any] = {"linewidth": 0.8, "linestyle": line, "mutation_scale": 7}
        draw_jump(axes, (place, start), (place, force), "0.25", **style)


def _draw_contact(axes: Axes, picture: ValidationPicture) -> None:
    """Topography, tension in approach, and the fronts of both branches."""
    reach = float(picture.position[-1])
    extent = (float(picture.position[0]), reach, float(picture.position[0]), reach)
    relief = axes.imshow(
        picture.heights.T,
        extent=extent,
        origin="lower",
        cmap=LinearSegmentedColormap.from_list("relief", _RELIEF),
        interpolation="bilinear",
    )
    tension = np.maximum(-picture.pressure, 0.0)
    axes.imshow(
        tension.T,
        extent=extent,
        origin="lower",
        cmap=LinearSegmentedColormap.from_list("tension", _TENSION),
        vmin=0.0,
        vmax=float(tension.max()) / 2,
        interpolation="nearest",
    )
    # The approach is wider, so that it is seen where both branches have one contact.
    for line, ((*_, colour), width) in enumerate(zip(BRANCHES, (2.0, 0.8), strict=True)):
        for radius, style in ((picture.front_radius, _DASHES), (picture.fixed_radius, _DOTS)):
            # Dashes are in widths of the line; both branches get dashes of one length.
            dashes = [part / width for part in style]
            curve = closed_front(picture.angle, radius[line])
            axes.plot(*curve, color=colour, linewidth=width, dashes=dashes)
    handles = [
        Line2D([], [], color=_TENSION[-1], linewidth=3, label="tension in approach"),
        Line2D([], [], color=BLACK, dashes=_DASHES, label="front, crack turns"),
        Line2D([], [], color=BLACK, dashes=_DOTS, label="front, crack fixed"),
        *(Line2D([], [], color=colour, label=f"in {name}") for _, name, _, colour in BRANCHES),
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
    axes.set(xlim=extent[:2], ylim=extent[2:])
    label_plane(axes)


def hysteresis_figure(rows: Sequence[Hysteresis], short_cutoff: float) -> Figure:
    """Extrapolated hysteresis of both models against e_el, and the ratio of the two with its law.

    Ratios at the ranges that were computed are small and open; single surfaces are left out.
    """
    limits = rough_settings(limit_settings(rows))
    computed = [setting for setting in rough_settings(settings(rows)) if setting.surfaces > 1]
    shapes = sorted({_shape(setting) for setting in limits})
    with house_style():
        figure = blank_figure(PAGE, 0.48 * PAGE)
        values, ratios = figure.subplots(1, 2)
        for number, shape in enumerate(shapes):
            near = [setting for setting in computed if _shape(setting) == shape]
            far = [setting for setting in limits if _shape(setting) == shape]
            look = {"color": COLOURS[number], "marker": MARKERS[number], "linewidth": 0.8}
            spectrum = _spectrum(far[0].rows[0], short_cutoff)
            _draw_models(values, far, spectrum, look)
            sideways = number - (len(shapes) - 1) / 2
            _draw_ratios(ratios, near, far, sideways, spectrum, look)
        _draw_ratio_law(ratios)
        for axes, panel in ((values, "a"), (ratios, "b")):
            axes.set(xlim=(0.0, None), xlabel=_ENERGY_LABEL)
            axes.legend(loc="upper left")
            label_panel(axes, panel)
        values.set(ylim=(0.0, None), ylabel=r"hysteresis / $w_\mathrm{int}$")
        _set_ratio_axis(ratios)
        explain(figure, _ranges_explained(computed))
        return figure


def _shape(setting: Setting) -> tuple[float, ...]:
    """Roll-off and Hurst exponent of the surfaces of a setting."""
    return setting.rows[0].roll_off, setting.rows[0].hurst


def _set_ratio_axis(axes: Axes) -> None:
    """Logarithmic ordinate of ratios, with room for the legend."""
    axes.set_ylabel("hysteresis, front / boundary elements")
    axes.set_yscale("log")
    label_decimals(axes.yaxis, FixedLocator(_RATIOS))
    axes.minorticks_off()
    axes.set_ylim(top=_LEGEND_ROOM * axes.get_ylim()[1])


def _draw_models(axes: Axes, far: Sequence[Setting], spectrum: str, look: dict[str, Any]) -> None:
    """Hysteresis of both models on surfaces of one spectrum."""
    for model, name, style in (
        ("front", "front", {"markerfacecolor": "white", "linestyle": "--"}),
        ("boundary", "boundary elements", {}),
    ):
        hysteresis = [setting.mean(attrgetter(f"{model}_difference")) for setting in far]
        _draw_estimates(axes, far, hysteresis, label=f"{name}, {spectrum}", **look, **style)


def _draw_ratios(
    axes: Axes,
    near: Sequence[Setting],
    far: Sequence[Setting],
    sideways: float,
    spectrum: str,
    look: dict[str, Any],
) -> None:
    """Ratios on surfaces of one spectrum: at every computed range, then at none.

    `sideways` is the place of the spectrum next to the others.
    """
    ranges = _ranges(near)
    small = {"markerfacecolor": "white", "markersize": 2.4}
    groups = [
        ([setting for setting in near if setting.rows[0].interaction_range == reach], small)
        for reach in ranges
    ]
    groups.append((list(far), {"label": spectrum}))
    for place, (alike, style) in enumerate(groups):
        aside = _ASIDE * (sideways * len(groups) + place - len(ranges) / 2)
        energies = [float(setting.mean(attrgetter("elastic_energy")).value) for setting in alike]
        logarithms = [setting.excess(0.0) for setting in alike]
        middle = np.array([float(logarithm.value) for logarithm in logarithms])
        error = np.array([float(logarithm.standard_error) for logarithm in logarithms])
        ratio = np.exp(middle)
        axes.errorbar(
            np.array(energies) + aside,
            ratio,
            yerr=(ratio - np.exp(middle - error), np.exp(middle + error) - ratio),
            **look | style | {"linestyle": "none"},
        )


def _draw_ratio_law(axes: Axes) -> None:
    """The law by which predictions are divided, with its standard error, and equal models."""
    coefficient, error = excess_coefficient(shipped_validity())
    energy = np.linspace(0.0, axes.get_xlim()[1], 100)
    label = rf"law $\exp({coefficient:.2f}\,e_\mathrm{{el}}/w_\mathrm{{int}})$"
    axes.plot(energy, np.exp(coefficient * energy), color=BLACK, zorder=1, label=label)
    low, high = (np.exp((coefficient + sign * error) * energy) for sign in (-1, 1))
    axes.fill_between(energy, low, high, color="0.88", linewidth=0, zorder=0)
    axes.axhline(1.0, color="0.5", linewidth=0.5, zorder=0)
    axes.set_xlim(0.0, energy[-1])


def _ranges(computed: Sequence[Setting]) -> list[float]:
    """Ranges of the attraction, from the longest to the shortest."""
    return sorted({setting.rows[0].interaction_range for setting in computed}, reverse=True)


def _ranges_explained(computed: Sequence[Setting]) -> str:
    """Explanation of the symbols of the ratios."""
    ranges = " and ".join(f"{reach:g}" for reach in _ranges(computed))
    small = f"small: at the ranges {ranges}, from left to right; " if ranges else ""
    return f"b: {small}large: at no range; bars and grey: one standard error"


def _spectrum(row: Hysteresis, short_cutoff: float) -> str:
    """Name of the spectrum of a surface in a legend."""
    if row.roll_off == short_cutoff:
        return rf"flat, $\lambda_\mathrm{{s}} = {short_cutoff:g}$"
    return rf"$\lambda_\mathrm{{r}} = {row.roll_off:g}$, $H = {row.hurst:g}$"


def _draw_estimates(
    axes: Axes, shown_settings: Sequence[Setting], estimates: Sequence[Estimate], **style: Any
) -> None:
    """Values against e_el with their standard errors, if there is more than one surface."""
    axes.errorbar(
        [float(setting.mean(attrgetter("elastic_energy")).value) for setting in shown_settings],
        [float(estimate.value) for estimate in estimates],
        yerr=[float(estimate.standard_error) for estimate in estimates],
        **style,
    )


def edge_figure(rows: Sequence[EdgeForces]) -> Figure:
    """What is not balanced against e_el, and the force that the line has at the shortest range."""
    with house_style():
        figure = blank_figure(PAGE, 0.46 * PAGE)
        imbalances, forces = figure.subplots(1, 2)
        _draw_imbalances(imbalances, rows)
        _draw_line_forces(forces, rows)
        for axes, panel in ((imbalances, "a"), (forces, "b")):
            axes.legend(loc="upper left")
            label_panel(axes, panel)
        imbalances.get_legend().set_title(HEIGHT_LABEL.format("range of attraction"))
        explain(
            figure,
            "one surface, and therefore no bars over surfaces; "
            f"b: means over {CLASSES} classes of sites; grey: both forces are equal",
        )
        return figure


def _draw_imbalances(axes: Axes, rows: Sequence[EdgeForces]) -> None:
    """Rms force that is left over the rms pinning, against e_el, for both ranges."""
    ranges = sorted({row.interaction_range for row in rows})
    for reach, face in zip(ranges, (BLACK, "white"), strict=False):
        alike = [row for row in rows if row.interaction_range == reach]
        alike.sort(key=attrgetter("elastic_energy"))
        axes.plot(
            [row.elastic_energy for row in alike],
            [row.left / row.pinning for row in alike],
            "o-",
            color=BLACK,
            linewidth=0.6,
            markerfacecolor=face,
            label=f"{reach:g}",
        )
    axes.set(
        xlim=(0.0, 1.1 * max(row.elastic_energy for row in rows)),
        ylim=(0.0, 1.1 * max(row.left / row.pinning for row in rows)),
        xlabel=_ENERGY_LABEL,
        ylabel="rms force left / rms pinning",
    )


def _draw_line_forces(axes: Axes, rows: Sequence[EdgeForces]) -> None:
    """Needed force of the line against the force of first order, at the shortest range."""
    shortest = min(row.interaction_range for row in rows)
    alike = [row for row in rows if row.interaction_range == shortest]
    for row, colour, marker in zip(alike, COLOURS, MARKERS, strict=False):
        label = rf"$e_\mathrm{{el}} = {row.elastic_energy:.2f}\,w_\mathrm{{int}}$"
        axes.plot(row.line, row.needed, marker, color=colour, label=label)
    axes.axline((0.0, 0.0), slope=1.0, color="0.6", linewidth=0.8, zorder=0)
    axes.set(
        xlabel=r"force of the line, first order / $w_\mathrm{int}$",
        ylabel=r"force that balances the others / $w_\mathrm{int}$",
    )
