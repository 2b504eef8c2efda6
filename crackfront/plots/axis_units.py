"""Units of axes: reduced ones, or those of SI with one prefix for all ticks of an axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from crackfront.core.units import ReducedUnit, Scales
from crackfront.core.variables import ADHESION
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    from matplotlib.axis import Axis


@dataclass(frozen=True, slots=True)
class AxisUnits:
    """Units of the axes of a figure: those of SI for a sphere, or reduced ones without it."""

    sphere: Scales | None = None

    @property
    def is_si(self) -> bool:
        """Whether the axes are in SI."""
        return self.sphere is not None

    def scale(self, unit: ReducedUnit) -> float:
        """What a reduced unit is on an axis."""
        return 1.0 if self.sphere is None else unit.scale(self.sphere)

    def name(self, axis: Axis, what: str, unit: ReducedUnit) -> None:
        """Write on an axis, or on that of a colour bar, what it shows between its limits.

        Powers of ten, on a logarithmic axis, have no prefix.
        """
        if not self.is_si:
            axis.set_label_text(f"{what} / ${unit.tex}$")
            return
        from matplotlib.ticker import Formatter

        name, one = unit.si.replace(" / ", "/").replace("^2", "²"), 1.0
        if axis.get_scale() != "log":
            name, one = scaled_unit(name, max(map(abs, axis.get_view_interval())))
            # A tick at zero may be off by rounding.
            axis.set_major_formatter(
                lambda value, _: Formatter.fix_minus(f"{round(value / one, 6) + 0.0:g}")
            )
        axis.set_label_text(f"{what} ({name})")

    def adhesion_text(self, value: float) -> str:
        """A work of adhesion that is given in w_int, in the mathematics of a label."""
        if not self.is_si:
            return rf"{value:.3f}\,{ADHESION.tex}"
        number, unit = prefixed("J/m^2", value * self.scale(ADHESION)).split(" ")
        return rf"{number}\ \mathrm{{{unit}}}"


def scaled_unit(unit: str, value: float) -> tuple[str, float]:
    """Unit with the prefix that a value calls for, and what one of it is without the prefix.

    Examples
    --------
    >>> scaled_unit("m", 1.2e-4)
    ('µm', 1e-06)
    """
    from matplotlib.ticker import EngFormatter

    power = min(max(3 * math.floor(math.log10(value * (1 + 1e-9)) / 3), -12), 0)
    return f"{EngFormatter.ENG_PREFIXES[power]}{unit}", 10.0**power


REDUCED = AxisUnits()
"""Reduced units."""
