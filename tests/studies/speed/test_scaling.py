"""How a sweep scales: measured where it can be, played through where not."""

import numpy as np
import pytest

from studies.speed import scaling

LOSSES = scaling.Losses(hand_out=1e-3, start=10.0)


@pytest.mark.parametrize(
    ("tasks", "n_worker", "expected"),
    [([2.0] * 12, 4, 6.0), ([1.0, 1.0, 1.0, 3.0], 2, 3.0)],
)
def test_a_job_has_no_gaps(tasks, n_worker, expected):
    seconds = scaling.job_seconds(tasks, n_worker, LOSSES) - LOSSES.start
    assert seconds == pytest.approx(expected, abs=13 * LOSSES.hand_out)


def test_more_ranks_are_never_slower_and_never_more_efficient_than_a_full_job(rng):
    shards = [rng.lognormal(0, 1, 60) for _ in range(100)]
    rows = scaling.played(shards, LOSSES, 32, (32, 64, 128, 1024))
    hours = [row.hours for row in rows]
    assert np.all(np.diff(hours) <= 0)
    assert all(0 < row.efficiency <= 1 for row in rows)


@pytest.mark.mpi
@pytest.mark.slow
def test_a_rank_hands_out_tasks_and_stores_their_curves():
    assert 0 < scaling.hand_out_seconds(2, 50) < np.inf


@pytest.mark.slow
@pytest.mark.parametrize("n_simulation", [2_000, 100_000])
def test_what_follows_the_simulations_has_the_memory_that_is_asked_for(tmp_path, n_simulation):
    path = scaling.synthetic(tmp_path, n_simulation)
    for name in scaling.LATE_COMMANDS:
        _, peak = scaling.in_fresh_process(scaling.late, path, name)
        assert peak < 2e9, name  # what the rules ask for
