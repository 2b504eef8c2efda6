"""Units of axes: reduced ones in the labels, or those of SI with their prefixes at the ticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from crackfront.core.units import Scales
from crackfront.data.written_units import prefixed
from crackfront.plots.parts import ENERGY_UNIT, FORCE_UNIT, LATERAL_UNIT, VERTICAL_UNIT

if TYPE_CHECKING:
    from matplotlib.axis import Axis

Quantity = Literal["lateral", "vertical", "force", "adhesion", "energy"]

_REDUCED: dict[Quantity, str] = {
    "lateral": LATERAL_UNIT,
    "vertical": VERTICAL_UNIT,
    "force": FORCE_UNIT,
    "adhesion": r"$w_\mathrm{int}$",
    "energy": ENERGY_UNIT,
}
_SI: dict[Quantity, str] = {
    "lateral": "m",
    "vertical": "m",
    "force": "N",
    "adhesion": "J/m²",
    "energy": "J",
}

_MOST_TICKS = 5
"""Places at which a length stands with its unit, which takes room."""


@dataclass(frozen=True, slots=True)
class AxisUnits:
    """Units in which reduced quantities are drawn: SI by a sphere, reduced without one."""

    scales: Scales | None = None

    @property
    def lateral(self) -> float:
        """What a reduced lateral length is on an axis."""
        return 1.0 if self.scales is None else self.scales.lateral

    @property
    def vertical(self) -> float:
        """What a reduced vertical length is on an axis."""
        return 1.0 if self.scales is None else self.scales.vertical

    @property
    def force(self) -> float:
        """What a reduced force is on an axis."""
        return 1.0 if self.scales is None else self.scales.force

    @property
    def adhesion(self) -> float:
        """What w_int is on an axis."""
        return 1.0 if self.scales is None else self.scales.work_of_adhesion

    @property
    def energy(self) -> float:
        """What a reduced energy is on an axis."""
        return self.force * self.vertical

    def name(self, axis: Axis, what: str, quantity: Quantity) -> None:
        """Write on an axis, or on that of a colour bar, what it shows."""
        if self.scales is None:
            axis.set_label_text(f"{what} / {_REDUCED[quantity]}")
            return
        from matplotlib.ticker import EngFormatter, MaxNLocator

        axis.set_label_text(what)
        if quantity == "lateral":
            axis.set_major_locator(MaxNLocator(_MOST_TICKS))
        axis.set_major_formatter(EngFormatter(_SI[quantity]))

    def adhesion_text(self, value: float) -> str:
        """A work of adhesion that is given in w_int, in the mathematics of a label."""
        if self.scales is None:
            return rf"{value:.3f}\,w_\mathrm{{int}}"
        number, unit = prefixed("J/m^2", value * self.adhesion).split(" ")
        return rf"{number}\ \mathrm{{{unit}}}"


REDUCED = AxisUnits()
"""Reduced units."""
