"""Scans in the library: a map as a surface to press on, and the prediction for a sphere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from os import PathLike
from pathlib import Path

from xarray import DataArray

from crackfront.core.units import Scales
from crackfront.data.arguments import refuse_other_type
from crackfront.data.written_units import prefixed
from crackfront.simulate.si_units import refuse_no_scales
from crackfront.simulate.surfaces import surface_array
from crackfront.topography.levelling import Detrend
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.prediction import Prediction, predicted, prediction_notes
from crackfront.topography.reading import Measurement
from crackfront.topography.report import prediction_text, surface_text, verdict_text
from crackfront.topography.tile import tile_heights, zero_load_radius
from crackfront.topography.verdict import verdict
from crackfront.topography.wording import File, Name, Wording


def read_scan(
    path: str | PathLike[str],
    sphere: Scales,
    *,
    channel: Name | None = None,
    crop: str | None = None,
    detrend: Detrend = "curvature",
    mask: File | Sequence[File] = (),
    unit: str | None = None,
    size: str | Sequence[float] | None = None,
    shortest: float | str | None = None,
) -> DataArray:
    """A measured map as a surface to press on, levelled and made periodic.

    Parameters
    ----------
    path : str or path
        File of an instrument, in any format that SurfaceTopography reads.
    sphere : Scales
        What is pressed on it; it says what a reduced length is.
    channel : str or int, optional
        Channel by name or number, for files with several.
    crop : str, optional
        Part of the scan to use, as in '2um:8um,0um:5um'.
    detrend : {"center", "height", "slope", "curvature"} or int, optional
        What is taken off: the mean, the plane of least height, that of least slope, a paraboloid,
        or the polynomial of an order.
    mask : str, path or sequence of them, optional
        What the levelling leaves out and the map keeps: parts of the scan as in `crop`, or files
        with a number for each point, not zero there.
    unit : str, optional
        Unit of lengths, for files that state none.
    size : str or sequence of float, optional
        Sides of the scan, for files that state none, as in '50,50'. (Units: those of `unit`, or of
        the file)
    shortest : float or str, optional
        Shortest wavelength to trust, as in '0.4um', in place of that which is found. (Units: m)

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
    refuse_other_type("scan", path, (str, PathLike), "the path of a file")
    words = Wording(channel, crop, detrend, mask, unit, size, shortest)
    measurement = words.scan(Path(path)).trusted_measurement
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
    scans: File | Iterable[File],
    sphere: Scales,
    *,
    channel: Name | Sequence[Name] | None = None,
    crop: str | Sequence[str] | None = None,
    detrend: Detrend = "curvature",
    mask: File | Sequence[File] = (),
    unit: str | None = None,
    size: str | Sequence[float] | None = None,
    shortest: float | str | None = None,
    longest: float | str | None = None,
) -> SurfacePrediction:
    """How strongly a sphere sticks to a measured surface, by the law of k.

    Parameters
    ----------
    scans : path or list of paths
        One measurement of the surface or several, maps or lines.
    sphere : Scales
        What is pressed on it.
    channel, crop
        As of :func:`read_scan`; one for all scans, or a list of one for each.
    detrend, mask, unit, size, shortest
        As of :func:`read_scan`.
    longest : float or str, optional
        Longest wavelength to trust, in place of that which is found. (Units: m)

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
    files = []
    for path in paths:
        refuse_other_type("scan", path, (str, PathLike), "the path of a file")
        files.append(Path(path))
    words = Wording(channel, crop, detrend, mask, unit, size, shortest, longest)
    surface = words.surface(files)
    found = predicted(surface, sphere)
    known = {item.name: getattr(found, item.name) for item in fields(Prediction)}
    return SurfacePrediction(**known, surface=surface)
