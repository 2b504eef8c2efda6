"""Units of axes: reduced ones in the labels, or those of SI with their prefixes at the ticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from crackfront.core.units import ReducedUnit, Scales
from crackfront.core.variables import ADHESION, LATERAL
from crackfront.data.written_units import prefixed

if TYPE_CHECKING:
    from matplotlib.axis import Axis

_MOST_TICKS = 5
"""Ticks of a length in SI, few because each stands with its unit."""


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
        """Write on an axis, or on that of a colour bar, what it shows."""
        if not self.is_si:
            axis.set_label_text(f"{what} / ${unit.tex}$")
            return
        from matplotlib.ticker import EngFormatter, MaxNLocator

        axis.set_label_text(what)
        if unit is LATERAL:
            axis.set_major_locator(MaxNLocator(_MOST_TICKS))
        axis.set_major_formatter(EngFormatter(unit.si.replace(" / ", "/").replace("^2", "²")))

    def adhesion_text(self, value: float) -> str:
        """A work of adhesion that is given in w_int, in the mathematics of a label."""
        if not self.is_si:
            return rf"{value:.3f}\,{ADHESION.tex}"
        number, unit = prefixed("J/m^2", value * self.scale(ADHESION)).split(" ")
        return rf"{number}\ \mathrm{{{unit}}}"


REDUCED = AxisUnits()
"""Reduced units."""
