"""A loop with the numbers that make each of its rows a JKR contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.measured.loops.contact_relations import penetration_at, radius_at
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig


@dataclass(frozen=True, slots=True)
class Contact:
    """The contact in each row, in SI units; NaN out of contact."""

    force: Array
    """Normal force. Shape (n_row,). (Units: N)"""
    radius: Array
    """Contact radius. Shape (n_row,). (Units: m)"""
    penetration: Array
    """Penetration of the sphere. Shape (n_row,). (Units: m)"""
    work_of_adhesion: Array
    """Apparent work of adhesion. Shape (n_row,). (Units: J/m^2)"""


@dataclass(frozen=True, slots=True)
class CalibratedLoop:
    """Recording, rig, modulus and zero of the displacement, from which every row is a contact."""

    recording: Recording
    """Columns of the loop, whose force is zero out of contact."""
    rig: Rig
    modulus: float
    """Contact modulus, of the rig or fitted. (Units: Pa)"""
    zero: float = 0.0
    """Displacement without penetration; 0 where force and radius are recorded. (Units: m)"""
    by_approach: bool = False
    """Whether a modulus is fitted to the approach alone, as the retraction contradicts it."""

    @property
    def scales(self) -> Scales:
        """Reduced units of the sphere, for works of adhesion in units of 1 J/m^2."""
        return Scales(self.rig.radius, 1.0, self.modulus)

    @property
    def compliance(self) -> float:
        """Reduced displacement that a reduced force of 1 takes to bend the machine."""
        if self.rig.stiffness is None:
            return 0.0
        scales = self.scales
        return scales.force / (self.rig.stiffness * scales.vertical)

    @property
    def has_force_and_radius(self) -> bool:
        """Whether both are recorded, so that neither the displacement nor its zero is needed."""
        return self.recording.force is not None and self.recording.radius is not None

    def contact(self) -> Contact:
        """Force, radius, penetration and apparent work of adhesion of each row."""
        scales, recording = self.scales, self.recording
        force = None if recording.force is None else recording.force / scales.force
        radius = None if recording.radius is None else _touching(recording.radius) / scales.lateral
        if force is not None and radius is not None:
            penetration = penetration_at(radius, force)
        else:
            # A recording without force or radius has a displacement.
            moved = (np.asarray(recording.displacement) - self.zero) / scales.vertical
            if radius is not None:
                # A penetration b needs the force a^3 + 3/2 a (b - a^2), which bends the machine.
                force = jkr.force(radius, moved) / (1 + 1.5 * self.compliance * radius)
                penetration = moved - self.compliance * force
            else:
                force = np.asarray(force)
                penetration = moved - self.compliance * force
                radius = radius_at(force, penetration)
        with np.errstate(divide="ignore", invalid="ignore"):
            work = jkr.apparent_work_of_adhesion(radius, penetration)
        return Contact(
            force=force * scales.force,
            radius=radius * scales.lateral,
            penetration=penetration * scales.vertical,
            work_of_adhesion=work,
        )


def _touching(radius: Array) -> Array:
    """Contact radii, NaN out of contact."""
    return np.where(radius > 0, radius, np.nan)
