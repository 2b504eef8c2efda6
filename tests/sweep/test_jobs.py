"""Jobs of a sweep on the cores of a machine."""

import pytest

from crackfront.sweep.jobs import cores_of_job


@pytest.mark.parametrize(
    ("seconds", "n_simulation", "n_core", "expected"),
    [
        ([30.0], 8, 1, 1),
        ([30.0], 8, 2, 2),
        ([3.0], 8, 2, 1),
        ([40.0] * 4, 8, 2, 1),
        ([40.0] * 5, 8, 4, 4),
        ([1.0, 2.0, 300.0], 8, 2, 2),
        ([1000.0] * 3, 8, 2, 2),
        ([80.0] * 1000, 8, 16, 1),
        ([200.0] * 8, 200, 16, 16),
        ([200.0] * 8, 2, 16, 1),
    ],
)
def test_jobs_stand_side_by_side_where_that_ends_earlier(seconds, n_simulation, n_core, expected):
    longest = [one / n_simulation for one in seconds]
    assert cores_of_job(seconds, longest, n_core, n_held=n_core) == expected
    assert cores_of_job(seconds, longest, n_core, n_held=0.9 * n_core) == n_core
