"""Beyond the paper: roughness of the fronts in steady retraction, for strong and weak disorder."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator
from scipy.fft import rfft

from crackfront.core.records import ADHESION, LATERAL, variable
from crackfront.data.section import Count, Energy, Positive, Section, refusal
from crackfront.studies.paper.contact import (
    RoughContact,
    circle_stiffness,
    refuse_rising,
    rough_contact,
)
from crackfront.studies.paper.figure import Progress

Array = NDArray[np.float64]

_DISORDER, _SURFACE, _MODE, _LAG = "disorder", "surface", "mode", "lag"

_N_LAG = 60


class RoughnessParameters(Section):
    """Fronts to take and ranges to fit.

    Attributes
    ----------
    short_cutoff : float
        Shortest wavelength of the flat spectrum. (Units: reduced lateral length)
    strong, weak : float
        e_el of the two kinds of surfaces. (Units: w_int)
    n_surface, n_front : int
        Surfaces of each kind and fronts on each of them.
    max_penetration : float
        Where the retraction begins. (Units: reduced vertical length)
    first_penetration, last_penetration : float
        Between them the fronts are taken. (Units: reduced vertical length)
    strong_from, strong_to, weak_from, weak_to : float
        Wavelengths of the fits, over the short cutoff.
    error : float
        Error of the factor k that the resolution may leave.
    seed : int
        Seed of the surfaces.
    """

    short_cutoff: Positive
    strong: Energy
    weak: Energy
    n_surface: Count
    n_front: Count
    max_penetration: Positive
    first_penetration: Positive
    last_penetration: Positive
    strong_from: Positive
    strong_to: Positive
    weak_from: Positive
    weak_to: Positive
    error: Positive
    seed: Count

    @model_validator(mode="after")
    def _usable(self) -> RoughnessParameters:
        refuse_rising(self.max_penetration, self.first_penetration, self.last_penetration)
        for name in ("strong", "weak"):
            low, high = getattr(self, f"{name}_from"), getattr(self, f"{name}_to")
            if low >= high:
                raise refusal(f"{name}_from is {low:g}; it must be below {name}_to, {high:g}")
        if self.n_surface < 2:
            raise refusal("n_surface is 1; an interval needs 2 surfaces or more")
        return self


@dataclass(frozen=True, slots=True)
class RoughnessRecord:
    """Power and height differences of the fronts."""

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms, mean of the tiles", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    radius: Array = variable("mean radius of the fronts", LATERAL, _DISORDER)
    ring_stiffness: Array = variable(
        "stiffness of the circle, a dG/da; that of mode n is larger by n", ADHESION, _DISORDER
    )
    longest: Array = variable("longest wavelength of the fit", LATERAL, _DISORDER)
    shortest: Array = variable("shortest wavelength of the fit", LATERAL, _DISORDER)
    mode: NDArray[np.int64] = variable("waves around the perimeter", "1", _MODE)
    power: Array = variable(
        "power spectral density along the front, mean of the fronts of a surface",
        f"({LATERAL})^3",
        _DISORDER,
        _SURFACE,
        _MODE,
    )
    lag: Array = variable("distance along the front", LATERAL, _LAG)
    difference: Array = variable("rms difference of the radius", LATERAL, _DISORDER, _LAG)


def roughness_record(parameters: RoughnessParameters, progress: Progress) -> RoughnessRecord:
    """Fronts of a retraction at equal distances in penetration, on several surfaces.

    Parameters
    ----------
    parameters : RoughnessParameters
        What to compute.
    progress : callable
        Called with a line for every kind of surfaces.
    """
    measured = []
    for name, energy in (("strong", parameters.strong), ("weak", parameters.weak)):
        measured.append([_surface(parameters, energy, one) for one in range(parameters.n_surface)])
        progress(f"{name} disorder: {parameters.n_surface} times {parameters.n_front} fronts")
    count = min(surface.power.size for kind in measured for surface in kind)
    means = np.array(
        [
            [np.mean([getattr(one, name) for one in kind]) for kind in measured]
            for name in ("rms", "larkin_length", "radius", "ring_stiffness")
        ]
    )
    power = np.array([[surface.power[:count] for surface in kind] for kind in measured])
    mode = np.arange(1, count + 1)
    circle = 2 * np.pi * means[2]
    lag = np.geomspace(parameters.short_cutoff / 2, np.min(circle) / 2, _N_LAG)
    wavelengths = parameters.short_cutoff * np.array(
        [
            [parameters.strong_to, parameters.weak_to],
            [parameters.strong_from, parameters.weak_from],
        ]
    )
    return RoughnessRecord(
        short_cutoff=parameters.short_cutoff,
        elastic_energy=np.array([parameters.strong, parameters.weak]),
        rms=means[0],
        larkin_length=means[1],
        radius=means[2],
        ring_stiffness=means[3],
        longest=wavelengths[0],
        shortest=wavelengths[1],
        mode=mode,
        power=power,
        lag=lag,
        difference=np.array(
            [_difference(*pair, mode, lag) for pair in zip(power.mean(axis=1), circle, strict=True)]
        ),
    )


@dataclass(frozen=True, slots=True)
class _Surface:
    """What is measured on one surface."""

    power: Array
    radius: float
    ring_stiffness: float
    rms: float
    larkin_length: float


def _surface(parameters: RoughnessParameters, energy: float, realisation: int) -> _Surface:
    """Mean power of the fronts on one surface."""
    contact = rough_contact(
        parameters.short_cutoff,
        energy,
        parameters.max_penetration,
        realisation=realisation,
        seed=parameters.seed,
        error=parameters.error,
        tolerance=1e-6,
    )
    loads = np.linspace(
        parameters.first_penetration, parameters.last_penetration, parameters.n_front
    )
    fronts = np.stack(list(_fronts(contact, parameters.max_penetration, loads)))
    circles = np.mean(fronts, axis=1)
    modes = rfft(fronts, axis=1, norm="forward")[:, 1 : fronts.shape[1] // 2]
    power = 2 * np.pi * circles[:, None] * np.abs(modes) ** 2
    return _Surface(
        power=power.mean(axis=0),
        radius=float(circles.mean()),
        ring_stiffness=float(circle_stiffness(circles, loads).mean()),
        rms=contact.rms,
        larkin_length=contact.larkin_length,
    )


def _fronts(contact: RoughContact, largest: float, loads: Array) -> Iterator[Array]:
    """Fronts of a retraction at given penetrations."""
    front = contact.touched(largest)
    for load in loads:
        front = contact.moved(front, float(load), -1)
        yield front


def _difference(power: Array, circle: float, mode: NDArray[np.int64], lag: Array) -> Array:
    """Root mean square difference of the radius at two points of a front."""
    angle = 2 * np.pi * lag / circle
    return np.sqrt(4 * (1 - np.cos(np.outer(angle, mode))) @ (power / circle))
