"""The folder of compiled kernels: its place, who may write to it, and when it changes."""

import os
import shutil
from pathlib import Path

import pytest

from crackfront.core import cache_folder
from crackfront.core.cache_folder import kernel_folder


@pytest.fixture(autouse=True)
def sources(tmp_path, monkeypatch):
    """One source in place of those of `core`, which the folder is named after."""
    core = tmp_path / "core"
    (core / "field").mkdir(parents=True)
    shutil.copy(Path(cache_folder.__file__).parent / "field/rays.py", core / "field")
    monkeypatch.setattr(cache_folder, "__file__", str(core / "cache_folder.py"))
    return core


def folder_now():
    """The folder as a new process would choose it."""
    kernel_folder.cache_clear()
    return kernel_folder()


def test_the_folder_is_closed_to_others_with_all_that_is_made_above_it(fresh_cache):
    mask = os.umask(0)
    try:
        folder = kernel_folder()
    finally:
        os.umask(mask)
    assert folder.parent == fresh_cache
    for made in (folder, fresh_cache, fresh_cache.parent):
        assert made.stat().st_mode & 0o777 == 0o700


@pytest.mark.usefixtures("fresh_cache")
def test_the_folder_that_numba_is_given_comes_first(tmp_path, monkeypatch):
    monkeypatch.setattr(cache_folder.numba.config, "CACHE_DIR", str(tmp_path / "given"))
    assert kernel_folder().parent == tmp_path / "given"


def loosen(folder):
    """Let everybody write to a folder."""
    folder.chmod(0o777)


def give_away(folder):
    """Give a folder to another user."""
    if os.geteuid() != 0:
        pytest.skip("only root can give files to another user")
    os.chown(folder, 12345, 12345)


def link_to_loose(folder):
    """A link in place of a folder, to one to which everybody can write."""
    elsewhere = folder.with_name("elsewhere")
    folder.rename(elsewhere)
    elsewhere.chmod(0o777)
    folder.symlink_to(elsewhere)


def permissions(folder):
    """Owners and permissions of all that is in a folder."""
    return {
        path: (path.lstat().st_uid, path.lstat().st_gid, path.lstat().st_mode)
        for path in folder.rglob("*")
    }


@pytest.mark.parametrize(("harm", "depth"), [(loosen, 2), (give_away, 0), (link_to_loose, 2)])
@pytest.mark.usefixtures("fresh_cache")
def test_a_folder_below_one_that_others_can_change_is_neither_used_nor_touched(
    tmp_path, monkeypatch, harm, depth
):
    nested = tmp_path / "a/b/c"
    monkeypatch.setattr(cache_folder.numba.config, "CACHE_DIR", str(nested))
    folder = kernel_folder()
    if depth > 0:
        folder.rmdir()
    harm([folder, *folder.parents][depth])
    before = permissions(tmp_path)
    assert nested not in folder_now().parents
    shutil.rmtree(tmp_path / "cache")
    assert permissions(tmp_path) == before


@pytest.mark.usefixtures("fresh_cache")
def test_a_parent_may_be_writable_where_everybody_renames_only_their_own(tmp_path, monkeypatch):
    parent = tmp_path / "given"
    parent.mkdir()
    parent.chmod(0o1777)
    monkeypatch.setattr(cache_folder.numba.config, "CACHE_DIR", str(parent))
    assert kernel_folder().parent == parent
    # In the folder itself everybody could add files.
    kernel_folder().chmod(0o1777)
    assert folder_now().parent != parent


@pytest.mark.parametrize("is_named", [True, False])
@pytest.mark.usefixtures("fresh_cache")
def test_the_cache_lies_with_temporary_files_where_there_is_no_home(
    tmp_path, monkeypatch, is_named
):
    if is_named:
        (tmp_path / "file").write_text("not a folder")
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    else:
        for name in ("HOME", "XDG_CACHE_HOME"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr("pwd.getpwuid", {}.__getitem__)
    assert kernel_folder().parent == tmp_path / f"temporary/crackfront-{os.geteuid()}"


@pytest.mark.usefixtures("fresh_cache")
def test_the_folder_changes_with_the_sources(sources):
    folder = folder_now()
    rays = sources / "field/rays.py"
    text = rays.read_text()
    rays.write_text(text + "\nCOUNT = 1\n")
    assert folder_now() != folder
    rays.write_text(text)
    assert folder_now() == folder
    (sources / "field/new.py").touch()
    assert folder_now() != folder
