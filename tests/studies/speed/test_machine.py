"""The memory of a process is measured from a moment on."""

from pathlib import Path

import numpy as np
import pytest

from crackfront.core.resources import peak_memory
from studies.speed.machine import in_fresh_process, restart_peak


def memory_of_an_array_that_is_gone():
    """What an array of 40 MB adds to the peak, and what a new start leaves of it, in bytes."""
    before = restart_peak()
    np.ones(5_000_000)
    return peak_memory() - before, restart_peak() - before


@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="the mark is Linux's")
def test_the_peak_of_memory_starts_anew_and_sees_an_array_that_is_gone():
    # In a process of its own: what earlier tests left here is given back meanwhile.
    grown, left = in_fresh_process(memory_of_an_array_that_is_gone)
    assert 35e6 < grown < 60e6
    assert left < 10e6
