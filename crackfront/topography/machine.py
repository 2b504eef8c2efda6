"""A surface and its prediction as a mapping for machines, in SI units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from crackfront.analysis.factors import Factors
from crackfront.core.records import variables
from crackfront.core.units import Scales
from crackfront.topography.densities import Density
from crackfront.topography.fitting import Uncertain
from crackfront.topography.limits import Limit
from crackfront.topography.measures import Surface
from crackfront.topography.prediction import Prediction
from crackfront.topography.reading import Measurement
from crackfront.topography.simulated import Simulated


def machine_readable(
    surface: Surface,
    scales: Scales | None = None,
    prediction: Prediction | None = None,
    factors: Factors | None = None,
    limits: Sequence[Limit] = (),
    notes: Sequence[str] = (),
    found: Simulated | None = None,
) -> dict[str, Any]:
    """What the texts say, for JSON; SI units, null where there is nothing.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    scales : Scales, optional
        The scene, in SI units.
    prediction : Prediction, optional
        What is predicted.
    factors : Factors, optional
        Factors k that the prediction uses.
    limits : sequence of Limit, optional
        Conditions of the theory.
    notes : sequence of str, optional
        What a reader must know.
    found : Simulated, optional
        What simulations found.
    """
    fitted = surface.fitted
    return {
        "measurements": [
            _measurement_entry(item)
            | {
                "isotropic_density": None if density is None else _density_entry(density, "m^4"),
                "profile_density": _density_entry(profile, "m^3"),
            }
            for item, density, profile in zip(
                surface.measurements, surface.isotropic, surface.profiles, strict=True
            )
        ],
        "spectrum": {
            **{
                name: {**asdict(value), "units": units}
                for name, value, units in spectrum_parameters(surface)
            },
            "shortest": _number(fitted.spectrum.short_cutoff, "m"),
            "longest": _number(fitted.longest, "m"),
            "chi_squared_per_freedom": _number(fitted.misfit, "1"),
            "has_roll_off": fitted.has_roll_off,
            "unmeasured_share_of_e_el": _number(surface.unmeasured_share, "1"),
        },
        "measures": [asdict(item) for item in surface.measures],
        "anisotropy": list(surface.anisotropy),
        "e_el": None
        if scales is None
        else asdict(surface.conformity_energy(scales.contact_modulus)) | {"units": "J m-2"},
        "prediction": None if prediction is None else _entries(prediction),
        "factors": None if factors is None else asdict(factors),
        "limits": [asdict(item) | {"margin": item.margin, "holds": item.holds} for item in limits],
        "notes": list(notes),
        "simulation": None if found is None else _without_nan(asdict(found)),
    }


def spectrum_parameters(surface: Surface) -> tuple[tuple[str, Uncertain, str], ...]:
    """Parameters of the fitted spectrum with their uncertainties and units.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    """
    uncertain = surface.fitted.uncertain
    return (
        ("roll_off", uncertain(lambda spectrum: spectrum.roll_off), "m"),
        ("hurst", uncertain(lambda spectrum: spectrum.hurst), "1"),
        ("plateau", uncertain(lambda spectrum: spectrum.plateau), "m^4"),
    )


def _measurement_entry(item: Measurement) -> dict[str, Any]:
    """A measurement without its heights."""
    return {
        "path": str(item.path),
        "format": item.format,
        "comment": item.comment,
        "checksum": item.checksum,
        "points": list(item.heights.shape),
        "size": {"value": list(item.size), "units": "m"},
        "missing": item.missing,
        "shortest": _number(item.shortest, "m"),
        "longest": _number(item.longest, "m"),
    }


def _density_entry(density: Density, units: str) -> dict[str, Any]:
    """A density in its bins."""
    return {
        "wavevector": {"value": density.wavevector.tolist(), "units": "1/m"},
        "density": {"value": density.value.tolist(), "units": units},
        "modes": density.modes.tolist(),
    }


def _entries(prediction: Prediction) -> dict[str, Any]:
    """All fields of a prediction with their units."""
    return {
        item.name: {
            "value": getattr(prediction, item.name),
            "units": item.units,
            "long_name": item.long_name,
        }
        for item in variables(Prediction)
    }


def _without_nan(values: Any) -> Any:
    """The same with null where there is no number, as JSON needs it."""
    if isinstance(values, dict):
        return {name: _without_nan(value) for name, value in values.items()}
    return None if isinstance(values, float) and math.isnan(values) else values


def _number(value: float, units: str) -> dict[str, Any]:
    """A number with its units."""
    return {"value": value, "units": units}
