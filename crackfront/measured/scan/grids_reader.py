"""Grids that were read here, as a reader of the library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from crackfront.measured.scan.library import library_part, library_scan
from crackfront.measured.scan.points import Points


@dataclass(frozen=True, slots=True)
class Grid:
    """Heights on a regular grid."""

    name: str
    points: Points
    """Sides in the unit of the reader; heights too, where their unit is a length."""
    unit: str | None = None
    """Unit of the heights as the file has it, where it is not a length."""


@dataclass(frozen=True, slots=True)
class GridsReader:
    """Grids with the methods of the library's readers."""

    name: str
    """Name of the format, as the library calls it."""
    grids: Sequence[Grid]
    unit: str | None = "m"
    """Unit of sides and heights, where the file states it."""
    info: dict[str, Any] | None = None

    def format(self) -> str:
        """Name of the format."""
        return self.name

    @property
    def channels(self) -> list[Any]:
        """What the library says of each grid."""
        return [
            library_part("IO.Reader").ChannelInfo(
                self,
                number,
                name=grid.name,
                dim=grid.points.heights.ndim,
                nb_grid_pts=grid.points.heights.shape,
                physical_sizes=grid.points.size,
                unit=self.unit,
                data_unit=grid.unit,
                info=self.info or {},
            )
            for number, grid in enumerate(self.grids)
        ]

    @property
    def default_channel(self) -> Any:
        """The first of them."""
        return self.channels[0]

    def topography(self, channel_index: int, unit: str | None = None) -> Any:
        """Heights in the unit of the file, or in a named one."""
        points = self.grids[channel_index].points
        return library_scan(points.heights, points.size, unit=self.unit or unit, info=self.info)
