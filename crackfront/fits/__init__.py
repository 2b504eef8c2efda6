"""From the records of runs to w_appr, w_retr, k and their uncertainties, on plain arrays."""

from crackfront.fits.estimate import Estimate
from crackfront.fits.force import FEWEST_POINTS, adhesion_from_forces
from crackfront.fits.notes import fit_notes, trend_sentence
from crackfront.fits.power_law import PowerLaw, truncated_power_law
from crackfront.fits.report import PAPER_FACTOR, PERTURBATION_FACTOR, fit_table
from crackfront.fits.result import Column, FieldKind, SweepFit, fit_columns
from crackfront.fits.steady import STEADY_DEFINITION, SteadyAdhesion, steady_adhesion
from crackfront.fits.sweep import FIT_DEFINITION, fit_sweep
from crackfront.fits.table import SweepTable

__all__ = [
    "FEWEST_POINTS",
    "FIT_DEFINITION",
    "PAPER_FACTOR",
    "PERTURBATION_FACTOR",
    "STEADY_DEFINITION",
    "Column",
    "Estimate",
    "FieldKind",
    "PowerLaw",
    "SteadyAdhesion",
    "SweepFit",
    "SweepTable",
    "adhesion_from_forces",
    "fit_columns",
    "fit_notes",
    "fit_sweep",
    "fit_table",
    "steady_adhesion",
    "trend_sentence",
    "truncated_power_law",
]
