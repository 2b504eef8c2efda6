"""Units of axes: reduced units, or SI units with one prefix for all ticks of an axis."""

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
    """Units of the axes of a figure: SI units for a sphere, reduced units without one."""

    sphere: Scales | None = None

    @property
    def is_si(self) -> bool:
        """Whether the axes are in SI."""
        return self.sphere is not None

    def scale(self, unit: ReducedUnit) -> float:
        """Value of a reduced unit in units of the axes."""
        return 1.0 if self.sphere is None else unit.scale(self.sphere)

    def name(self, axis: Axis, quantity: str, unit: ReducedUnit) -> None:
        """Label an axis, or the axis of a colour bar, with its quantity and unit.

        In SI, ticks of a linear axis are scaled to the prefix of the unit.
        """
        if not self.is_si:
            axis.set_label_text(f"{quantity} / ${unit.tex}$")
            return
        from matplotlib.ticker import Formatter

        name = unit.si.replace(" / ", "/").replace("^2", "²")
        if axis.get_scale() != "log":
            name, scale = scaled_unit(name, max(map(abs, axis.get_view_interval())))
            # A tick at zero may be off by rounding.
            axis.set_major_formatter(
                lambda value, _: Formatter.fix_minus(f"{round(value / scale, 6) + 0.0:g}")
            )
        axis.set_label_text(f"{quantity} ({name})")

    def adhesion_text(self, value: float) -> str:
        """A work of adhesion (Units: w_int) as TeX for a label, in the units of the axes."""
        if not self.is_si:
            return rf"{value:.3f}\,{ADHESION.tex}"
        number, unit = prefixed("J/m^2", value * self.scale(ADHESION)).split(" ")
        return rf"{number}\ \mathrm{{{unit}}}"


def scaled_unit(unit: str, value: float) -> tuple[str, float]:
    """Unit with the prefix that suits a value, and the factor of this prefix.

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
