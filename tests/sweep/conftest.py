"""One sweep that ran undisturbed, and what is made of it, for tests of what may happen to them."""

import pytest

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
