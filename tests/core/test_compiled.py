"""The cache of compiled kernels: its place, who may write to it, and when kernels are compiled."""

import os
import shutil
import tempfile

import numpy as np
import pytest

from crackfront.core import compiled


def quotient(a, b):
    return a / b


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """A cache folder of its own, not remembered afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    compiled.cache_folder.cache_clear()
    yield tmp_path / "cache/crackfront"
    compiled.cache_folder.cache_clear()


def cache_hits():
    """Versions of a new kernel that were found on disk, once it has given the right answer."""
    kernel = compiled.jit(quotient)
    assert kernel(1.0, 4.0) == 0.25
    return sum(kernel.stats.cache_hits.values())


def test_a_kernel_is_compiled_once_in_a_private_folder_of_these_sources(fresh_cache):
    assert (cache_hits(), cache_hits()) == (0, 1)
    [path] = fresh_cache.rglob("*quotient*.nbi")
    folder = compiled.cache_folder()
    assert (folder.parent, folder.stat().st_mode & 0o077) == (fresh_cache, 0)
    assert folder in path.parents


def test_the_folder_that_numba_is_given_is_used(fresh_cache, tmp_path, monkeypatch):
    monkeypatch.setattr(compiled.numba.config, "CACHE_DIR", str(tmp_path / "given"))
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert any((tmp_path / "given").rglob("*quotient*.nbi"))
    assert not fresh_cache.exists()


@pytest.mark.parametrize("missing", ["file", None])
def test_the_cache_lies_with_temporary_files_where_there_is_no_home(
    fresh_cache, tmp_path, monkeypatch, missing
):
    if missing:
        (tmp_path / missing).write_text("not a folder")
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / missing))
    else:
        for name in ("HOME", "XDG_CACHE_HOME"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr("pwd.getpwuid", {}.__getitem__)
    assert compiled.cache_folder().parent == tmp_path / f"crackfront-{os.geteuid()}"


def shared(folder):
    """Let everybody write to a folder."""
    folder.mkdir(parents=True)
    folder.chmod(0o777)


def given_away(folder):
    """A folder of another user."""
    folder.mkdir(parents=True, mode=0o700)
    os.chown(folder, 12345, 12345)


def linked(folder):
    """A link in place of a folder."""
    (folder.parent / "elsewhere").mkdir(parents=True)
    folder.symlink_to(folder.parent / "elsewhere")


@pytest.mark.parametrize("depth", [0, 1])
@pytest.mark.parametrize("harm", [shared, given_away, linked])
def test_a_folder_that_others_can_fill_is_neither_used_nor_touched(fresh_cache, harm, depth):
    if harm is given_away and os.geteuid() != 0:
        pytest.skip("only root can give files to another user")
    name = compiled.cache_folder().name
    compiled.cache_folder.cache_clear()
    folder = fresh_cache / name if depth else fresh_cache
    shutil.rmtree(fresh_cache)
    harm(folder)
    before = folder.lstat()
    (folder / "planted.nbi").write_bytes(b"code")
    assert compiled.cache_folder().parent.name == f"crackfront-{os.geteuid()}"
    assert (folder / "planted.nbi").read_bytes() == b"code"
    assert (folder.lstat().st_mode, folder.lstat().st_uid) == (before.st_mode, before.st_uid)


def test_kernels_run_without_a_cache_where_no_folder_is_private(fresh_cache, monkeypatch, tmp_path):
    (tmp_path / "cache").write_text("not a folder")
    (tmp_path / f"crackfront-{os.geteuid()}").write_text("not a folder")
    assert (cache_hits(), cache_hits()) == (0, 0)


@pytest.mark.usefixtures("fresh_cache")
def test_the_first_kernel_that_no_cache_holds_is_told_once():
    told = []
    compiled.when_compiling(lambda: None)
    compiled.when_compiling(lambda: told.append("compiling"))
    for counts in (["compiling"], ["compiling"]):
        assert compiled.jit(quotient)(1.0, 2.0) == 0.5
        assert compiled.jit(quotient)(1, 2) == 0.5
        assert told == counts
    told.clear()
    compiled.when_compiling(lambda: told.append("compiling"))
    assert compiled.jit(quotient)(1.0, 2.0) == 0.5
    assert told == []
    assert compiled.jit(quotient)(1.0, 2) == 0.5
    assert told == ["compiling"]


def test_a_compiled_division_by_zero_is_infinite():
    divide = compiled.jit(cache=False)(lambda a, b: a / b)
    assert divide(1.0, 0.0) == np.inf
    assert np.isnan(divide(0.0, 0.0))
