"""How a sweep scales: measured where it can be, played through where not."""

import subprocess
import sys

import numpy as np
import pytest

from studies.speed import scaling


@pytest.mark.parametrize(
    ("tasks", "n_worker", "expected"),
    [([2.0] * 12, 4, 6.0), ([1.0, 1.0, 1.0, 3.0], 2, 3.0)],
    ids=["whole rounds", "the longest first"],
)
def test_a_job_has_no_gaps(tasks, n_worker, expected):
    seconds = scaling.job_seconds(tasks, n_worker) - scaling.START_SECONDS
    assert seconds == pytest.approx(expected, abs=13 * scaling.HAND_OUT_SECONDS)


def test_a_manager_hands_out_no_faster_than_it_can():
    short = scaling.HAND_OUT_SECONDS / 10
    seconds = scaling.job_seconds([short] * 1000, 500) - scaling.START_SECONDS
    assert seconds == pytest.approx(1000 * scaling.HAND_OUT_SECONDS, rel=0.01)


def test_more_ranks_are_never_slower_and_never_more_efficient_than_a_full_job(rng):
    shards = [rng.lognormal(0, 1, 60) for _ in range(100)]
    rows = scaling.played(shards, (32, 64, 128, 1024))
    hours = [row.hours for row in rows]
    assert np.all(np.diff(hours) <= 0)
    assert all(0 < row.efficiency <= 31 / 32 for row in rows)


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("n_worker", "n_round"), [(2, 6), pytest.param(32, 10, marks=pytest.mark.slow)]
)
def test_dispatch_is_efficient(n_worker, n_round):
    assert scaling.dispatch_efficiency(n_worker, n_round) >= 0.95


@pytest.mark.parametrize("n_simulation", [8_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_rows_are_aggregated_in_bounded_time_and_memory(n_simulation):
    code = f"from studies.speed.scaling import aggregation; print(*aggregation({n_simulation}))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=280, check=True
    )
    seconds, peak = map(float, done.stdout.split())
    assert seconds < 10 + 5e-4 * n_simulation
    assert peak < 2.9e8 + 1.1e3 * n_simulation
