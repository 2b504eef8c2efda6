"""What is predicted for a measured surface under a sphere, where it holds, and the real run."""

from crackfront.prediction.law import (
    Prediction,
    Range,
    predicted,
    reduced_spectrum,
    surface_factors,
)
from crackfront.prediction.limits import Limit, prediction_notes, surface_notes, theory_limits
from crackfront.prediction.machine import machine_readable
from crackfront.prediction.report import (
    conformity_text,
    prediction_text,
    simulation_text,
    surface_text,
)
from crackfront.prediction.simulated import (
    Simulated,
    expected_seconds,
    prediction_simulations,
    simulated,
)

__all__ = [
    "Limit",
    "Prediction",
    "Range",
    "Simulated",
    "conformity_text",
    "expected_seconds",
    "machine_readable",
    "predicted",
    "prediction_notes",
    "prediction_simulations",
    "prediction_text",
    "reduced_spectrum",
    "simulated",
    "simulation_text",
    "surface_factors",
    "surface_notes",
    "surface_text",
    "theory_limits",
]
