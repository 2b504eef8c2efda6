"""How wrong the numerics are: scenes, errors against converged ones, and the laws they give."""

from crackfront.accuracy.coverage import (
    Coverage,
    held_out_coverage,
    numerical_interval,
    total_interval,
)
from crackfront.accuracy.fitting import fit_laws
from crackfront.accuracy.report import (
    accuracy_report,
    accuracy_tables,
    filled_page,
    hysteresis_errors,
    pareto_front,
)
from crackfront.accuracy.sampling import Sample, sampling_errors
from crackfront.accuracy.scenes import ASKED, SCENES, Scene, with_knob
from crackfront.accuracy.study import (
    Branches,
    Errors,
    SceneErrors,
    front_difference,
    joined,
    measured_branches,
    scene_errors,
)

__all__ = [
    "ASKED",
    "SCENES",
    "Branches",
    "Coverage",
    "Errors",
    "Sample",
    "Scene",
    "SceneErrors",
    "accuracy_report",
    "accuracy_tables",
    "filled_page",
    "fit_laws",
    "front_difference",
    "held_out_coverage",
    "hysteresis_errors",
    "joined",
    "measured_branches",
    "numerical_interval",
    "pareto_front",
    "sampling_errors",
    "scene_errors",
    "total_interval",
    "with_knob",
]
