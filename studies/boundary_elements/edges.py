r"""Forces of the crack front's model on the edges of contacts by boundary elements.

If both models agreed, these would be in equilibrium,

.. math:: w_{loc} - G_{JKR} = w_{int} (-\Delta_\\theta)^{1/2} a / a .
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, rfft

from crackfront.core import jkr
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.sphere import half_laplacian
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, VERTICAL, variable
from studies.accuracy.study import rms
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.front import FrontCycle

CLASSES = 12
"""Classes of sites, as many in each, by the first-order force of the line."""


@dataclass(frozen=True, slots=True)
class EdgeForces:
    """Forces on the edges of one surface, of which waves below the short cutoff are left out."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    slope: float = variable("rms slope of the edges", "1")
    pinning: float = variable("rms deviation of w_loc from its mean along an edge", ADHESION)
    left: float = variable("rms force that is not balanced", ADHESION)
    share: float = variable("force of the line: needed over first order", "1")
    line: Array = variable("force of the line to first order, by class", ADHESION, "class")
    needed: Array = variable("mean force that balances the others there", ADHESION, "class")


def edge_forces(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> EdgeForces:
    """Forces on the edges of the steady states; the share is fitted by least squares."""
    steady = case.loads.are_steady(boundary.penetration)
    angle = np.linspace(0.0, 2 * np.pi, boundary.radius.shape[1], endpoint=False)
    sites, parts = front.field.geometry.sites, []
    for radius, load in zip(boundary.radius[steady], boundary.penetration[steady], strict=True):
        modes = rfft(np.interp(sites, angle, radius, period=2 * np.pi))
        modes[1 + int(2 * np.pi * np.mean(radius) / case.short_cutoff) :] = 0.0
        edge = irfft(modes, sites.size)
        turn = irfft(1j * np.arange(modes.size) * modes, sites.size)
        adhesion = front_adhesion(edge, front.field) / WORK_OF_ADHESION
        release = jkr.energy_release_rate(edge, load) / WORK_OF_ADHESION
        pinning = adhesion - np.mean(adhesion)
        parts.append([turn / edge, pinning, half_laplacian(edge) / edge, adhesion - release])
    slope, pinning, line, needed = np.concatenate(parts, axis=1)
    classes = np.array_split(np.argsort(line), CLASSES)
    return EdgeForces(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=rough_adhesion(case.heights(), case.pixel).e_el,
        slope=rms(slope),
        pinning=rms(pinning),
        left=rms(needed - line),
        share=float(np.sum(line * needed) / np.sum(line**2)),
        line=np.array([np.mean(line[places]) for places in classes]),
        needed=np.array([np.mean(needed[places]) for places in classes]),
    )
