"""Columns of a recorded loop: force, contact radius and displacement, in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from crackfront.core.arrays import Array
from crackfront.surfaces.written_units import prefixed

UNITS = {"force": "N", "radius": "m", "displacement": "m"}
"""The columns of a loop and their SI units."""

_NEGATIVE_RADII = 0.1
"""Largest ratio of a negative contact radius to the largest one that noise may cause."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Columns of a loop, row by row in the order of time.

    Attributes
    ----------
    force : (n_row,) array or None
        Normal force, positive where it pushes. (Units: N)
    radius : (n_row,) array or None
        Contact radius; 0 or NaN out of contact. (Units: m)
    displacement : (n_row,) array or None
        Displacement of the sphere's mount towards the surface. (Units: m)
    headings : mapping, optional
        Headings of the columns in their table.
    remarks : tuple of str, optional
        Sentences on how the table was read.
    """

    force: Array | None
    radius: Array | None
    displacement: Array | None
    headings: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = [name for name in UNITS if getattr(self, name) is not None]
        columns = [getattr(self, name) for name in names]
        if len(columns) < 2:
            raise ValueError(
                f"a loop needs two of {', '.join(UNITS)}, and has {' and '.join(names) or 'none'}; "
                "give another one"
            )
        if len({column.shape for column in columns}) > 1 or columns[0].ndim != 1:
            raise ValueError(
                "the columns of a loop are not of one length; give a value for each row"
            )
        self._check_radii()

    def _check_radii(self) -> None:
        """Raise ValueError if contact radii are more negative than noise out of contact."""
        if self.radius is None or not np.any(self.radius > 0):
            return
        lowest = float(np.nanmin(self.radius))
        if -lowest > _NEGATIVE_RADII * float(np.nanmax(self.radius)):
            name = self.headings.get("radius", "radius")
            raise ValueError(
                f"the contact radius, column {name!r}, falls to {prefixed('m', lowest)}; it must "
                "not be negative, so check whether two headings are exchanged"
            )

    def rows(self, places: slice) -> Recording:
        """Some successive rows."""
        force, radius, displacement = (
            None if column is None else column[places]
            for column in (self.force, self.radius, self.displacement)
        )
        return replace(self, force=force, radius=radius, displacement=displacement)

    def inverted(self, names: Iterable[str]) -> Recording:
        """The recording with the opposite sign of some columns.

        Raises ValueError if one is missing, or is not the force or the displacement.
        """
        changed = {}
        for name in names:
            if name not in ("force", "displacement"):
                raise ValueError(f"invert is {name!r}; choose force or displacement")
            column = getattr(self, name)
            if column is None:
                raise ValueError(f"invert is {name}, a column that the loop lacks; leave it out")
            changed[name] = -column
        return replace(self, **changed)
