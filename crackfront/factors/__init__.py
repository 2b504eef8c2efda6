r"""The factors k of a surface that was not simulated, from those of surfaces that were.

`python -m benchmarks.factors` makes `factors.csv` from the results of sweeps: of every spectrum and
amplitude the factors of the two branches,

.. math:: k_{appr} = (w_{int} - e_{el} - w_{appr}) / e_{el}, \quad
          k_{retr} = (w_{retr} - w_{int} + e_{el}) / e_{el},

and k, their mean. A spectrum is a place in the plane of two lengths relative to the radius of the
contact: the correlation length of w_loc and the roll-off. Within a spectrum k is interpolated in
the logarithm of e_el, between spectra with inverse distances.
"""

from crackfront.factors.expected import (
    BRANCHES,
    Factor,
    Factors,
    expected_factors,
    leave_one_out_error,
)
from crackfront.factors.measured import MeasuredFactors, measured_factors

__all__ = [
    "BRANCHES",
    "Factor",
    "Factors",
    "MeasuredFactors",
    "expected_factors",
    "leave_one_out_error",
    "measured_factors",
]
