"""Computation of the roughness of fronts: of a sphere in steady retraction, and straight ones."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydantic import model_validator
from scipy.fft import rfft

from crackfront.core.arrays import Array
from crackfront.sweep.section import section_error
from crackfront.validation import Count, Positive
from studies.paper.figure import Integers
from studies.paper.front_spectra import RoughnessRecord
from studies.paper.rough import STRONG, WEAK, RetractionParameters, circle_stiffness, surface_means
from studies.paper.straight import StraightParameters
from studies.progress import Progress

_N_LAG = 60
"""Distances at which height differences are computed."""

SPHERE = (STRONG, WEAK)
"""Places of the fronts of the sphere in a record."""

STRONG_LINE = 2
"""Place of the straight front in strong disorder."""

WEAK_LINE = 3
"""Place of the straight front in weak disorder."""

_PRECISION = 1e-3
"""Error of the load of a straight front that the solver may leave, in correlation lengths of the
force."""

_TRAVEL = 0.5
"""Share of a tile's period over which its fronts are taken."""


class LineParameters(StraightParameters):
    """Straight fronts on one spring and the range of their fit."""

    spring: Positive  # L_kappa over the Larkin length
    fit_from: Positive  # wavelengths of the fit, over the Larkin length
    fit_to: Positive

    @model_validator(mode="after")
    def _usable(self) -> LineParameters:
        low, high = self.fit_from, self.fit_to
        if low >= high:
            raise section_error(f"fit_from is {low:g}; it must be below fit_to, {high:g}")
        return self


class RoughnessParameters(RetractionParameters):
    """Fronts to take and ranges to fit."""

    n_front: Count  # on each surface, at equal distances in penetration; of a line, in load
    first_penetration: Positive
    last_penetration: Positive
    strong_from: Positive  # wavelengths of the fits, over the short cutoff
    strong_to: Positive
    weak_from: Positive
    weak_to: Positive
    strong_line: LineParameters  # straight fronts, on as many tiles as the sphere has surfaces
    weak_line: LineParameters

    @property
    def lines(self) -> tuple[LineParameters, LineParameters]:
        """Straight fronts in the order of their records."""
        return self.strong_line, self.weak_line

    @model_validator(mode="after")
    def _usable(self) -> RoughnessParameters:
        for name in ("strong", "weak"):
            low, high = getattr(self, f"{name}_from"), getattr(self, f"{name}_to")
            if low >= high:
                raise section_error(f"{name}_from is {low:g}; it must be below {name}_to, {high:g}")
        if self.n_surface < 2:
            raise section_error("n_surface is 1; an interval needs 2 surfaces or more")
        return self


@dataclass(frozen=True, slots=True)
class _Surface:
    """What is measured on one surface."""

    power: Array
    radius: float
    ring_stiffness: float
    rms: float
    larkin_length: float


def roughness_record(parameters: RoughnessParameters, progress: Progress) -> RoughnessRecord:
    """Fronts of a retraction, and straight ones, on several surfaces or tiles."""
    surfaces, lines = range(parameters.n_surface), parameters.lines
    energies = parameters.strong, parameters.weak
    measured = []
    for name, energy in zip(("strong", "weak"), energies, strict=True):
        measured.append([_surface(parameters, energy, surface) for surface in surfaces])
        progress(f"{name} disorder: {parameters.n_surface} times {parameters.n_front} fronts")
    for line in lines:
        measured.append([_tile(parameters, line, surface) for surface in surfaces])
        progress(f"straight, spring of {line.spring:g} Larkin lengths: as many fronts")
    n_mode = min(surface.power.size for kind in measured for surface in kind)
    power = np.array([[surface.power[:n_mode] for surface in kind] for kind in measured])
    means = surface_means(measured, "rms", "larkin_length", "radius", "ring_stiffness")
    shortest, longest = _fit_range(parameters, means["larkin_length"][STRONG_LINE:])
    mode, circumference = np.arange(1, n_mode + 1), 2 * np.pi * means["radius"]
    lag = np.geomspace(parameters.short_cutoff / 2, np.min(circumference) / 2, _N_LAG)
    spectra = zip(power.mean(axis=1), circumference, strict=True)
    return RoughnessRecord(
        short_cutoff=parameters.short_cutoff,
        elastic_energy=np.array([*energies, *(line.elastic_energy for line in lines)]),
        **means,
        longest=longest,
        shortest=shortest,
        mode=mode,
        power=power,
        lag=lag,
        difference=np.array([_difference(*spectrum, mode, lag) for spectrum in spectra]),
    )


def _fit_range(parameters: RoughnessParameters, larkin_lengths: Array) -> tuple[Array, Array]:
    """Shortest and longest wavelengths of the fits; Larkin lengths are of the lines."""
    cutoff, lines = parameters.short_cutoff, parameters.lines
    unit = np.array([cutoff, cutoff, *larkin_lengths])
    shortest = [parameters.strong_from, parameters.weak_from, *(line.fit_from for line in lines)]
    longest = [parameters.strong_to, parameters.weak_to, *(line.fit_to for line in lines)]
    return unit * shortest, unit * longest


def _tile(parameters: RoughnessParameters, line: LineParameters, realisation: int) -> _Surface:
    """Mean power of straight fronts on one tile."""
    pulled = line.front(line.spring, parameters.seed, realisation, _PRECISION)
    travel = _TRAVEL * pulled.period * np.arange(1, parameters.n_front + 1) / parameters.n_front
    fronts = np.stack([*pulled.moved(pulled.load + travel)])
    radius = parameters.short_cutoff * pulled.field.geometry.length / (2 * np.pi)
    return _Surface(
        power=_power(fronts * parameters.short_cutoff, radius),
        radius=radius,
        ring_stiffness=pulled.field.geometry.length / (2 * np.pi * pulled.spring),
        rms=2 * math.sqrt(line.elastic_energy),
        larkin_length=parameters.short_cutoff * pulled.larkin_length,
    )


def _surface(parameters: RoughnessParameters, energy: float, realisation: int) -> _Surface:
    """Mean power of the fronts on one surface."""
    contact = parameters.contact(energy, 1e-6, realisation)
    ends = parameters.first_penetration, parameters.last_penetration
    loads = np.linspace(*ends, parameters.n_front)
    front, fronts_at_loads = contact.touched(parameters.max_penetration), []
    for load in loads:
        front = contact.moved(front, float(load), -1)
        fronts_at_loads.append(front)
    fronts = np.stack(fronts_at_loads)
    circles = np.mean(fronts, axis=1)
    return _Surface(
        power=_power(fronts, circles[:, None]),
        radius=float(circles.mean()),
        ring_stiffness=float(circle_stiffness(circles, loads).mean()),
        rms=contact.w_rms,
        larkin_length=contact.larkin_length,
    )


def _power(fronts: Array, radius: Array | float) -> Array:
    """Mean spectral density of fronts on circles."""
    modes = rfft(fronts, axis=1, norm="forward")[:, 1 : fronts.shape[1] // 2]
    return np.asarray(np.mean(2 * np.pi * radius * np.abs(modes) ** 2, axis=0))


def _difference(power: Array, circle: float, mode: Integers, lag: Array) -> Array:
    """Root mean square difference of the radius at two points of a front."""
    angle = 2 * np.pi * lag / circle
    return np.sqrt(4 * (1 - np.cos(np.outer(angle, mode))) @ (power / circle))
