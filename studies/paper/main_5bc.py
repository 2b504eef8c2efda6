"""Main Fig. 5b, c: a rubber sphere on nanodiamond in SI units, to a largest force and back."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure as Drawing

from crackfront.analysis.estimate import REACH, Estimate, mean_estimate, with_interval
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.outcome import Status
from crackfront.core.units import Scales
from crackfront.plots.style import BLACK, ORANGE, PAGE, blank_figure, explain, house_style
from crackfront.simulate.simulation import simulation_adhesion, simulation_field
from studies.paper.checks import Check, close_to
from studies.paper.drawing import BRANCHES, name_panels
from studies.paper.figure import Figure, values_of
from studies.paper.measured import ForceRadius, fitted_adhesion
from studies.paper.nanodiamond import EVERY_WAVELENGTH, NanodiamondContact, NanodiamondParameters
from studies.paper.perimeters import Advance, Perimeters, widest_instability
from studies.paper.rough import ONE_DIGIT, expected_seconds, recorded
from studies.progress import Progress

_MICRO = 1e6
"""Micrometres in a metre."""

_MILLI = 1e3
"""Millijoules in a joule, millinewtons in a newton."""

_NANO = 1e9
"""Nanometres in a metre."""

_SEVERAL_TENS = (20.0, 100.0)
"""Extents that count as several tens of micrometres (Units: um)."""

_SYNTHETIC_POINTS = 40
"""Points of a synthetic measurement."""

_SYNTHETIC_NOISE = 0.02
"""Noise of its forces, relative to the largest."""


def nanodiamond_contact(
    parameters: NanodiamondParameters, progress: Progress
) -> NanodiamondContact:
    """Approach to the largest force, retraction until contact is lost, and the fits of w_int."""
    scales, surface = parameters.scales, _Surface(parameters, 0)
    record = surface.record(parameters.cycle(surface.recorder, progress))
    if not np.any(record.states.direction < 0):
        raise ValueError(f"the largest force was not reached: {record.status.value}")
    if not surface.perimeters.lines:
        raise ValueError("no state lies between jump-in and shown_force; raise shown_force")
    progress(f"retraction: {record.status.value}")
    steady = steady_adhesion(record, surface.correlation_length)
    if steady.sentence:
        raise ValueError(steady.sentence)
    instabilities = _instabilities(parameters, surface, progress)
    works = np.array([[steady.w_appr, steady.w_appr_error], [steady.w_retr, steady.w_retr_error]])
    approach, retraction = scales.work_of_adhesion * works
    states = record.states
    radius, force = states.mean_radius * scales.lateral, states.force * scales.force
    return NanodiamondContact(
        status=record.status.value,
        sphere_radius=scales.radius,
        **values_of(scales, "work_of_adhesion", "contact_modulus"),
        **values_of(parameters, "factor", "whole_elastic_energy", "short_cutoff", "roll_off"),
        **values_of(parameters, "hurst", "largest_force", "shown_force", "precision"),
        elastic_energy=surface.elastic_energy,
        direction=states.direction,
        penetration=states.penetration * scales.vertical,
        radius=radius,
        force=force,
        approach=approach,
        retraction=retraction,
        load_step=parameters.step,
        **_perimeter_values(surface, scales),
        **_instability_values(instabilities, scales),
        **_fits(parameters, surface, ForceRadius(force, radius, states.direction)),
    )


def _perimeter_values(surface: _Surface, scales: Scales) -> dict[str, Any]:
    """Perimeters of the approach, and the sizes that they are compared with, in SI units."""
    perimeters = surface.perimeters
    return {
        "jump_in": perimeters.states[0].penetration * scales.vertical,
        "angle": perimeters.angle,
        "line": (np.array(perimeters.lines) * scales.lateral).astype(np.float32),
        "line_force": np.array([state.force for state in perimeters.states]) * scales.force,
        "threshold": surface.correlation_length * scales.lateral,
        "tile_side": surface.simulation.resolution.tile_side * scales.lateral,
    }


def _fits(
    parameters: NanodiamondParameters, surface: _Surface, simulated: ForceRadius
) -> dict[str, Any]:
    """Measured points, and w_int from synthetic, simulated and measured approaches."""
    scales, factor = parameters.scales, parameters.factor
    whole, measured = parameters.whole_elastic_energy, parameters.points()
    synthetic = _synthetic_points(parameters, simulated.radius)
    return {
        "synthetic_fit": fitted_adhesion(synthetic, scales, whole, factor),
        "simulated_fit": fitted_adhesion(simulated, scales, surface.elastic_energy, factor),
        "measured_fit": fitted_adhesion(measured, scales, whole, factor),
        "measured_force": measured.force,
        "measured_radius": measured.radius,
        "measured_direction": measured.direction,
    }


class _Surface:
    """One surface, its field, and what is kept of an approach on it."""

    def __init__(self, parameters: NanodiamondParameters, realisation: int) -> None:
        scales, self.simulation = parameters.scales, parameters.simulation(realisation)
        adhesion = simulation_adhesion(self.simulation)
        self.elastic_energy = adhesion.e_el * scales.work_of_adhesion
        self.field = simulation_field(self.simulation, adhesion)
        self.correlation_length = self.simulation.spectrum.correlation_length
        self.perimeters = Perimeters(
            self.correlation_length,
            parameters.shown_force / scales.force,
            wide=_SEVERAL_TENS[0] / _MICRO / scales.lateral,
            every=max(1, round(parameters.line_step / parameters.step)),
        )
        self.recorder = Recorder(observers=[self.perimeters])

    def record(self, loads: Iterable[Load]) -> CycleRecord:
        """States at some loads."""
        return recorded(self.simulation, self.field, loads, self.recorder)

    def widest(self, precision: float) -> Advance:
        """Widest single instability of the approach (Units: reduced lengths)."""
        steps, solver = self.perimeters.steps, self.simulation.solver
        return widest_instability(self.field, steps, self.correlation_length, precision, solver)


@dataclass(frozen=True, slots=True)
class _Instabilities:
    """Instabilities of the approaches on all surfaces (Units: reduced lateral length)."""

    arc: Advance
    """The widest on the first surface."""
    widths: list[list[float]]
    """Widths of the parts that jump in a load step, of each surface."""
    widest: list[float]
    """Width of the widest instability of each surface."""


def _instabilities(
    parameters: NanodiamondParameters, first: _Surface, progress: Progress
) -> _Instabilities:
    """Instabilities of the first surface, whose cycle is known, and of further approaches."""
    scales, precision = parameters.scales, parameters.precision / parameters.scales.vertical
    arc = first.widest(precision)
    instabilities = _Instabilities(arc, [first.perimeters.extents], [arc.extent])
    for realisation in range(1, parameters.n_surface):
        surface = _Surface(parameters, realisation)
        surface.record(parameters.approach(surface.recorder, parameters.shown_force))
        instabilities.widths.append(surface.perimeters.extents)
        instabilities.widest.append(surface.widest(precision).extent)
    for realisation, width in enumerate(instabilities.widest):
        text = f"{width * scales.lateral * _MICRO:.0f} um"
        progress(f"surface {realisation}: widest instability {text}")
    return instabilities


def _instability_values(instabilities: _Instabilities, scales: Scales) -> dict[str, Any]:
    """Instabilities of all surfaces in SI units."""
    arc, widths = instabilities.arc, instabilities.widths
    return {
        "surface": np.repeat(np.arange(len(widths)), [len(extents) for extents in widths]),
        "extents": np.concatenate(widths) * scales.lateral,
        "widest": np.array(instabilities.widest) * scales.lateral,
        "arc_angle": arc.angle,
        "arc_inner": arc.inner * scales.lateral,
        "arc_outer": arc.outer * scales.lateral,
    }


def _synthetic_points(parameters: NanodiamondParameters, radius: Array) -> ForceRadius:
    """Points that the model itself gives, with noise of a known size."""
    scales, energy = parameters.scales, parameters.whole_elastic_energy
    adhesion = parameters.work_of_adhesion - (1 + parameters.factor) * energy
    radii = np.linspace(radius.min(), radius.max(), _SYNTHETIC_POINTS)
    smooth = jkr.equilibrium_force(radii / scales.lateral, adhesion / parameters.work_of_adhesion)
    rng = np.random.default_rng(np.random.SeedSequence(parameters.seed, spawn_key=(1,)))
    noise = _SYNTHETIC_NOISE * parameters.largest_force * rng.standard_normal(radii.size)
    return ForceRadius(smooth * scales.force + noise, radii, np.ones(radii.size, dtype=np.int64))


_ENERGY = "mJ/m2"
_near = partial(close_to, units=_ENERGY)

_PAPER_ENERGY = 11.1
"""e_el of the film (Units: mJ / m^2)."""

MEASURED = 0.08
"""Hysteresis of the experiment, of which the paper states no error (Units: J / m^2)."""


def nanodiamond_checks(contact: NanodiamondContact) -> tuple[Check, ...]:
    """Energies, hysteresis, instabilities and the fit."""
    hysteresis, fits = _hysteresis_checks(contact), _fit_checks(contact)
    return (*_surface_checks(contact), *hysteresis, _instability_check(contact), *fits)


def _surface_checks(contact: NanodiamondContact) -> tuple[Check, ...]:
    """The surface, and that the cycle is whole."""
    whole = replace(contact.spectrum, short_cutoff=EVERY_WAVELENGTH * contact.spectrum.roll_off)
    share = contact.spectrum.mean_square(0.5) / whole.mean_square(0.5)
    shortest, whole_energy = _NANO * contact.short_cutoff, _MILLI * contact.whole_elastic_energy
    reached, largest = _MILLI * float(contact.force.max()), _MILLI * contact.largest_force
    width = 2 * _MICRO * float(contact.radius.max())
    return (
        Check(
            "the cycle is whole: it reaches the largest force and ends by losing contact",
            f"{largest:g} mN; {Status.LOST_CONTACT.value}",
            f"{reached:.4g} mN; {contact.status}",
            reached >= largest and contact.status == Status.LOST_CONTACT.value,
        ),
        Check(
            "the surface does not repeat under the contact",
            f"a tile of {width:.0f} um or more",
            f"{_MICRO * contact.tile_side:.0f} um",
            _MICRO * contact.tile_side >= width,
        ),
        _near("e_el of all wavelengths", whole_energy, _PAPER_ENERGY, 0.05),
        _near(
            "e_el of the simulated surface: as the spectrum has at its wavelengths",
            _MILLI * contact.elastic_energy,
            _MILLI * share * contact.whole_elastic_energy,
            0.05 * _PAPER_ENERGY,
            remark=f"wavelengths above {shortest:.0f} nm, which have {share:.3f} "
            "of the e_el of all; the chance of one tile leaves the difference",
        ),
    )


def _hysteresis_checks(contact: NanodiamondContact) -> tuple[Check, ...]:
    """Hysteresis by the theory with k = 3, in the simulation and in the experiment."""
    surface, whole = _MILLI * contact.work_of_adhesion, _MILLI * contact.whole_elastic_energy
    energy = _MILLI * contact.elastic_energy
    approach, retraction = _MILLI * contact.approach[0], _MILLI * contact.retraction[0]
    hysteresis = _MILLI * float(contact.retraction[0] - contact.approach[0])
    error = _MILLI * math.hypot(contact.approach[1], contact.retraction[1])
    law = contact.law
    law_hysteresis = (law.approach.factor.value + law.retraction.factor.value) * energy
    reach = 2 * REACH * law.both.standard_error * energy
    remark = (
        f"w_appr = {approach:.1f} and w_retr = {retraction:.1f}, "
        f"± {error:.1f} on their difference: k = {hysteresis / (2 * energy):.2f}; k falls with "
        f"disorder, here w_rms = {2 * math.sqrt(energy / surface):.2f} w_int; tolerance: one "
        "digit of k"
    )
    return (
        _near("w_appr that k = 3 predicts", surface - (1 + PAPER_FACTOR) * whole, 18.4, 0.1),
        _near("w_retr that k = 3 predicts", surface - (1 - PAPER_FACTOR) * whole, 85.3, 0.1),
        _near("hysteresis that k = 3 predicts", 2 * PAPER_FACTOR * whole, 66.8, 0.1),
        _near(
            "hysteresis of the simulation: the hysteresis with k = 3 at the e_el of the tile",
            hysteresis,
            2 * PAPER_FACTOR * energy,
            2 * ONE_DIGIT * energy,
            remark=remark,
            law=(law_hysteresis, math.hypot(reach, REACH * error)),
        ),
        Check(
            "hysteresis of the simulation: the order of magnitude of the measured one",
            f"{_MILLI * MEASURED:g} {_ENERGY} within a factor of {math.sqrt(10):.2g}",
            f"{hysteresis:.4g} {_ENERGY}",
            abs(math.log10(hysteresis / (_MILLI * MEASURED))) <= 0.5,
            "the paper claims the order of magnitude; w_int was not adjusted to our own approach",
        ),
    )


def widest_instability_estimate(contact: NanodiamondContact) -> Estimate[float]:
    """Widest single instability of an approach, a mean over surfaces (Units: um)."""
    mean, _ = mean_estimate(_MICRO * contact.widest)
    return mean.each(float)


def _instability_check(contact: NanodiamondContact) -> Check:
    """Lateral extent of the widest instability on several surfaces."""
    low, high = _SEVERAL_TENS
    widest, extents = _MICRO * contact.widest, _MICRO * contact.extents
    mean, order = widest_instability_estimate(contact), np.argsort(widest)
    listed = ", ".join(f"{extent:.0f}" for extent in widest[order])
    merged = ", ".join(f"{extents[contact.surface == surface].max():.0f}" for surface in order)
    return Check(
        "instabilities of the approach after jump-in: up to several tens of um wide",
        f"the widest of a surface: {low:g} to {high:g} um, within the 95% interval of the mean",
        f"{with_interval(mean)} um",
        mean.high >= low and mean.low <= high,
        f"{widest.size} surfaces: {listed} um; connected sites that advance by more than the "
        f"correlation length of w_loc, {_MICRO * contact.threshold:.2f} um, separated to "
        f"{_NANO * contact.precision:.2g} nm of penetration; in whole load steps of "
        f"{_NANO * contact.load_step:.0f} nm, which merge some, the widest are {merged} um, and of "
        f"{extents.size} parts {np.count_nonzero(extents > low)} are wider than {low:g} um and "
        f"{np.count_nonzero(extents > high)} wider than {high:g} um",
    )


def _fit_checks(contact: NanodiamondContact) -> tuple[Check, ...]:
    """The w_int that a fit to the approach gives."""
    surface, energy = _MILLI * contact.work_of_adhesion, _MILLI * contact.elastic_energy
    value, low, high = _MILLI * contact.synthetic_fit
    approach_factor = (surface - energy - _MILLI * contact.approach[0]) / energy
    by_law = contact.law.approach.factor
    checks = [
        Check(
            f"w_int from synthetic points: JKR with w_appr of k = {contact.factor:g} and noise",
            f"{surface:g} {_ENERGY} in the 95% interval",
            f"{value:.2f}, {low:.2f} to {high:.2f} {_ENERGY}",
            bool(low <= surface <= high),
            "one draw of the noise, by the seed of the figure: one in twenty lies outside",
        ),
        _near(
            f"w_int from the simulated approach with k = {contact.factor:g}",
            _MILLI * contact.simulated_fit[0],
            surface,
            ONE_DIGIT * energy,
            remark=f"the approach alone has k = {approach_factor:.2f}, and the fit is off by its "
            "difference from that assumed times e_el",
            law=(
                surface + (contact.factor - by_law.value) * energy,
                REACH * math.hypot(by_law.standard_error * energy, _MILLI * contact.approach[1]),
            ),
        ),
    ]
    if contact.measured_force.size:
        value, low, high = _MILLI * contact.measured_fit
        checks.append(
            _near(
                f"w_int from the measured approach with k = {contact.factor:g}",
                value,
                63.0,
                (high - low) / 2,
                remark="the paper's value; tolerance: the 95% interval of the points' scatter",
            )
        )
    return tuple(checks)


def nanodiamond_figure(contact: NanodiamondContact) -> Drawing:
    """Perimeters of the approach, and the loop."""
    with house_style():
        figure = blank_figure(PAGE, 0.54 * PAGE)
        perimeter_axes, force_axes = figure.subplots(1, 2)
        _draw_perimeters(perimeter_axes, contact)
        _draw_loop(force_axes, contact)
        name_panels((perimeter_axes, force_axes), "bc")
        simulated, whole = contact.elastic_energy * _MILLI, contact.whole_elastic_energy * _MILLI
        explain(
            figure,
            "b: the edge of the contact at equal steps of the penetration; c: dotted: JKR with the "
            "apparent works of adhesion of the branches; broken: JKR with "
            f"$k={PAPER_FACTOR:g}$ and the $e_\\mathrm{{el}}$ of this surface, {simulated:.2f} "
            f"mJ/m$^2$ (all wavelengths: {whole:.2f})",
        )
        return figure


def _draw_perimeters(axes: Axes, contact: NanodiamondContact) -> None:
    """Perimeters in approach, and the area that the widest instability closes."""
    directions = np.stack([np.cos(contact.angle), np.sin(contact.angle)], axis=-1)
    lines = contact.line[..., None] * directions * _MICRO
    closed = np.concatenate([lines, lines[:, :1]], axis=1)
    label = f"fronts of the approach,\nup to {contact.shown_force * _MILLI:.2g} mN"
    axes.add_collection(LineCollection(list(closed), colors=BLACK, linewidths=0.3, label=label))
    around = np.concatenate([contact.arc_angle, contact.arc_angle[::-1]])
    radius = np.concatenate([contact.arc_inner, contact.arc_outer[::-1]]) * _MICRO
    label = f"widest instability:\n{contact.widest[0] * _MICRO:.0f} µm of the edge"
    outline = radius * np.cos(around), radius * np.sin(around)
    axes.fill(*outline, color=ORANGE, linewidth=0.6, zorder=3, label=label)
    reach = 1.03 * float(np.abs(lines).max())
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xlabel="$x$ (µm)")
    axes.set_ylabel("$y$ (µm)")
    axes.legend(loc="center", handlelength=0.8)


def _draw_loop(axes: Axes, contact: NanodiamondContact) -> None:
    """Radius against force: simulation, JKR curves by it and by k = 3, measured points."""
    surface, energy = contact.work_of_adhesion, contact.elastic_energy
    works = contact.approach[0], contact.retraction[0]
    for (direction, name, short, colour), adhesion in zip(BRANCHES, works, strict=True):
        _draw_simulated(axes, contact, direction, color=colour, label=name)
        label = rf"JKR, $w_\mathrm{{{short}}}$ = {adhesion * _MILLI:.1f} mJ/m$^2$"
        _draw_jkr(axes, contact, adhesion, dashes=(1, 1.2), color=colour, label=label)
        theory = surface - energy - direction * PAPER_FACTOR * energy
        label = rf"JKR, $k = {PAPER_FACTOR:g}$: {theory * _MILLI:.1f} mJ/m$^2$"
        look = {"dashes": (4, 2), "color": colour, "zorder": 1}
        _draw_jkr(axes, contact, max(theory, 0.0), label=label, **look)
        _draw_measured(axes, contact, direction, color=colour, label=f"measured, {name}")
    lowest = contact.radius[contact.direction < 0].min()
    axes.set_ylim(0.75 * lowest * _MICRO, _largest_shown(contact) * _MICRO)
    force = contact.force * _MILLI
    low, high = force.min(), force.max()
    axes.set_xlim(low - 0.15 * (high - low), high + 0.08 * (high - low))
    axes.set(xlabel="normal force (mN)", ylabel="mean contact radius (µm)")
    axes.legend(loc="lower right")


def _largest_shown(contact: NanodiamondContact) -> float:
    """Largest radius of the axes (Units: m)."""
    return 1.08 * float(contact.radius.max())


def _draw_simulated(axes: Axes, contact: NanodiamondContact, direction: int, **style: Any) -> None:
    """Simulated states of a branch; the approach begins after jump-in."""
    branch = contact.direction == direction
    if direction > 0:
        branch &= contact.penetration >= contact.jump_in
    force, radius = contact.force[branch] * _MILLI, contact.radius[branch] * _MICRO
    axes.plot(force, radius, linewidth=1.4, zorder=3, **style)


def _draw_jkr(axes: Axes, contact: NanodiamondContact, adhesion: float, **style: Any) -> None:
    """JKR curve of a work of adhesion in J / m^2."""
    scales = contact.scales
    radius = np.linspace(0, _largest_shown(contact), 300)
    work = adhesion / contact.work_of_adhesion
    force = jkr.equilibrium_force(radius / scales.lateral, work) * scales.force
    axes.plot(force * _MILLI, radius * _MICRO, linewidth=0.7, **style)


def _draw_measured(axes: Axes, contact: NanodiamondContact, direction: int, **style: Any) -> None:
    """Measured points of a branch, if there are any."""
    measured = contact.measured_direction == direction
    if np.any(measured):
        force = contact.measured_force[measured] * _MILLI
        radius = contact.measured_radius[measured] * _MICRO
        axes.plot(force, radius, "D", mfc="white", zorder=4, **style)


FIGURE = Figure(
    title="Main Fig. 5b, c: a rubber sphere on nanodiamond",
    compute=nanodiamond_contact,
    checks=nanodiamond_checks,
    draw=nanodiamond_figure,
    # An approach and the separation of its instabilities take about as long as a cycle.
    seconds=lambda parameters: parameters.n_surface * expected_seconds(parameters),
)
