"""What a result depends on in addition to its parameters; golden files keep the versions honest.

A result is stored with both. Raise a version when its golden file says that numbers moved
(tests/golden), add a line to its history, and name the change in the commit.
"""

from __future__ import annotations

PHYSICS_VERSION = 1
"""Version of the states of a front: another one makes simulations run again.

- 1: the first release.
"""

ROWS_VERSION = 2
"""Version of rows, fits and figures: another one remakes them from stored states.

- 2: a fit has the exponent by the law, the realisations that narrower intervals need, and powers of
  k in disorder and size; the probability of its midpoint is not a bound.
- 1: the first release.
"""
