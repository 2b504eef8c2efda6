r"""A straight periodic front, each site of which is on a spring; its rays are parallel.

With the place X of the springs' other end as the load,

.. math:: w_{loc}(u, y) = \bar w + \kappa (u - X) + w_{int} |\partial_y| u ,

where a spring is as stiff as the line is over the length L_kappa = w_int / kappa. A sphere is
locally such a line: see docs/model.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
from scipy.fft import rfft

from crackfront.core.adhesion import AdhesionMap
from crackfront.core.arguments import check_positive
from crackfront.core.arrays import Array
from crackfront.core.compiled import implements
from crackfront.core.field.fields import Interpolation, TileField, tile_field
from crackfront.core.geometry import base
from crackfront.core.outcome import Direction, Relaxation, Status
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, LENGTH, Variable, variable

Value = TypeVar("Value", float, Array)


@dataclass(frozen=True)
class LineState(Generic[Value]):
    """A metastable straight front, or all of a cycle, one entry a state."""

    load_noun: ClassVar[str] = "load"
    branch_names: ClassVar[Mapping[int, str]] = {1: "forward", -1: "back"}
    front_name: ClassVar[str] = "position"

    spring_position: Value = variable("place of the springs' other end, the load", LENGTH)
    direction: Value = variable("+1 where the load advances, -1 where it recedes", "1")
    mean_position: Value = variable("mean place of the front", LENGTH)
    rms_position: Value = variable("rms deviation of the front from its mean", LENGTH)
    pinning_force: Value = variable("mean force of the springs, kappa (X - mean)", ADHESION)
    least_travel: Value = variable("smallest way of a site since its branch began", LENGTH)
    iterations: Value = variable("sweeps of the solver", "1")
    updates: Value = variable("updates of single sites by the solver", "1")
    residual: Value = variable("largest force along the motion, per front length", ADHESION)

    @property
    def summary(self) -> str:
        """One state in words."""
        return (
            f"load {self.spring_position:+.6g}, pinning force {self.pinning_force:+.4f}, "
            f"mean position {self.mean_position:.6g}, rms {self.rms_position:.4g}"
        )

    def forces_summary(self, status: Status) -> str:
        """Largest pinning forces of the states of a cycle, in words."""
        most, least = np.max(self.pinning_force), np.min(self.pinning_force)
        return f"pinning force up to {most:.4g} forward and {least:.4g} back (w_int)"


class Line(NamedTuple):
    """A straight periodic front.

    Attributes
    ----------
    n_site : int
        Number of sites.
    length : float
        Period. (Units: length)
    stiffness : float
        Stiffness of the springs, kappa. (Units: reduced energy / length**3)
    mean : float
        Work of adhesion at which they do not pull. (Units: reduced energy / area)
    corner : tuple of float
        Coordinates of the first point of a tile; rays begin at x = 0. (Units: length)
    """

    n_site: int
    length: float
    stiffness: float
    mean: float
    corner: tuple[float, float] = (0.0, 0.0)

    @property
    def perimeter(self) -> float:
        """The period (Units: length)."""
        return self.length

    @property
    def sites(self) -> Array:
        """Places of the rays along the front (Units: length)."""
        return self.corner[1] + self.length * np.arange(self.n_site) / self.n_site

    @property
    def state_type(self) -> type[LineState[Array]]:
        """Record of a straight front."""
        return LineState

    @property
    def variables(self) -> tuple[Variable, Variable]:
        """Places of a front, and places of its sites along it."""
        site = Variable("y", ("y",), LENGTH, "place of a site along the front")
        return Variable(LineState.front_name, ("y",), LENGTH, "front"), site

    def state(
        self, relaxation: Relaxation, load: float, direction: Direction, turn: Array
    ) -> LineState[float]:
        """Quantities that are recorded of a front in equilibrium."""
        mean = float(np.mean(relaxation.front))
        return LineState(
            spring_position=load,
            direction=direction,
            mean_position=mean,
            rms_position=float(np.std(relaxation.front)),
            pinning_force=self.stiffness * (load - mean) / WORK_OF_ADHESION,
            least_travel=float(np.min(np.abs(relaxation.front - turn))),
            iterations=relaxation.sweeps,
            updates=relaxation.updates,
            residual=relaxation.residual,
        )

    def stored_energy(self, front: Array, load: float) -> float:
        """Energy of springs and line (Units: reduced energy)."""
        springs = self.mean * front + self.stiffness / 2 * (front - load) ** 2
        power = np.abs(rfft(front, norm="forward")) ** 2
        power[1 : (self.n_site + 1) // 2] *= 2
        line = np.sum(_stiffness(self, 1.0) * np.arange(power.size) * power) / 2
        return self.length * float(np.mean(springs) + line)

    def can_rest_inside(self, place: float, product: float, load: float) -> bool:
        """True: a straight front does not lose contact."""
        return True


def line_field(
    adhesion: AdhesionMap,
    spring: float,
    loads: tuple[float, float],
    *,
    n_site: int | None = None,
    spacing: float | None = None,
    interpolation: Interpolation = "cubic",
    band_limited: bool = False,
) -> TileField:
    """Field of a straight front along y on a periodic tile, which no load between two leaves.

    Parameters
    ----------
    adhesion : AdhesionMap
        Work of adhesion on the tile; its mean is that at which the springs do not pull.
    spring : float
        Length of the springs, L_kappa. (Units: length)
    loads : tuple of float
        Lowest and highest load. (Units: length)
    n_site : int, optional
        Sites of the front, by default one for every y.
    spacing : float, optional
        Distance of samples along a ray, by default the pixel. (Units: length)
    interpolation, band_limited
        As of :func:`crackfront.core.field.fields.tile_field`.

    Raises
    ------
    ValueError
        If the length of the spring is not positive, or as in
        :func:`crackfront.core.field.fields.tile_field`.
    """
    check_positive(spring=spring)
    values, pixel = adhesion.work_of_adhesion, adhesion.pixel
    stiffness, mean = WORK_OF_ADHESION / spring, float(np.mean(values))
    count = n_site or values.shape[1]
    line = Line(count, pixel * values.shape[1], stiffness, mean, adhesion.corner)
    reach = _reach(adhesion, stiffness) + 2 * pixel
    steps = np.floor((loads[0] - reach - adhesion.corner[0]) / pixel)
    return tile_field(
        adhesion,
        line,
        pixel if spacing is None else spacing,
        loads[1] + reach,
        interpolation,
        band_limited=band_limited,
        origin=adhesion.corner[0] + steps * pixel,
    )


def initial_front(field: TileField, adhesion: AdhesionMap, load: float) -> Array:
    """Straight front so far behind a load that every site is driven forward.

    Parameters
    ----------
    field : TileField
        Field of the line on the tile.
    adhesion : AdhesionMap
        The tile.
    load : float
        Place of the springs' other end. (Units: length)

    Returns
    -------
    (n_site,) array
        The front. (Units: length)
    """
    line = field.geometry
    return np.full(line.n_site, load - _reach(adhesion, line.stiffness))


def _reach(adhesion: AdhesionMap, stiffness: float) -> float:
    """Distance to the load at which the springs overcome any pinning of a tile (Units: length)."""
    values = adhesion.work_of_adhesion
    # Splines overshoot the points by less than a quarter of their range.
    return 1.25 * float(values.max() - values.min()) / stiffness + 2 * adhesion.pixel


@implements(base.restoring_force, Line)
def _spring_force(geometry: Any, place: float, load: float) -> float:
    """Mean work of adhesion and force of the spring, per length of the front."""
    return geometry.mean + geometry.stiffness * (place - load)


@implements(base.restoring_slope, Line)
def _spring_slope(geometry: Any, place: float, load: float) -> float:
    """Stiffness of the spring, the same at all places."""
    return geometry.stiffness


@implements(base.lowest_place, Line)
def _lowest(geometry: Any, load: float) -> float:
    """Minus infinity: a straight front can rest anywhere."""
    return -np.inf


@implements(base.mode_stiffness, Line)
def _stiffness(geometry: Any, mode: float) -> float:
    """w_int times the wavevector of the mode."""
    return WORK_OF_ADHESION * 2 * np.pi / geometry.length * mode


@implements(base.weight, Line)
def _unit_weight(geometry: Any, place: float) -> float:
    """Weight of the work of adhesion, 1: forces are per length of the front."""
    return 1.0


@implements(base.weight_slope, Line)
def _no_slope(geometry: Any) -> float:
    """Derivative of the constant weight."""
    return 0.0


@implements(base.ray_start, Line)
def _row(geometry: Any, ray: int, n_x: int, n_y: int, inverse_pixel: float) -> Any:
    """Point of a tile at which the ray, parallel to x, crosses x = 0."""
    spacing = geometry.length / geometry.n_site
    return -geometry.corner[0] * inverse_pixel, ray * spacing * inverse_pixel


@implements(base.ray_direction, Line)
def _along(geometry: Any, ray: int) -> Any:
    """Unit vector along x."""
    return 1.0, 0.0
