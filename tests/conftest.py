"""What every test shares: floating-point errors raise, random numbers are seeded."""

import gc
import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

# Hypothesis and crackfront are imported in functions: a process that only hands tests to workers
# needs neither.

SEED = 20240229


class DoctestsThatExist:
    """Keeps pytest from importing and searching modules without an example, which are most."""

    @pytest.hookimpl(wrapper=True)
    def pytest_collect_file(self, file_path: Path) -> Iterator[None]:
        """Only the tests of a file whose text has no prompt of Python."""
        collectors = yield
        if file_path.suffix != ".py" or b">>>" in file_path.read_bytes():
            return collectors
        return [item for item in collectors if isinstance(item, pytest.Module)]


def pytest_configure(config: pytest.Config) -> None:
    """Set up generated examples and the search for doctests."""
    if config.getoption("numprocesses", 0) and not hasattr(config, "workerinput"):
        return  # workers collect and run the tests
    _choose_generated_examples(by_day="not slow" in config.option.markexpr)
    # As a plugin, because hooks of this file see only files of this folder.
    config.pluginmanager.register(DoctestsThatExist())
    gc.disable()


def _choose_generated_examples(*, by_day: bool) -> None:
    """More generated examples where the slow tests run too, by night."""
    import hypothesis

    hypothesis.settings.register_profile(
        "ours",
        deadline=None,
        max_examples=10 if by_day else 100,
        derandomize=bool(os.environ.get("CI")),
    )
    hypothesis.settings.load_profile("ours")


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
            _compile_kernels_of_tiles()
        case "gw1":
            _compile_kernels_of_rings()


def _compile_kernels_of_tiles() -> None:
    from crackfront.core.solver.relax import Newton
    from crackfront.simulate.run_simulation import compile_solver
    from crackfront.simulate.sphere.full_cycle import FullCycle

    compile_solver(Newton.name, FullCycle)


def _compile_kernels_of_rings() -> None:
    from crackfront.core.cycle.load_schedule import LoadSchedule
    from crackfront.core.cycle.record import Recorder
    from crackfront.core.cycle.run import run_cycle
    from crackfront.core.geometry.sphere import polar_field
    from crackfront.core.solver.relax import Newton
    from crackfront.core.units import WORK_OF_ADHESION

    rings = polar_field(np.linspace(0.1, 3.0, 30), np.full(30, WORK_OF_ADHESION))
    run_cycle(rings, LoadSchedule(0.0, 0.5), Newton(1e-3), Recorder())


@pytest.fixture(autouse=True)
def _floating_point_errors_raise() -> Iterator[None]:
    before = np.seterr(all="raise", under="ignore")
    yield
    np.seterr(**before)


@pytest.fixture(autouse=True, scope="session")
def _style_as_printed() -> Iterator[dict[str, object]]:
    """No search for the layout of figures, no fonts; fixtures that tests share draw so too.

    The value is the style with both.
    """
    from crackfront.plots.style import STYLE

    as_printed = STYLE.copy()
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setitem(STYLE, "figure.constrained_layout.use", False)
        monkeypatch.setitem(STYLE, "pdf.fonttype", 3)
        yield as_printed


@pytest.fixture(autouse=True)
def _figures_as_printed(
    request: pytest.FixtureRequest, _style_as_printed: dict[str, object]
) -> Iterator[None]:
    """Where the look of figures is in question, they have their layout and fonts."""
    if not request.node.get_closest_marker("look"):
        yield
        return
    from crackfront.plots.style import STYLE

    with pytest.MonkeyPatch.context() as monkeypatch:
        for name, value in _style_as_printed.items():
            monkeypatch.setitem(STYLE, name, value)
        yield


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
