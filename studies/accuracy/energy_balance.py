"""Dissipated energy of a cycle against its load step, by three quadratures.

The dissipated energies equal, to round-off, the work of the load steps as they are made: the front
is fixed while the load changes (unless its edge comes to lie in compression), and jumps at the new
load. This overshoots the quasi-static loop by an error of first order; the trapezoidal rule on the
force curve and the extrapolation of two steps come nearer.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.arrays import Array
from crackfront.core.cycle.load_schedule import DEFAULT_STEP, LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS
from studies.accuracy.study import rms
from studies.tables import Table, make_table

CUTOFF = 0.08
"""Short cutoff of the spectrum. (Units: reduced lateral length)"""

N_POINT = 128
"""Points along a side of a tile."""

N_ANGLE = 340
"""Sites of a front."""

N_SURFACE = 4
"""Surfaces of each amplitude."""

AMPLITUDES = (0.1, 0.4, 0.84)
"""w_rms / w_int."""

STEPS = DEFAULT_STEP * 2.0 ** np.arange(5, -2, -1)
"""Load steps, each half of the one before. (Units: reduced vertical length)"""


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


class Energies(NamedTuple):
    """Energies of a cycle (Units: reduced energy)."""

    dissipated: float
    work: float
    """Work of the load steps as they are made."""
    trapezoid: float
    """Trapezoidal rule on the force curve."""


def energies(record: CycleRecord) -> Energies:
    """Dissipated energy, work of the load steps, and the trapezoidal rule on the force curve."""
    assert record.dissipated_energy is not None, "the cycle records energies"
    assert record.pull_off_energy is not None, "the cycle records energies"
    force, radius = record.states.force, record.states.mean_radius
    change = np.diff(np.append(record.states.penetration, record.end_load))
    fixed_front = force + 2 * CONTACT_MODULUS * radius * change
    # Contact is lost at the last load by the front that was fixed on the way to it.
    after = np.append(force[1:], fixed_front[-1])
    return Energies(
        dissipated=float(record.dissipated_energy.sum() + record.pull_off_energy),
        work=float(np.sum((force + fixed_front) * change) / 2),
        trapezoid=float(np.sum((force + after) * change) / 2),
    )


def energy_table() -> Table:
    """Energies of all amplitudes and steps; errors are rms, against the finest two steps."""
    rows = [row for amplitude in AMPLITUDES for row in _amplitude_rows(amplitude)]
    return make_table(
        "w_rms/w_int | step | dissipated | error of dissipated % | error of trapezoidal rule % "
        "| error of extrapolation % | dissipated - work of the steps",
        rows,
    )


def _amplitude_rows(amplitude: float) -> Iterator[tuple[str, ...]]:
    """Rows of an amplitude, one a step, the coarsest first."""
    balances = [
        [energies(cycle(amplitude, seed, step)) for seed in range(N_SURFACE)] for step in STEPS
    ]
    dissipated, work, trapezoid = np.moveaxis(np.array(balances), 2, 0)
    # A value from each step and the next finer one.
    extrapolated = 2 * dissipated[1:] - dissipated[:-1]
    best = extrapolated[-1]
    for index, step in enumerate(STEPS):
        # The first step lacks a coarser one; the last extrapolation is the reference.
        is_extrapolated = 0 < index < len(STEPS) - 1
        yield (
            f"{amplitude:g}",
            f"{step:g}",
            f"{dissipated[index].mean():.4f}",
            _percent_error(dissipated[index], best),
            _percent_error(trapezoid[index], best),
            _percent_error(extrapolated[index - 1], best) if is_extrapolated else "",
            f"{np.max(np.abs(dissipated[index] - work[index])):.0e}",
        )


def _percent_error(values: Array, expected: Array) -> str:
    """Rms relative error over surfaces, in per cent."""
    return f"{100 * rms(values / expected - 1):.2f}"
