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

_WRITTEN: dict[Quantity, tuple[str, str]] = {
    "lateral": (LATERAL_UNIT, "m"),
    "vertical": (VERTICAL_UNIT, "m"),
    "force": (FORCE_UNIT, "N"),
    "adhesion": (r"$w_\mathrm{int}$", "J/m²"),
    "energy": (ENERGY_UNIT, "J"),
}
"""Reduced unit and that of SI of each quantity."""

_MOST_TICKS = 5
"""Ticks of a length in SI, few because each stands with its unit."""


@dataclass(frozen=True, slots=True)
class AxisUnits:
    """What a reduced length, height, force and w_int are on an axis, in SI or themselves."""

    lateral: float = 1.0
    vertical: float = 1.0
    force: float = 1.0
    adhesion: float = 1.0
    is_si: bool = False

    @classmethod
    def by(cls, scales: Scales) -> AxisUnits:
        """Units of SI, by the sphere that makes reduced units."""
        reduced = scales.lateral, scales.vertical, scales.force, scales.work_of_adhesion
        return cls(*reduced, is_si=True)

    @property
    def energy(self) -> float:
        """What a reduced energy is on an axis."""
        return self.force * self.vertical

    def name(self, axis: Axis, what: str, quantity: Quantity) -> None:
        """Write on an axis, or on that of a colour bar, what it shows."""
        reduced, si = _WRITTEN[quantity]
        if not self.is_si:
            axis.set_label_text(f"{what} / {reduced}")
            return
        from matplotlib.ticker import EngFormatter, MaxNLocator

        axis.set_label_text(what)
        if quantity == "lateral":
            axis.set_major_locator(MaxNLocator(_MOST_TICKS))
        axis.set_major_formatter(EngFormatter(si))

    def adhesion_text(self, value: float) -> str:
        """A work of adhesion that is given in w_int, in the mathematics of a label."""
        if not self.is_si:
            return rf"{value:.3f}\,w_\mathrm{{int}}"
        number, unit = prefixed("J/m^2", value * self.adhesion).split(" ")
        return rf"{number}\ \mathrm{{{unit}}}"


REDUCED = AxisUnits()
"""Reduced units."""
