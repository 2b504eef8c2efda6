"""What the rows of a sweep and the files of its shards come from, in digits; nothing is read.

Workflows import this to plan jobs, without the libraries that read and write the files.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence

from crackfront.core.fingerprint import fingerprint
from crackfront.simulate.simulation import Simulation, stems


@functools.cache
def row_fingerprint() -> str:
    """Twelve hexadecimal digits that change with any module that makes a row of a result."""
    return fingerprint("crackfront.sweep.rows")


def shard_fingerprint(one_per_amplitude: Sequence[Simulation], realisations: range) -> str:
    """Twelve hexadecimal digits that change with the simulations of a shard, and how rows are made.

    They follow from the first realisation of each amplitude
    (:meth:`crackfront.sweep.sweep.Sweep.one_per_amplitude`), at the same cost for any number of
    realisations.
    """
    text = "\n".join([*stems(one_per_amplitude), repr(realisations), row_fingerprint()])
    return hashlib.sha256(text.encode()).hexdigest()[:12]
