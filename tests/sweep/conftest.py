"""One sweep that ran undisturbed, and what is made of it, for tests of what may happen to them."""

import shutil
from pathlib import Path

import pytest

from crackfront.sweep.store import Store
from tests.commands import run

TEST = Path(__file__).parents[2] / "config/test.yaml"


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """A store with the curves, the rows and the table of the configuration `test`."""
    store = Store(tmp_path_factory.mktemp("made") / "sweep")
    for name in ("simulate", "aggregate"):
        assert run(name, TEST, "--output", store.folder).exit_code == 0
    return store


@pytest.fixture(scope="session")
def finished(made, tmp_path_factory):
    """A folder with everything that is made of that sweep."""
    folder = shutil.copytree(made.folder, tmp_path_factory.mktemp("finished") / "sweep")
    for name in ("fit", "figures", "summary"):
        assert run(name, TEST, "--output", folder).exit_code == 0
    assert run("checksums", folder).exit_code == 0
    return folder
