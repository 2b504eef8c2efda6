"""The workflow without a home folder, as in containers."""

import os
import subprocess
import sys

import pytest

from tests.places import ROOT


def plan(folder, profile=ROOT / "workflow/profiles/default", **environment):
    """Result of the plans as `make` asks for them, without the caches of this user."""
    sweep = str(ROOT / "config/test.yaml")
    names = ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR")
    kept = {name: value for name, value in os.environ.items() if name not in names}
    return subprocess.run(
        [
            *(sys.executable, str(ROOT / "workflow/run.py"), "--plan", sweep),
            *("--snakefile", str(ROOT / "Snakefile")),
            *("--profile", str(profile), "--directory", str(folder)),
            *("--config", f"sweep={sweep}", "--dry-run"),
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        cwd=folder,
        env=kept | environment,
    )


@pytest.mark.slow
def test_errors_of_a_profile_are_shown(tmp_path):
    missing = plan(tmp_path, profile=tmp_path / "nowhere")
    assert missing.returncode == 1
    assert "no profile.yaml" in missing.stderr


@pytest.mark.slow
@pytest.mark.parametrize("variable", ["HOME", "XDG_CACHE_HOME"])
def test_a_home_that_cannot_be_written_is_replaced_by_a_private_temporary_folder(
    tmp_path, variable
):
    (tmp_path / "file").touch()
    (temporary := tmp_path / "temporary").mkdir()
    done = plan(tmp_path, TMPDIR=str(temporary), **{variable: str(tmp_path / "file/folder")})
    assert done.returncode == 0, done.stderr
    assert "simulate" in done.stdout
    [cache] = temporary.iterdir()
    assert cache.stat().st_mode & 0o777 == 0o700


def test_a_temporary_folder_that_somebody_else_has_linked_is_not_used(tmp_path):
    (tmp_path / "file").touch()
    (temporary := tmp_path / "temporary").mkdir()
    (theirs := tmp_path / "theirs").mkdir()
    (temporary / f"crackfront-{os.geteuid()}").symlink_to(theirs)
    done = plan(tmp_path, TMPDIR=str(temporary), HOME=str(tmp_path / "file/home"))
    assert done.returncode == 1
    assert "set XDG_CACHE_HOME" in done.stderr
    assert "Traceback" not in done.stderr
