"""The computed figures of the paper, each from its parameters to its data and checks."""

import functools
from pathlib import Path

from crackfront.core.fingerprint import fingerprint
from crackfront.studies.paper.avalanches import (
    AvalancheParameters,
    AvalancheRecord,
    avalanche_checks,
    avalanche_record,
)
from crackfront.studies.paper.checks import Check, checks_table, close_to
from crackfront.studies.paper.film_scales import (
    FilmScales,
    FilmScalesParameters,
    film_scales,
    film_scales_checks,
)
from crackfront.studies.paper.instabilities import (
    InstabilityParameters,
    InstabilityRecord,
    instability_record,
)
from crackfront.studies.paper.instability_checks import instability_checks
from crackfront.studies.paper.mapping import Mapping, MappingParameters, mapping, mapping_checks
from crackfront.studies.paper.motion import Motion, MotionParameters, motion, motion_checks
from crackfront.studies.paper.nanodiamond import NanodiamondContact, nanodiamond_contact
from crackfront.studies.paper.nanodiamond_checks import nanodiamond_checks
from crackfront.studies.paper.nanodiamond_parameters import NanodiamondParameters
from crackfront.studies.paper.parametric import (
    ParametricStudy,
    ParametricStudyParameters,
    parametric_study,
    parametric_study_checks,
    study_fit,
)
from crackfront.studies.paper.pinned_loop import (
    PinnedLoop,
    PinnedLoopParameters,
    pinned_loop,
    pinned_loop_checks,
)
from crackfront.studies.paper.rings import RingLoops, RingsParameters, ring_adhesion, ring_loops
from crackfront.studies.paper.rings_checks import rings_checks
from crackfront.studies.paper.roughness import (
    RoughnessParameters,
    RoughnessRecord,
    roughness_record,
)
from crackfront.studies.paper.roughness_checks import roughness_checks
from crackfront.studies.paper.scene import FigureScene, Progress
from crackfront.studies.paper.smooth import (
    SmoothLoop,
    SmoothLoopParameters,
    smooth_loop,
    smooth_loop_checks,
)
from crackfront.studies.paper.synthetic_film import (
    SyntheticFilm,
    SyntheticFilmParameters,
    synthetic_film,
    synthetic_film_checks,
)

__all__ = [
    "FIGURES",
    "AvalancheRecord",
    "Check",
    "FigureScene",
    "FilmScales",
    "InstabilityRecord",
    "Mapping",
    "Motion",
    "NanodiamondContact",
    "ParametricStudy",
    "ParametricStudyParameters",
    "PinnedLoop",
    "Progress",
    "RingLoops",
    "RoughnessRecord",
    "SmoothLoop",
    "SyntheticFilm",
    "checks_table",
    "close_to",
    "figure_fingerprint",
    "ring_adhesion",
    "study_fit",
]

FIGURES = {
    "main-1d": FigureScene(
        title="Main Fig. 1d: a smooth sphere with two works of adhesion",
        parameters=SmoothLoopParameters,
        record=SmoothLoop,
        compute=smooth_loop,
        checks=smooth_loop_checks,
    ),
    "main-2": FigureScene(
        title="Main Fig. 2: rings of high and low work of adhesion",
        parameters=RingsParameters,
        record=RingLoops,
        compute=ring_loops,
        checks=rings_checks,
    ),
    "main-3ab": FigureScene(
        title="Main Fig. 3a, b: a retraction in single elastic instabilities",
        parameters=InstabilityParameters,
        record=InstabilityRecord,
        compute=instability_record,
        checks=instability_checks,
    ),
    "main-3cd": FigureScene(
        title="Main Fig. 3c, d: the smooth loop of a finely rough sphere, and its fronts at b = 0",
        parameters=PinnedLoopParameters,
        record=PinnedLoop,
        compute=pinned_loop,
        checks=pinned_loop_checks,
    ),
    "main-4": FigureScene(
        title="Main Fig. 4: roughness, and the work of adhesion that it is equivalent to",
        parameters=MappingParameters,
        record=Mapping,
        compute=mapping,
        checks=mapping_checks,
    ),
    "main-5a": FigureScene(
        title="Main Fig. 5a: spectrum of nanodiamond, and the scales that dominate its measures",
        parameters=FilmScalesParameters,
        record=FilmScales,
        compute=film_scales,
        checks=film_scales_checks,
    ),
    "main-5bc": FigureScene(
        title="Main Fig. 5b, c: a rubber sphere on nanodiamond",
        parameters=NanodiamondParameters,
        record=NanodiamondContact,
        compute=nanodiamond_contact,
        checks=nanodiamond_checks,
    ),
    "si-5": FigureScene(
        title="SI Fig. S-5: hysteresis against disorder, and k against disorder and size",
        parameters=ParametricStudyParameters,
        record=ParametricStudy,
        compute=parametric_study,
        checks=parametric_study_checks,
    ),
    "si-6": FigureScene(
        title="SI Fig. S-6: profile densities of nanodiamond and of synthetic surfaces",
        parameters=SyntheticFilmParameters,
        record=SyntheticFilm,
        compute=synthetic_film,
        checks=synthetic_film_checks,
    ),
    "beyond-avalanches": FigureScene(
        title="Beyond the paper: avalanches",
        parameters=AvalancheParameters,
        record=AvalancheRecord,
        compute=avalanche_record,
        checks=avalanche_checks,
    ),
    "beyond-roughness": FigureScene(
        title="Beyond the paper: roughness of the front",
        parameters=RoughnessParameters,
        record=RoughnessRecord,
        compute=roughness_record,
        checks=roughness_checks,
    ),
    "beyond-animation": FigureScene(
        title="Animation: the fronts of a cycle over the field, beside its loop",
        parameters=MotionParameters,
        record=Motion,
        compute=motion,
        checks=motion_checks,
        animated=True,
    ),
}
"""Figures by the name of their configuration in config/figures."""


_DRAWINGS = tuple(f"studies/paper/{path.name}" for path in Path(__file__).parent.glob("draw_*.py"))
"""Sources that draw and compute nothing."""


@functools.cache
def figure_fingerprint() -> str:
    """Twelve hexadecimal digits that change with every source that a figure's data come from."""
    return fingerprint(
        "core", "simulate", "simulate/laws.csv", "analysis", "studies/paper", without=_DRAWINGS
    )
