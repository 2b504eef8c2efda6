"""How the files of a surface are read, in the words of commands, library and configurations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any

from crackfront.data.arguments import refuse_other_type
from crackfront.data.bounds import SI, refuse_outside
from crackfront.data.written_units import si_value
from crackfront.topography.bands import Scan, scan
from crackfront.topography.levelling import detrend_named
from crackfront.topography.measures import MeasuredSurface, measured_surface
from crackfront.topography.reading import Treatment, read_measurements
from crackfront.topography.regions import Region, region_named

Name = str | int
"""Name or number of a channel."""

File = str | PathLike[str]


@dataclass(frozen=True, slots=True)
class Wording:
    """How files are read and which of their waves are trusted, as a user says it.

    Attributes
    ----------
    channel : str, int or sequence of them, optional
        Channel by name or number, for files with several; one for all, or one for each.
    crop : str or sequence of str, optional
        Part of the scan to use, as in '2um:8um,0um:5um'; one for all, or one for each.
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
    shortest, longest : float or str, optional
        Ends of the trusted wavelengths, as in '0.4um', in place of those that are found.
        (Units: m)
    prefix : str, optional
        What stands before the names of these in refusals.
    """

    channel: Name | Sequence[Name] | None = None
    crop: str | Sequence[str] | None = None
    detrend: str | int = "curvature"
    mask: File | Sequence[File] = ()
    unit: str | None = None
    size: str | Sequence[float] | None = None
    shortest: float | str | None = None
    longest: float | str | None = None
    prefix: str = ""

    def surface(self, paths: Sequence[Path]) -> MeasuredSurface:
        """Surface of files.

        Raises
        ------
        ValueError
            If a word or a file cannot be used; one sentence.
        TypeError
            If a word is of another type.
        OSError
            If a file cannot be opened.
        """
        ends = self._ends
        return measured_surface(read_measurements(paths, self._treatments(len(paths))), *ends)

    def scan(self, path: Path) -> Scan:
        """Scan of one file; raises as :meth:`surface`."""
        ends = self._ends
        [measurement] = read_measurements([path], self._treatments(1))
        return scan(measurement, *ends)

    @property
    def _ends(self) -> tuple[float | None, float | None]:
        """Ends of the trusted wavelengths that are named (Units: m)."""
        return self._length("shortest", self.shortest), self._length("longest", self.longest)

    def _length(self, name: str, value: float | str | None) -> float | None:
        """A length as a text or in metres."""
        if value is None:
            return None
        what = self.prefix + name
        refuse_other_type(what, value, (str, Real), "a length, as '0.4um' or in metres")
        if isinstance(value, str):
            return si_value(value, "m", what=what)
        refuse_outside(what, float(value), SI["m"], "m")
        return float(value)

    def _treatments(self, count: int) -> list[Treatment]:
        """How each of so many files is read."""
        masks = _sequence(self.mask)
        if masks and count > 1:
            raise ValueError(
                f"{self.prefix}mask is for one scan, and {count} are named; level them one by one"
            )
        detrend = detrend_named(str(self.detrend))
        size = self._size
        mask = tuple(self._masked(one) for one in masks)
        return [
            Treatment(
                detrend=detrend,
                unit=self.unit,
                size=size,
                channel=None if channel is None else str(channel),
                crop=None if crop is None else self._region("crop", crop),
                mask=mask,
            )
            for channel, crop in zip(
                self._each("channel", _sequence(self.channel), count),
                self._each("crop", _sequence(self.crop), count),
                strict=True,
            )
        ]

    def _region(self, name: str, value: object) -> Region:
        """Region of a text."""
        what = self.prefix + name
        refuse_other_type(what, value, str, "a text, as in '2um:8um,0um:5um'")
        return region_named(str(value), what)

    def _masked(self, value: object) -> Region | Path:
        """Part of a scan or file of a mask."""
        refuse_other_type(
            f"{self.prefix}mask", value, (str, PathLike), "a part, or the path of a file"
        )
        text = str(value)
        return self._region("mask", text) if isinstance(value, str) and ":" in text else Path(text)

    def _each(self, name: str, values: Sequence[Any], count: int) -> Sequence[Any]:
        """What is said of each of the files."""
        if len(values) not in (0, 1, count):
            raise ValueError(
                f"{self.prefix}{name} is given {len(values)} times for {count} scan(s); give it "
                "once, or once for each in their order"
            )
        return values if len(values) == count else (*values, None)[:1] * count

    @property
    def _size(self) -> tuple[float, ...] | None:
        """Sides of scans that state none."""
        if self.size is None:
            return None
        given = self.size.split(",") if isinstance(self.size, str) else self.size
        try:
            return tuple(float(side) for side in given)
        except (TypeError, ValueError) as error:
            raise ValueError(
                f"{self.prefix}size is {self.size!r}; write one number for each direction, as in "
                "50,50"
            ) from error


def _sequence(value: Any) -> tuple[Any, ...]:
    """One or several of what may be given once or for each."""
    if value is None:
        return ()
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)
