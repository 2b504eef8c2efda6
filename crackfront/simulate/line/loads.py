"""How a sweep holds and pulls its straight fronts, and the loads that this gives a spectrum."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from scipy.fft import next_fast_len

from crackfront.core.adhesion import (
    FieldKind,
    correlation_length,
    force_correlation_length,
    larkin_length,
)
from crackfront.core.spectrum import Spectrum
from crackfront.data.bounds import refuse_beyond_memory
from crackfront.simulate.front_sizes import LAW_SIZE
from crackfront.simulate.line.schedule import LineSchedule
from crackfront.simulate.numerics import Numerics

SpringUnit = Literal["correlation_length", "larkin_length"]

LAW_LENGTH = 10.0
"""Length of a front over that of its springs on which the law of k was measured.

On a shorter front k is larger: the front is pinned as a whole.
"""

_DEPTH, _ROUGHNESS = 1.43, 0.4
"""Rms of a front over the force's correlation length, 1.43 (L_kappa / Larkin length)^0.4: measured
over all spectra, amplitudes and springs of `config/line.yaml`, within a fifth."""

_LEAD_IN = 3.0
"""Correlation lengths after which a front has forgotten its start, beside multiples of its rms."""


@dataclass(frozen=True, slots=True)
class LineLoad:
    """How the straight fronts of a sweep are held and pulled."""

    spring_unit: SpringUnit
    """Unit in which the spectra state the length of their springs."""
    length: float
    """Period of the front over the length of its springs."""
    period: float
    """Period of the tile along the motion over the expected rms of the front."""
    transient: float
    """Travel before a branch is averaged, over the same rms."""
    step: float
    """Largest load step, in correlation lengths."""
    uncorrelated: bool = False
    """Whether sites are independent of each other, the limit of weak disorder."""

    max_penetration: ClassVar[float] = 0.0

    def usual_size(self, spectrum: Spectrum) -> float:
        """Size of a front for which settings are chosen, whatever its spectrum."""
        return LAW_SIZE

    def for_surface(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        spring: float,
        numerics: Numerics,
    ) -> LineSchedule:
        """Loads of one spectrum and amplitude on springs of so many units; whole pixels.

        Along both axes the tile has the roll-offs and short cutoffs of the numerics or more.
        """
        larkin = larkin_length(kind, spectrum, 2 * math.sqrt(elastic_energy))
        length = correlation_length(kind, spectrum)
        spring *= length if self.spring_unit == "correlation_length" else larkin
        settings = numerics.settings_of(kind, spectrum, elastic_energy, self.usual_size(spectrum))
        pixel = spectrum.short_cutoff / settings.pixels_per_cutoff
        least = numerics.tile_side(spectrum)
        rms = front_rms(force_correlation_length(kind, spectrum), spring / larkin)
        return LineSchedule(
            spring=spring,
            length=pixel * _points(max(self.length * spring, least) / pixel),
            period=pixel * _points(max(self.period * rms, least) / pixel),
            lead_in=_LEAD_IN * length + self.transient * rms,
            step=self.step * length,
            uncorrelated=self.uncorrelated,
        )


def front_rms(force_correlation_length: float, size: float) -> float:
    """Rms deviation of a front from its mean on springs of a size g (Units: length)."""
    return _DEPTH * force_correlation_length * max(size, 0.1) ** _ROUGHNESS


def _points(least: float) -> int:
    """Points of a side, an even product of small primes; refused where no machine holds them."""
    remedy = "lower length, period, springs or pixels_per_cutoff"
    refuse_beyond_memory(f"sides of {least:.2g} points", 32.0 * least, remedy, anywhere=True)
    return 2 * int(next_fast_len(math.ceil(least / 2 * (1 - 1e-12)), real=True))
