"""Fields and cycles that tests of cycles share."""

import functools

import numpy as np
from scipy.ndimage import gaussian_filter

from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.units import WORK_OF_ADHESION


def noisy_field(seed, n_angle=24, amplitude=0.3, spacing=0.06, largest=2.8):
    rng = np.random.default_rng(seed)
    radii = spacing * np.arange(1, int(largest / spacing))
    noise = rng.standard_normal((radii.size, n_angle))
    return polar_field(radii, WORK_OF_ADHESION * (1 + amplitude * noise))


def smooth_field(n_angle=24, spacing=0.02, largest=2.4, adhesion=1.0):
    radii = spacing * np.arange(1, int(largest / spacing))
    return polar_field(radii, np.full((radii.size, n_angle), adhesion * WORK_OF_ADHESION))


def branch(record, direction):
    return record.states.direction == direction


def patches(seed, sites, samples, interpolation):
    """A field at three times w_int, patches three sites and samples wide, and their spacing."""
    rng = np.random.default_rng(seed)
    n_angle, n_sample = int(rng.integers(*sites)), int(rng.integers(*samples))
    noise = gaussian_filter(rng.standard_normal((n_sample, n_angle)), 1, mode=("nearest", "wrap"))
    radii = np.linspace(rng.uniform(0.05, 0.1), 3.6, n_sample)
    adhesion = WORK_OF_ADHESION * (1 + 3 * noise / noise.std())
    return polar_field(radii, adhesion, interpolation), radii[1] - radii[0]


@functools.cache
def cycles_of_few_sites(interpolation):
    """Field and record of each of some cycles over patches that are as wide as a contact."""
    cycles = []
    for seed in range(40):
        field, _ = patches(seed, (4, 24), (16, 40), interpolation)
        recorder = Recorder(fronts=True, energy=True)
        cycles.append((field, run_cycle(field, LoadSchedule(0.6, 0.05), recorder=recorder)))
    return cycles
