"""Works of adhesion that change along the window, as with the speed of the edge."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import stdtrit

from crackfront.analysis.steady_adhesion import Branches
from crackfront.core.arrays import Array
from crackfront.measured.loops.calibration import CalibratedLoop
from crackfront.measured.loops.loop_fit import best_modulus
from crackfront.surfaces.written_units import prefixed

_BLOCKS = 10
"""Blocks of a branch whose means show a trend, and which are left out in turn."""

_FEWEST_BLOCKS = 5
"""Blocks that determine a trend and its error."""

_CERTAINTY = 0.9995
"""Certainty of a change, of either sign; few healthy loops have one by chance."""

_LEAST_TREND = 0.05
"""Change of a work along the window, over its mean, that is worth a remark."""

_LEAST_CHANGE = 0.01
"""Change of the fitted modulus by the retraction, over the modulus, that matters."""


def retraction_changes_modulus(loop: CalibratedLoop, averaged: Branches) -> bool:
    """Whether both branches fit another modulus than the approach alone, beyond its noise.

    A work of adhesion that changes along the retraction looks like another modulus there.
    """
    approach, retraction = averaged
    n_block = min(_BLOCKS, approach.size // 2)
    if not loop.has_force_and_radius or retraction.size == 0 or n_block < _FEWEST_BLOCKS:
        return False
    none = retraction[:0]

    def modulus(rows: Branches) -> float:
        return best_modulus(loop.recording, loop.rig, rows)

    blocks = np.array_split(approach, n_block)
    left_out = [
        modulus((np.concatenate(blocks[:place] + blocks[place + 1 :]), none))
        for place in range(n_block)
    ]
    alone = modulus((approach, none))
    change = abs(modulus(averaged) - alone)
    # The modulus by both branches has less noise than this.
    noise = math.sqrt((n_block - 1) * float(np.var(left_out)))
    likely = float(stdtrit(n_block - 1, _CERTAINTY)) * noise
    return bool(change > max(likely, _LEAST_CHANGE * abs(alone)))


def trends(loop: CalibratedLoop, averaged: Branches) -> dict[str, str]:
    """A sentence on each work of adhesion that rises or falls along its rows, by its name."""
    work = loop.contact().work_of_adhesion
    sentences = {}
    for name, rows in zip(("w_appr", "w_retr"), averaged, strict=True):
        ends = _ends_of_trend(work[rows])
        if ends is not None:
            verb = "rises" if ends[1] > ends[0] else "falls"
            first, last = (prefixed("J/m2", end) for end in ends)
            sentences[name] = f"{name} {verb} from {first} to {last} along the window"
    return sentences


def _ends_of_trend(work: Array) -> tuple[float, float] | None:
    """First and last value of the line through works in time; None if they have no clear trend."""
    n_block = min(_BLOCKS, work.size // 2)
    if n_block < _FEWEST_BLOCKS:
        return None
    means = [float(np.mean(block)) for block in np.array_split(work, n_block)]
    time = (np.arange(n_block) + 0.5) / n_block
    (slope, start), covariance = np.polyfit(time, means, 1, cov=True)
    error = float(stdtrit(n_block - 2, _CERTAINTY)) * math.sqrt(covariance[0, 0])
    if abs(slope) <= max(error, _LEAST_TREND * abs(float(np.mean(means)))):
        return None
    return float(start), float(start + slope)
