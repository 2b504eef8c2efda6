"""Intervals of e_el are computed, not drawn by lot, and nothing jumps where a limit is passed."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.measured.options import PredictionOptions
from crackfront.measured.prediction.prediction import check_and_predict
from crackfront.measured.spectrum import draws, quadrature
from crackfront.measured.spectrum.draws import ORDERS, mean_squares
from crackfront.measured.spectrum.measured_surface import measured_surface
from studies.accuracy.energies import KINDS, synthetic_surface
from tests.commands import slow
from tests.measured.made import DETAIL, OVERVIEW, SCENE, shipped_surface

MOST = 0.03
"""How far the median and the ends of an interval may move, as a part of its width."""


def ends(surface):
    """Logarithms of the ends of the interval of e_el, and of its median."""
    energy = surface.half_derivative
    return np.log([energy.low, energy.value, energy.high])


def moved(first, second):
    """The furthest that an end or the median moves, as a part of the width."""
    return np.max(np.abs(first - second)) / (first[2] - first[0])


BY_NIGHT = (
    "deep scratches",
    "roll-off outside",
    "optic, Gaussian",
    "three line scans",
    "overview",
    "detail",
)
FILES = {"detail": [DETAIL], "overview": [OVERVIEW], "both": [DETAIL, OVERVIEW]}
MEASURED = {name: lambda files=files: shipped_surface(*files) for name, files in FILES.items()} | {
    kind.name: lambda kind=kind: synthetic_surface(kind, 0)
    for kind in KINDS
    if kind.name in BY_NIGHT
}


@pytest.fixture(
    scope="module", params=[slow(name) if name in BY_NIGHT else name for name in MEASURED]
)
def surface(request):
    return MEASURED[request.param]()


@pytest.fixture(scope="module")
def measurements(surface):
    return [scan.measurement for scan in surface.scans]


@pytest.fixture(scope="module")
def expected_moves(surface):
    """Ends of the interval of e_el as it is computed."""
    return ends(surface)


@pytest.fixture
def other_seeds(monkeypatch):
    """Every seed of a prediction is another one."""
    monkeypatch.setattr(draws, "SEED", 7)
    monkeypatch.setattr(quadrature, "SEED", 8)


@pytest.mark.usefixtures("other_seeds")
def test_intervals_do_not_depend_on_the_seeds_and_the_digits_of_heights(
    measurements, expected_moves
):
    steps = [1e-4 * measurement.heights.std() for measurement in measurements]
    rounded = [
        replace(measurement, heights=step * np.round(measurement.heights / step))
        for measurement, step in zip(measurements, steps, strict=True)
    ]
    assert 0 < moved(expected_moves, ends(measured_surface(rounded))) < MOST


def test_mean_squares_of_draws_are_those_of_tables(rng):
    grid = np.geomspace(1e4, 1e7, 40)
    table = np.log(1e-26) - 3.2 * np.log(grid / 1e4) + 0.3 * rng.standard_normal((5, 40))
    end = np.exp(rng.uniform(np.log(1e6), np.log(1e7), 5))
    [square] = mean_squares(grid, table, end)
    for number in range(5):
        inside = grid < end[number]
        last = np.interp(np.log(end[number]), np.log(grid), table[number])
        waves = 2 * np.pi / np.append(grid[inside], end[number])
        values = np.exp(np.append(table[number, inside], last))
        spectrum = TabulatedSpectrum(tuple(waves.tolist()), tuple(values.tolist()))
        expected = [spectrum.mean_square(order) for order in ORDERS]
        assert square[:, number] == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("files", [[OVERVIEW], [DETAIL, OVERVIEW]], ids=["unsure", "known"])
def test_what_is_a_little_stiffer_has_no_other_kind_of_answer(files):
    """From a sphere that conforms to one that does not, as by heights that grow by two per cent."""
    surface = shipped_surface(*files)
    earlier, outcomes = None, []
    for modulus in SCENE.contact_modulus * 1.04 ** np.arange(60):
        verdict, predicted = check_and_predict(
            surface, replace(SCENE, contact_modulus=modulus), PredictionOptions()
        )
        outcomes.append(verdict.outcome)
        if predicted is None:
            break
        estimates = [getattr(predicted, name) for name in ("e_el", "hysteresis", "w_retr")]
        numbers = np.array(
            [(estimate.low, estimate.value, estimate.high) for estimate in estimates]
        )
        if earlier is not None:
            assert numbers == pytest.approx(earlier, rel=0.08)
        earlier = numbers
        undecided = verdict.with_severity("undecided")
        assert bool(undecided) == (verdict.outcome == "cannot be decided")
    order = list(dict.fromkeys(outcomes))
    assert order == ["applies with reservations", "cannot be decided", "does not apply"]
