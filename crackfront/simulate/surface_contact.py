"""The contact of a sphere with a surface."""

from __future__ import annotations

from dataclasses import dataclass, replace

from xarray import DataArray

from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.kinds import TileField
from crackfront.simulate.asked import EXCESS
from crackfront.simulate.contact import contact_field, tile_contact
from crackfront.simulate.laws import numerical_error
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.surface_arrays import surface_adhesion, surface_kind
from crackfront.simulate.surfaces import chosen_simulation, refuse_no_fraction
from crackfront.simulate.tiles import measured_correlation_length, stated_spectrum

_TOLERANCE = 1e-8
"""Force that may be left on a surface whose spectrum is not known, relative to w_int."""


@dataclass(frozen=True, slots=True)
class SurfaceContact:
    """A sphere on a surface.

    Attributes
    ----------
    field : TileField
        Work of adhesion along the rays.
    tolerance : float
        Force that may be left, relative to w_int per front length.
    elastic_energy, rms : float
        e_el and w_rms measured on the tile. (Units: w_int)
    correlation_length : float
        That of w_loc, measured on the tile. (Units: reduced lateral length)
    simulation : Simulation or None
        The numerics and their expected errors, where the spectrum is known.
    """

    field: TileField
    tolerance: float
    elastic_energy: float
    rms: float
    correlation_length: float
    simulation: Simulation | None


def surface_contact(surface: DataArray, schedule: LoadSchedule, error: float) -> SurfaceContact:
    """Contact of a surface, resolved by the measured laws or else by its pixels.

    Parameters
    ----------
    surface : xarray.DataArray
        A surface in reduced units.
    schedule : LoadSchedule
        Penetrations to visit.
    error : float
        Standard error of the factor k of either branch that the numerics may leave.

    Raises
    ------
    ValueError
        If surface or error cannot be used, or the pixels are too coarse for the error.
    """
    refuse_no_fraction("error", error)
    adhesion = surface_adhesion(surface)
    length = measured_correlation_length(adhesion.work_of_adhesion, adhesion.pixel)
    spectrum, deepest = stated_spectrum(surface), schedule.max_penetration
    if spectrum is None or adhesion.elastic_energy == 0:
        field = tile_contact(adhesion, deepest)
        return SurfaceContact(
            field, _TOLERANCE, adhesion.elastic_energy, adhesion.rms, length, None
        )
    chosen = chosen_simulation(
        surface_kind(surface), spectrum, adhesion.elastic_energy, schedule, error=error
    )
    n_point = min(adhesion.work_of_adhesion.shape)
    sizes = replace(chosen.resolution, tile_side=n_point * adhesion.pixel, n_point=n_point)
    simulation = replace(chosen, resolution=sizes)
    left = max(numerical_error(simulation)) / adhesion.elastic_energy
    if left > EXCESS * error:
        pixels = spectrum.short_cutoff / adhesion.pixel
        raise ValueError(
            f"error is {error:g}, but the finest numerics on {pixels:.3g} pixels per short cutoff "
            f"leave {left:.2g}; ask for that, or make the surface with this error"
        )
    field = contact_field(
        adhesion, sizes.n_angle, sizes.spacing, deepest, sizes.interpolation, band_limited=True
    )
    return SurfaceContact(
        field, chosen.tolerance, adhesion.elastic_energy, adhesion.rms, length, simulation
    )
