"""Loops of a rig as it would record them, of known works of adhesion."""

import numpy as np

from crackfront.core import jkr
from crackfront.core.units import Scales
from crackfront.measured.loops.recording import Recording

RADIUS, MODULUS = 1.25e-3, 0.7e6 / 0.75
W_APPR, W_RETR = 0.03, 0.06
TRUTH = {"w_appr": W_APPR, "w_retr": W_RETR, "hysteresis": W_RETR - W_APPR}


def loop(
    seed,
    *,
    n_row=120,
    force_noise=0.002,
    radius_noise=0.003,
    drift=0.0,
    stiffness=1e3,
    retraction=1.0,
    preload=1.5,
    n_away=30,
    wave=0.0,
    without=None,
):
    """A loop with a pinned edge at its turn, irregular steps and rows out of contact.

    The largest radius is `preload` times that of the retraction without a force. Noise, drift and
    a wave in time are relative to the largest force, that of the radius to itself. The retraction
    ends at a part of its way.
    """
    random, scales = np.random.default_rng(seed), Scales(RADIUS, 1.0, MODULUS)
    turn = preload * (6 * W_RETR) ** (1 / 3)
    first, last = (1.6 * jkr.pull_off_radius(work) for work in (W_APPR, W_RETR))
    last = turn - retraction * (turn - last)
    approach = np.sort(random.uniform(first, turn, n_row))
    back = np.sort(random.uniform(last, turn, n_row))[::-1]
    radius = np.concatenate([approach, np.full(20, turn), back])
    pinned = np.linspace(W_APPR, W_RETR, 20)
    work = np.concatenate([np.full(n_row, W_APPR), pinned, np.full(n_row, W_RETR)])
    force = jkr.equilibrium_force(radius, work)
    penetration = jkr.equilibrium_penetration(radius, work)
    away = np.zeros(n_away)
    start = np.linspace(penetration[0] - 1, penetration[0], n_away)
    end = np.linspace(penetration[-1], penetration[-1] - 1, n_away)
    if retraction < 1:
        end = away = np.zeros(0)
    radius = np.concatenate([np.zeros(n_away), radius, away])
    force = np.concatenate([np.zeros(n_away), force, away])
    penetration = np.concatenate([start, penetration, end])
    largest, time = np.max(np.abs(force)), np.linspace(-0.3, 0.7, force.size)
    noise = force_noise * random.normal(size=force.size) + drift * time
    noise += wave * np.sin(np.arange(force.size) / 7)
    columns = {
        "force": (force + largest * noise) * scales.force,
        "radius": radius * (1 + radius_noise * random.normal(size=radius.size)) * scales.lateral,
        "displacement": penetration * scales.vertical + force * scales.force / stiffness + 1e-6,
    }
    if without is not None:
        columns[without] = None
    return Recording(**columns)


def in_contact(**options):
    """Columns of a loop that begins and ends in contact, at radii of no jump."""
    whole, scales = loop(0, **options), Scales(RADIUS, 1.0, MODULUS)
    touching = np.flatnonzero(whole.radius > scales.lateral * jkr.equilibrium_radius(0.0, W_APPR))
    rows = slice(touching[0], touching[-1] + 1)
    return {name: getattr(whole, name)[rows] for name in ("force", "radius", "displacement")}
