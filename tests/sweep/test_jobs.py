"""Jobs of a sweep on the cores of a machine."""

import pytest

from crackfront.sweep.jobs import cores_of_job


@pytest.mark.parametrize(
    ("seconds", "n_core", "expected"),
    [
        ([30.0], 1, 1),
        ([30.0], 2, 2),
        ([3.0], 2, 1),
        ([40.0] * 4, 2, 1),
        ([40.0] * 5, 4, 4),
        ([1.0, 2.0, 300.0], 2, 2),
        ([1000.0] * 3, 2, 2),
        ([80.0] * 1000, 16, 1),
    ],
)
def test_jobs_stand_side_by_side_where_that_ends_earlier(seconds, n_core, expected):
    assert cores_of_job(seconds, n_core) == expected
