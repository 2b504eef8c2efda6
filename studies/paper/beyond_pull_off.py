"""Beyond the paper's figures: pull-off force against h_rms, above and below H = 0.5."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.analysis.estimate import mean_estimate
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.run import run_cycle
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.style import (
    BLUE,
    PAGE,
    VERMILION,
    blank_figure,
    explain,
    house_style,
)
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.simulation import Simulation, simulation_adhesion, simulation_field
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.validation import Count, Fraction, Positive
from studies.paper.checks import Check
from studies.paper.drawing import DASHED, name_panels
from studies.paper.figure import Figure
from studies.paper.rough import RoughParameters, rough_spectrum
from studies.progress import Progress

_KIND = "hurst_exponent", "cutoff", "height"


class PullOffParameters(RoughParameters):
    """Surfaces whose pull-off force is measured, by Hurst exponent, cutoff and rms height."""

    hurst: Annotated[tuple[float, ...], Field(min_length=2, max_length=2, strict=False)]
    roll_off: Positive  # of all surfaces (reduced lateral length)
    short_cutoffs: Annotated[tuple[Positive, ...], Field(min_length=2, max_length=2, strict=False)]
    elastic_energies: Annotated[tuple[Fraction, ...], Field(min_length=2, strict=False)]
    max_penetration: Positive  # where the retraction begins (reduced vertical length)
    step: Positive
    n_surface: Count  # of each kind

    @model_validator(mode="after")
    def _possible(self) -> PullOffParameters:
        for spectrum in self.spectra().flat:
            self.simulation_on(spectrum)
        return self

    def spectra(self) -> NDArray[Any]:
        """Spectra by Hurst exponent, cutoff and height; a height has one h_rms."""
        sizes = len(self.hurst), len(self.short_cutoffs), len(self.elastic_energies)
        spectra = np.empty(sizes, dtype=object)
        for hurst, cutoff, height in np.ndindex(sizes):
            coarse, fine = (
                rough_spectrum(shortest, self.roll_off, self.hurst[hurst])
                for shortest in (self.short_cutoffs[cutoff], self.short_cutoffs[-1])
            )
            square = fine.with_elastic_energy(self.elastic_energies[height]).mean_square(0.0)
            spectra[hurst, cutoff, height] = coarse.amplified(square / coarse.mean_square(0.0))
        return spectra

    def simulation_on(self, spectrum: SelfAffineSpectrum, realisation: int = 0) -> Simulation:
        """Full cycle on a surface of a spectrum."""
        schedule = FullCycle(self.max_penetration, self.step)
        return self.simulation_of(spectrum, spectrum.elastic_energy, schedule, realisation)


@dataclass(frozen=True, slots=True)
class PullOff:
    """Pull-off forces of rough spheres."""

    roll_off: float = variable("roll-off wavelength lambda_r", LATERAL)
    hurst: Array = variable("Hurst exponent", "1", "hurst_exponent")
    short_cutoff: Array = variable("shortest wavelength lambda_s", LATERAL, "cutoff")
    rms_height: Array = variable("rms height of the spectrum", VERTICAL, *_KIND)
    elastic_energy: Array = variable("e_el of the spectrum", ADHESION, *_KIND)
    force: Array = variable("pull-off force", FORCE, *_KIND, "surface")


def pull_off_forces(parameters: PullOffParameters, progress: Progress) -> PullOff:
    """Lowest forces of full cycles on all surfaces."""
    spectra = parameters.spectra()
    force = np.empty((*spectra.shape, parameters.n_surface))
    for place, spectrum in np.ndenumerate(spectra):
        for realisation in range(parameters.n_surface):
            force[place][realisation] = _pull_off(parameters, spectrum, realisation)
        progress(
            f"H = {spectrum.hurst:g}, cutoff {spectrum.short_cutoff:g}, e_el "
            f"{spectrum.elastic_energy:.3f}: {force[place].mean():.4f} pi w_int R"
        )
    heights = [spectrum.mean_square(0.0) ** 0.5 for spectrum in spectra.flat]
    energies = [spectrum.elastic_energy for spectrum in spectra.flat]
    return PullOff(
        roll_off=parameters.roll_off,
        hurst=np.array(parameters.hurst),
        short_cutoff=np.array(parameters.short_cutoffs),
        rms_height=np.reshape(heights, spectra.shape),
        elastic_energy=np.reshape(energies, spectra.shape),
        force=force,
    )


def _pull_off(parameters: PullOffParameters, spectrum: SelfAffineSpectrum, number: int) -> float:
    """Lowest force of a cycle on one surface (Units: pi w_int R)."""
    simulation = parameters.simulation_on(spectrum, number)
    compile_solver(simulation.solver.name, FullCycle)
    field = simulation_field(simulation, simulation_adhesion(simulation))
    schedule = FullCycle(parameters.max_penetration, parameters.step)
    return float(run_cycle(field, schedule, simulation.solver).states.force.min())


def expected_seconds(parameters: PullOffParameters) -> float:
    """Processor time of all cycles (Units: s)."""
    simulations = map(parameters.simulation_on, parameters.spectra().flat)
    return parameters.n_surface * sum(
        expected_cost(simulation).seconds for simulation in simulations
    )


_EXPECTATION = (
    "Pull-off: the paper states that for H > 0.5 h_rms^(1/2), which decides the hysteresis, "
    "depends on long waves as h_rms does. At equal h_rms the e_el then depends less on short waves "
    "than for H < 0.5. The pull-off force need not follow: shorter waves also raise k, since the "
    "contact is larger compared with their Larkin length (docs/law.md)."
)
"""Source of the expectation."""


def pull_off_checks(record: PullOff) -> tuple[Check, ...]:
    """Growth of the pull-off force with h_rms, and what short waves add at equal h_rms."""
    above, below = _share_of_short_waves(record)
    difference, _ = mean_estimate(below - above)
    undecided = ""
    if difference.low <= 0 <= difference.high:
        undecided = f"the difference is {100 * difference.value:.1f}%, less than its 95% interval"
    mean = -record.force.mean(axis=3)
    numbers = "; ".join(
        f"lambda_s = {cutoff:g}: {', '.join(f'{force:.3f}' for force in forces)}"
        for cutoff, forces in zip(record.short_cutoff, mean[0], strict=True)
    )
    ratios = record.elastic_energy[:, 1, 0] / record.elastic_energy[:, 0, 0]
    return (
        Check(
            f"H = {record.hurst[0]:g} > 0.5: the pull-off force increases with h_rms",
            "at every step, with both cutoffs",
            f"{numbers} pi w_int R",
            bool(np.all(np.diff(mean[0]) > 0)),
            f"means of {record.force.shape[-1]} surfaces",
        ),
        Check(
            "at equal h_rms short waves add less to the pull-off force for H > 0.5 than below",
            f"less than {100 * below.mean():.1f}%",
            f"{100 * above.mean():.1f}%",
            bool(above.mean() < below.mean()),
            f"means over h_rms, with waves down to {record.short_cutoff[1]:g} instead of "
            f"{record.short_cutoff[0]:g}: e_el is {ratios[0]:.2f} and {ratios[1]:.2f} times larger",
            undecided=undecided,
            expectation=_EXPECTATION,
        ),
    )


def _share_of_short_waves(record: PullOff) -> Array:
    """Relative growth of the force by short waves at equal h_rms, (hurst, surface)."""
    return np.mean(record.force[:, 1] / record.force[:, 0] - 1, axis=1)


_LOOKS = ((BLUE, "o"), (VERMILION, "s"))
"""Colour and marker of each cutoff."""


def pull_off_figure(record: PullOff) -> Drawing:
    """Pull-off force against h_rms, a panel for each Hurst exponent."""
    with house_style():
        figure = blank_figure(PAGE, 0.45 * PAGE)
        panels = figure.subplots(1, 2, sharey=True)
        for hurst, axes in enumerate(panels):
            _draw_forces(axes, record, hurst)
        panels[0].set_ylabel(r"pull-off force / $\pi w_\mathrm{int}R$")
        name_panels(panels, "ab")
        by_paper = "w_\\mathrm{int}-e_\\mathrm{el}+k\\,e_\\mathrm{el}"
        explain(
            figure,
            f"roll-off $\\lambda_\\mathrm{{r}}={record.roll_off:g}$; points: lowest force of each "
            f"simulated sphere; broken: $\\frac{{3}}{{2}}({by_paper})$ with $k={PAPER_FACTOR:g}$; "
            "grey: a smooth sphere",
        )
        return figure


def _draw_forces(axes: Axes, record: PullOff, hurst: int) -> None:
    """Points of all surfaces of a Hurst exponent, and the force by the paper's k."""
    axes.axhline(-jkr.pull_off_force(), color="0.6", linewidth=0.8, zorder=0)
    for cutoff, (colour, marker) in enumerate(_LOOKS):
        heights, energy = record.rms_height[hurst, cutoff], record.elastic_energy[hurst, cutoff]
        shown = np.linspace(0, 1.1 * heights[-1], 100)
        by_paper = 1 + (PAPER_FACTOR - 1) * energy[-1] * (shown / heights[-1]) ** 2
        axes.plot(shown, -jkr.pull_off_force() * by_paper, color=colour, **DASHED)
        label = rf"$\lambda_\mathrm{{s}}={record.short_cutoff[cutoff]:g}$"
        for surface, forces in enumerate(record.force[hurst, cutoff].T):
            name = label if surface == 0 else None
            axes.plot(heights, -forces, marker, color=colour, mfc="white", label=name, zorder=3)
    axes.set_xlabel(rf"rms height $h_\mathrm{{rms}}$ / ${VERTICAL.tex}$")
    axes.set_ylim(-0.98 * jkr.pull_off_force(), -1.05 * float(record.force.min()))
    axes.legend(loc="upper left", title=f"$H={record.hurst[hurst]:g}$")


FIGURE = Figure(
    title="Beyond the paper: pull-off force against rms height, for H above and below 0.5",
    compute=pull_off_forces,
    checks=pull_off_checks,
    draw=pull_off_figure,
    seconds=expected_seconds,
)
