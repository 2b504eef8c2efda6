"""The first metastable front in the direction of motion."""

DEFAULT_TOLERANCE = 1e-8
"""Default of the force that may be left along the motion, relative to w_int per front length."""

DEFAULT_MAX_SWEEPS = 10_000_000
"""Default of the limit on the sweeps of one load step."""
