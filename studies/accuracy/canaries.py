"""Canaries of the errors of numerics, scans, measured loops and predictions."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from crackfront.core.arrays import Array
from studies.accuracy import measured_loops
from studies.accuracy.averages import held_out_coverage, sampling_errors
from studies.accuracy.energies import KINDS, scan_energy, synthetic_surface
from studies.accuracy.energy_balance import cycle, energies
from studies.accuracy.movement import movement
from studies.accuracy.predictions import comparisons
from studies.accuracy.scenes import SCENES
from studies.accuracy.study import rms, scene_errors
from studies.canaries import interval_number
from studies.numbers import Number

_SCENE = SCENES["flat-0.04"]
_SURFACES = range(2)


def _rms_number(errors: Array, unit: str) -> Number:
    """Rms of some errors, which so few errors determine only roughly."""
    value = rms(errors)
    reason = f"standard error of an rms of {errors.size} numbers"
    return Number(value, value / math.sqrt(2 * errors.size), unit, reason)


def _settings() -> Mapping[str, Number]:
    """Error that few sites leave, and the hysteresis of the reference."""
    trials = [trial for trial in _SCENE.single_trials if trial.settings.angles_per_cutoff == 2.2]
    study = scene_errors(_SCENE, trials[:1], _SURFACES)
    values = 100 * study.hysteresis_errors(study.errors[0])
    spread = float(np.std(values, ddof=1)) / math.sqrt(values.size)
    finest = _SCENE.elastic_energy * 0.003
    return {
        "hysteresis": Number(
            study.hysteresis, finest, "w_int", "smallest error of k that the laws are asked for"
        ),
        "bias of 2.2 sites": Number(float(values.mean()), spread, "%", "standard error"),
    }


def _requested() -> Mapping[str, Number]:
    """Error of k where 0.03 is requested."""
    study = scene_errors(_SCENE, _SCENE.requested_trials([0.03]), _SURFACES)
    return {"error of k": _rms_number(study.errors[0].adhesion / _SCENE.elastic_energy, "1")}


def _averages() -> Mapping[str, Number]:
    """Hysteresis of one surface by steady states, by a full cycle and on a small tile."""
    samples = {
        (sample.setting, sample.value): sample for sample in sampling_errors(_SCENE, range(1))
    }
    return {
        f"hysteresis, {setting} {value:g}": Number(
            float(samples[setting, value].hysteresis[0]),
            float(samples[setting, value].standard_error[0]),
            "w_int",
            "standard error that the run states",
        )
        for setting, value in (("travel", 1.0), ("step", 0.05), ("tile", 32))
    }


def _coverage() -> Mapping[str, Number]:
    """Stated and true error of steady runs."""
    (coverage,) = held_out_coverage(_SCENE, (0.03,), 3)
    return {
        "true numerical error": _rms_number(coverage.numerical, "w_int"),
        "true total error": _rms_number(coverage.total, "w_int"),
    }


def _energy_balance() -> Mapping[str, Number]:
    """Energy that a cycle dissipates, and its difference from the work of the load steps."""
    lost, work, trapezoid = energies(cycle(amplitude=0.4, seed=0, step=0.032))
    digits = "last digit on the page"
    return {
        "dissipated energy": Number(lost, 5e-5, "reduced energy", digits),
        "trapezoidal rule": Number(trapezoid, 5e-5, "reduced energy", digits),
        "difference from the work": Number(lost - work, 1e-12, "reduced energy", "round-off"),
    }


def _scans() -> Mapping[str, Number]:
    """e_el of a scan over its true value; ends of intervals move by 2% of their width at most."""
    ratio = scan_energy(synthetic_surface(KINDS[0], 0)).ratio
    reason = "2% of the interval, which is what other seeds change (Movement)"
    error = 0.02 * (ratio.high - ratio.low)
    return {
        "e_el found over true": Number(ratio.value, error, reason=reason),
        "its lower end": Number(ratio.low, error, reason=reason),
        "its upper end": Number(ratio.high, error, reason=reason),
    }


def _movement() -> Mapping[str, Number]:
    """Largest movement of an interval with seeds, digits and draws."""
    moved = movement([scan.measurement for scan in synthetic_surface(KINDS[0], 0).scans])
    return {
        name: Number(100 * float(ends.max()), error, "% of the interval", reason)
        for name, ends, error, reason in (
            ("seeds", moved.seeds, 1.0, "as much as other seeds change"),
            ("digits", moved.digits, 0.05, "last digit on the page"),
            ("draws", moved.size, 1.0, "as much as other seeds change"),
        )
    }


def _measured_loop() -> Mapping[str, Number]:
    """Hysteresis of one loop, as the usual rig records it."""
    usual = {"usual": measured_loops.INSTRUMENTS["usual"]}
    coverage = measured_loops.coverage(measured_loops.cycles(1), usual)["usual"]
    unit, reason = "% of the true hysteresis", "last digit on the page"
    return {
        "error of the hysteresis": Number(100 * float(coverage.offset[0, 2]), 0.5, unit, reason),
        "half of its interval": Number(100 * float(coverage.reach[0, 2]), 0.5, unit, reason),
    }


def _prediction() -> Mapping[str, Number]:
    """Factor k of the first film, predicted and simulated."""
    film = next(comparisons())
    return {
        "k predicted": interval_number(film.prediction.k),
        "k simulated": interval_number(film.simulations.k),
    }


CANARIES = {
    "settings": _settings,
    "requested": _requested,
    "averages": _averages,
    "coverage": _coverage,
    "energy balance": _energy_balance,
    "scans": _scans,
    "movement": _movement,
    "measured loop": _measured_loop,
    "prediction": _prediction,
}
