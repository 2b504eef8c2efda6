r"""The interface of a geometry: functions that kernels dispatch on its type, and records of states.

A site of a front moves along its ray; its place is its distance along it. At rest, per site,

.. math:: \omega(u)\, w_{loc}(u) = f(u, X) + Q u ,

with a weight :math:`\omega`, the restoring force f under the load X and the stiffness Q of the
line, which is diagonal in the modes of the front.

A new geometry, such as :mod:`crackfront.core.geometry.line`, must provide the following:

1. A named tuple of numbers and arrays that has the members of :class:`Geometry`. It is all that
   kernels know of the contact. It need not be in `core`, but then each process compiles its
   kernels.
2. A frozen dataclass that has the members of :class:`State`: the record of a front at rest.
3. An implementation of each dispatched function of this module for the named tuple, registered by
   :func:`crackfront.core.compiled.implements`. numba compiles it, without keyword arguments.
4. The restoring force increases with the place, and so does its slope: solvers find the first
   equilibrium only then. A weight can make it so, as the radius of a sphere.
5. The restoring force falls where the load increases: an increasing load lets the front advance.
6. `stored_energy` is the energy whose derivative by the places is :math:`f + Q u`, summed over the
   perimeter. The recorder computes dissipated energies from it. The energies of making and losing
   contact also assume that the front is closed, with a perimeter of 2 pi.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Protocol

from scipy.fft import next_fast_len

from crackfront.core.arrays import Array
from crackfront.core.compiled import dispatched, jit
from crackfront.core.outcome import Direction, Relaxation, Status
from crackfront.core.variables import Variable


class State(Protocol):
    """Record of one front at rest, or of all fronts of a cycle: a dataclass of numbers or arrays.

    Its fields are made by :func:`crackfront.core.variables.variable`. The first is the load. Every
    kind of contact has the fields below; a kind that loses contact also has a `force`.
    """

    load_noun: ClassVar[str]
    """What messages call the load."""
    branch_names: ClassVar[Mapping[int, str]]
    """What messages and figures call the branches, by their direction."""
    front_name: ClassVar[str]
    """Name of the fronts in files."""

    @property
    def direction(self) -> Any:
        """Direction in which the load was reached, +1 or -1."""

    @property
    def least_travel(self) -> Any:
        """Smallest way of a site since its branch began."""

    @property
    def iterations(self) -> Any:
        """Sweeps of the solver."""

    @property
    def updates(self) -> Any:
        """Updates of single sites by the solver."""

    @property
    def residual(self) -> Any:
        """Largest force along the motion that is left, per front length."""

    @property
    def summary(self) -> str:
        """One state in words."""

    def forces_summary(self, status: Status) -> str:
        """Forces of all states of a cycle that ended with a status, in words."""


class Geometry(Protocol):
    """Properties and methods of a geometry; the compiled functions of this module complete it."""

    @property
    def n_site(self) -> int:
        """Sites of the front."""

    @property
    def perimeter(self) -> float:
        """Sum of the distances between sites, in the unit in which forces are densities."""

    @property
    def state_type(self) -> type[Any]:
        """Dataclass of what is recorded of a front at rest, a :class:`State`."""

    @property
    def sites(self) -> Array:
        """Coordinates of the sites along the front."""

    @property
    def variables(self) -> tuple[Variable, Variable]:
        """What files say of the places of a front, and of the coordinates of its sites."""

    def state(self, relaxation: Relaxation, load: float, direction: Direction, turn: Array) -> Any:
        """What is recorded of a front at rest whose branch began at the front `turn`."""

    def stored_energy(self, front: Array, load: float) -> float:
        """Energy of body and line, the derivative of which is f + Q u."""

    def can_rest_inside(self, place: float, product: float, load: float) -> bool:
        """Whether a front may rest before a place of this weighted work of adhesion."""


@dispatched
def restoring_force(geometry: Any, place: float, load: float) -> float:
    """Restoring force f on a site; with the place it increases, and so does its convex slope."""
    raise NotImplementedError


@dispatched
def restoring_slope(geometry: Any, place: float, load: float) -> float:
    """Slope of the restoring force, an upper bound of the slope at all smaller places."""
    raise NotImplementedError


@dispatched
def lowest_place(geometry: Any, load: float) -> float:
    """Place below which no site can rest."""
    raise NotImplementedError


@dispatched
def mode_stiffness(geometry: Any, mode: float) -> float:
    """Stiffness of the line against a mode, proportional to its number."""
    raise NotImplementedError


@dispatched
def weight(geometry: Any, place: float) -> float:
    """Factor of the work of adhesion at a place in the balance of forces."""
    raise NotImplementedError


@dispatched
def weight_slope(geometry: Any) -> float:
    """Derivative of the weight by the place."""
    raise NotImplementedError


@dispatched
def ray_start(geometry: Any, ray: int, n_x: int, n_y: int, inverse_pixel: float) -> Any:
    """Where a ray begins on a periodic tile of so many points, x and y (Units: pixels)."""
    raise NotImplementedError


@dispatched
def ray_direction(geometry: Any, ray: int) -> Any:
    """Direction of a ray on a tile, x and y of a unit vector."""
    raise NotImplementedError


@jit
def self_modes(n_site: int) -> float:
    """Stiffness of the line against the advance of one site, relative to its first mode.

    The mean number of a mode: N/4 for even N, (N^2 - 1)/4N for odd N.
    """
    return n_site / 4 if n_site % 2 == 0 else (n_site**2 - 1) / (4 * n_site)


def fast_site_count(least: float) -> int:
    """Even number of sites, 4 or more and not below a number, whose transforms are fast.

    Transforms are fast of lengths without large prime factors. From 256 sites on the number is a
    multiple of 8, so that four pairs of sites are transformed at once; from 16384 on, of 32.
    """
    least = max(4.0, least * (1 - 1e-12))
    together = 2 if least < 256 else 8 if least < 16384 else 32
    return together * int(next_fast_len(math.ceil(least / together), real=True))
