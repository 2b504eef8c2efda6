import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import crackfront
from crackfront import compiled

PACKAGE = Path(crackfront.__file__).parent


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """A copy of the package whose fingerprint can be taken without the module's memory."""
    copy = tmp_path / "crackfront"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compiled, "__file__", str(copy / "compiled.py"))
    return copy


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """A cache folder of its own, not remembered afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def fingerprint():
    return compiled.solver_fingerprint.__wrapped__()


def physics_files(folder):
    for name in compiled.PHYSICS:
        path = folder / name
        yield from sorted(path.glob("*.py")) if path.is_dir() else [folder / f"{name}.py"]


def test_the_fingerprint_is_twelve_hexadecimal_digits():
    assert len(compiled.solver_fingerprint()) == 12
    assert set(compiled.solver_fingerprint()) <= set("0123456789abcdef")


def test_equal_sources_have_equal_fingerprints(sources):
    assert fingerprint() == compiled.solver_fingerprint()


def test_every_file_of_the_physics_changes_the_fingerprint(sources):
    before = fingerprint()
    files = list(physics_files(sources))
    assert len(files) >= len(compiled.PHYSICS)
    for path in files:
        text = path.read_bytes()
        path.write_bytes(text + b"\n")
        assert fingerprint() != before, path
        path.write_bytes(text)
    assert fingerprint() == before


def test_files_that_do_not_touch_a_number_leave_the_fingerprint(sources):
    before = fingerprint()
    (sources / "notes.py").write_text("a remark\n")
    assert fingerprint() == before


def test_every_module_that_compiles_a_kernel_is_part_of_the_fingerprint():
    counted = set(physics_files(PACKAGE))
    users = {path for path in PACKAGE.rglob("*.py") if "compiled import" in path.read_text("utf-8")}
    with_jit = {path for path in users if "jit" in path.read_text("utf-8")}
    assert with_jit
    assert with_jit <= counted


def test_every_module_that_a_simulation_imports_is_part_of_the_fingerprint():
    show = (
        "import sys, crackfront.synthesis, crackfront.steady;"
        "print(*[name for name in sys.modules if name.startswith('crackfront.')])"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", show],
        env=os.environ | {"PYTHONPATH": str(PACKAGE.parent)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    ).stdout.split()
    assert {name.split(".")[1] for name in loaded} == set(compiled.PHYSICS)


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
