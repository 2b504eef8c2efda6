"""What a loop gives: its works of adhesion, the forces of its rows, and remarks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate
from crackfront.core.arrays import Array
from crackfront.core.variables import variable
from crackfront.core.words import wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class MeasuredLoop:
    """What a loop gives, in SI units; printed, it is a page.

    Arrays have an entry for each row of the recording. A simulated cycle in reduced units stays in
    them, its works of adhesion in w_int.
    """

    force: Array = variable("normal force, its zero corrected", "N", "row")
    contact_radius: Array = variable("contact radius", "m", "row")
    work_of_adhesion: Array = variable("apparent work of adhesion", "J m-2", "row")
    direction: Array = variable("1 in approach, -1 in retraction, 0 out of contact", "1", "row")
    in_window: NDArray[np.bool_] = variable("whether a row is averaged", "1", "row")
    w_appr: Estimate[float] = variable("work of adhesion of the approach", "J m-2")
    w_retr: Estimate[float] = variable("work of adhesion of the retraction", "J m-2")
    hysteresis: Estimate[float] = variable("w_retr - w_appr", "J m-2")
    contact_modulus: Estimate[float] = variable("contact modulus E', given or fitted", "Pa")
    fitted_modulus: Estimate[float] = variable("contact modulus E' that fits the loop", "Pa")
    stiffness: Estimate[float] = variable("stiffness of the machine", "N m-1")
    lost_energy: float = variable("energy lost in the loop per largest contact area", "J m-2")
    pull_off_force: Estimate[float] = variable("largest pulling force of the retraction", "N")
    sphere_radius: float = variable("radius of the sphere", "m")
    window: tuple[float, float] = (math.nan, math.nan)
    """Contact radii over which both works are averaged (Units: m)."""
    remarks: tuple[str, ...] = ()
    """Sentences on what was corrected, assumed or not found."""
    reduced: bool = False
    """Whether the numbers are in reduced units instead of SI."""

    def plot(self, axes: Axes | None = None) -> Axes:
        """Contact radius against force, with the JKR curves of both works of adhesion.

        Parameters
        ----------
        axes : matplotlib.axes.Axes, optional
            Axes to draw on; by default axes of a new figure.

        Returns
        -------
        matplotlib.axes.Axes
            The axes with the drawing.
        """
        from crackfront.measured.loops.loop_drawing import plot_measured_loop

        return plot_measured_loop(self, axes)

    def to_dict(self) -> dict[str, Any]:
        """Numbers and remarks for JSON, by the names of `crackfront loop --json`."""
        from crackfront.measured.loops.loop_page import loop_json

        return loop_json(self)

    def __repr__(self) -> str:
        """The page that the command `crackfront loop` prints."""
        from crackfront.measured.loops.loop_page import loop_lines

        return wrapped("\n".join(loop_lines(self)))
