"""The cache of compiled kernels: its place, who may write to it, and what is damaged in it."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from itertools import cycle
from pathlib import Path

import pytest
from crackfront.core.fingerprint import ROOT, module_digests, solver_fingerprint

from crackfront.core import compiled, kernel_cache


def quotient(a, b):
    return a / b


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """A cache folder of its own, not remembered afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    kernel_cache.kernel_folder.cache_clear()
    kernel_cache._say_damaged.cache_clear()
    yield tmp_path / "cache/crackfront"
    kernel_cache.kernel_folder.cache_clear()


def cache_hits():
    """Versions of a new kernel that were found on disk, once it has given the right answer."""
    kernel = compiled.jit(quotient)
    assert kernel(1.0, 4.0) == 0.25
    return sum(kernel.stats.cache_hits.values())


def test_a_kernel_is_compiled_once_in_a_private_folder_of_these_sources(fresh_cache):
    assert (cache_hits(), cache_hits()) == (0, 1)
    [path] = fresh_cache.rglob("*quotient*")
    folder = kernel_cache.kernel_folder()
    assert (folder.parent, folder.stat().st_mode & 0o077) == (fresh_cache, 0)
    assert folder in path.parents


def test_the_folder_that_numba_is_given_is_used(fresh_cache, tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache.numba.config, "CACHE_DIR", str(tmp_path / "given"))
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert any((tmp_path / "given").rglob("*quotient*"))
    assert not fresh_cache.exists()


def test_a_folder_that_numba_is_given_and_others_can_fill_is_not_used(
    fresh_cache, tmp_path, monkeypatch
):
    shared(tmp_path / "given")
    monkeypatch.setattr(kernel_cache.numba.config, "CACHE_DIR", str(tmp_path / "given"))
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert not any((tmp_path / "given").iterdir())
    assert any(fresh_cache.rglob("*quotient*"))


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
    assert kernel_cache.kernel_folder().parent == tmp_path / f"crackfront-{os.geteuid()}"


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
    name = kernel_cache.kernel_folder().name
    kernel_cache.kernel_folder.cache_clear()
    folder = fresh_cache / name if depth else fresh_cache
    shutil.rmtree(fresh_cache)
    harm(folder)
    before = folder.lstat()
    (folder / "planted").write_bytes(b"code")
    assert kernel_cache.kernel_folder().parent.name == f"crackfront-{os.geteuid()}"
    assert (folder / "planted").read_bytes() == b"code"
    assert (folder.lstat().st_mode, folder.lstat().st_uid) == (before.st_mode, before.st_uid)


def test_kernels_run_without_a_cache_where_no_folder_is_private(fresh_cache, monkeypatch, tmp_path):
    (tmp_path / "cache").write_text("not a folder")
    (tmp_path / f"crackfront-{os.geteuid()}").write_text("not a folder")
    assert (cache_hits(), cache_hits()) == (0, 0)


def emptied(content):
    return b""


def truncated(content):
    return content[: len(content) // 2]


def flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


HARMS = (emptied, truncated, flipped)


@pytest.mark.parametrize("harm", HARMS)
def test_a_damaged_kernel_is_compiled_anew_and_one_line_says_so(fresh_cache, caplog, harm):
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert caplog.messages == []
    [path] = fresh_cache.rglob("*quotient*")
    for _ in range(2):
        path.write_bytes(harm(path.read_bytes()))
        assert (cache_hits(), cache_hits()) == (0, 1)
    sentence = f"compiled kernels in {path.parent} are damaged; they are compiled anew"
    assert caplog.messages == [sentence]


def test_a_kernel_that_goes_missing_is_compiled_anew_without_a_word(fresh_cache, caplog):
    assert (cache_hits(), cache_hits()) == (0, 1)
    shutil.rmtree(fresh_cache)
    assert (cache_hits(), cache_hits()) == (0, 0)
    kernel_cache.kernel_folder.cache_clear()
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert caplog.messages == []


def test_a_full_disk_costs_the_cache_and_no_result(fresh_cache, monkeypatch):
    def full(path, content):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kernel_cache, "write_checked", full)
    assert (cache_hits(), cache_hits()) == (0, 0)


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_cache_of_which_each_file_is_damaged_does_not_end_a_command(tmp_path):
    def compiled_anew():
        done = subprocess.run(
            [sys.executable, "-m", "crackfront", "compile"],
            env=os.environ | {"XDG_CACHE_HOME": str(tmp_path)},
            cwd=ROOT,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        return done

    compiled_anew()
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    written = {path: path.read_bytes() for path in files}
    for path, harm in zip(files, cycle(HARMS)):
        path.write_bytes(harm(written[path]))
    told = compiled_anew().stderr.splitlines()
    # Spheres and straight fronts are compiled in a process each.
    assert 1 <= len(told) <= 2
    assert set(told) == {told[0]}
    assert re.fullmatch("compiled kernels in .* are damaged; they are compiled anew", told[0])
    assert compiled_anew().stderr == ""
    assert {path for path in tmp_path.rglob("*") if path.is_file()} == set(files)


def test_the_folder_bears_the_fingerprint_of_all_modules_that_hold_kernels(fresh_cache):
    assert kernel_cache.kernel_folder().name == f"kernels-{solver_fingerprint()}"
    parts = "cycle.run", "geometry.line", "geometry.sphere", "solver.relax"
    counted = module_digests(*(f"crackfront.core.{part}" for part in parts))
    holding = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for path in Path(ROOT, "crackfront").rglob("*.py")
        if "from crackfront.core.compiled import" in path.read_text("utf-8")
    } - {"crackfront.cli.report"}
    assert len(holding) > 8
    assert holding <= counted.keys()
