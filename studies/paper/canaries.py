"""Canaries of the figures: each computed at a reduced scale."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from studies.canaries import interval_number
from studies.numbers import Number
from studies.paper import event_laws, front_spectra
from studies.paper.figure import figure, load_figure
from studies.paper.rough import STRONG
from studies.paper.roughness import STRONG_LINE
from studies.paper.si_5 import study_fit
from studies.progress import silent
from studies.records import read_record

_CLAIM = "tolerance of the claim of the figure"

Numbers = Mapping[str, Number]


def _computed(name: str, changes: Mapping[str, Any], numbers: Callable[[Any], Numbers]) -> Numbers:
    """Numbers of a figure at the scale quick, with some parameters changed to make it faster."""
    quick = load_figure(Path(f"config/figures/{name}.yaml"), "quick")
    parameters = type(quick).model_validate(quick.model_dump() | dict(changes))
    return numbers(figure(name).compute(parameters, silent))


def _smooth_loop(loop: Any) -> Numbers:
    """Pull-off force of a smooth sphere."""
    return {"lowest force": Number(float(loop.force.min()), 2e-3, "pi w_int R", _CLAIM)}


def _rings(loops: Any) -> Numbers:
    """Mean hysteresis of rings of intermediate wavelength."""
    hysteresis = loops.case_retraction[1] - loops.case_approach[1]
    return {"hysteresis of rings of 0.1": Number(float(hysteresis), 1e-3, "w_int", _CLAIM)}


def _instabilities(record: Any) -> Numbers:
    """Energy that the instabilities of strong disorder dissipate, over the work that is lost."""
    energy = float(record.energy[record.disorder_index == STRONG].sum())
    lost = float(record.work[STRONG] - record.energy_change[STRONG])
    return {
        "dissipated energy over lost work": Number(energy / lost, 0.02, reason=_CLAIM),
        "lost work": Number(lost, 0.02 * lost, "reduced energy", _CLAIM),
    }


def _pinned_loop(loop: Any) -> Numbers:
    """Factor k of the smooth loop."""
    scale = 2 * loop.elastic_energy
    error = math.hypot(loop.approach_error, loop.retraction_error) / scale
    return {"k": Number((loop.retraction - loop.approach) / scale, error, reason="standard error")}


def _mapping(record: Any) -> Numbers:
    """e_el and rms of w_loc of a tile, which follow from the seed without a solver."""
    return {
        "e_el": Number(record.energy, 1e-9, "w_int", "round-off"),
        "rms of w_loc": Number(record.rms, 1e-9, "w_int", "round-off"),
    }


def _film_scales(record: Any) -> Numbers:
    """e_el of nanodiamond."""
    energy = 1e3 * record.contact_modulus / 4 * float(record.mean_square[1])
    return {"e_el": Number(energy, 0.05, "mJ/m2", _CLAIM)}


def _nanodiamond(contact: Any) -> Numbers:
    """Hysteresis of a rubber sphere on nanodiamond."""
    hysteresis = 1e3 * float(contact.retraction[0] - contact.approach[0])
    error = 1e3 * math.hypot(contact.approach[1], contact.retraction[1])
    return {"hysteresis": Number(hysteresis, error, "mJ/m2", "standard error")}


def _parametric_study() -> Numbers:
    """Fit of the stored sweep of SI Fig. S-5."""
    path = Path("docs/reference/si-5.nc")
    fit = study_fit(read_record(path, figure(path.stem).record))
    pooled = fit.pooled
    return {
        "k": interval_number(pooled.factor.each(float)),
        "exponent": interval_number(pooled.exponent.each(float)),
    }


def _synthetic_film(record: Any) -> Numbers:
    """e_el of synthetic surfaces."""
    energy, error = 1e3 * record.tile_energy, 1e3 * record.energy_error
    return {"e_el": Number(energy, error, "mJ/m2", "standard error")}


def _motion(cycle: Any) -> Numbers:
    """Energy that a whole cycle dissipates."""
    energy = float(cycle.dissipated_energy.sum() + cycle.pull_off_energy)
    reason = "2%, the part of the hysteresis that the requested error of k leaves"
    return {"dissipated energy": Number(energy, 0.02 * energy, "reduced energy", reason)}


def _pull_off(record: Any) -> Numbers:
    """Mean pull-off force of surfaces of both Hurst exponents."""
    reason = "2%, about the scatter of one surface"
    force = float(record.force.mean())
    return {"pull-off force": Number(force, 0.02 * abs(force), "pi w_int R", reason)}


def _video(record: Any) -> Numbers:
    """Lowest force of a contact on nanodiamond."""
    force = 1e3 * float(record.force.min())
    reason = "2%, more than a requested error of 0.1 of k leaves"
    return {"lowest force": Number(force, 0.02 * abs(force), "mN", reason)}


def _avalanches(record: Any) -> Numbers:
    """Exponent of whole events of straight fronts, and the energy that a sphere dissipates."""
    depth = event_laws.depth_slope(record)
    strong = record.energy[record.disorder_index == STRONG]
    energy, error = float(strong.sum()), float(np.sqrt(np.sum(strong**2)))
    return {
        "growth of the depth of events": Number(depth.exponent, depth.reach),
        "energy of avalanches": Number(energy, error, "reduced energy", "error of counting"),
    }


def _roughness(record: Any) -> Numbers:
    """Roughness exponents of spheres and straight fronts at strong disorder."""
    return {
        f"exponent, {name}": Number(
            front_spectra.fitted_roughness(record, index).exponent, 0.05, reason=_CLAIM
        )
        for name, index in (("sphere", STRONG), ("straight front", STRONG_LINE))
    }


_SHORT_LINE = {
    "elastic_energy": 0.9,
    "pixels_per_cutoff": 3.0,
    "length": 5.0,
    "spring": 100.0,
    "fit_from": 8.0,
    "fit_to": 400.0,
}
"""Straight fronts of a quarter of the length of `config/figures/beyond-roughness.yaml`."""

_REDUCED: Mapping[str, tuple[Mapping[str, Any], Callable[[Any], Numbers]]] = {
    "main-1d": ({}, _smooth_loop),
    "main-2": ({}, _rings),
    "main-3ab": ({"short_cutoff": 0.14, "precision": 2e-4}, _instabilities),
    "main-3cd": ({"short_cutoff": 0.01, "roll_off": 0.16, "tile_roll_offs": 20}, _pinned_loop),
    "main-4": ({}, _mapping),
    "main-5a": ({}, _film_scales),
    "main-5bc": (
        {"short_cutoff": 0.525e-6, "tile_roll_offs": 10, "n_surface": 1},
        _nanodiamond,
    ),
    "si-6": ({"realisations": 1}, _synthetic_film),
    "beyond-animation": ({}, _motion),
    "beyond-avalanches": (
        {"short_cutoff": 0.04, "springs": [75.0, 150.0, 300.0], "n_tile": 1},
        _avalanches,
    ),
    "beyond-pull-off": ({"n_surface": 1, "short_cutoffs": [0.1, 0.05]}, _pull_off),
    "beyond-video": ({"short_cutoff": 0.525e-6, "step": 240e-9}, _video),
    "beyond-roughness": (
        {"short_cutoff": 0.03, "n_surface": 2, "n_front": 3, "strong_line": _SHORT_LINE},
        _roughness,
    ),
}
"""Changes of the parameters of a figure, and the numbers of its data that are compared."""

CANARIES = {
    "si-5": _parametric_study,
    **{name: partial(_computed, name, *reduced) for name, reduced in _REDUCED.items()},
}
