"""The interface of a kind of contact in simulations, and how to add a kind.

A kind of contact is one file or folder. `Simulation.schedule` is an instance of its class, and no
other code asks which kind it is. `tests/simulate/test_third_contact.py` adds a cylinder in one
file. A new kind must provide the following:

1. Its geometry: the named tuple, the state and the compiled functions that
   :mod:`crackfront.core.geometry.base` lists. Other loads of a sphere or a line use the
   geometries of `core/geometry`.
2. A frozen dataclass that derives from :class:`Schedule`. Its fields and its `load_name` are part
   of the key of a simulation. Keys stay the same if a later field has a default.
3. The problem, :class:`ContactTile`: the sizes of front and tile, the work of adhesion, the field.
4. The loads, :class:`Loads`: a run from load to load, and the shortest loads of the kind.
5. The result, :class:`Averages`: the works of adhesion of a run, and the cutoffs that the
   averaged fronts cross.
6. The forecast, :class:`Forecast`: the number of states, which decides the cost, and the stiffness
   with which the contact restores its edge, which decides k by the law.
7. If a contact has a largest penetration, also :class:`Pressed`: sweeps advise to penetrate deeper.
   If springs of a constant length pull its front, also :class:`OnSprings`: tables have the length.
8. If the loads of a sweep depend on the surface, a second dataclass that derives from
   :class:`SurfaceLoads`; else a sweep has the :class:`Schedule` itself.
9. For configurations, its keys in `LoadSection` of `sweep/sections.py`. For `run_loop` and
   `crackfront cycle`, a :class:`crackfront.surfaces.loop_setup.LoopContact`.

Lengths are in the unit of the spectrum, works of adhesion in w_int where nothing else is said.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from crackfront.core.adhesion import AdhesionMap, FieldKind
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.field.fields import Field, TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.tiles import Fineness, RandomSurface, Resolution

if TYPE_CHECKING:
    from crackfront.analysis.steady_adhesion import SteadyAdhesion
    from crackfront.simulate.numerics import Numerics
    from crackfront.simulate.simulation import Simulation


@dataclass(frozen=True, slots=True)
class Problem:
    """What a front moves over."""

    field: Field
    """Work of adhesion along its rays, with the geometry."""
    correlation_length: float
    """Correlation length of w_loc. (Units: reduced lateral length)"""
    elastic_energy: float
    """Requested e_el. (Units: w_int)"""


class ExpectedMotion(NamedTuple):
    """States that a simulation is expected to find."""

    n_state: float
    travel: float
    """Way of a smooth front from state to state, in correlation lengths of w_loc."""


class ContactTile(ABC):
    """The problem: sizes of the front and the tile, and the field on it."""

    __slots__ = ()

    @property
    @abstractmethod
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""

    @abstractmethod
    def resolution(self, fineness: Fineness) -> Resolution:
        """Sizes of front and tile that are as fine as requested; they are part of the key."""

    @abstractmethod
    def tile(self, resolution: Resolution) -> tuple[tuple[int, int], tuple[float, float]]:
        """Points and sides of the tile along x and y, of equal pixels (Units: length)."""

    @abstractmethod
    def geometry(self, n_site: int) -> Geometry:
        """Contact with a front of so many sites, without a tile."""

    @abstractmethod
    def adhesion(self, surface: RandomSurface) -> AdhesionMap:
        """Work of adhesion on the tile of a surface."""

    @abstractmethod
    def field(self, adhesion: AdhesionMap, resolution: Resolution) -> TileField:
        """Field of a tile that no front leaves under these loads."""


class Loads(ABC):
    """A run from load to load."""

    __slots__ = ()

    load_name: ClassVar[str]
    """Name of this kind of load in keys, whatever its class is named."""

    @abstractmethod
    def run(self, problem: Problem, solver: Solver | None, recorder: Recorder) -> CycleRecord:
        """Record of a front under all loads: `recorder.run`, then `recorder.record`.

        Its status is `LOST_CONTACT` after a full cycle and `STEADY` where all loads of other
        kinds were visited: rows have works of adhesion for these statuses alone.
        """

    @classmethod
    @abstractmethod
    def smallest(cls) -> Schedule:
        """Shortest loads of the kind, on which its kernels are compiled."""


class Averages(ABC):
    """The works of adhesion that a run gives."""

    __slots__ = ()

    @abstractmethod
    def steady_adhesion(
        self, record: CycleRecord, correlation_length: float, mean_adhesion: float
    ) -> SteadyAdhesion:
        """Apparent works of adhesion of both branches, or a sentence that says why not.

        The correlation length is of w_loc (Units: length), the mean of w_loc on the tile in w_int.
        A kind averages over its steady states or over a whole period of its tile;
        :mod:`crackfront.analysis.steady_adhesion` has functions for both.
        """

    @abstractmethod
    def averaged_cutoffs(
        self, steady: SteadyAdhesion, correlation_length: float, short_cutoff: float
    ) -> tuple[float, float, float]:
        """Cutoffs crossed by the fronts that w_appr and w_retr average, and the longest front.

        Cutoffs crossed are as in :mod:`crackfront.simulate.laws`; states closer than a correlation
        length of w_loc count as one. (Units of the front: length)
        """

    @abstractmethod
    def usual_cutoffs(self, spectrum: Spectrum) -> float:
        """Cutoffs crossed, for which settings are chosen, as in :mod:`crackfront.simulate.laws`."""


class Forecast(ABC):
    """What is expected before a run."""

    __slots__ = ()

    @abstractmethod
    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States that these loads are expected to find on a surface."""

    @abstractmethod
    def spring_at(self, work_of_adhesion: float) -> float:
        """Length L_kappa of the springs on the front at the largest load (Units: length).

        The work of adhesion (Units: w_int) is the apparent one of a branch. Infinity if the edge
        is unstable.
        """


class Schedule(ContactTile, Loads, Averages, Forecast):
    """Loads of a kind of contact, with all that simulations need of this kind."""

    __slots__ = ()


class Pressed(ABC):
    """Loads up to a largest penetration."""

    __slots__ = ()

    max_penetration: float
    """Largest penetration. (Units: reduced vertical length)"""

    @abstractmethod
    def steady_penetration(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float:
        """Largest penetration from which on so many states of both branches are steady.

        Works of adhesion of approach and retraction (Units: w_int) and the transient, the travel
        after which a branch is steady (Units: length), are expected ones. (Units: reduced vertical
        length)
        """

    def steadier_start(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float | None:
        """Start that leaves so many steady states without a deeper contact, as above.

        None if no start does, or the loads always begin at first contact. (Units: reduced vertical
        length)
        """
        return None

    def steadier_travel(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float | None:
        """Way from state to state that leaves so many steady ones, as above.

        None if no way does, or the loads are steps. (Units: correlation length)
        """
        return None


class OnSprings(ABC):
    """A front on springs of a constant length."""

    __slots__ = ()

    spring: float
    """Length of the springs, L_kappa. (Units: length)"""


class SurfaceLoads(ABC):
    """Rule of a sweep that makes loads for each spectrum and amplitude, a frozen dataclass."""

    __slots__ = ()

    @abstractmethod
    def usual_cutoffs(self, spectrum: Spectrum) -> float:
        """Cutoffs crossed, for which settings are chosen, as :meth:`Averages.usual_cutoffs`."""

    @abstractmethod
    def for_surface(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        spring: float,
        numerics: Numerics,
    ) -> Schedule:
        """Loads on the surfaces of one spectrum, amplitude and spring of the sweep."""

    @abstractmethod
    def check_resolution(self, simulation: Simulation) -> None:
        """Raise ValueError if the numerics are too coarse for loads that this rule made."""


SweepLoad = Schedule | SurfaceLoads
"""Loads of a sweep: the same for all simulations, or a rule that makes them for each surface."""
