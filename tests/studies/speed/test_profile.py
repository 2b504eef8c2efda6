"""Shares of the solver from what perf prints."""

import pytest

from studies.speed.profile import Share, _kernel, _solver_shares, page

HARDEN = "_ZN10crackfront4core6solver6forces6hardenB4v112B92c8tJ"
REPORT = f"""# Samples: 3K
    30.00%  [JIT] tid 1  [.] {HARDEN}
    20.00%  rocket_fft.so  [.] rf_execute
    10.00%  [kernel]  [k] schedule
"""


def test_kernels_have_the_name_of_their_function():
    assert _kernel(f"[JIT] tid 1 [.] {HARDEN}") == "forces.harden"
    assert _kernel("libm.so [.] cos") == "libm.so [.] cos"


def test_shares_are_of_parts_and_add_up():
    found = _solver_shares(REPORT)
    assert found["bounds on the way ahead"] == pytest.approx(0.5)
    assert found["steps of the whole front, transforms"] == pytest.approx(1 / 3)
    assert sum(found.values()) == pytest.approx(1)


def test_a_part_that_costs_nothing_brings_what_its_share_says():
    assert "| half | 1.000 | 50% | 2.00 |" in page([Share("half", 1.0, 0.5)])
