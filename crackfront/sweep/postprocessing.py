"""Expected time and memory to collect, fit and draw a sweep, by a law of measured sweeps."""

from __future__ import annotations

from crackfront.simulate.costs import Cost
from crackfront.sweep.sweep import Sweep

_LAWS = {
    "aggregate": (1.0, 1.1e-5, 2.4e8, 7e2, 0),
    "fit": (1.2, 2e-6, 2.4e8, 2.5e2, 1),
    "figures": (5.5, 2e-6, 3.2e8, 2.5e2, 1),
    "summary": (1.2, 2e-6, 2.4e8, 2.5e2, 1),
}
"""Of each command: seconds without rows and per row, bytes of memory without rows and per row, and
1 if it draws the bootstrap, else 0. `python -m studies speed scaling` measures them."""

_DRAWN_SECONDS, _DRAWN_BYTES, _MOST_DRAWN = 8e-9, 24.0, 1.95e8
"""Bootstrap: seconds per row and sample, bytes per realisation and sample, most bytes at once."""


def postprocessing_costs(sweep: Sweep) -> dict[str, Cost]:
    """Expected cost of the commands that follow the simulations, by their names, in their order."""
    n_row, n_sample = sweep.n_simulation, sweep.fit.n_bootstrap
    drawn = min(_MOST_DRAWN, _DRAWN_BYTES * n_sample * sweep.n_realisation)
    needs = {}
    for name, (start, row, memory, row_bytes, draws) in _LAWS.items():
        seconds = start + n_row * (row + draws * n_sample * _DRAWN_SECONDS)
        needs[name] = Cost(seconds, memory + n_row * row_bytes + draws * drawn, disk=0.0)
    return needs
