"""Files of instruments as the library reads them, completed by what they do not state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, get_args

from crackfront.core.extras import MissingExtraError

Detrend = Literal["center", "height", "slope", "curvature"]
"""What is taken off: the mean, the plane of least height, that of least slope, the paraboloid."""


@dataclass(frozen=True, slots=True)
class Treatment:
    """How files are read.

    Attributes
    ----------
    detrend : {"center", "height", "slope", "curvature"}
        What is taken off, as the library's modes of the same names.
    unit : str or None
        Unit of lengths, for files that state none.
    size : tuple of float or None
        Sides of the scan, or the length of a line, for files that state none.
        (Units: those of `unit`, or of the file)
    shortest : float or None
        Shortest wavelength to trust. (Units: m)
    """

    detrend: Detrend = "curvature"
    unit: str | None = None
    size: tuple[float, ...] | None = None
    shortest: float | None = None

    def __post_init__(self) -> None:
        if self.detrend not in get_args(Detrend):
            raise ValueError(
                f"detrend is {self.detrend!r}; choose one of {', '.join(get_args(Detrend))}"
            )
        for name, values in (("size", self.size or ()), ("shortest", (self.shortest or 1.0,))):
            if not all(math.isfinite(value) and value > 0 for value in values):
                raise ValueError(f"{name} is {getattr(self, name)}; it must be positive and finite")


def surface_library() -> ModuleType:
    """The library SurfaceTopography; seconds to import, hence imported where it is needed.

    Raises
    ------
    ValueError
        If it is not installed, with the command that installs it.
    """
    try:
        import SurfaceTopography
    except ModuleNotFoundError as error:
        raise MissingExtraError("measured surfaces", error, "surfaces") from error
    return SurfaceTopography


def raw_topography(path: Path, treatment: Treatment) -> tuple[Any, str, str]:
    """What the library reads from a file.

    Parameters
    ----------
    path : Path
        The file.
    treatment : Treatment
        What completes it.

    Returns
    -------
    object
        The library's map or line.
    str
        Name of the format.
    str
        The file's comment.

    Raises
    ------
    ValueError
        If the library is missing or the file cannot be used; one sentence.
    """
    library = surface_library()
    try:
        reader = library.open_topography(str(path))
        channel = reader.default_channel
    except library.Exceptions.CannotDetectFileFormat as error:
        raise ValueError(
            f"{path} is in no format that SurfaceTopography reads, or damaged; export it from the "
            "instrument again, as X3P if there is a choice"
        ) from error
    # A damaged file may fail anywhere in a parser that is not ours.
    except Exception as error:
        raise _unreadable(path, "what its head says", error) from error
    if channel.data_kind.value != "height":
        raise ValueError(
            f"{path}: channel {channel.name!r} holds {channel.data_kind.value}, no heights; export "
            "the channel of the heights alone"
        )
    given = _completed(path, reader.format(), channel, treatment)
    try:
        raw = reader.topography(channel_index=channel.index, **given)
        raw.heights()
    except Exception as error:
        raise _unreadable(path, reader.format(), error) from error
    if not raw.is_uniform:
        raise ValueError(
            f"{path}: the points are not equally spaced; resample the line on a uniform grid"
        )
    comment = raw.info.get("comment") or ""
    return raw, reader.format(), str(comment).strip()


def _completed(path: Path, name: str, channel: Any, treatment: Treatment) -> dict[str, Any]:
    """What a file does not state, from the treatment."""
    given: dict[str, Any] = {}
    if channel.unit is None:
        if treatment.unit is None:
            raise ValueError(
                f"{path}, read as {name}, states no unit of length; name it, as in --unit um"
            )
        if not surface_library().Support.UnitConversion.is_length_unit(treatment.unit):
            raise ValueError(f"--unit {treatment.unit} is no unit of length; name one, as in um")
        given["unit"] = treatment.unit
    elif treatment.unit not in (None, channel.unit):
        raise ValueError(
            f"{path} states its own unit, {channel.unit}; leave --unit {treatment.unit} out"
        )
    if channel.physical_sizes is None or None in channel.physical_sizes:
        if treatment.size is None:
            raise ValueError(f"{path} states no size of the scan; name it, as in --size 50,50")
        if len(treatment.size) != channel.dim:
            raise ValueError(
                f"{path} has {channel.dim} dimension(s) and the size that is named "
                f"{len(treatment.size)}; name one length for each, as in --size 50,50"
            )
        given["physical_sizes"] = treatment.size
    elif treatment.size is not None:
        stated = " x ".join(f"{side:g}" for side in channel.physical_sizes)
        raise ValueError(f"{path} states its own size, {stated} {channel.unit}; leave --size out")
    return given


def _unreadable(path: Path, name: str, error: Exception) -> ValueError:
    """What is said of a file at which a reader fails."""
    return ValueError(
        f"{path} cannot be read as {name}: {_first_line(error)}; export it from the instrument "
        "again"
    )


def _first_line(error: Exception) -> str:
    """First line of a message, or what kind it is."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__
