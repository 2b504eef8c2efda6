"""Kinds of fields, named tuples of arrays so that one compiled solver serves them all."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from scipy.fft import fftfreq, irfft2, rfft2, rfftfreq
from scipy.ndimage import spline_filter

from crackfront.core.adhesion import AdhesionMap
from crackfront.core.arguments import check_positive
from crackfront.core.arrays import Array

Interpolation = Literal["cubic", "linear"]


class RayField(NamedTuple):
    """Samples on the rays themselves.

    Attributes
    ----------
    geometry : Geometry
        The contact, which says how the rays lie.
    places : (n_sample,) array
        Increasing, positive. (Units: reduced lateral length)
    products : (n_site, n_sample) array
        Weighted work of adhesion. (Units: reduced energy / length)
    slopes : (n_site, n_sample) array
        Derivatives of the products along the rays, (0, 0) where the pieces are linear.
        (Units: reduced energy / area)
    """

    geometry: Any
    places: Array
    products: Array
    slopes: Array


class TileField(NamedTuple):
    """A periodic tile, evaluated by cubic B-splines where the front is.

    Attributes
    ----------
    geometry : Geometry
        The contact, which says how the rays lie; the apex of a sphere is the tile's centre, half a
        side from its first point.
    coefficients : (n_x + 3, n_y + 3) array
        Spline coefficients of the work of adhesion, three rows and columns repeated.
    inverse_pixel : float
        Points per length. (Units: 1 / reduced lateral length)
    origin, spacing : float
        Distance of samples along a ray; sample m lies at (m + 1) * spacing + origin.
    n_sample : int
        Number of samples on a ray.
    cubic : bool
        Whether the product between samples is cubic, of the same slopes as the tile, or linear.
    """

    geometry: Any
    coefficients: Array
    inverse_pixel: float
    origin: float
    spacing: float
    n_sample: int
    cubic: bool


Field = RayField | TileField


def first_place(field: Field) -> float:
    """Place of the first sample of a ray (Units: reduced lateral length)."""
    return float(field.places[0]) if isinstance(field, RayField) else field.origin + field.spacing


def last_place(field: Field) -> float:
    """Place of the last sample of a ray (Units: reduced lateral length)."""
    if isinstance(field, RayField):
        return float(field.places[-1])
    return field.n_sample * field.spacing + field.origin


def tile_field(
    adhesion: AdhesionMap,
    geometry: Any,
    spacing: float,
    largest_place: float,
    interpolation: Interpolation = "cubic",
    *,
    band_limited: bool = False,
    origin: float = 0.0,
) -> TileField:
    """Field from a periodic Cartesian tile.

    Parameters
    ----------
    adhesion : AdhesionMap
        Work of adhesion on the tile; the tile may be smaller than the contact.
    geometry : Geometry
        The contact.
    spacing : float
        Distance of samples along a ray. (Units: reduced lateral length)
    largest_place : float
        Place that the front must not leave. (Units: reduced lateral length)
    interpolation : {"cubic", "linear"}, optional
        Radius times work of adhesion between the samples of a ray: a cubic with the slopes of the
        tile, or straight.
    band_limited : bool, optional
        The tile was synthesised from modes: the splines keep their amplitudes, rather than pass
        through the points, which weakens a wave of 4 pixels by 1.4% along each axis.
    origin : float, optional
        Place before the first sample. (Units: reduced lateral length)

    Returns
    -------
    TileField
        The field.

    Raises
    ------
    ValueError
        If a count or length is too small, a value of the tile is not finite, or the interpolation
        is unknown.
    """
    if interpolation not in get_args(Interpolation):
        kinds = ", ".join(get_args(Interpolation))
        raise ValueError(f"interpolation is {interpolation!r}; choose one of {kinds}")
    values = np.asarray(adhesion.work_of_adhesion, dtype=float)
    if values.ndim != 2:
        raise ValueError(f"work of adhesion has shape {values.shape}; a tile must be (x, y)")
    check_field_values(values, names=("x", "y"))
    check_positive(pixel=adhesion.pixel)
    if geometry.n_site < 4:
        raise ValueError(f"the front has {geometry.n_site} sites; give at least 4")
    if not 0 < spacing < (largest_place - origin) / 2 < np.inf:
        raise ValueError(
            f"sample spacing is {spacing}; it must be positive and below half the distance from "
            f"{origin:.6g} to the largest place, {largest_place:.6g}"
        )
    if band_limited:
        coefficients = _mode_coefficients(values)
    else:
        coefficients = spline_filter(values, order=3, mode="grid-wrap")
    return TileField(
        geometry=geometry,
        coefficients=np.pad(coefficients, (0, 3), mode="wrap"),
        inverse_pixel=1.0 / adhesion.pixel,
        origin=float(origin),
        spacing=float(spacing),
        n_sample=int(np.ceil((largest_place - origin) / spacing)),
        cubic=interpolation == "cubic",
    )


def _mode_coefficients(values: Array) -> Array:
    """Coefficients of cubic B-splines that keep the amplitude of every mode of the points."""
    n_x, n_y = values.shape
    modes = rfft2(values)
    # A mode of f waves a pixel comes out of the splines multiplied by sinc(f)^4.
    modes /= np.sinc(fftfreq(n_x))[:, None] ** 4
    modes /= np.sinc(rfftfreq(n_y))[None, :] ** 4
    return np.asarray(irfft2(modes, s=(n_x, n_y)))


def check_field_values(values: Array, names: tuple[str, ...]) -> None:
    """Raise if a field contains NaN or infinity, with the indices of the first."""
    finite = np.isfinite(values)
    if not np.all(finite):
        bad = np.argwhere(~finite)
        indices = ", ".join(f"{name} index {i}" for name, i in zip(names, bad[0], strict=True))
        count = f" ({len(bad)} values are not finite)" if len(bad) > 1 else ""
        raise ValueError(
            f"work of adhesion is {values[tuple(bad[0])]} at {indices}{count}; "
            "replace it by a finite value"
        )
