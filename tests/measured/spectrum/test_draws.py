"""Intervals of e_el are computed, not drawn by lot, and nothing jumps where a limit is passed."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.measured.options import PredictionOptions
from crackfront.measured.prediction.prediction import check_and_predict
from crackfront.measured.spectrum import draws, quadrature
from crackfront.measured.spectrum.draws import ORDERS, Draws, mean_squares
from crackfront.measured.spectrum.joining import joint_spectrum
from crackfront.measured.spectrum.measured_surface import measured_surface
from studies.accuracy.energies import KINDS, found_scan
from tests.commands import slow
from tests.measured.made import DETAIL, OVERVIEW, SCENE, shipped_surface

MOST = 0.03
"""How far the median and the ends of an interval may move, as a part of its width."""


def ends(surface):
    """Logarithms of the ends of the interval of e_el, and of its median."""
    found = surface.half_derivative
    return np.log([found.low, found.value, found.high])


def moved(one, other):
    """The furthest that an end or the median moves, as a part of the width."""
    return np.max(np.abs(one - other)) / (one[2] - one[0])


BY_DAY = "roll-off outside", "deep scratches"
BY_NIGHT = "optic, Gaussian", "three line scans"
FILES = {"detail": [DETAIL], "overview": [OVERVIEW], "both": [DETAIL, OVERVIEW]}
MEASURED = {name: lambda files=files: shipped_surface(*files) for name, files in FILES.items()} | {
    kind.name: lambda kind=kind: found_scan(kind, 0).surface
    for kind in KINDS
    if kind.name in BY_DAY + BY_NIGHT
}


@pytest.fixture(
    scope="module", params=[slow(name) if name in BY_NIGHT else name for name in MEASURED]
)
def surface(request):
    return MEASURED[request.param]()


@pytest.fixture(scope="module")
def measurements(surface):
    return [one.measurement for one in surface.scans]


@pytest.fixture(scope="module")
def known(surface):
    """Ends of the interval of e_el as it is computed."""
    return ends(surface)


@pytest.fixture
def other_seeds(monkeypatch):
    """Every seed of a prediction is another one."""
    monkeypatch.setattr(draws, "SEED", 7)
    monkeypatch.setattr(quadrature, "SEED", 8)


@pytest.mark.usefixtures("other_seeds")
def test_intervals_do_not_depend_on_the_seeds_and_the_digits_of_heights(measurements, known):
    steps = [1e-4 * one.heights.std() for one in measurements]
    rounded = [
        replace(one, heights=step * np.round(one.heights / step))
        for one, step in zip(measurements, steps, strict=True)
    ]
    assert 0 < moved(known, ends(measured_surface(rounded))) < MOST


def test_four_times_as_many_draws_say_the_same(monkeypatch):
    known = shipped_surface(DETAIL)
    number = 4 * known.joint.draws.weight.size // draws.BATCH
    monkeypatch.setattr(draws, "BATCHES", (number,))
    more = measured_surface([one.measurement for one in known.scans])
    assert more.joint.draws.weight.size == number * draws.BATCH
    assert moved(ends(known), ends(more)) < MOST


def test_what_is_unsettled_is_what_moves():
    scans = shipped_surface(DETAIL).scans
    found = [joint_spectrum(scans, seed).draws for seed in range(4)]
    energies = [item.mean_square(0.5) for item in found]
    logarithms = np.log([(one.low, one.value, one.high) for one in energies])
    width = np.mean(logarithms[:, 2] - logarithms[:, 0])
    scatter = np.max(np.std(logarithms, axis=0, ddof=1)) / width
    assert scatter < 3 * max(item.unsettled for item in found)
    assert max(item.unsettled for item in found) < 2 * draws.SETTLED


def test_few_heavy_draws_beyond_an_end_make_it_unsettled(rng):
    # Draws of a normal distribution, weighted to one that is wider, so that its ends hang on few.
    found, number = [], 4000
    for _ in range(60):
        x = rng.normal(0, 1, number)
        weight = np.exp(x**2 / 2 - x**2 / (2 * 1.5**2))
        none = np.zeros((2, number))
        squares = np.exp([x, x, x])
        found.append(Draws(squares, squares, none, weight / weight.sum(), *np.zeros((3, 1))))
    upper = np.log([one.mean_square(0.5).high for one in found])
    stated = np.median([one.unsettled for one in found])
    assert np.std(upper) / (2 * 1.5 * 1.96) == pytest.approx(stated, rel=0.6)
    # An effective number of draws does not show it.
    usual = np.sqrt(0.025 * 0.975 / np.median([one.effective for one in found]))
    density = np.exp(-(1.96**2) / 2) / np.sqrt(2 * np.pi) / 1.5
    assert usual / density / (2 * 1.5 * 1.96) < 0.6 * stated


def test_mean_squares_of_draws_are_those_of_tables(rng):
    grid = np.geomspace(1e4, 1e7, 40)
    table = np.log(1e-26) - 3.2 * np.log(grid / 1e4) + 0.3 * rng.standard_normal((5, 40))
    end = np.exp(rng.uniform(np.log(1e6), np.log(1e7), 5))
    [found] = mean_squares(grid, table, end)
    for number in range(5):
        inside = grid < end[number]
        last = np.interp(np.log(end[number]), np.log(grid), table[number])
        waves = 2 * np.pi / np.append(grid[inside], end[number])
        values = np.exp(np.append(table[number, inside], last))
        spectrum = TabulatedSpectrum(tuple(waves.tolist()), tuple(values.tolist()))
        expected = [spectrum.mean_square(order) for order in ORDERS]
        assert found[:, number] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("files", [[OVERVIEW], [DETAIL, OVERVIEW]], ids=["unsure", "known"])
def test_what_is_a_little_stiffer_has_no_other_kind_of_answer(files):
    """From a sphere that conforms to one that does not, as by heights that grow by two per cent."""
    surface = shipped_surface(*files)
    known, outcomes = None, []
    for modulus in SCENE.contact_modulus * 1.04 ** np.arange(60):
        verdict, found = check_and_predict(
            surface, replace(SCENE, contact_modulus=modulus), PredictionOptions()
        )
        outcomes.append(verdict.outcome)
        if found is None:
            break
        estimates = [getattr(found, name) for name in ("e_el", "hysteresis", "w_retr")]
        numbers = np.array([(one.low, one.value, one.high) for one in estimates])
        if known is not None:
            assert numbers == pytest.approx(known, rel=0.08)
        known = numbers
        undecided = verdict.with_severity("undecided")
        assert bool(undecided) == (verdict.outcome == "cannot be decided")
    order = list(dict.fromkeys(outcomes))
    assert order == ["applies with reservations", "cannot be decided", "does not apply"]


@pytest.mark.usefixtures("few_draws")
@pytest.mark.parametrize("number", [slow(3), 12])
def test_a_gaussian_spot_that_looks_blunt_is_no_fall_of_the_surface(number):
    [kind] = [kind for kind in KINDS if kind.name == "optic, Gaussian"]
    found = found_scan(kind, number)
    [scan] = found.surface.scans
    assert scan.band.shortest.cause == "resolution"
    # The density of the spot, of a standard deviation of one pixel, is down to 1/e there.
    assert scan.band.instrument.attenuation == pytest.approx(
        1 / scan.measurement.pixels[0], rel=0.2
    )
    assert found.covers
