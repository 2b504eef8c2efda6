"""Canaries of boundary elements: a small case, and the law through the stored comparisons."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from crackfront.analysis.validity import excess_coefficient
from studies.boundary_elements.cycle import boundary_cycle
from studies.boundary_elements.front import front_cycle
from studies.boundary_elements.hysteresis import hysteresis
from studies.boundary_elements.page import kept_surfaces, kept_validity
from studies.boundary_elements.parameters import load_validation, validation_cases
from studies.numbers import Number


def _small_case() -> Mapping[str, Number]:
    """Hysteresis of a rough sphere by both models."""
    parameters = load_validation(Path("config/validation-test.yaml"))
    (case,) = validation_cases(parameters)
    front = front_cycle(case, parameters.front.n_angle, parameters.front.spacing)
    result = hysteresis(case, boundary_cycle(case), front)
    reason = "1% of the larger hysteresis: a hundred times the tolerance of pressures"
    error = 0.01 * max(result.front_difference, result.boundary_difference)
    return {
        "hysteresis of the front": Number(result.front_difference, error, "w_int", reason),
        "hysteresis of boundary elements": Number(
            result.boundary_difference, error, "w_int", reason
        ),
    }


def _coefficient() -> Mapping[str, Number]:
    """Growth of the excess hysteresis of the front with e_el."""
    value, error = excess_coefficient(kept_validity(kept_surfaces()))
    return {"c": Number(value, error, reason="standard error")}


CANARIES = {"small case": _small_case, "coefficient": _coefficient}
