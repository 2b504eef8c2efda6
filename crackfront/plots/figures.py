"""Figures of surfaces, loops, fronts and instabilities, on new or existing axes.

Data in SI units are drawn in SI units.
"""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataArray, Dataset

from crackfront.core.arrays import Array
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.axis_units import REDUCED, AxisUnits
from crackfront.plots.density_axes import draw_spectrum
from crackfront.plots.fronts import draw_field, draw_fronts, draw_heights, draw_straight_fronts
from crackfront.plots.instability_maps import draw_instabilities
from crackfront.plots.loop_figures import draw_loop, draw_pinning
from crackfront.plots.style import COLUMN, axes_to_draw_on, blank_figure, house_style
from crackfront.simulate.cycle_files import cycle_record
from crackfront.surfaces.random_surface import stated_spectrum
from crackfront.surfaces.si_units import Labelled, in_reduced_units, stated_scales
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.surface_array import surface_kind
from crackfront.surfaces.tile_measures import Modes, tile_modes
from crackfront.validation import Count, checked_call

_ORDERS = (0.0, 0.5, 1.0)
"""Orders of the derivatives whose dominant scales are drawn: heights, half-derivatives, slopes."""

_TAIL = 0.1
"""Part of a mean square in waves shorter than its dominant scales, and in longer ones."""

_LARGEST_RATIO = 2.0
"""Ratio of measured and requested e_el up to which the stated spectrum is drawn."""

_BINS_A_DECADE = 20
"""Bins of a spectrum in a decade of wavevectors."""


def _reduced(data: Labelled) -> tuple[Labelled, AxisUnits]:
    """Data in reduced units, and the units for their axes."""
    scales = stated_scales(data)
    if scales is None:
        return data, REDUCED
    return in_reduced_units(data, scales), AxisUnits(scales)


def _check_states(loop: Dataset, name: str) -> None:
    """Raise ValueError unless a loop has a state with a finite value and a direction."""
    finite = np.isfinite(loop[name].values) & np.isfinite(loop.direction.values)
    if not np.any(finite):
        raise ValueError(f"{name} of the loop lacks a finite value to plot; give another loop")


def _fronts(loop: Dataset, name: str, site: str) -> tuple[Array, Array, NDArray[np.int64]]:
    """Coordinates of sites, fronts over (step, site), and directions of a loop with fronts."""
    missing = [variable for variable in (site, "direction") if variable not in loop]
    if missing:
        raise ValueError(f"the loop lacks {', '.join(missing)}; give it as run_loop returned it")
    fronts, direction = loop[name], loop.direction
    if {*fronts.dims} != {"step", site} or direction.dims != ("step",):
        raise ValueError(
            f"{name} has the dimensions ({', '.join(map(str, fronts.dims))}); a loop has step and "
            f"{site}: keep a single state as a list, as in loop.isel(step=[0])"
        )
    fronts = fronts.transpose("step", site)
    if not np.all(np.isfinite(fronts)):
        raise ValueError(f"{name} has values that are not finite; drop these states")
    return loop[site].values, fronts.values, direction.values


@checked_call
def plot_surface(surface: DataArray, axes: Axes | None = None) -> Axes:
    """Heights, or works of adhesion, on the tile.

    Parameters
    ----------
    surface : xarray.DataArray
        A surface in reduced units, or in SI units (:func:`in_si_units`).
    axes : matplotlib.axes.Axes, optional
        Axes to draw on; by default axes of a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the drawing.

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
    with axes_to_draw_on(axes) as drawn:
        if kind == "roughness":
            draw_heights(drawn, x, y, surface.transpose("x", "y").values, units)
        else:
            values = adhesion.work_of_adhesion / WORK_OF_ADHESION
            draw_field(drawn, x, y, values, 1.0, 2 * adhesion.w_rms, units)
    return drawn


@checked_call
def plot_spectrum(surface: DataArray, axes: Axes | None = None) -> Axes:
    """Isotropic power spectrum of a rough surface, with the scales that dominate it.

    Each bar spans the wavevectors with 80% of a mean square: of heights, of half-derivatives
    (which decide e_el), or of slopes. The spectrum in the attributes of the surface is drawn too,
    unless its e_el differs from the heights by more than a factor of two.

    Parameters
    ----------
    surface, axes : optional
        As for :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the drawing.

    Raises
    ------
    ValueError
        If the surface cannot be used, is not made of heights, or is flat.
    TypeError
        If an argument is of another type.
    """
    if surface_kind(surface) != "roughness":
        raise ValueError(f"surface is {surface.name}; give heights, which have a height spectrum")
    surface, units = _reduced(surface)
    adhesion = surface_adhesion(surface)
    pixel = adhesion.pixel
    modes = tile_modes(surface.transpose("x", "y").values, pixel)
    if modes.power.size == 0:
        raise ValueError("the surface is flat; give one with roughness, which has a spectrum")
    wavevector, density = modes.isotropic_density(_BINS_A_DECADE, pixel**2 * surface.size)
    rms, shortest, longest = _dominant_scales(modes)
    ideal = _stated_density(surface, adhesion.e_el, wavevector)
    with axes_to_draw_on(axes) as drawn:
        draw_spectrum(drawn, wavevector, density, rms, shortest, longest, ideal, units)
    return drawn


def _dominant_scales(modes: Modes) -> tuple[Array, Array, Array]:
    """Rms of each derivative in `_ORDERS`, and the ends of the wavelengths that dominate it."""
    rms, shortest, longest = [], [], []
    for order in _ORDERS:
        mean_squares = np.cumsum(modes.power * modes.wavevector ** (2 * order))
        total = mean_squares[-1]
        largest_mode, smallest_mode = np.searchsorted(
            mean_squares, total * np.array([1 - _TAIL, _TAIL])
        )
        rms.append(np.sqrt(total))
        shortest.append(2 * np.pi / modes.wavevector[largest_mode])
        longest.append(2 * np.pi / modes.wavevector[smallest_mode])
    return np.array(rms), np.array(shortest), np.array(longest)


def _stated_density(surface: DataArray, e_el: float, wavevector: Array) -> Array | None:
    """Density of the spectrum that a surface states; None without one, or if it does not apply.

    Heights keep their attributes when a user multiplies them, but their e_el changes.
    """
    shape, requested = stated_spectrum(surface), surface.attrs.get("elastic_energy_requested")
    if shape is None or requested is None:
        return None
    ratio = e_el / float(requested)
    if not 1 / _LARGEST_RATIO < ratio < _LARGEST_RATIO:
        return None
    return shape.with_elastic_energy(float(requested)).density(wavevector)


@checked_call
def plot_loop(loop: Dataset, axes: Axes | None = None) -> Axes:
    """Mean radius against force, with the JKR curves of both branches and of the paper.

    For a straight front: the force of its springs against their position.

    Parameters
    ----------
    loop : xarray.Dataset
        A result of :func:`run_loop` or `crackfront cycle`, in reduced units or in SI.
    axes : matplotlib.axes.Axes, optional
        As for :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the drawing.

    Raises
    ------
    ValueError
        If it is not a loop, or lacks states.
    TypeError
        If an argument is of another type.
    """
    if "pinning_force" in loop:
        states = cycle_record(loop).states
        _check_states(loop, "pinning_force")
        with axes_to_draw_on(axes) as drawn:
            draw_pinning(drawn, states)
        return drawn
    loop, units = _reduced(loop)
    states = cycle_record(loop).states
    _check_states(loop, "force")
    names = "w_appr", "w_retr", "lowest_radius", "highest_radius", "e_el"
    # Loops on rays lack these measures.
    w_appr, w_retr, lowest, highest, energy = (float(loop.get(name, math.nan)) for name in names)
    measures = (w_appr, w_retr), (lowest, highest)
    kind = loop.attrs.get("kind", "roughness")
    with axes_to_draw_on(axes) as drawn:
        draw_loop(drawn, states, *measures, elastic_energy=energy, kind=kind, units=units)
    return drawn


def loop_figure(loop: Dataset) -> Figure:
    """Figure of :func:`plot_loop` for print, a column wide."""
    with house_style():
        figure = blank_figure(COLUMN, 0.82 * COLUMN)
        plot_loop(loop, figure.add_subplot())
        return figure


@checked_call
def plot_fronts(
    loop: Dataset, surface: DataArray | None = None, axes: Axes | None = None, most: Count = 12
) -> Axes:
    """Fronts of both branches, drawn over the work of adhesion if the surface is given.

    Parameters
    ----------
    loop : xarray.Dataset
        As for :func:`plot_loop`, with its fronts.
    surface : xarray.DataArray, optional
        As for :func:`plot_surface`, in any units; not for straight fronts.
    axes : matplotlib.axes.Axes, optional
        As for :func:`plot_surface`.
    most : int, optional
        Largest number of fronts drawn for each branch.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the drawing.

    Raises
    ------
    ValueError
        If loop or surface cannot be used, or the loop lacks fronts.
    TypeError
        If an argument is of another type.
    """
    if ("radius" not in loop and "position" not in loop) or loop.sizes.get("step") == 0:
        raise ValueError(
            "the loop lacks fronts; run it with fronts=True, or crackfront cycle with "
            "--record fronts"
        )
    if "position" in loop:
        if surface is not None:
            raise ValueError("straight fronts are drawn without a surface; leave it out")
        curves = _fronts(loop, "position", "y")
        with axes_to_draw_on(axes) as drawn:
            draw_straight_fronts(drawn, *curves, most)
        return drawn
    loop, units = _reduced(loop)
    curves = _fronts(loop, "radius", "angle")
    with axes_to_draw_on(axes) as drawn:
        if surface is not None:
            _draw_pinning_field(drawn, surface, units)
        draw_fronts(drawn, *curves, most, units)
    return drawn


def _draw_pinning_field(axes: Axes, surface: DataArray, units: AxisUnits) -> None:
    """Draw the work of adhesion of a surface, with the apex at the centre of its tile."""
    surface_kind(surface)
    adhesion = surface_adhesion(_reduced(surface)[0])
    values = adhesion.work_of_adhesion / WORK_OF_ADHESION
    x, y = (adhesion.pixel * (np.arange(count) - count / 2) for count in values.shape)
    reach = max(2 * adhesion.w_rms, 0.05)
    draw_field(axes, x, y, values, float(np.mean(values)), reach, units)


@checked_call
def plot_instabilities(jumps: Dataset, axes: Axes | None = None) -> Axes:
    """Area that each instability of a branch swept, coloured by the dissipated energy.

    Parameters
    ----------
    jumps : xarray.Dataset
        A result of :func:`find_instabilities`, in reduced units or in SI.
    axes : matplotlib.axes.Axes, optional
        As for :func:`plot_surface`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the drawing.

    Raises
    ------
    ValueError
        If `jumps` is not a result of :func:`find_instabilities`, or is empty.
    TypeError
        If an argument is of another type.
    """
    if "before" not in jumps or "travel" not in jumps.attrs:
        raise ValueError("jumps is another dataset; give what find_instabilities returns")
    if jumps.before.size == 0:
        raise ValueError("the branch lacks an instability to draw; give another branch")
    jumps, units = _reduced(jumps)
    fronts = jumps.before.values, jumps.after.values
    energy, travel = jumps.dissipated_energy.values, float(jumps.attrs["travel"])
    with axes_to_draw_on(axes) as drawn:
        draw_instabilities(drawn, jumps.angle.values, *fronts, energy, travel, units)
    return drawn
