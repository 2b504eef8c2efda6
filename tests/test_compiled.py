from pathlib import Path

import numpy as np
import pytest

import crackfront
from crackfront.core import compiled

PACKAGE = Path(crackfront.__file__).parent


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """A cache folder of its own, not remembered afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_the_cache_lies_in_a_folder_of_these_sources(fresh_cache):
    folder = compiled.cache_folder.__wrapped__()
    assert folder == fresh_cache / "crackfront" / compiled.solver_fingerprint()
    assert folder.is_dir()


def test_the_cache_moves_to_the_temporary_folder_where_home_cannot_be_written(
    tmp_path, monkeypatch
):
    blocked, spare = tmp_path / "file", tmp_path / "spare"
    blocked.write_text("not a folder")
    spare.mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(spare))
    assert compiled.cache_folder.__wrapped__().is_relative_to(spare)


def test_no_writable_folder_for_compiled_code_is_an_error_that_says_what_to_set(
    tmp_path, monkeypatch
):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(blocked))
    with pytest.raises(OSError, match="is writable; set XDG_CACHE_HOME to a folder"):
        compiled.cache_folder.__wrapped__()


def test_kernels_count_as_cached_once_an_index_of_one_is_there(fresh_cache, monkeypatch):
    monkeypatch.setattr(compiled, "cache_folder", compiled.cache_folder.__wrapped__)
    assert not compiled.kernels_are_cached()
    folder = compiled.cache_folder() / "relax_0"
    folder.mkdir()
    (folder / "kernel.nbi").write_bytes(b"")
    assert compiled.kernels_are_cached()


def test_a_compiled_division_by_zero_is_infinite():
    divide = compiled.jit(cache=False)(lambda a, b: a / b)
    assert divide(1.0, 0.0) == np.inf
    assert np.isnan(divide(0.0, 0.0))
