"""One sweep that ran undisturbed, and what is made of it, for tests of what may happen to them."""

import itertools
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep import tasks
from crackfront.sweep.store import Store
from tests.commands import run
from tests.places import TEST


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """A store with the curves, the rows and the table of the configuration `test`."""
    store = Store(tmp_path_factory.mktemp("made") / "sweep")
    for name in ("simulate", "aggregate"):
        assert run(name, TEST, "--output", store.folder).exit_code == 0
    return store


@pytest.fixture(autouse=True)
def _empty_pictures(empty_pictures):
    """How the figures of a sweep look is tested elsewhere."""


@pytest.fixture
def empty_figures(monkeypatch):
    """Figures have no axes: what a fit draws is tested in the folders `cli` and `plots`."""
    for drawn in ("sweep_figures.hysteresis", "sweep_figures.factor", "loop_figures.simulation"):
        monkeypatch.setattr(f"crackfront.plots.{drawn}_figure", lambda _: Figure())


@pytest.fixture(scope="session")
def _results():
    """Results of simulations that tests have run, and numbers that tell their runs apart."""
    return {}, itertools.count(1)


@pytest.fixture
def remembered(monkeypatch, _results):
    """A simulation is computed once for all tests; what runs it again has the same states at once.

    Its wall time differs, as that of any run does.
    """
    results, counts = _results

    def run(simulation, **how):
        if "resume" in how:
            return run_simulation(simulation, **how)
        if simulation not in results:
            results[simulation] = run_simulation(simulation)
        result = results[simulation]
        seconds = result.measures.seconds + 1e-6 * next(counts)
        return replace(result, measures=replace(result.measures, seconds=seconds))

    monkeypatch.setattr(tasks, "run_simulation", run)
    return run
