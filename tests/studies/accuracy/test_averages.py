"""Steady runs: schedules and tiles, and whether runs state their true errors."""

import numpy as np
import pytest

from studies.accuracy.averages import held_out_coverage, sampling_errors
from studies.accuracy.scenes import SCENES


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_the_stated_errors_cover_nine_in_ten_over_shapes_and_amplitudes():
    names = [
        f"{shape}-{energy}"
        for shape in ("chemical", "flat", "h08", "h03")
        for energy in (0.01, 0.16)
    ]
    items = [item for name in names for item in held_out_coverage(SCENES[name], (0.1, 0.03), 8)]
    # Intervals cover nine errors in ten; standard errors are not three times the median error.
    for name, standard_error_of in (
        ("total", lambda item: np.hypot(item.run_numerical, item.run_statistical)),
        ("numerical", lambda item: item.numerical_stated + 0 * item.numerical),
    ):
        error, interval, stated = (
            np.concatenate([np.ravel(part(item)) for item in items])
            for part in (
                lambda item, name=name: abs(getattr(item, name)),
                lambda item, name=name: getattr(item, f"{name}_interval"),
                standard_error_of,
            )
        )
        is_finite = np.isfinite(error) & np.isfinite(interval)
        assert np.mean(error[is_finite] <= interval[is_finite]) >= 0.9, name
        assert np.median(stated[is_finite] / error[is_finite]) <= 3, name


@pytest.mark.slow
def test_schedules_change_the_mean_within_its_error():
    samples = sampling_errors(SCENES["flat-0.04"], range(3))
    schedules = [item for item in samples if item.setting != "tile"]
    complete = [item for item in schedules if np.all(np.isfinite(item.hysteresis))]
    assert len(complete) >= len(schedules) - 1
    for item in complete:
        difference = np.mean(item.hysteresis - samples[0].hysteresis)
        assert abs(difference) < 2 * np.mean(item.standard_error)
    seconds = [item.seconds.mean() for item in complete if item.setting == "step"]
    assert seconds[0] > 2 * seconds[-1]
