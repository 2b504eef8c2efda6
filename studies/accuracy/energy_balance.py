"""Dissipated energy of a cycle against its load step, by three quadratures.

python -m studies.accuracy.energy_balance

The dissipated energies equal, to round-off, the work of the load steps as they are made: the front
is held while the load changes (unless its edge comes to lie in compression), and jumps at the new
load. This overshoots the quasi-static loop by
an error of first order; the trapezoidal rule on the force curve and the extrapolation of two steps
come nearer.
"""

from __future__ import annotations

import click
import numpy as np

from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.contact import contact_field
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import DEFAULT_STEP, LoadSchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS

CUTOFF = 0.08
N_POINT = 128
N_ANGLE = 340
N_SURFACE = 4
STEPS = DEFAULT_STEP * 2.0 ** np.arange(5, -2, -1)
HEADER = (
    "| w_rms/w_int | step | dissipated | its error % | trapezoidal rule % | extrapolated % | "
    "dissipated - work of the steps |\n|---|---|---|---|---|---|---|"
)


def cycle(rms: float, seed: int, step: float) -> CycleRecord:
    """Full cycle with energies on a flat chemical spectrum."""
    pixel = CUTOFF / 4
    spectrum = SelfAffineSpectrum(CUTOFF, CUTOFF, 1.0)
    noise = gaussian_field(spectrum, N_POINT, N_POINT * pixel, np.random.default_rng(seed))
    noise *= rms / np.sqrt(spectrum.mean_square(0.0))
    field = contact_field(
        chemical_adhesion(noise, pixel), 1.0, N_ANGLE, CUTOFF / 5, band_limited=True
    )
    return run_cycle(field, LoadSchedule(1.0, step), recorder=Recorder(energy=True))


def energies(record: CycleRecord) -> tuple[float, float, float]:
    """Dissipated energy, work of the load steps, and the trapezoidal rule on the force curve."""
    if record.dissipated_energy is None or record.pull_off_energy is None:
        raise RuntimeError("the cycle has no energies")
    change = np.diff(np.append(record.states.penetration, record.end_load))
    held = record.states.force + 2 * CONTACT_MODULUS * record.states.mean_radius * change
    # Contact is lost at the last load by the front that was held on the way to it.
    after = np.append(record.states.force[1:], held[-1])
    lost = record.dissipated_energy.sum() + record.pull_off_energy
    work = (np.sum((record.states.force + other) * change) / 2 for other in (held, after))
    return (float(lost), *(float(value) for value in work))


def main() -> None:
    """Print the table; errors are rms over the surfaces, against the finest two steps."""
    click.echo(HEADER)
    for rms in (0.1, 0.4, 0.84):
        found = np.array(
            [[energies(cycle(rms, seed, s)) for seed in range(N_SURFACE)] for s in STEPS]
        )
        lost, work, trapezoid = np.moveaxis(found, 2, 0)
        extrapolated = np.vstack([np.full(N_SURFACE, np.nan), 2 * lost[1:] - lost[:-1]])
        exact = extrapolated[-1]

        def percent(values: np.ndarray, exact: np.ndarray = exact) -> float:
            return float(100 * np.sqrt(np.mean((values / exact - 1) ** 2)))

        for row, step in enumerate(STEPS):
            further = f"{percent(extrapolated[row]):.2f}" if 0 < row < STEPS.size - 1 else ""
            gap = np.max(np.abs(lost[row] - work[row]))
            click.echo(
                f"| {rms:g} | {step:g} | {lost[row].mean():.4f} | {percent(lost[row]):.2f} | "
                f"{percent(trapezoid[row]):.2f} | {further} | {gap:.0e} |"
            )


if __name__ == "__main__":
    main()
