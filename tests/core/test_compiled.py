import os
import subprocess
import sys
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


@pytest.fixture
def no_home(tmp_path, monkeypatch):
    """A folder for temporary files, where the cache of the user cannot be."""
    (tmp_path / "file").write_text("not a folder")
    (tmp_path / "spare").mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(compiled.tempfile, "tempdir", str(tmp_path / "spare"))
    return tmp_path / "spare"


def test_the_cache_lies_in_a_folder_of_these_sources(fresh_cache):
    folder = compiled.cache_folder.__wrapped__()
    assert folder == fresh_cache / "crackfront" / compiled.solver_fingerprint()
    assert folder.is_dir()
    assert folder.stat().st_mode & 0o077 == 0


def test_the_cache_moves_to_a_temporary_folder_of_this_user_where_home_cannot_be_written(no_home):
    folder = compiled.cache_folder.__wrapped__()
    assert folder.parent == no_home / f"crackfront-{os.geteuid()}"
    assert folder == compiled.cache_folder.__wrapped__()


def test_no_writable_folder_for_compiled_code_is_an_error_that_says_what_to_set(
    no_home, monkeypatch
):
    monkeypatch.setattr(compiled.tempfile, "tempdir", str(no_home / "none"))
    monkeypatch.setattr(compiled, "is_private", lambda folder: False)
    with pytest.raises(OSError, match="set XDG_CACHE_HOME to a folder that is writable"):
        compiled.cache_folder.__wrapped__()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files to another user")
@pytest.mark.parametrize("depth", [0, 1])
def test_code_in_a_folder_of_another_user_is_not_run(no_home, depth):
    theirs = [no_home / f"crackfront-{os.geteuid()}"]
    theirs.append(theirs[0] / compiled.solver_fingerprint())
    theirs[1].mkdir(parents=True, mode=0o700)
    os.chown(theirs[depth], 12345, 12345)
    folder = compiled.cache_folder.__wrapped__()
    assert folder.parent == no_home
    assert folder not in theirs
    assert folder.stat().st_uid == os.geteuid()


def test_a_link_in_the_place_of_the_cache_is_not_followed(no_home, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (no_home / f"crackfront-{os.geteuid()}").symlink_to(tmp_path / "elsewhere")
    assert compiled.cache_folder.__wrapped__().name.startswith("crackfront-")
    assert not any((tmp_path / "elsewhere").iterdir())


def test_a_cache_in_which_others_may_write_is_made_anew(fresh_cache):
    folder = compiled.cache_folder.__wrapped__()
    (folder / "planted.nbi").write_bytes(b"code")
    folder.chmod(0o770)
    assert compiled.cache_folder.__wrapped__() == folder
    assert not any(folder.iterdir())
    assert folder.stat().st_mode & 0o077 == 0


def quotient(a, b):
    return a / b


def test_the_first_kernel_that_no_cache_holds_is_told_once(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled.numba.config, "CACHE_DIR", str(tmp_path))
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


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_file_of_the_cache_is_made_anew(tmp_path, monkeypatch, ending):
    monkeypatch.setattr(compiled.numba.config, "CACHE_DIR", str(tmp_path))

    def hits():
        """Cached versions that a new kernel finds, once it has given the right answer."""
        kernel = compiled.jit(quotient)
        assert kernel(1.0, 4.0) == 0.25
        return sum(kernel.stats.cache_hits.values())

    assert (hits(), hits()) == (0, 1)
    [path] = tmp_path.rglob(f"*quotient*.{ending}")
    content = path.read_bytes()
    flipped = bytearray(content)
    flipped[len(content) // 2] ^= 4
    for wrong in (b"", content[: len(content) // 2], bytes(flipped)):
        path.write_bytes(wrong)
        assert (hits(), hits()) == (0, 1)


def test_who_has_neither_home_nor_name_has_a_temporary_folder(tmp_path, monkeypatch):
    def nobody(number):
        raise KeyError(number)

    for name in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("pwd.getpwuid", nobody)
    monkeypatch.setattr(compiled.tempfile, "tempdir", str(tmp_path))
    folder = compiled.cache_folder.__wrapped__()
    assert folder.parent == tmp_path / f"crackfront-{os.geteuid()}"


def test_a_compiled_division_by_zero_is_infinite():
    divide = compiled.jit(cache=False)(lambda a, b: a / b)
    assert divide(1.0, 0.0) == np.inf
    assert np.isnan(divide(0.0, 0.0))


def test_what_is_compiled_ahead_is_all_that_simulations_call():
    program = """
from pathlib import Path
from crackfront.core.solver.monotone import relax_together
from crackfront.simulate.run import compile_solver, run_simulation
from crackfront.sweep.configuration import load_configuration

for line in False, True:
    compile_solver("newton", line)
assert len(relax_together.signatures) == 2
for name in "test", "line-test":
    run_simulation(next(iter(load_configuration(Path(f"config/{name}.yaml")).simulations())))
assert len(relax_together.signatures) == 2
"""
    subprocess.run([sys.executable, "-c", program], cwd=PACKAGE.parent, check=True)
