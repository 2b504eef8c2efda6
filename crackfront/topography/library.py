"""Scans in the library: a map as a surface to press on, and the prediction for a sphere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, fields
from os import PathLike
from pathlib import Path

from xarray import DataArray

from crackfront.core.units import Scales
from crackfront.data.arguments import refuse_other_type
from crackfront.data.written_units import prefixed, si_value
from crackfront.simulate.si_units import refuse_no_scales
from crackfront.simulate.surfaces import surface_array
from crackfront.topography.levelling import Detrend
from crackfront.topography.measures import MeasuredSurface, measured_surface
from crackfront.topography.prediction import Prediction, predicted, prediction_notes
from crackfront.topography.reading import Measurement, Treatment, read_measurements
from crackfront.topography.report import prediction_text, surface_text, verdict_text
from crackfront.topography.tile import tile_heights, zero_load_radius
from crackfront.topography.verdict import verdict


def read_scan(
    path: str | PathLike[str],
    sphere: Scales,
    *,
    detrend: Detrend = "curvature",
    unit: str | None = None,
    size: tuple[float, ...] | None = None,
    shortest: float | str | None = None,
) -> DataArray:
    """A measured map as a surface to press on, levelled and made periodic.

    Parameters
    ----------
    path : str or path
        File of an instrument, in any format that SurfaceTopography reads.
    sphere : Scales
        What is pressed on it; it says what a reduced length is.
    detrend : {"center", "height", "slope", "curvature"}, optional
        What is taken off: the mean, the plane of least height, that of least slope, a paraboloid.
    unit : str, optional
        Unit of lengths, for files that state none.
    size : tuple of float, optional
        Sides of the scan, for files that state none. (Units: those of `unit`, or of the file)
    shortest : float or str, optional
        Shortest wavelength to trust, as '0.4um'; by default four pixels, or more where the file
        says so. (Units: m)

    Returns
    -------
    xarray.DataArray
        `height(x, y)` in reduced units, the apex of the sphere at the centre of the scan. The
        attributes `source`, `levelling`, `tile`, `waves` and others say what was done and why.

    Raises
    ------
    ValueError
        If the file cannot be used, or is a line scan.
    TypeError
        If an argument is of another type.
    OSError
        If the file cannot be opened.
    """
    refuse_no_scales(sphere)
    [measurement] = _measurements([path], detrend, unit, size, shortest)
    heights, pixel = tile_heights(measurement)
    return surface_array(
        "roughness",
        heights / sphere.vertical,
        pixel / sphere.lateral,
        source=f"{measurement.path}, {measurement.format}, checksum {measurement.checksum}",
        levelling=f"{measurement.levelling} was taken off: form and tilt are no roughness",
        **dict(_treatments(measurement, 2 * zero_load_radius(sphere))),
    )


def _treatments(measurement: Measurement, across: float) -> Iterator[tuple[str, str]]:
    """What is done to a map beside levelling, and why, under a contact so many metres across."""
    if measurement.periodic:
        yield "tile", "the scan as it stands, as its file says that it is periodic"
    else:
        yield "tile", "mirrored at its edges, where a scan does not go on: twice its sides"
    shortest = prefixed("m", measurement.shortest)
    yield "waves", f"those shorter than {shortest} were taken away, as they are not to be trusted"
    if measurement.missing > 0:
        yield "missing", f"{measurement.missing:.2%} of the points were missing and interpolated"
    if max(measurement.pixels) > 1.001 * min(measurement.pixels):
        yield "pixels", "oblong in the file, hence interpolated on square ones"
    if min(measurement.size) < across:
        sides = prefixed("m", min(measurement.size), digits=3)
        yield (
            "contact",
            f"{prefixed('m', across)} across at zero load, larger than the scan of {sides}: it "
            "meets images of that",
        )


@dataclass(frozen=True, slots=True, repr=False)
class SurfacePrediction(Prediction):
    """A prediction that shows itself as text, and the surface that it is for."""

    surface: MeasuredSurface = field(kw_only=True)

    def __repr__(self) -> str:
        notes = ["Notes", *(f"  {note}" for note in prediction_notes(self.surface, self))]
        scales = Scales(self.radius, self.work_of_adhesion, self.contact_modulus)
        ruling = verdict(self.surface, scales, None, self)
        texts = surface_text(self.surface), verdict_text(ruling), prediction_text(self)
        return "\n\n".join([*texts, "\n".join(notes)])


def predict(
    scans: str | PathLike[str] | Iterable[str | PathLike[str]],
    sphere: Scales,
    *,
    detrend: Detrend = "curvature",
    unit: str | None = None,
    size: tuple[float, ...] | None = None,
    shortest: float | str | None = None,
) -> SurfacePrediction:
    """How strongly a sphere sticks to a measured surface, by the law of k.

    Parameters
    ----------
    scans : path or list of paths
        One measurement of the surface or several, maps or lines.
    sphere : Scales
        What is pressed on it.
    detrend, unit, size, shortest
        As of :func:`read_scan`.

    Returns
    -------
    SurfacePrediction
        e_el, k, w_appr, w_retr, pull-off forces and more, in SI units; printed, it says all of them
        with intervals, limits and notes.

    Raises
    ------
    ValueError
        If a file cannot be used, or no contact conforms, e_el >= w_int.
    TypeError
        If an argument is of another type.
    OSError
        If a file cannot be opened.
    """
    refuse_no_scales(sphere)
    paths = [scans] if isinstance(scans, (str, PathLike)) else scans
    refuse_other_type("scans", paths, Iterable, "the path of a file, or a list of such")
    surface = measured_surface(_measurements(paths, detrend, unit, size, shortest))
    found = predicted(surface, sphere)
    known = {item.name: getattr(found, item.name) for item in fields(Prediction)}
    return SurfacePrediction(**known, surface=surface)


def _measurements(
    paths: Iterable[str | PathLike[str]],
    detrend: Detrend,
    unit: str | None,
    size: tuple[float, ...] | None,
    shortest: float | str | None,
) -> tuple[Measurement, ...]:
    """Measurements of files."""
    found = []
    for path in paths:
        refuse_other_type("scan", path, (str, PathLike), "the path of a file")
        found.append(Path(path))
    limit = si_value(shortest, "m", what="shortest") if isinstance(shortest, str) else shortest
    return read_measurements(found, Treatment(detrend, unit, size, limit))
