"""The memory of a process is measured from a moment on."""

import gc
from pathlib import Path

import numpy as np
import pytest

from studies.speed.machine import peak_memory, restart_peak


@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="the mark is Linux's")
def test_the_peak_of_memory_starts_anew_and_sees_an_array_that_is_gone():
    gc.collect()  # what earlier tests left would be given back meanwhile
    before = restart_peak()
    np.ones(5_000_000)
    assert 35 < peak_memory() - before < 60
    assert restart_peak() - before < 10
