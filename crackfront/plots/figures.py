"""Figures of surfaces, loops, fronts and instabilities, each on axes that are given or new.

What is in SI units is drawn in them.
"""

from __future__ import annotations

import math
from contextlib import AbstractContextManager, nullcontext
from numbers import Integral

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataArray, Dataset

from crackfront.core.arguments import refuse_other_type
from crackfront.core.arrays import Array
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.density_axes import draw_spectrum
from crackfront.plots.fronts import draw_field, draw_fronts, draw_heights, draw_straight_fronts
from crackfront.plots.instability_maps import draw_instabilities
from crackfront.plots.loop_figures import draw_loop, draw_pinning
from crackfront.plots.style import COLUMN, blank_figure, house_style, shown_axes
from crackfront.simulate.cycle_files import cycle_record
from crackfront.surfaces.random_surface import stated_spectrum
from crackfront.surfaces.si_units import Labelled, in_reduced_units, stated_scales
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.surface_array import surface_kind
from crackfront.surfaces.tile_measures import tile_modes

_ORDERS = (0.0, 0.5, 1.0)
_REST = 0.1
"""Part of a mean square below, and above, the scales that dominate it."""

_BINS_A_DECADE = 20


def _drawing(axes: Axes | None) -> AbstractContextManager[Axes]:
    """Given axes in the style that they have, or new ones in that of the package."""
    refuse_other_type(
        "axes", axes, (Axes, type(None)), "one Axes of matplotlib, as axes[0] of several"
    )
    return shown_axes() if axes is None else nullcontext(axes)


def _reduced(data: Labelled) -> tuple[Labelled, AxisUnits]:
    """Data in reduced units, and the units that they had."""
    scales = stated_scales(data)
    if scales is None:
        return data, REDUCED
    return in_reduced_units(data, scales), AxisUnits(scales)


def _refuse_no_loop(loop: object) -> None:
    """Raise TypeError if an argument is no loop."""
    wanted = "an xarray.Dataset, as run_loop returns it or crackfront cycle has written it"
    refuse_other_type("loop", loop, Dataset, wanted)


def _refuse_no_state(loop: Dataset, name: str) -> None:
    """Raise if the values of a name have no number, or no direction that goes with it."""
    known = np.isfinite(loop[name].values) & np.isfinite(loop.direction.values)
    if not np.any(known):
        raise ValueError(f"{name} of the loop has no finite value to plot; give another loop")


def _fronts(loop: Dataset, name: str, site: str) -> tuple[Array, Array, NDArray[np.int64]]:
    """Places of sites, fronts over (step, site) and directions; ValueError if one is missing."""
    if missing := [one for one in (site, "direction") if one not in loop]:
        raise ValueError(f"the loop lacks {', '.join(missing)}; give it as run_loop returned it")
    fronts, direction = loop[name], loop.direction
    if {*fronts.dims} != {"step", site} or direction.dims != ("step",):
        raise ValueError(
            f"{name} has the dimensions ({', '.join(map(str, fronts.dims))}); a loop has step and "
            f"{site}: keep a single state as a list, as in loop.isel(step=[0])"
        )
    fronts = fronts.transpose("step", site)
    if not np.all(np.isfinite(fronts)):
        raise ValueError(f"{name} holds values that are not finite; drop these states")
    return loop[site].values, fronts.values, direction.values


def plot_surface(surface: DataArray, axes: Axes | None = None) -> Axes:
    """Heights, or works of adhesion, on the tile.

    Parameters
    ----------
    surface : xarray.DataArray
        A surface in reduced units, or what :func:`in_si_units` made of it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default axes of a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes that it is drawn on.

    Raises
    ------
    ValueError
        If the surface cannot be used.
    TypeError
        If an argument is of another type.
    """
    kind = surface_kind(surface)
    surface, units = _reduced(surface)
    adhesion = surface_adhesion(surface)
    x, y = surface.x.values, surface.y.values
    with _drawing(axes) as drawn:
        if kind == "roughness":
            draw_heights(drawn, x, y, surface.transpose("x", "y").values, units)
        else:
            values = adhesion.work_of_adhesion / WORK_OF_ADHESION
            draw_field(drawn, x, y, values, 1.0, 2 * adhesion.w_rms, units)
    return drawn


def plot_spectrum(surface: DataArray, axes: Axes | None = None) -> Axes:
    """Isotropic power spectrum of a rough surface, with the scales that dominate it.

    A bar spans the wavevectors that carry 80% of the mean square of heights, half-derivatives (and
    with them e_el) or slopes. The spectrum that the surface states is drawn beside it, if its e_el
    is still that of the heights within a factor of two.

    Parameters
    ----------
    surface, axes : optional
        As of :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes that it is drawn on.

    Raises
    ------
    ValueError
        If the surface cannot be used, is not one of heights, or is flat.
    TypeError
        If an argument is of another type.
    """
    if surface_kind(surface) != "roughness":
        raise ValueError(f"{surface.name} has no height spectrum; plot that of height(x, y)")
    surface, units = _reduced(surface)
    adhesion = surface_adhesion(surface)
    pixel = adhesion.pixel
    modes = tile_modes(surface.transpose("x", "y").values, pixel)
    if modes.power.size == 0:
        raise ValueError("the surface is flat; it has no spectrum to plot")
    wavevector, density = modes.isotropic_density(_BINS_A_DECADE, pixel**2 * surface.size)
    shares = np.array([modes.power * modes.wavevector ** (2 * order) for order in _ORDERS])
    totals = np.cumsum(shares, axis=1)
    ends = [np.searchsorted(one, one[-1] * np.array([1 - _REST, _REST])) for one in totals]
    shortest, longest = (2 * np.pi / modes.wavevector[np.array(ends)]).T
    shape, energy = stated_spectrum(surface), surface.attrs.get("elastic_energy_requested")
    ideal = None
    # Heights that were multiplied keep the attributes, and have another spectrum.
    if shape is not None and energy is not None and 0.5 < adhesion.e_el / float(energy) < 2:
        ideal = shape.with_elastic_energy(float(energy)).density(wavevector)
    rms = np.sqrt(totals[:, -1])
    with _drawing(axes) as drawn:
        draw_spectrum(drawn, wavevector, density, rms, shortest, longest, ideal, units)
    return drawn


def plot_loop(loop: Dataset, axes: Axes | None = None) -> Axes:
    """Force against mean radius, between the JKR curves of both branches and those of the paper.

    Of a straight front it is the force of its springs against their place.

    Parameters
    ----------
    loop : xarray.Dataset
        What :func:`run_loop` has returned or `crackfront cycle` written, in reduced units or in SI.
    axes : matplotlib.axes.Axes, optional
        As of :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes that it is drawn on.

    Raises
    ------
    ValueError
        If it is no loop, or holds no state.
    TypeError
        If an argument is of another type.
    """
    _refuse_no_loop(loop)
    if "pinning_force" in loop:
        states = cycle_record(loop).states
        _refuse_no_state(loop, "pinning_force")
        with _drawing(axes) as drawn:
            draw_pinning(drawn, states)
        return drawn
    loop, units = _reduced(loop)
    states = cycle_record(loop).states
    _refuse_no_state(loop, "force")
    names = "w_appr", "w_retr", "lowest_radius", "highest_radius", "e_el"
    # A loop on rays has no such measures.
    w_appr, w_retr, lowest, highest, energy = (float(loop.get(name, math.nan)) for name in names)
    measures = (w_appr, w_retr), (lowest, highest)
    kind = loop.attrs.get("kind", "roughness")
    with _drawing(axes) as drawn:
        draw_loop(drawn, states, *measures, elastic_energy=energy, kind=kind, units=units)
    return drawn


def loop_figure(loop: Dataset) -> Figure:
    """Figure of :func:`plot_loop` for print, a column wide."""
    with house_style():
        figure = blank_figure(COLUMN, 0.82 * COLUMN)
        plot_loop(loop, figure.add_subplot())
        return figure


def plot_fronts(
    loop: Dataset, surface: DataArray | None = None, axes: Axes | None = None, most: int = 12
) -> Axes:
    """Fronts of both branches, over the work of adhesion that pins them if the surface is given.

    Parameters
    ----------
    loop : xarray.Dataset
        As of :func:`plot_loop`, with its fronts.
    surface : xarray.DataArray, optional
        As of :func:`plot_surface`, in the units of the loop or in others; none for straight fronts.
    axes : matplotlib.axes.Axes, optional
        As of :func:`plot_surface`.
    most : int, optional
        Largest number of fronts that are drawn of a branch.

    Returns
    -------
    matplotlib.axes.Axes
        The axes that they are drawn on.

    Raises
    ------
    ValueError
        If loop or surface cannot be used, or the loop holds no fronts.
    TypeError
        If an argument is of another type.
    """
    _refuse_no_loop(loop)
    if isinstance(surface, Axes):
        raise TypeError("surface is axes of matplotlib; give them by name, as axes=...")
    if ("radius" not in loop and "position" not in loop) or loop.sizes.get("step") == 0:
        raise ValueError(
            "the loop holds no fronts; run it with fronts=True, or crackfront cycle with "
            "--record fronts"
        )
    refuse_other_type("most", most, Integral, "a whole number")
    if most < 1:
        raise ValueError(f"most is {most}; draw 1 front or more")
    if "position" in loop:
        if surface is not None:
            raise ValueError("straight fronts are drawn without a surface; leave it out")
        curves = _fronts(loop, "position", "y")
        with _drawing(axes) as drawn:
            draw_straight_fronts(drawn, *curves, most)
        return drawn
    loop, units = _reduced(loop)
    curves = _fronts(loop, "radius", "angle")
    with _drawing(axes) as drawn:
        if surface is not None:
            surface_kind(surface)
            adhesion = surface_adhesion(_reduced(surface)[0])
            values = adhesion.work_of_adhesion / WORK_OF_ADHESION
            # The apex is the centre of the tile, whatever the coordinates of a given surface.
            x, y = (adhesion.pixel * (np.arange(count) - count / 2) for count in values.shape)
            reach = max(2 * adhesion.w_rms, 0.05)
            draw_field(drawn, x, y, values, float(np.mean(values)), reach, units)
        draw_fronts(drawn, *curves, most, units)
    return drawn


def plot_instabilities(jumps: Dataset, axes: Axes | None = None) -> Axes:
    """What each instability of a branch has swept, coloured by the energy that it dissipated.

    Parameters
    ----------
    jumps : xarray.Dataset
        What :func:`find_instabilities` has returned, in reduced units or in SI.
    axes : matplotlib.axes.Axes, optional
        As of :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes that they are drawn on.

    Raises
    ------
    ValueError
        If there is no instability.
    TypeError
        If an argument is of another type.
    """
    refuse_other_type("jumps", jumps, Dataset, "what find_instabilities returns")
    if "before" not in jumps or "travel" not in jumps.attrs:
        raise ValueError("the dataset holds no instabilities; give what find_instabilities returns")
    jumps, units = _reduced(jumps)
    fronts = jumps.before.values, jumps.after.values
    energy, travel = jumps.dissipated_energy.values, float(jumps.attrs["travel"])
    with _drawing(axes) as drawn:
        draw_instabilities(drawn, jumps.angle.values, *fronts, energy, travel, units)
    return drawn
