"""Main Fig. 5a: spectrum of nanodiamond, and the scales that dominate its rms measures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from pydantic import model_validator
from scipy.integrate import cumulative_trapezoid

from crackfront.core.arrays import Array
from crackfront.core.variables import variable
from crackfront.plots import density_axes, style
from crackfront.sweep.section import section_error
from crackfront.validation import Positive
from studies.paper.checks import Check, close_to
from studies.paper.drawing import write_next_to
from studies.paper.figure import Figure, values_of
from studies.paper.film import CONVERTED_LABEL, FilmDensities, FilmParameters, conformity_energy
from studies.progress import Progress

_ORDER = "order"

_ORDERS = (0.0, 0.5, 1.0)

_SHARE = 0.8
"""Part of a mean square that the bar of a figure stands for."""

_NO_DATA = "ideal spectrum of the paper's fit; the measured one is not part of this repository"


class FilmScalesParameters(FilmParameters):
    """What Fig. 5a shows."""

    work_of_adhesion: Positive  # w_int (J / m^2)

    @model_validator(mode="after")
    def _long_enough(self) -> FilmScalesParameters:
        if self.longest < 10 * self.roll_off:
            raise section_error(
                f"longest is {self.longest:g}; show ten roll-off wavelengths "
                f"({10 * self.roll_off:g}) or more"
            )
        return self


@dataclass(frozen=True, slots=True)
class FilmScales(FilmDensities):
    """Densities of the film, and the wavelengths that dominate its rms measures."""

    work_of_adhesion: float = variable("intrinsic work of adhesion", "J m-2")
    roll_off: float = variable("roll-off wavelength", "m")
    isotropic: Array = variable("isotropic spectral density C", "m4", "wavevector")
    order: Array = variable("order of a derivative", "1", _ORDER)
    mean_square: Array = variable("mean square of the derivative", "m^(2 - 2 order)", _ORDER)
    shortest: Array = variable("wavelength below which a tenth of it lies", "m", _ORDER)
    longest: Array = variable("wavelength above which a tenth of it lies", "m", _ORDER)


def film_scales(parameters: FilmScalesParameters, progress: Progress) -> FilmScales:
    """Densities of the film from its spectrum."""
    spectrum, densities = parameters.spectrum, parameters.densities(parameters.short_cutoff)
    ranges = np.array([spectrum.dominant_wavelengths(order, _SHARE) for order in _ORDERS])
    n_point = densities.wavevector.size, densities.measured_wavevector.size
    progress(f"{n_point[0]} wavevectors, {n_point[1]} measured points")
    return FilmScales(
        **values_of(densities),
        **values_of(parameters, "work_of_adhesion", "roll_off"),
        isotropic=spectrum.density(densities.wavevector),
        order=np.array(_ORDERS),
        mean_square=np.array([spectrum.mean_square(order) for order in _ORDERS]),
        shortest=ranges[:, 0],
        longest=ranges[:, 1],
    )


def film_scales_checks(record: FilmScales) -> tuple[Check, ...]:
    """The paper's numbers, the ranges, and its conversion of profiles."""
    energy = record.contact_modulus / 4 * record.mean_square[1]
    relative = energy / record.work_of_adhesion
    middles = 1e6 * np.sqrt(record.shortest * record.longest)
    checks = [
        close_to("e_el", 1e3 * energy, 11.1, 0.05, units="mJ/m2", remark=_NO_DATA),
        close_to("e_el / w_int", relative, 0.177, 5e-4),
        close_to("w_rms / w_int = 2 sqrt(e_el / w_int)", 2 * math.sqrt(relative), 0.84, 5e-3),
        close_to("h_rms", 1e9 * math.sqrt(record.mean_square[0]), 109, 1, units="nm"),
        Check(
            "the half-derivative is dominated near the roll-off: its range contains it",
            f"{1e6 * record.roll_off:.3g} um within",
            f"{1e6 * record.shortest[1]:.3g} to {1e6 * record.longest[1]:.3g} um",
            bool(record.shortest[1] < record.roll_off < record.longest[1]),
        ),
        Check(
            "the ranges move to shorter wavelengths with the order of the derivative",
            "decreasing middles",
            ", ".join(f"{middle:.3g}" for middle in middles) + " um",
            bool(np.all(np.diff(middles) < 0)),
        ),
        *(_range_check(record, index) for index in range(record.order.size)),
        close_to(
            "e_el from the exact profile density by the paper's conversion, over e_el",
            conformity_energy(record.wavevector, record.profile, record.contact_modulus) / energy,
            1.0,
            2e-3,
            remark="exact for the half-derivative of any isotropic surface; heights and slopes "
            "come out pi/2 too large and pi/4 too small in the mean square",
        ),
    ]
    if record.measured_wavevector.size:
        measured = record.measured_wavevector, record.measured_profile
        computed = conformity_energy(*measured, record.contact_modulus)
        name = "e_el of the measured profiles, over their wavevectors"
        checks.append(close_to(name, 1e3 * computed, 1e3 * energy, 1.0, units="mJ/m2"))
    return tuple(checks)


def _range_check(record: FilmScales, index: int) -> Check:
    """Share of a mean square in its range, from the density that is drawn."""
    order, q = record.order[index], record.wavevector
    shown = q ** (2 + 2 * order) * record.isotropic / (2 * np.pi)
    integral = cumulative_trapezoid(shown, np.log(q), initial=0.0)
    ends = 2 * np.pi / np.array([record.longest[index], record.shortest[index]])
    low, high = np.interp(np.log(ends), np.log(q), integral)
    return close_to(
        f"share of the mean square of order {order:g} in its range, by quadrature",
        float((high - low) / record.mean_square[index]),
        _SHARE,
        2e-3,
    )


def film_scales_figure(record: FilmScales) -> Drawing:
    """Isotropic density with the dominating scales, and density of profiles below."""
    with style.house_style():
        figure = style.blank_figure(style.COLUMN, 1.35 * style.COLUMN)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.25, 1))
        for axes in (upper, lower):
            density_axes.set_density_scales(axes, record.wavevector)
        _draw_isotropic(upper, record)
        _draw_profiles(lower, record)
        density_axes.add_wavelengths(upper)
        style.explain(figure, "bars: scales of 80% of a mean square; grey: the roll-off")
        return figure


def _draw_isotropic(axes: Axes, record: FilmScales) -> None:
    """Isotropic density, the scales that dominate its mean squares, and the roll-off."""
    axes.plot(record.wavevector, record.isotropic, color=style.BLACK)
    scales = record.mean_square, record.shortest, record.longest
    density_axes.draw_dominant_scales(axes, *scales)
    place, text = 2 * np.pi / record.roll_off, f"roll-off {1e6 * record.roll_off:.3g} µm"
    # Up to the density, so that it crosses no bar and no name.
    ends = axes.get_ylim()[0], record.isotropic[0]
    axes.vlines(place, *ends, color="0.6", linewidth=0.6, zorder=1)
    look = {"xycoords": axes.get_xaxis_transform(), "ha": "right", "color": "0.35"}
    write_next_to(axes, text, (place, 0.03), (-3, 0), **look)
    if record.measured_wavevector.size:
        density = np.pi / record.measured_wavevector * record.measured_profile
        axes.plot(record.measured_wavevector, density, ".", color=style.VERMILION, markersize=2)
    axes.set_ylabel(density_axes.ISOTROPIC_LABEL)


def _draw_profiles(axes: Axes, record: FilmScales) -> None:
    """Density of profiles, exact, by the paper's conversion, and measured."""
    q = record.wavevector
    axes.plot(q, record.profile, color=style.BLACK, label="exact projection")
    axes.plot(q, record.converted, color=style.BLUE, dashes=(4, 2), label=CONVERTED_LABEL)
    if record.measured_wavevector.size:
        measured = record.measured_wavevector, record.measured_profile
        axes.plot(*measured, ".", color=style.VERMILION, markersize=2, label="measured")
    axes.axvline(2 * np.pi / record.roll_off, color="0.6", linewidth=0.6, zorder=1)
    axes.legend(loc="upper right")
    axes.set(xlabel=density_axes.WAVEVECTOR_LABEL, ylabel=density_axes.PROFILE_LABEL)


FIGURE = Figure(
    title="Main Fig. 5a: spectrum of nanodiamond, and the scales that dominate its measures",
    compute=film_scales,
    checks=film_scales_checks,
    draw=film_scales_figure,
)
