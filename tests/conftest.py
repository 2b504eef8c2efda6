"""What every test shares: floating-point errors raise, random numbers are seeded."""

import atexit
import gc
import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import hypothesis
import numpy as np
import pytest

# As of the command: Python looks for garbage among what is imported, also as it ends.
gc.set_threshold(1_000_000)
atexit.register(gc.freeze)

SEED = 20240229

hypothesis.settings.register_profile("local", deadline=None)
hypothesis.settings.register_profile("reproducible", deadline=None, derandomize=True)
hypothesis.settings.load_profile("reproducible" if os.environ.get("CI") else "local")


@pytest.fixture(autouse=True)
def _floating_point_errors_raise() -> Iterator[None]:
    before = np.seterr(all="raise", under="ignore")
    yield
    np.seterr(**before)


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
