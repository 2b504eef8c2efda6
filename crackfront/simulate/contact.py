"""The interface of a kind of contact in simulations: a class of its loads."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from crackfront.core.adhesion import AdhesionMap, FieldKind
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.field.fields import Interpolation, TileField
from crackfront.core.geometry.base import Geometry, fast_site_count
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.laws import sphere_size
from crackfront.simulate.tiles import RandomSurface, gaussian_adhesion

if TYPE_CHECKING:
    from crackfront.analysis.steady_adhesion import SteadyAdhesion
    from crackfront.simulate.numerics import Numerics


class ExpectedMotion(NamedTuple):
    """States that a simulation is expected to find."""

    n_state: float
    travel: float
    """Way of a smooth front from state to state, in correlation lengths of w_loc."""


class SweepLoad(Protocol):
    """Load of all simulations of a sweep; a :class:`Schedule` is one that all of them share."""

    @property
    def max_penetration(self) -> float:
        """Largest penetration of a sphere (Units: reduced vertical length); else 0."""

    @property
    def uncorrelated(self) -> bool:
        """Whether sites are independent of each other, the limit of weak disorder."""

    def usual_size(self, spectrum: Spectrum) -> float:
        """Size of a front for choosing settings, as in :mod:`crackfront.simulate.laws`."""

    def for_surface(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        spring: float,
        numerics: Numerics,
    ) -> Schedule:
        """Loads on the surfaces of one spectrum, amplitude and spring of the sweep."""


class Schedule(ABC):
    """Loads of a kind of contact, with all that simulations need of this kind.

    A kind is a frozen dataclass in a folder of its own. Its fields enter the keys of simulations.
    It has these attributes, the abstract methods, and others of them where the default is another.
    """

    __slots__ = ()

    load_name: ClassVar[str]
    """What keys of simulations call this kind of load, whatever its class is named."""
    max_penetration: float
    """Largest penetration of a sphere; else 0. (Units: reduced vertical length)"""
    spring: float
    """Length of the springs of a straight front; else NaN. (Units: length)"""
    uncorrelated: bool
    """Whether sites are independent of each other, the limit of weak disorder."""

    @property
    @abstractmethod
    def n_period(self) -> int | None:
        """States at the end of each branch that are averaged; None where travel decides."""

    # The contact and its surface.

    @property
    @abstractmethod
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""

    def usual_size(self, spectrum: Spectrum) -> float:
        """Size of a front for which settings are chosen, by default that of a sphere."""
        return sphere_size(spectrum)

    def site_count(self, requested: int | None, least: float, n_point: int) -> int:
        """Sites of a front: as requested, else the least, on a tile of so many points along it."""
        return requested or fast_site_count(least)

    def fitted(self, side: float, spacing: float) -> tuple[float, float]:
        """Side of the tile along the front, of a least one, and distance of samples, of a largest.

        (Units: length)
        """
        return side, spacing

    def tile(self, n_point: int, side: float) -> tuple[tuple[int, int], tuple[float, float]]:
        """Points and sides along x and y of a tile with so many points on its side along y."""
        return (n_point, n_point), (side, side)

    @abstractmethod
    def geometry(self, n_site: int) -> Geometry:
        """Contact, whose springs do not pull at w_int."""

    def adhesion(self, surface: RandomSurface) -> AdhesionMap:
        """Work of adhesion on the tile of a surface, by default that of a Gaussian one."""
        return gaussian_adhesion(surface)

    @abstractmethod
    def field(
        self, adhesion: AdhesionMap, n_site: int, spacing: float, interpolation: Interpolation
    ) -> TileField:
        """Field of a tile, as of :func:`crackfront.core.geometry.sphere.contact_field`."""

    # The run.

    def for_surface(self, *_: object) -> Schedule:
        """Loads on one surface, by default the same on all."""
        return self

    @abstractmethod
    def run(
        self,
        field: Any,
        solver: Solver | None,
        recorder: Recorder,
        *,
        correlation_length: float,
        elastic_energy: float,
    ) -> CycleRecord:
        """States of the whole load on a field of a correlation length and an e_el (w_int)."""

    @classmethod
    @abstractmethod
    def smallest(cls) -> Schedule:
        """Shortest loads of the kind, on which its kernels are compiled."""

    # What is known of it before and after.

    @abstractmethod
    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States that these loads are expected to find on a surface."""

    @abstractmethod
    def spring_at(self, work_of_adhesion: float) -> float:
        """Length L_kappa of the springs that hold the front at the largest load (Units: length).

        The work of adhesion (Units: w_int) is that of a branch. ValueError where nothing holds it.
        """

    @abstractmethod
    def steady_load(
        self, surface: RandomSurface, works: tuple[float, float], travel: float, n_state: int
    ) -> float:
        """Largest load from which on so many states of both branches on a surface are steady.

        Works of adhesion of approach and retraction (Units: w_int) and the travel after which a
        branch is steady (Units: length) are expected ones. Minus infinity where any load is enough.
        (Units: that of the load)
        """

    @abstractmethod
    def refuse_few_sites(self, name: str, larkin_length: float, site: float) -> None:
        """Raise ValueError if sites of this distance cannot resolve a spectrum of this name."""

    @abstractmethod
    def averaged_sizes(
        self, steady: SteadyAdhesion, correlation_length: float, short_cutoff: float
    ) -> tuple[float, float, float]:
        """Sizes of the fronts that w_appr and w_retr average, and the longest (Units: length).

        Sizes are as in :mod:`crackfront.simulate.laws`; states closer than a correlation
        length of w_loc count as one.
        """
