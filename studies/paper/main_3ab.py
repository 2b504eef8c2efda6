"""Main Fig. 3a, b: a retraction in single instabilities, for strong and for weak disorder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure as Drawing
from pydantic import model_validator
from scipy.signal import resample

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import (
    Motion,
    measured_instabilities,
    resolved_motion,
    shortest_instability,
)
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.outcome import Direction
from crackfront.core.variables import ADHESION, ENERGY, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.instability_maps import ENERGY_LABEL, draw_patches, energy_shades
from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL
from crackfront.plots.style import PAGE, PURPLE, VERMILION, blank_figure, explain, house_style
from crackfront.sweep.section import section_error
from crackfront.validation import Count, Positive
from studies.paper.checks import Check, close_to
from studies.paper.drawing import BRANCHES, draw_jump, name_panels, write_next_to
from studies.paper.figure import Figure, Integers
from studies.paper.rough import STRONG, WEAK, DisorderParameters, RoughContact, flat_spectrum
from studies.progress import Progress

_DISORDER, _EVENT, _ANGLE, _STATE = "disorder", "instability", "angle", "state"


class InstabilityParameters(DisorderParameters):
    """What Fig. 3a and b show."""

    load_step: Positive  # penetrations that are visited in any case (reduced vertical length)
    travel: Positive  # largest motion of a site in a smooth step, over the short cutoff
    precision: Positive  # penetration to which an instability is located
    least_angles: Count  # fewest sites of the front

    @model_validator(mode="after")
    def _ordered(self) -> InstabilityParameters:
        if self.weak >= self.strong:
            raise section_error(
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
    shortest: Array = variable(
        "length on which disorder is as stiff as the line", LATERAL, _DISORDER
    )
    work: Array = variable("work of the load in retraction", ENERGY, _DISORDER)
    energy_change: Array = variable("change of energy in retraction", ENERGY, _DISORDER)
    smooth_energy: Array = variable("energy lost in the smooth steps", ENERGY, _DISORDER)
    disorder_index: Integers = variable("which disorder", "1", _EVENT)
    penetration: Array = variable("penetration of the instability", VERTICAL, _EVENT)
    energy: Array = variable("energy that the instability dissipates", ENERGY, _EVENT)
    extent: Array = variable("width of its largest patch", LATERAL, _EVENT)
    before: Array = variable("front before the instability", LATERAL, _EVENT, _ANGLE)
    after: Array = variable("front after the instability", LATERAL, _EVENT, _ANGLE)
    state_direction: Integers = variable("+1 approach, -1 retraction", "1", _STATE)
    state_penetration: Array = variable("penetration of a state", VERTICAL, _STATE)
    state_radius: Array = variable("mean radius of a state", LATERAL, _STATE)
    state_force: Array = variable("normal force of a state", FORCE, _STATE)


@dataclass(frozen=True, slots=True)
class _Branch:
    """A resolved branch: its steps between metastable fronts."""

    contact: RoughContact
    steps: list[Motion]

    @property
    def jumps(self) -> list[Motion]:
        """Its instabilities."""
        return [step for step in self.steps if step.unstable]

    @property
    def smooth_energy(self) -> float:
        """Energy lost in the other steps, each taken at fixed penetration."""
        smooth, field = [step for step in self.steps if not step.unstable], self.contact.field
        lost = [dissipated_energy(step.before, step.after, step.end, field) for step in smooth]
        return float(np.sum(lost))

    @property
    def states(self) -> Array:
        """Penetration, mean radius and force of all states, (3, n_state)."""
        first = self.steps[0]
        fronts = [(first.start, first.before), *((step.end, step.after) for step in self.steps)]
        return np.array([(b, np.mean(a), np.mean(jkr.force(a, b))) for b, a in fronts]).T

    @property
    def work(self) -> float:
        """Work of the load."""
        penetration, _, force = self.states
        return float(np.trapezoid(force, penetration))

    @property
    def energy_change(self) -> float:
        """Change of the energy of the contact, from its first and last front alone."""
        first, last = self.steps[0], self.steps[-1]
        start, end = (jkr.stored_energy(first.before, state) for state in (first.start, last.end))
        fall = dissipated_energy(first.before, last.after, last.end, self.contact.field)
        return float(np.mean(end - start)) - fall


def instability_record(parameters: InstabilityParameters, progress: Progress) -> InstabilityRecord:
    """Retraction of both surfaces until contact is lost, and the approach of the stronger one."""
    contacts = _contacts(parameters)
    approach = _branch(parameters, contacts[STRONG], 1)
    progress(f"approach: {len(approach.jumps)} instabilities")
    retractions = []
    for contact, name in zip(contacts, ("strong", "weak"), strict=True):
        retractions.append(_branch(parameters, contact, -1))
        progress(f"retraction, {name} disorder: {len(retractions[-1].jumps)} instabilities")
    travel = parameters.travel * parameters.short_cutoff
    correlation = flat_spectrum(parameters.short_cutoff).correlation_length
    rms = [contact.w_rms for contact in contacts]
    states = [branch.states for branch in (approach, retractions[STRONG])]
    penetration, radius, force = np.concatenate(states, axis=1)
    return InstabilityRecord(
        short_cutoff=parameters.short_cutoff,
        travel=travel,
        elastic_energy=np.array([parameters.strong, parameters.weak]),
        rms=np.array(rms),
        shortest=np.array([shortest_instability(correlation, w_rms) for w_rms in rms]),
        work=np.array([branch.work for branch in retractions]),
        energy_change=np.array([branch.energy_change for branch in retractions]),
        smooth_energy=np.array([branch.smooth_energy for branch in retractions]),
        **_instability_values(retractions, travel),
        state_direction=np.repeat([1, -1], [branch_states.shape[1] for branch_states in states]),
        state_penetration=penetration,
        state_radius=radius,
        state_force=force,
    )


def _instability_values(retractions: Sequence[_Branch], travel: float) -> dict[str, Any]:
    """Instabilities of both retractions, the stronger disorder first."""
    instabilities = [
        measured_instabilities(branch.jumps, branch.contact.field, travel) for branch in retractions
    ]
    sizes = [instability.penetration.size for instability in instabilities]

    def values(name: str) -> Array:
        return np.concatenate([getattr(instability, name) for instability in instabilities])

    return {
        "disorder_index": np.repeat([STRONG, WEAK], sizes),
        "penetration": values("penetration"),
        "energy": values("dissipated_energy"),
        "extent": values("extent"),
        "before": values("before"),
        "after": values("after"),
    }


def _contacts(parameters: InstabilityParameters) -> list[RoughContact]:
    """The two contacts, of one surface and as many sites each."""
    tolerance = parameters.precision / 10
    energies = parameters.strong, parameters.weak
    n_site = parameters.least_angles
    while True:
        contacts = [
            parameters.contact(energy, tolerance, least_angles=n_site) for energy in energies
        ]
        n_sites = [contact.field.geometry.n_site for contact in contacts]
        if min(n_sites) == max(n_sites):
            return contacts
        # The contact with fewer sites is made again with as many as the other one has.
        n_site = max(n_sites)


def _branch(
    parameters: InstabilityParameters, contact: RoughContact, direction: Direction
) -> _Branch:
    """One branch from the front that an approach to its first penetration has."""
    schedule = LoadSchedule(parameters.max_penetration, parameters.load_step)
    start = 0.0 if direction > 0 else parameters.max_penetration
    steps = resolved_motion(
        contact.field,
        contact.touched(start),
        start,
        schedule.approach() if direction > 0 else schedule.retraction(),
        direction,
        travel=parameters.travel * parameters.short_cutoff,
        precision=parameters.precision,
        solver=contact.solver,
    )
    return _Branch(contact, list(steps))


def instability_checks(record: InstabilityRecord) -> tuple[Check, ...]:
    """What the instabilities dissipate, how wide they are, and the radii at b = 0."""
    inner, outer = _radii_at_zero(record)
    smallest = [_smallest_extent(record, index) for index in (STRONG, WEAK)]
    expected = record.shortest[WEAK] / record.shortest[STRONG]
    return (
        *_disorder_checks(record, STRONG, "strong"),
        *_disorder_checks(record, WEAK, "weak"),
        Check(
            "the smallest extent grows for weaker disorder",
            "> 1",
            f"{smallest[WEAK] / smallest[STRONG]:.3g} times",
            smallest[WEAK] > smallest[STRONG],
            f"lengths on which disorder is as stiff as the line: {expected:.3g} times",
        ),
        Check(
            "b = 0: the radius in approach (A) is below that in retraction (B)",
            "a(A) < a(B)",
            f"{inner:.4f} < {outer:.4f}",
            inner < outer,
            "strong disorder; reduced lateral length",
        ),
    )


def _smallest_extent(record: InstabilityRecord, index: int) -> float:
    """Extent that a tenth of the instabilities of one disorder stay below."""
    return float(np.quantile(record.extent[record.disorder_index == index], 0.1))


def _radii_at_zero(record: InstabilityRecord) -> tuple[float, float]:
    """Mean radii of the states A and B at b = 0, in approach and in retraction."""
    zero = record.state_penetration == 0
    radii = [record.state_radius[zero & (record.state_direction == sign)] for sign in (1, -1)]
    return float(radii[0][0]), float(radii[1][-1])


def _disorder_checks(record: InstabilityRecord, index: int, name: str) -> Iterator[Check]:
    """Signs and sum of the energies that one retraction dissipates, and its smallest extent."""
    energy = record.energy[record.disorder_index == index]
    yield Check(
        f"{name} disorder: every instability dissipates energy",
        "> 0",
        f"{energy.size} from {energy.min():.2g} to {energy.max():.2g}",
        bool(np.all(energy > 0)),
        "reduced energy",
    )
    lost = record.work[index] - record.energy_change[index]
    yield close_to(
        f"{name} disorder: the instabilities dissipate the work that is not stored",
        float(np.sum(energy)) / lost,
        1.0,
        0.02,
        remark=f"smooth steps add {record.smooth_energy[index] / lost:.2g} where each is taken at "
        "fixed penetration, in proportion to its size; integral of F db by trapezia over all "
        "steps, from the turn to the last state, pull-off not included",
    )
    shortest, smallest = float(record.shortest[index]), _smallest_extent(record, index)
    correlation = flat_spectrum(record.short_cutoff).correlation_length
    expected = max(shortest, correlation)
    yield Check(
        f"{name} disorder: smallest extent, the length on which disorder is as stiff as the line "
        "or, if that is shorter, the correlation length of w_loc",
        f"{expected:.3g}, within a factor of 2",
        f"{smallest:.3g}",
        expected / 2 < smallest < expected * 2,
        f"tenth percentile of area over depth; disorder is as stiff as the line on {shortest:.3g}, "
        f"whose factor is a convention; correlation length {correlation:.3g}",
    )


_FINER = 4
"""Points of a drawn front per site; the front is smooth between its sites."""

_GAP = 0.05
"""Distance of the two quarters from the middle between them."""


def instability_figure(record: InstabilityRecord) -> Drawing:
    """Patches of both retractions, and force against radius of the cycle."""
    with house_style():
        figure = blank_figure(PAGE, 0.45 * PAGE)
        energy_axes, extent_axes = figure.subplots(1, 2, width_ratios=(1.6, 1))
        shades = energy_shades(record.energy)
        for index in (STRONG, WEAK):
            _draw_quarter(energy_axes, record, index, shades)
            _draw_shortest(energy_axes, record, index)
        _finish_quarters(energy_axes, record)
        place = energy_axes.inset_axes((0.42, 0.155, 0.5, 0.028))
        bar = figure.colorbar(shades, cax=place, orientation="horizontal", extend="min")
        bar.set_label(ENERGY_LABEL, labelpad=1)
        _draw_cycle(extent_axes, record)
        name_panels((energy_axes, extent_axes), "ab")
        explain(
            figure,
            "a: areas swept by single instabilities, outlined by the fronts before and after; "
            "white: swept smoothly; orange bars: $\\ell_0$, the reduced length on which disorder "
            "is as stiff as the line; b: strong disorder; A, B: $b=0$ in approach and retraction",
        )
        return figure


def _draw_quarter(
    axes: Axes, record: InstabilityRecord, index: int, shades: ScalarMappable
) -> None:
    """Patches of one disorder on its quarter of the contact, outlined by the pinned fronts."""
    chosen, apex = record.disorder_index == index, _GAP if index == WEAK else -_GAP
    count = record.before.shape[1] * _FINER
    begin = count // 4 if index == STRONG else 0
    fronts = [
        np.asarray(resample(values[chosen], count, axis=1)[:, begin : begin + count // 4 + 1])
        for values in (record.before, record.after)
    ]
    first = np.pi / 2 if index == STRONG else 0
    angle = np.pi / 2 * np.linspace(0, 1, fronts[0].shape[1]) + first
    angle = np.broadcast_to(angle, fronts[0].shape)
    draw_patches(axes, angle, fronts, record.energy[chosen], record.travel, shades, apex)


def _draw_shortest(axes: Axes, record: InstabilityRecord, index: int) -> None:
    """Bar of the length on which disorder is as stiff as the line, outside the perimeter."""
    length, side = float(record.shortest[index]), 1 if index == WEAK else -1
    radius = 1.06 * record.before.max()
    middle = np.pi / 2 - side * 0.3 * np.pi
    angle = middle + np.linspace(-0.5, 0.5, 20) * length / radius
    bar = side * _GAP + radius * np.cos(angle), radius * np.sin(angle)
    axes.plot(*bar, color=VERMILION, linewidth=2.5, solid_capstyle="butt")
    place = side * _GAP + radius * np.cos(middle), radius * np.sin(middle)
    write_next_to(axes, r"$\ell_0$", place, (6 * side, 4), ha="center", color=VERMILION)


def _finish_quarters(axes: Axes, record: InstabilityRecord) -> None:
    """Limits, names and a scale."""
    reach = 1.04 * record.before.max() + _GAP
    axes.set(xlim=(-reach, reach), ylim=(-0.6, 1.32 * reach), aspect="equal")
    axes.set_axis_off()
    for index, name, side in ((STRONG, "strong", -1), (WEAK, "weak", 1)):
        text = (
            f"{name} disorder\n"
            rf"$w_\mathrm{{rms}} = {record.rms[index]:.2f}\,w_\mathrm{{int}}$" + "\n"
            "as stiff as the line\n"
            rf"on $\ell_0 = {record.shortest[index]:.3f}$"
        )
        place = side * reach, 1.32 * reach
        axes.annotate(text, place, ha="left" if side < 0 else "right", va="top")
    axes.plot(
        [-reach, 0.5 - reach], [-0.12, -0.12], color="black", linewidth=1.2, solid_capstyle="butt"
    )
    axes.annotate(r"$0.5\,(3\pi w_\mathrm{int}R^2/4E')^{1/3}$", (-reach, -0.17), va="top")


def _draw_cycle(axes: Axes, record: InstabilityRecord) -> None:
    """Radius against force of the stronger disorder."""
    for direction, name, _, colour in BRANCHES:
        branch = record.state_direction == direction
        radius, force = record.state_radius[branch], record.state_force[branch]
        axes.plot(force, radius, color=colour, linewidth=0.8, label=name)
        end = 0 if direction > 0 else -1
        start, stop = ((0.0, 0.0), (force[end], radius[end]))[::direction]
        draw_jump(axes, start, stop, PURPLE, linewidth=0.9, mutation_scale=7)
    axes.plot([], [], color=PURPLE, linewidth=0.9, label="jumps in and out")
    radius = np.linspace(0.0, 1.6, 200)
    force = jkr.force(radius, 0.0)
    axes.plot(force, radius, color="black", linewidth=0.7, label="$b = 0$", zorder=1)
    for letter, place, aside in zip("AB", _radii_at_zero(record), ((5, -9), (-10, 4)), strict=True):
        state = float(jkr.force(place, 0.0)), place
        axes.plot(*state, "o", color="black", markersize=2.8, zorder=5)
        write_next_to(axes, letter, state, aside, fontweight="bold")
    axes.set_xlim(1.25 * record.state_force.min(), 0.1)
    axes.set_ylim(0.0, 1.08 * record.state_radius.max())
    axes.legend(loc="lower left")
    axes.set(xlabel=FORCE_LABEL, ylabel=RADIUS_LABEL)


FIGURE = Figure(
    title="Main Fig. 3a, b: a retraction in single elastic instabilities",
    compute=instability_record,
    checks=instability_checks,
    draw=instability_figure,
    # As measured with 480 and 1440 sites.
    seconds=lambda parameters: 8e-5 * parameters.least_angles**2,
)
