"""What every test shares: floating-point errors raise, random numbers are seeded."""

import gc
import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import hypothesis
import numpy as np
import pytest

from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.solver.relax import Newton
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.style import STYLE
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.sphere.full_cycle import FullCycle

SEED = 20240229
AS_PRINTED = STYLE.copy()


def pytest_configure(config: pytest.Config) -> None:
    """More generated examples where the slow tests run too, by night."""
    by_day = "not slow" in config.option.markexpr
    hypothesis.settings.register_profile(
        "ours",
        deadline=None,
        max_examples=10 if by_day else 100,
        derandomize=bool(os.environ.get("CI")),
    )
    hypothesis.settings.load_profile("ours")
    gc.disable()


def pytest_collection_finish() -> None:
    """Modules and tests are not searched for garbage again and again: a tenth of the time."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The workflow first: one worker makes the sweep its tests share, and no long test is last."""
    items.sort(key=lambda item: not item.nodeid.startswith("tests/workflow/"))


@pytest.fixture(autouse=True, scope="session")
def _kernels_shared_out(request: pytest.FixtureRequest) -> None:
    """Of workers side by side, two begin with kernels of either kind: neither compiles both.

    Where no test of the core runs, hardly any needs them.
    """
    if not any(item.nodeid.startswith("tests/core/") for item in request.session.items):
        return
    match os.environ.get("PYTEST_XDIST_WORKER"):
        case "gw0":
            compile_solver(Newton.name, FullCycle)
        case "gw1":
            rings = polar_field(np.linspace(0.1, 3.0, 30), np.full(30, WORK_OF_ADHESION))
            run_cycle(rings, LoadSchedule(0.0, 0.5), Newton(1e-3), Recorder())


@pytest.fixture(autouse=True)
def _floating_point_errors_raise() -> Iterator[None]:
    before = np.seterr(all="raise", under="ignore")
    yield
    np.seterr(**before)


@pytest.fixture(autouse=True, scope="session")
def _plain_figures() -> Iterator[None]:
    """No search for the layout of figures, no fonts; fixtures that tests share draw so too."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setitem(STYLE, "figure.constrained_layout.use", False)
        monkeypatch.setitem(STYLE, "pdf.fonttype", 3)
        yield


@pytest.fixture(autouse=True)
def _figures_as_printed(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the look of figures is in question, they have their layout and fonts."""
    if request.node.get_closest_marker("look"):
        for name, value in AS_PRINTED.items():
            monkeypatch.setitem(STYLE, name, value)


@pytest.fixture
def empty_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are made but not drawn: their files are empty."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda _, path, **_look: path.touch())


@pytest.fixture
def _heeded_signals() -> Iterator[None]:
    """Signals reach the commands also where the tests run in the background, which ignores some."""
    ignored = [
        number
        for number in (signal.SIGINT, signal.SIGHUP)
        if signal.getsignal(number) is signal.SIG_IGN
    ]
    for number in ignored:
        signal.signal(number, signal.default_int_handler)
    yield
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)


def _mapped(path: Path) -> bool:
    """Whether a process of ours has a file in its memory."""
    for maps in Path("/proc").glob("[0-9]*/maps"):
        with suppress(OSError):
            if str(path) in maps.read_text():
                return True
    return False


def _shared_memory() -> set[Path]:
    """Our files in MPICH's shared memory."""
    ours = set()
    for path in Path("/dev/shm").glob("mpich_shm_*"):
        with suppress(FileNotFoundError):  # of a rank that has just ended
            if path.stat().st_uid == os.getuid():
                ours.add(path)
    return ours


@pytest.fixture(autouse=True, scope="session")
def _shared_memory_of_killed_ranks() -> Iterator[None]:
    """Remove what MPICH leaves in memory when ranks are killed; nobody else does."""
    before = _shared_memory()
    yield
    for path in _shared_memory() - before:
        if not _mapped(path):
            path.unlink(missing_ok=True)


@pytest.fixture
def rng() -> np.random.Generator:
    """A generator that starts equal in every test."""
    return np.random.default_rng(np.random.SeedSequence(SEED))
