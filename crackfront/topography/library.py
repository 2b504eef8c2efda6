"""Scans in the library: a map as a surface to press on, and the prediction for a sphere."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from xarray import DataArray

from crackfront.core.units import Scales
from crackfront.data.arguments import refuse_other_type
from crackfront.simulate.si_units import refuse_no_scales
from crackfront.topography.bands import scan
from crackfront.topography.instruments import surface_library
from crackfront.topography.measures import read_surface
from crackfront.topography.options import (
    PredictionOptions,
    ReadingOptions,
    declared,
    options_for_each,
    parameters_text,
    parsed_options,
)
from crackfront.topography.prediction import Prediction, check_and_predict
from crackfront.topography.reading import read_measurements
from crackfront.topography.remarks import remark_text
from crackfront.topography.tile import scan_surface

Function = TypeVar("Function", bound=Callable[..., Any])
File = str | PathLike[str]


def _taking(*records: type[Any]) -> Callable[[Function], Function]:
    """Give a function the options of records: as keywords, in its signature and its docstring."""
    kind = inspect.Parameter.KEYWORD_ONLY
    keywords = [
        inspect.Parameter(one.name, kind, default=one.default, annotation=one.kind.accepts)
        for one in declared(*records)
    ]

    def decorated(function: Function) -> Function:
        plain = inspect.signature(function)
        named = [item for item in plain.parameters.values() if item.kind is not item.VAR_KEYWORD]
        function.__doc__ = str(function.__doc__).replace("{options}", parameters_text(*records))
        signature = plain.replace(parameters=[*named, *keywords])
        function.__signature__ = signature  # type: ignore[attr-defined]
        return function

    return decorated


@_taking(ReadingOptions)
def read_scan(path: File, sphere: Scales, **options: Any) -> DataArray:
    """A measured map as a surface to press on, levelled and made periodic.

    Parameters
    ----------
    path : str or path
        File of an instrument, in any format that SurfaceTopography reads.
    sphere : Scales
        What is pressed on it; it says what a reduced length is.
    {options}

    Returns
    -------
    xarray.DataArray
        `height(x, y)` in reduced units, the apex of the sphere at the centre of the scan. The
        attributes `source`, `levelling`, `tile`, `waves` and `notes` say what was done and why.

    Raises
    ------
    ValueError
        If the file cannot be used, or is a line scan.
    TypeError
        If an argument is of another type.
    OSError
        If the file cannot be opened.
    """
    inspect.signature(read_scan).bind(path, sphere, **options)
    refuse_no_scales(sphere)
    file = _path(path)
    reading = parsed_options(ReadingOptions, options)
    surface_library()  # Whole: the program may use it too.
    [measured] = read_measurements([file], reading)
    return scan_surface(scan(measured, reading.shortest, reading.longest), sphere)


def _path(scan: File) -> Path:
    """Path of a scan, refused where it is none."""
    refuse_other_type("scan", scan, (str, PathLike), "the path of a file")
    return Path(scan)


@_taking(ReadingOptions, PredictionOptions)
def predict(
    scans: File | Iterable[File], sphere: Scales, *, strict: bool = False, **options: Any
) -> Prediction:
    """How strongly a sphere sticks to a measured surface, by the law of k.

    Parameters
    ----------
    scans : path or list of paths
        One measurement of the surface or several, maps or lines.
    sphere : Scales
        What is pressed on it.
    strict : bool, optional
        Raise where the theory applies with reservations as well.
    {options}

    Returns
    -------
    Prediction
        e_el, k, w_appr, w_retr, pull-off forces and more, in SI units, with intervals; printed, it
        is a page of those that matter most.

    Raises
    ------
    ValueError
        If a file cannot be used, or the theory does not apply.
    TypeError
        If an argument is of another type.
    OSError
        If a file cannot be opened.
    """
    inspect.signature(predict).bind(scans, sphere, strict=strict, **options)
    refuse_no_scales(sphere)
    paths = [scans] if isinstance(scans, (str, PathLike)) else scans
    refuse_other_type("scans", paths, Iterable, "the path of a file, or a list of such")
    files = [_path(path) for path in paths]
    given = parsed_options(PredictionOptions, options)
    surface_library()  # Whole: the program may use it too.
    surface = read_surface(files, options_for_each(ReadingOptions, options, len(files)))
    verdict, prediction = check_and_predict(surface, sphere, given)
    if prediction is None:
        failing = map(remark_text, verdict.of("fails", "undecided"))
        raise ValueError(f"the theory does not apply: {' '.join(failing)}")
    if strict and (found := verdict.of("undecided", "reservation")):
        sentences = " ".join(map(remark_text, found))
        raise ValueError(f"the theory applies with reservations: {sentences}")
    return prediction
