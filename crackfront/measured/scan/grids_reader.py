"""Grids that were read here, as a reader of the library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crackfront.measured.scan.library import library_part, library_scan


@dataclass(frozen=True, slots=True)
class Grid:
    """Heights on a regular grid."""

    name: str
    heights: np.ndarray[Any, Any]
    """In the unit of the reader, where their unit is a length."""
    size: tuple[float, ...] | None
    """Sides in the unit of the reader; None where the file does not state them."""
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
                dim=grid.heights.ndim,
                nb_grid_pts=grid.heights.shape,
                physical_sizes=grid.size,
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

    def topography(
        self,
        channel_index: int,
        unit: str | None = None,
        physical_sizes: tuple[float, ...] | None = None,
    ) -> Any:
        """Heights, in the unit and with the sides of the file, or with named ones."""
        grid = self.grids[channel_index]
        sides = grid.size or physical_sizes
        return library_scan(grid.heights, sides, unit=self.unit or unit, info=self.info)
