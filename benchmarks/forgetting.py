"""Whether steady branches have forgotten the circle at which they began.

python -m benchmarks.forgetting

Fronts that begin at the circle of :func:`crackfront.steady.forward_circle` are compared, load by
load, with those that begin as far behind as the field allows.
"""

from __future__ import annotations

from dataclasses import replace

import click
import numpy as np

from benchmarks.hysteresis import CASES, N_REALISATION, Case, Setting, surface
from crackfront import jkr
from crackfront.cycle import CycleRecord, FrontHistory
from crackfront.pinning import TileField, first_radius, last_radius, n_angle
from crackfront.relax import Direction
from crackfront.scene import contact_field, correlation_length
from crackfront.spectrum import SelfAffineSpectrum
from crackfront.steady import forward_circle

SETTING = Setting(2.2, 4, "cubic", 4, 1e-7)
N_LOAD = 10
SAME = 1e-4
"""Largest difference of equal fronts, in short cutoffs."""

SURFACES = (
    *(replace(CASES[0], name=f"flat, w_rms {rms:g}", rms=rms) for rms in (0.1, 0.4, 0.84, 1.5)),
    Case("(0.02, 0.4, 0.3), w_rms 0.45", 0.45, SelfAffineSpectrum(0.02, 0.4, 0.3), 160, 0.1),
    Case("(0.02, 0.4, 0.3), w_rms 0.77", 0.77, SelfAffineSpectrum(0.02, 0.4, 0.3), 160, 0.1),
    Case("(0.02, 0.32, 0.8), w_rms 0.45", 0.45, SelfAffineSpectrum(0.02, 0.32, 0.8), 160, 0.1),
)


def branch(field: TileField, start: np.ndarray, loads: np.ndarray, sign: Direction) -> CycleRecord:
    """States of one branch from a start."""
    history = FrontHistory(field, start, tolerance=SETTING.tolerance, record_fronts=True)
    history.begin(start)
    for penetration in loads:
        history.follow(float(penetration), sign)
    return history.record()


def differing(case: Case, sign: Direction) -> tuple[int, int]:
    """Number of states that differ in any site, and of all that count as steady."""
    cutoff = case.spectrum.short_cutoff
    kind = "chemical" if case.spectrum.roll_off == cutoff else "roughness"
    length = correlation_length(kind, case.spectrum)
    loads = 1.0 + sign * 6 * length * np.arange(N_LOAD)
    sites = 2 * np.pi * jkr.equilibrium_radius(1.0) / cutoff * SETTING.angles
    count = total = 0
    for seed in range(N_REALISATION):
        field = contact_field(
            surface(case, SETTING.pixels, seed),
            2 * round(sites / 2),
            cutoff / SETTING.samples,
            float(loads.max()),
            band_limited=True,
        )
        furthest = first_radius(field) if sign > 0 else last_radius(field)
        behind = branch(field, np.full(n_angle(field), furthest), loads, sign)
        begin = jkr.equilibrium_radius(1.0) - sign * length
        near = branch(field, forward_circle(field, 1.0, sign, begin), loads, sign)
        if near.radius is None or behind.radius is None:
            raise RuntimeError("fronts were not recorded")
        steady = near.least_travel >= length
        difference = np.max(np.abs(near.radius - behind.radius), axis=1)
        count += int(np.count_nonzero(difference[steady] > SAME * cutoff))
        total += int(np.count_nonzero(steady))
    return count, total


def main() -> None:
    """Compare on all surfaces in both directions."""
    for case in SURFACES:
        for sign, name in ((1, "approach"), (-1, "retraction")):
            count, total = differing(case, 1 if sign > 0 else -1)
            click.echo(f"{case.name}, {name}: {count} of {total} steady states differ")


if __name__ == "__main__":
    main()
