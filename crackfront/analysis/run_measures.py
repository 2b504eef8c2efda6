"""Measures of the tile of a simulation, and the cost of the simulation."""

from __future__ import annotations

from dataclasses import dataclass

from crackfront.core.variables import ADHESION, variable


@dataclass(frozen=True)
class RunMeasures:
    """Measures of the tile of a simulation, and the cost of the simulation."""

    e_el: float = variable("energy of full conformity measured on the tile", ADHESION)
    w_rms: float = variable("rms of the local work of adhesion measured on the tile", ADHESION)
    negative_share: float = variable("part of the tile where w_loc is negative", "1")
    seconds: float = variable("wall time of synthesis and cycle", "s")
    cpu_seconds: float = variable("processor time of synthesis and cycle", "s")
    peak_memory: float = variable(
        "high-water mark of the process when the simulation ended, earlier ones included", "byte"
    )
