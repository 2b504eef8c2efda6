"""Dissipated energy of a cycle against its load step, by three quadratures.

The dissipated energies equal, to round-off, the work of the load steps as they are made: the front
is fixed while the load changes (unless its edge comes to lie in compression), and jumps at the new
load. This overshoots the quasi-static loop by an error of first order; the trapezoidal rule on the
force curve and the extrapolation of two steps come nearer.
"""

from __future__ import annotations

import numpy as np

from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.load_schedule import DEFAULT_STEP, LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS
from studies.accuracy.study import rms
from studies.pages import markdown_table

CUTOFF = 0.08
N_POINT = 128
"""Points along a side of a tile."""

N_ANGLE = 340
"""Sites of a front."""

N_SURFACE = 4
"""Surfaces of each amplitude."""

STEPS = DEFAULT_STEP * 2.0 ** np.arange(5, -2, -1)


def cycle(amplitude: float, seed: int, step: float) -> CycleRecord:
    """Full cycle with energies on a flat chemical spectrum of an amplitude w_rms/w_int."""
    pixel = CUTOFF / 4
    spectrum = SelfAffineSpectrum(CUTOFF, CUTOFF, 1.0)
    noise = gaussian_field(spectrum, N_POINT, N_POINT * pixel, np.random.default_rng(seed))
    noise *= amplitude / np.sqrt(spectrum.mean_square(0.0))
    field = contact_field(
        chemical_adhesion(noise, pixel), 1.0, N_ANGLE, CUTOFF / 5, band_limited=True
    )
    return run_cycle(field, LoadSchedule(1.0, step), recorder=Recorder(energy=True))


def energies(record: CycleRecord) -> tuple[float, float, float]:
    """Dissipated energy, work of the load steps, and the trapezoidal rule on the force curve."""
    assert record.dissipated_energy is not None, "the cycle records energies"
    assert record.pull_off_energy is not None, "the cycle records energies"
    change = np.diff(np.append(record.states.penetration, record.end_load))
    fixed_front = record.states.force + 2 * CONTACT_MODULUS * record.states.mean_radius * change
    # Contact is lost at the last load by the front that was fixed on the way to it.
    after = np.append(record.states.force[1:], fixed_front[-1])
    lost = record.dissipated_energy.sum() + record.pull_off_energy
    work, trapezoid = (
        np.sum((record.states.force + end) * change) / 2 for end in (fixed_front, after)
    )
    return float(lost), float(work), float(trapezoid)


def energy_table() -> str:
    """Energies of all amplitudes and steps; errors are rms, against the finest two steps."""
    rows = []
    for amplitude in (0.1, 0.4, 0.84):
        balances = [
            [energies(cycle(amplitude, seed, step)) for seed in range(N_SURFACE)] for step in STEPS
        ]
        lost, work, trapezoid = np.moveaxis(np.array(balances), 2, 0)
        # A value from each step and the next finer one.
        extrapolated = 2 * lost[1:] - lost[:-1]
        percents = [
            [f"{100 * rms(row / extrapolated[-1] - 1):.2f}" for row in values]
            for values in (lost, trapezoid, extrapolated[:-1])
        ]
        percents[2] = ["", *percents[2], ""]
        gaps = np.max(np.abs(lost - work), axis=1)
        for row, step in enumerate(STEPS):
            errors = [column[row] for column in percents]
            mean = f"{lost[row].mean():.4f}"
            rows.append((f"{amplitude:g}", f"{step:g}", mean, *errors, f"{gaps[row]:.0e}"))
    return markdown_table(
        "w_rms/w_int | step | dissipated | its error % | trapezoidal rule % | extrapolated % "
        "| dissipated - work of the steps",
        rows,
    )
