"""Figures of a validation by amplitude: what the front's hysteresis is worth, and one contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crackfront.core.variables import LATERAL, VERTICAL, variable
from crackfront.plots.parts import label_panel
from crackfront.plots.style import (
    BLACK,
    BLUE,
    COLOURS,
    MARKERS,
    PAGE,
    VERMILION,
    blank_figure,
    house_style,
)
from studies.boundary_elements.amplitudes import regions
from studies.boundary_elements.averages import Model, Setting
from studies.boundary_elements.cycle import N_ANGLE, BoundaryCycle
from studies.boundary_elements.front import FrontCycle, shared_states
from studies.boundary_elements.parameters import Case

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_MARGIN = 0.15
"""What is shown beyond the contact (Units: reduced lateral length)."""

OPEN, CLOSED, OPEN_INSIDE, CLOSED_OUTSIDE = range(4)
"""Both models open, both closed, boundary elements open, boundary elements closed."""

_SHADES = ("white", "0.85", VERMILION, BLUE)


@dataclass(frozen=True, slots=True)
class AmplitudePicture:
    """Contacts of both models on one surface, in the middle of approach and of retraction."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity that was asked for", "w_int")
    short_cutoff: float = variable("shortest wavelength", LATERAL)
    penetration: Array = variable("penetration", VERTICAL, "branch")
    position: Array = variable("distance from the apex", LATERAL, "x")
    contact: NDArray[np.int8] = variable(
        "0 open, 1 closed, 2 within the front but open, 3 outside the front but closed",
        "1",
        "branch",
        "x",
        "y",
    )
    angle: Array = variable("angle of a ray", "rad", "angle")
    front_radius: Array = variable("fronts", LATERAL, "branch", "angle")


def amplitude_picture(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> AmplitudePicture:
    """Picture of one case in the middle of both branches."""
    theirs, ours = shared_states(boundary, front.states)
    middles = []
    for sign in (1, -1):
        branch = np.flatnonzero(boundary.direction[theirs] == sign)
        middles.append(int(branch[branch.size // 2]))
    places = theirs[middles]
    shown = front.radius[ours[middles]]
    position: Array = (np.arange(float(case.n_point)) - case.n_point // 2) * case.pixel
    reach = float(max(np.max(shown), np.max(boundary.radius[places]))) + _MARGIN
    kept = np.flatnonzero(np.abs(position) <= reach)
    contacts = []
    for place, edge in zip(places.tolist(), shown, strict=True):
        closed = boundary.closed_at(place)
        found = regions(closed, boundary.radius[place], edge, case.pixel)
        contact = found.inside.astype(np.int8)
        contact[found.open_inside] = OPEN_INSIDE
        contact[found.closed_outside] = CLOSED_OUTSIDE
        contacts.append(contact[np.ix_(kept, kept)])
    return AmplitudePicture(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=case.elastic_energy,
        short_cutoff=case.short_cutoff,
        penetration=boundary.penetration[places],
        position=position[kept],
        contact=np.stack(contacts),
        angle=2 * np.pi * np.arange(N_ANGLE) / N_ANGLE,
        front_radius=shown,
    )


def contact_figure(picture: AmplitudePicture) -> Figure:
    """Both contacts, and where the models differ."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    from crackfront.plots.fronts import closed_front, label_plane

    reach = float(picture.position[-1])
    extent = (float(picture.position[0]), reach, float(picture.position[0]), reach)
    with house_style():
        figure = blank_figure(PAGE, 0.56 * PAGE)
        both = figure.subplots(1, 2, sharey=True)
        for branch, (axes, name) in enumerate(zip(both, ("approach", "retraction"), strict=True)):
            axes.imshow(
                picture.contact[branch].T,
                extent=extent,
                origin="lower",
                cmap=ListedColormap(_SHADES),
                vmin=-0.5,
                vmax=3.5,
                interpolation="nearest",
            )
            curve = closed_front(picture.angle, picture.front_radius[branch])
            axes.plot(*curve, color=BLACK, linewidth=0.7)
            axes.set_title(f"{name}, $b = {picture.penetration[branch]:.2g}$")
            label_plane(axes)
            label_panel(axes, "ab"[branch])
        both[1].set_ylabel("")
        names = ("closed in both", "open, within the front", "closed, outside the front")
        handles = [
            Patch(facecolor=shade, edgecolor="0.3", linewidth=0.4, label=name)
            for shade, name in zip(_SHADES[1:], names, strict=True)
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        return figure


def validity_figure(found: Sequence[Setting], shown: Sequence[Setting]) -> Figure:
    """Hysteresis of both models against e_el, and the ratio of the two.

    Parameters
    ----------
    found : sequence of Setting
        Every setting; its ratio is drawn small and open.
    shown : sequence of Setting
        Those extrapolated to a vanishing range, whose hystereses are drawn.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.42 * PAGE)
        both = figure.subplots(1, 2)
        _draw_hystereses(both[0], shown)
        _draw_ratios(both[1], found, shown)
        for axes, name in zip(both, "ab", strict=True):
            axes.set_xlim(0.0, None)
            axes.set_xlabel(r"$e_\mathrm{el}/w_\mathrm{int}$")
            label_panel(axes, name)
        return figure


def _spectra(found: Sequence[Setting]) -> list[tuple[float, float]]:
    """Spectra, in the order of their roll-off."""
    return sorted({(one.rows[0].roll_off, one.rows[0].hurst) for one in found})


def _draw_hystereses(axes: Axes, shown: Sequence[Setting]) -> None:
    """Means over the surfaces with their intervals; boundary elements filled, the front open."""
    for number, spectrum in enumerate(_spectra(shown)):
        ours = [one for one in shown if one.rows[0].scene[:2] == spectrum]
        energy = [float(one.mean(lambda row: row.elastic_energy).value) for one in ours]
        models: tuple[tuple[Model, str], ...] = ("boundary", COLOURS[number]), ("front", "white")
        for model, face in models:
            estimates = [one.hysteresis(model) for one in ours]
            named = "boundary elements" if model == "boundary" else "front"
            axes.errorbar(
                energy,
                [float(one.value) for one in estimates],
                yerr=[np.nan_to_num(float(one.standard_error)) for one in estimates],
                color=COLOURS[number],
                marker=MARKERS[number],
                markerfacecolor=face,
                linewidth=0.8,
                linestyle="-" if model == "boundary" else "--",
                label=f"{named}, {spectrum_name(*spectrum)}",
            )
    axes.set_ylim(0.0, None)
    axes.set_ylabel(r"hysteresis / $w_\mathrm{int}$")
    axes.legend(loc="upper left")


def spectrum_name(roll_off: float, hurst: float) -> str:
    """A spectrum in words."""
    return rf"$\lambda_r = {roll_off:g}$, $H = {hurst:g}$"


def _draw_ratios(axes: Axes, found: Sequence[Setting], shown: Sequence[Setting]) -> None:
    """Ratios with their standard errors, and the bands of 10% and of 25%."""
    for part, grey in ((0.25, "0.93"), (0.10, "0.85")):
        axes.axhspan(1 - part, 1 + part, color=grey, linewidth=0, zorder=0)
        axes.text(
            0.01,
            1 + part,
            f"{part:.0%}",
            ha="left",
            va="top",
            transform=axes.get_yaxis_transform(),
        )
    axes.axhline(1.0, color="0.4", linewidth=0.5)
    for number, spectrum in enumerate(_spectra(shown)):
        for many, size, face in ((found, 2.4, "white"), (shown, 4.2, COLOURS[number])):
            ours = [one for one in many if one.rows[0].scene[:2] == spectrum]
            ratios = [one.hysteresis_ratio() for one in ours]
            axes.errorbar(
                [float(one.mean(lambda row: row.elastic_energy).value) for one in ours],
                [float(one.value) for one in ratios],
                yerr=[np.nan_to_num(float(one.standard_error)) for one in ratios],
                color=COLOURS[number],
                marker=MARKERS[number],
                markersize=size,
                markerfacecolor=face,
                linewidth=0.6,
                linestyle="none",
                label=spectrum_name(*spectrum) if many is shown else None,
            )
    axes.set_ylabel("hysteresis, front / boundary elements")
    axes.legend(loc="upper left")
