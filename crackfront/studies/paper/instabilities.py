"""Main Fig. 3a, b: a retraction in single instabilities, for strong and for weak disorder."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from crackfront.core import jkr
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import Motion, resolved_motion, swept_clusters
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.outcome import Direction
from crackfront.core.records import ADHESION, ENERGY, FORCE, LATERAL, VERTICAL, variable
from crackfront.data.section import Count, Energy, Positive, Section, refusal
from crackfront.studies.paper.contact import STRONG, WEAK, RoughContact, rough_contact
from crackfront.studies.paper.figure import Progress

Array = NDArray[np.float64]

_DISORDER, _EVENT, _ANGLE, _STATE = "disorder", "instability", "angle", "state"


class InstabilityParameters(Section):
    """What Fig. 3a and b show.

    Attributes
    ----------
    short_cutoff : float
        Shortest wavelength of the flat spectrum. (Units: reduced lateral length)
    strong, weak : float
        e_el of the two surfaces. (Units: w_int)
    max_penetration, load_step : float
        Penetrations that are visited in any case. (Units: reduced vertical length)
    travel : float
        Largest motion of a site in a smooth step, over the short cutoff.
    precision : float
        Penetration to which an instability is located. (Units: reduced vertical length)
    error : float
        Error of the factor k that the resolution may leave.
    least_angles : int
        Fewest sites of the front.
    seed : int
        Seed of the surface; both amplitudes have the same.
    """

    short_cutoff: Positive
    strong: Energy
    weak: Energy
    max_penetration: Positive
    load_step: Positive
    travel: Positive
    precision: Positive
    error: Positive
    least_angles: Count
    seed: Count

    @model_validator(mode="after")
    def _ordered(self) -> InstabilityParameters:
        if self.weak >= self.strong:
            raise refusal(
                f"e_el is {self.strong:g} for strong and {self.weak:g} for weak disorder; the "
                "first must be the larger"
            )
        return self


@dataclass(frozen=True, slots=True)
class InstabilityRecord:
    """Instabilities of two retractions, and the whole cycle of the stronger disorder."""

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    travel: float = variable("smallest motion that counts as a jump", LATERAL)
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms measured on the tile", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    work: Array = variable("work of the load in retraction", ENERGY, _DISORDER)
    energy_change: Array = variable("change of energy in retraction", ENERGY, _DISORDER)
    smooth_energy: Array = variable("energy lost in the smooth steps", ENERGY, _DISORDER)
    disorder_index: NDArray[np.int64] = variable("which disorder", "1", _EVENT)
    penetration: Array = variable("penetration of the instability", VERTICAL, _EVENT)
    energy: Array = variable("energy that the instability dissipates", ENERGY, _EVENT)
    extent: Array = variable("width of its largest patch", LATERAL, _EVENT)
    before: Array = variable("front before the instability", LATERAL, _EVENT, _ANGLE)
    after: Array = variable("front after the instability", LATERAL, _EVENT, _ANGLE)
    state_direction: NDArray[np.int64] = variable("+1 approach, -1 retraction", "1", _STATE)
    state_penetration: Array = variable("penetration of a state", VERTICAL, _STATE)
    state_radius: Array = variable("mean radius of a state", LATERAL, _STATE)
    state_force: Array = variable("normal force of a state", FORCE, _STATE)


@dataclass(frozen=True, slots=True)
class _Branch:
    """A resolved branch: its steps and what each dissipates."""

    motions: list[Motion]
    energies: Array
    unstable: NDArray[np.bool_]

    @property
    def states(self) -> Array:
        """Penetration, mean radius and force of all states, (3, n_state)."""
        first = self.motions[0]
        fronts = [(first.start, first.before), *((step.end, step.after) for step in self.motions)]
        return np.array([(b, np.mean(a), np.mean(jkr.force(a, b))) for b, a in fronts]).T


def instability_record(parameters: InstabilityParameters, progress: Progress) -> InstabilityRecord:
    """Retraction of both surfaces until contact is lost, and the approach of the stronger one.

    Parameters
    ----------
    parameters : InstabilityParameters
        What to compute.
    progress : callable
        Called with a line for every branch.

    Raises
    ------
    ValueError
        If the two surfaces need different numbers of sites.
    """
    schedule = LoadSchedule(parameters.max_penetration, parameters.load_step)
    contacts = _contacts(parameters)
    approach = _branch(parameters, contacts[STRONG], 0.0, schedule.approach(), 1)
    progress(f"approach: {np.count_nonzero(approach.unstable)} instabilities")
    retractions = []
    for contact, name in zip(contacts, ("strong", "weak"), strict=True):
        branch = _branch(parameters, contact, parameters.max_penetration, schedule.retraction(), -1)
        progress(f"retraction, {name} disorder: {np.count_nonzero(branch.unstable)} instabilities")
        retractions.append(branch)
    return _record(parameters, contacts, approach, retractions)


def _contacts(parameters: InstabilityParameters) -> list[RoughContact]:
    """The two contacts, of one surface."""
    contacts = [
        rough_contact(
            parameters.short_cutoff,
            energy,
            parameters.max_penetration,
            realisation=0,
            seed=parameters.seed,
            error=parameters.error,
            tolerance=parameters.precision / 10,
            least_angles=parameters.least_angles,
        )
        for energy in (parameters.strong, parameters.weak)
    ]
    sites = [contact.field.geometry.n_site for contact in contacts]
    if sites[STRONG] != sites[WEAK]:
        raise ValueError(
            f"the fronts have {sites[STRONG]} and {sites[WEAK]} sites; raise least_angles to "
            f"{max(sites)}"
        )
    return contacts


def _branch(
    parameters: InstabilityParameters,
    contact: RoughContact,
    start: float,
    loads: Iterable[float],
    direction: Direction,
) -> _Branch:
    """One branch from the front that an approach to `start` has."""
    motions = list(
        resolved_motion(
            contact.field,
            contact.touched(start),
            start,
            loads,
            direction,
            travel=parameters.travel * parameters.short_cutoff,
            precision=parameters.precision,
            solver=contact.solver,
        )
    )
    energies = [
        dissipated_energy(step.before, step.after, step.end, contact.field) for step in motions
    ]
    return _Branch(motions, np.array(energies), np.array([step.unstable for step in motions]))


def _record(
    parameters: InstabilityParameters,
    contacts: list[RoughContact],
    approach: _Branch,
    retractions: list[_Branch],
) -> InstabilityRecord:
    """Arrays of the figure."""
    travel = parameters.travel * parameters.short_cutoff
    events = [
        (index, step, energy)
        for index, branch in enumerate(retractions)
        for step, energy in zip(branch.motions, branch.energies, strict=True)
        if step.unstable
    ]
    jumps = [step for _, step, _ in events]
    states = [branch.states for branch in (approach, retractions[STRONG])]
    balances = [_balance(*pair) for pair in zip(contacts, retractions, strict=True)]
    penetration, radius, force = np.concatenate(states, axis=1)
    return InstabilityRecord(
        short_cutoff=parameters.short_cutoff,
        travel=travel,
        elastic_energy=np.array([parameters.strong, parameters.weak]),
        rms=np.array([contact.rms for contact in contacts]),
        larkin_length=np.array([contact.larkin_length for contact in contacts]),
        work=np.array([work for work, _ in balances]),
        energy_change=np.array([change for _, change in balances]),
        smooth_energy=np.array([np.sum(one.energies[~one.unstable]) for one in retractions]),
        disorder_index=np.array([index for index, _, _ in events]),
        penetration=np.array([step.end for step in jumps]),
        energy=np.array([energy for _, _, energy in events]),
        extent=np.array(
            [swept_clusters(step.before, step.after, travel)[0].extent for step in jumps]
        ),
        before=np.array([step.before for step in jumps]),
        after=np.array([step.after for step in jumps]),
        state_direction=np.repeat([1, -1], [one.shape[1] for one in states]),
        state_penetration=penetration,
        state_radius=radius,
        state_force=force,
    )


def _balance(contact: RoughContact, branch: _Branch) -> tuple[float, float]:
    """Work of the load over a branch, and by how much the energy of the contact changed.

    The energy is that of the first and of the last front, whatever lies between them.
    """
    penetration, _, force = branch.states
    first, last = branch.motions[0], branch.motions[-1]
    held = jkr.elastic_energy(first.before, last.end) - jkr.elastic_energy(
        first.before, first.start
    )
    fall = dissipated_energy(first.before, last.after, last.end, contact.field)
    return float(np.trapezoid(force, penetration)), float(np.mean(held)) - fall
