"""Measured surfaces: the only importer of SurfaceTopography, which reads and detrends them."""

from crackfront.surfaces.densities import Density, isotropic_density, profile_density
from crackfront.surfaces.files import Detrend, Treatment
from crackfront.surfaces.fitting import FittedSpectrum, Uncertain, fitted_spectrum
from crackfront.surfaces.measures import (
    ORDERS,
    RmsMeasure,
    Surface,
    measured_mean_square,
    measured_surface,
)
from crackfront.surfaces.reading import Measurement, read_measurements
from crackfront.surfaces.tile import Placement, measured_adhesion, zero_load_radius

__all__ = [
    "ORDERS",
    "Density",
    "Detrend",
    "FittedSpectrum",
    "Measurement",
    "Placement",
    "RmsMeasure",
    "Surface",
    "Treatment",
    "Uncertain",
    "fitted_spectrum",
    "isotropic_density",
    "measured_adhesion",
    "measured_mean_square",
    "measured_surface",
    "profile_density",
    "read_measurements",
    "zero_load_radius",
]
