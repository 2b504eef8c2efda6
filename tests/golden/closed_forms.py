"""Scenes without a front: spectra, synthesis, the mapping of roughness, JKR and units."""

from collections.abc import Callable

import numpy as np

from crackfront.core import jkr
from crackfront.core.adhesion import (
    chemical_adhesion,
    correlation_length,
    front_stress_intensity,
    half_derivative_mean_square,
    larkin_length,
    rough_adhesion,
)
from crackfront.core.geometry.base import fast_site_count
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum, TabulatedSpectrum
from crackfront.core.synthesis import gaussian_field, uncorrelated_rows
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, ReducedUnit, Scales
from crackfront.simulate.tiles import RandomSurface, correlated_adhesion, uncorrelated_adhesion
from tests.golden.golden import Values

FRACTAL = SelfAffineSpectrum(short_cutoff=0.3, roll_off=0.9, hurst=0.8, plateau=0.02)
FLAT = SelfAffineSpectrum(short_cutoff=0.4, roll_off=0.4, hurst=0.5)
# Where the order of a derivative is H, its mean square has a logarithm.
LOGARITHMIC = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.7, hurst=0.5)
TABLE = TabulatedSpectrum((1.2, 0.7, 0.4, 0.25), (0.02, 0.015, 4e-3, 3e-4))

SPECTRA: dict[str, Spectrum] = {
    "fractal": FRACTAL,
    "flat": FLAT,
    "logarithmic": LOGARITHMIC,
    "tabulated": TABLE,
}

ORDERS = (-0.5, 0.0, 0.25, 0.5, 1.0, 1.5)
"""Orders of derivatives whose mean squares are compared."""


def spectra() -> Values:
    """Densities, mean squares and lengths of every shape of spectrum."""
    values: Values = {}
    for name, spectrum in SPECTRA.items():
        wavevectors = 2 * np.pi / np.array([5.0, 1.0, 0.8, 0.5, 0.42, 0.35, 0.27, 0.12])
        scaled = spectrum.with_elastic_energy(0.07)
        longer = spectrum.longer_than(1.1 * spectrum.short_cutoff)
        values |= {
            f"{name} density": spectrum.density(wavevectors),
            f"{name} mean square between": np.array(spectrum.mean_square_between(0.5, 0.45, 0.8)),
            f"{name} scaled density": scaled.density(wavevectors),
            f"{name} lengths": np.array(
                [
                    spectrum.short_cutoff,
                    spectrum.longest_feature,
                    spectrum.correlation_length,
                    *spectrum.dominant_wavelengths(0.5),
                    correlation_length("chemical", spectrum),
                    larkin_length("roughness", spectrum, 0.3),
                    larkin_length("chemical", spectrum, 0.3),
                ]
            ),
            f"{name} elastic energy": np.array(spectrum.elastic_energy),
        }
        for order in ORDERS:
            values[f"{name} mean squares, order {order:g}"] = np.array(
                [spectrum.mean_square(order), longer.mean_square(order)]
            )
    wavevectors = 2 * np.pi / np.array([5.0, 1.0, 0.8, 0.5, 0.42, 0.31])
    return values | {"profile density": FRACTAL.profile_density(wavevectors)}


def synthesis() -> Values:
    """Gaussian tiles, square, oblong, of odd sides, and independent rows."""

    def rng() -> np.random.Generator:
        return np.random.default_rng(71)

    return {
        "square": gaussian_field(FRACTAL, 12, 1.5, rng()),
        "oblong": gaussian_field(TABLE, (14, 10), (1.75, 1.25), rng()),
        "odd": gaussian_field(FLAT, 9, 1.6, rng()),
        "at two pixels a wave": gaussian_field(FLAT, 8, 1.6, rng()),
        "rows": uncorrelated_rows(FRACTAL, 0.5, (14, 4), 0.1, rng()),
        "odd rows": uncorrelated_rows(TABLE, 0.0, (15, 3), 0.12, rng()),
    }


def mapping() -> Values:
    """Works of adhesion of heights and of chemical fields, and their measures."""
    values: Values = {}
    for name, shape in {"even": (10, 8), "odd": (7, 9), "oblong": (6, 11)}.items():
        heights = np.random.default_rng(72).standard_normal(shape)
        heights -= heights.mean()
        rough = rough_adhesion(0.02 * heights, 0.1)
        chemical = chemical_adhesion(0.3 * heights, 0.1)
        values |= {
            f"{name} stress intensity": front_stress_intensity(heights, 0.1, 2.0),
            f"{name} half-derivative": np.array(half_derivative_mean_square(heights, 0.1)),
            f"{name} rough": rough.work_of_adhesion,
            f"{name} chemical": chemical.work_of_adhesion,
            f"{name} measures": np.array([rough.e_el, rough.w_rms, chemical.e_el, chemical.w_rms]),
        }
    for kind in ("roughness", "chemical"):
        surface = RandomSurface(kind, FRACTAL, 0.04, 73, (12, 12), (1.5, 1.5))
        for name, adhesion in (
            ("surface", correlated_adhesion(surface)),
            ("independent rows", uncorrelated_adhesion(surface)),
        ):
            values[f"{kind} {name}"] = adhesion.work_of_adhesion
            values[f"{kind} {name} measures"] = np.array(
                [adhesion.e_el, adhesion.w_rms, adhesion.pixel, surface.correlation_length]
            )
    return values


def smooth_sphere() -> Values:
    """All closed forms of JKR, where the edge is open and where it is in compression."""
    radius = np.array([0.3, 0.6, 1.0, 1.7, 2.4])[:, np.newaxis]
    penetration = np.array([-0.6, 0.0, 0.5, 2.0])
    works = (0.8, 1.0, 1.3)
    return {
        "stress intensity": jkr.stress_intensity(radius, penetration),
        "energy release rate": jkr.energy_release_rate(radius, penetration),
        "force": jkr.force(radius, penetration),
        "stored energy": jkr.stored_energy(radius, penetration),
        "apparent work": jkr.apparent_work_of_adhesion(radius, penetration),
        "equilibrium penetration": jkr.equilibrium_penetration(radius, np.array(works)),
        "equilibrium force": jkr.equilibrium_force(radius, np.array(works)),
        "displacement": jkr.surface_displacement(np.array([0.2, 0.9, 1.1, 3.0]), 1.0, 0.4),
        "equilibrium radius": np.array(
            [[jkr.equilibrium_radius(depth, work) for depth in (-0.4, 0.3, 2)] for work in works]
        ),
        "radius at force": np.array([jkr.radius_at_force(0.4, work) for work in works]),
        "spring": np.array([jkr.spring(1.5, work) for work in works]),
        "slope": np.array([jkr.penetration_slope(depth) for depth in (-0.3, 0.5)]),
        "pull-off": np.array(
            [
                (
                    jkr.pull_off_radius(work),
                    jkr.pull_off_penetration(work),
                    jkr.pull_off_force(work),
                )
                for work in works
            ]
        ),
    }


def units() -> Values:
    """Reduced units in SI, the constants of the model and numbers of sites."""
    # Of order one: comparisons have a smallest scale.
    scales = Scales(radius=1.25, work_of_adhesion=0.63, contact_modulus=0.93)
    return {
        "constants": np.array([WORK_OF_ADHESION, CONTACT_MODULUS]),
        "energy per area": np.array(scales.energy_per_area),
        "sites": np.array([fast_site_count(least) for least in (1, 33, 257, 20000)], float),
    } | {unit.name.lower(): np.array(unit.scale(scales)) for unit in ReducedUnit}


CLOSED_FORMS: dict[str, Callable[[], Values]] = {
    "spectra": spectra,
    "synthesis": synthesis,
    "mapping of roughness": mapping,
    "smooth sphere": smooth_sphere,
    "units": units,
}
"""Scenes by their names in the file."""
