"""Functions of the library for scans: a map as a surface, and predictions for a sphere."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from xarray import DataArray

from crackfront.core.arguments import check_type
from crackfront.core.units import Scales
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.options import (
    Options,
    PredictionOptions,
    PsdOptions,
    ReadingOptions,
    SelfAffineOptions,
    SphereOptions,
    check_option_names,
    checked_options,
    named_options,
    reading_options,
    sphere_scales,
)
from crackfront.measured.prediction.prediction import Prediction, prediction_or_reason
from crackfront.measured.prediction.remarks import remark_text
from crackfront.measured.scan.library import surface_library
from crackfront.measured.scan.psd import read_psd_file
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import MeasuredSurface, read_surface
from crackfront.measured.spectrum.stated import (
    StatedSurface,
    Surface,
    density_surface,
    self_affine_surface_of,
)
from crackfront.measured.tile import scan_surface
from crackfront.surfaces.scales import check_scales

File = str | PathLike[str]


def read_scan(path: File, sphere: Scales, **options: Any) -> DataArray:
    """A measured map as a surface for simulations, levelled and made periodic.

    Parameters
    ----------
    path : str or path
        File of an instrument, in any format that SurfaceTopography reads.
    sphere : Scales
        Sphere, which defines the reduced units.
    **options
        Fields of :class:`~crackfront.measured.options.ReadingOptions`, as
        ``crop="2um:8um,0um:5um"`` or ``shortest=4e-7``: channel, crop, detrend, mask, surface,
        unit, height_unit, size, tip_radius, shortest, longest. `crackfront surface --help`
        explains them.

    Returns
    -------
    xarray.DataArray
        `height(x, y)` in reduced units, the apex of the sphere at the centre of the scan. The
        attributes `source`, `levelling`, `tile`, `waves` and `notes` document the treatment.

    Raises
    ------
    ValueError
        If the file cannot be used, or is a line scan.
    TypeError
        If an argument is of another type.
    OSError
        If the file cannot be opened.
    """
    check_option_names("read_scan", options, ReadingOptions)
    check_scales(sphere)
    file = _path(path, "path")
    [reading] = reading_options(options, 1)
    surface_library()  # All of it, as the user's program may import it too.
    measurements = read_measurements([file], reading)
    if len(measurements) > 1:
        raise ValueError(
            f"{file} contains {len(measurements)} measurements; name a file with a single one"
        )
    return scan_surface(analysed_scan(measurements[0], reading.shortest, reading.longest), sphere)


def _path(value: File, name: str) -> Path:
    """Path from an argument; TypeError if it is not a path."""
    check_type(name, value, (str, PathLike), "the path of a file")
    return Path(value)


def read_psd(path: File, **options: Any) -> StatedSurface:
    """A surface from a spectral density that another program exported.

    Parameters
    ----------
    path : str or path
        Text with two columns: an export of contact.engineering, Gwyddion, MountainsMap, or another
        program that names the columns in their heads.
    **options
        Fields of :class:`~crackfront.measured.options.PsdOptions`, as ``psd_units="1/um,um^3"``
        or ``psd_sides="one"``, for what the file does not state. They replace the heads of the
        columns.

    Returns
    -------
    StatedSurface
        Isotropic spectrum in SI units, for :func:`predict`.

    Raises
    ------
    ValueError
        If the file does not contain a density, or its convention is unknown.
    TypeError
        If an argument is of another type.
    OSError
        If the file cannot be opened.
    """
    check_option_names("read_psd", options, PsdOptions)
    return density_surface(read_psd_file(_path(path, "path"), checked_options(PsdOptions, options)))


def self_affine_surface(**numbers: Any) -> StatedSurface:
    """A surface from the numbers of a self-affine spectrum, for :func:`predict`.

    Parameters
    ----------
    **numbers
        Fields of :class:`~crackfront.measured.options.SelfAffineOptions`: rms, hurst, and either
        correlation_length (where the autocorrelation of the heights is 1/e) or roll_off; and
        short_cutoff, which is needed for a Hurst exponent of 0.5 or less. Lengths are texts with a
        unit, or numbers in metres.

    Returns
    -------
    StatedSurface
        Spectrum of :class:`~crackfront.core.spectrum.SelfAffineSpectrum`, in SI units.

    Raises
    ------
    ValueError
        If a number is missing, or the numbers contradict each other.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> rough = self_affine_surface(rms="60nm", correlation_length="1um", hurst=0.8)
    >>> f"{rough.measures[0].rms.value * 1e9:.4g} nm, {rough.longest * 1e6:.2g} um"
    '60 nm, 4.1 um'
    """
    check_option_names("self_affine_surface", numbers, SelfAffineOptions)
    return self_affine_surface_of(checked_options(SelfAffineOptions, numbers))


def predict(
    scans: File | Iterable[File] | StatedSurface,
    sphere: Scales | None = None,
    *,
    strict: bool = False,
    **options: Any,
) -> Prediction:
    """Predict the adhesion of a sphere on a measured surface, by the law of k.

    If the theory does not apply, the result says so: its `applies` is False, its `reason` names the
    conditions that fail, and its numbers are NaN.

    Parameters
    ----------
    scans : path or list of paths, or StatedSurface
        One or several measurements of the surface, maps or lines; or a result of :func:`read_psd`
        or :func:`self_affine_surface`.
    sphere : Scales, optional
        Sphere that is pressed on the surface; or state it as the command does, by the options
        modulus (Young's modulus), poisson, radius and work_of_adhesion.
    strict : bool, optional
        Whether a theory that does not apply, or only with reservations, raises a ValueError.
    **options
        Options of :func:`read_scan`, and fields of
        :class:`~crackfront.measured.options.PredictionOptions`, as ``range="0.3nm"``: pull_off,
        range, thickness, work_of_adhesion_error. A list gives every scan its own channel, crop,
        surface, unit, height_unit, size or tip_radius.

    Returns
    -------
    Prediction
        e_el, k, w_appr, w_retr, pull-off forces and more, in SI units, with intervals. Printed, it
        is a page with the most important numbers. `plot()` draws the forces of both branches,
        `to_dict()` has all numbers.

    Raises
    ------
    ValueError
        If a file cannot be used, or the sphere is stated twice or incompletely.
    TypeError
        If an argument is of another type.
    OSError
        If a file cannot be opened.

    Examples
    --------
    >>> rough = self_affine_surface(rms="20nm", roll_off="2um", hurst=0.8, short_cutoff="20nm")
    >>> sphere = {"radius": "1.25mm", "work_of_adhesion": "63mJ/m2", "poisson": 0.5}
    >>> series = [predict(rough, modulus=modulus, **sphere) for modulus in ("0.7MPa", "1GPa")]
    >>> [prediction.applies for prediction in series]
    [True, False]
    >>> f"{1e3 * series[0].hysteresis.value:.1f} mJ/m2, {series[1].hysteresis.value} mJ/m2"
    '2.0 mJ/m2, nan mJ/m2'
    """
    records: list[type[Options]] = [PredictionOptions, SphereOptions]
    if not isinstance(scans, StatedSurface):
        records.append(ReadingOptions)
    check_option_names("predict", options, *records)
    scales = _sphere(sphere, options)
    prediction_options = checked_options(PredictionOptions, options)
    surface: Surface = scans if isinstance(scans, StatedSurface) else _measured(scans, options)
    prediction = prediction_or_reason(surface, scales, prediction_options)
    if strict:
        _check_reservations(prediction)
    return prediction


def _sphere(sphere: Scales | None, options: dict[str, Any]) -> Scales:
    """The sphere, from itself or from options; ValueError unless it is stated in one way."""
    names = named_options(SphereOptions, options)
    if sphere is None:
        return sphere_scales(checked_options(SphereOptions, options))
    check_scales(sphere)
    if names:
        raise ValueError(
            f"{names[0]} is {options[names[0]]!r}, and a sphere is given; leave out one of them"
        )
    return sphere


def _check_reservations(prediction: Prediction) -> None:
    """Raise ValueError if the theory does not apply, or only with reservations."""
    if not prediction.applies:
        raise ValueError(f"the theory does not apply: {prediction.reason}")
    reservations = prediction.verdict.with_severity("undecided", "reservation")
    if reservations:
        sentences = " ".join(map(remark_text, reservations))
        raise ValueError(f"the theory applies with reservations: {sentences}")


def _measured(scans: File | Iterable[File], options: dict[str, Any]) -> MeasuredSurface:
    """Surface from one or several scans."""
    paths = [scans] if isinstance(scans, (str, PathLike)) else scans
    check_type("scans", paths, Iterable, "the path of a file, or a list of such")
    files = [_path(path, "scan") for path in paths]
    surface_library()  # All of it, as the user's program may import it too.
    return read_surface(files, reading_options(options, len(files)))
