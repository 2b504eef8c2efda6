"""The origin that every file states."""

import subprocess
import sys

import pytest

from crackfront import __version__
from crackfront.data import provenance as module
from crackfront.data.fingerprint import solver_fingerprint
from crackfront.data.provenance import git_commit, provenance


@pytest.fixture(autouse=True)
def _forget_the_commit():
    git_commit.cache_clear()
    yield
    git_commit.cache_clear()


@pytest.mark.parametrize(
    "program", ["/home/someone/.venv/bin/crackfront", "/home/someone/crackfront/__main__.py"]
)
def test_the_command_does_not_name_the_folders_of_a_machine(monkeypatch, program):
    monkeypatch.setattr(sys, "argv", [program, "fit", "a b.yaml"])
    assert provenance().command == "crackfront fit 'a b.yaml'"


def test_the_origin_names_version_sources_and_configuration():
    origin = provenance("seed: 1\n")
    assert origin.crackfront_version == __version__
    assert origin.solver_fingerprint == solver_fingerprint()
    assert origin.configuration == "seed: 1\n"


@pytest.mark.parametrize("error", [FileNotFoundError("git"), subprocess.TimeoutExpired("git", 10)])
def test_without_git_the_commit_is_unknown(monkeypatch, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(subprocess, "run", fail)
    assert git_commit() == "unknown"


def test_outside_of_a_repository_the_commit_is_unknown(monkeypatch, tmp_path):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    monkeypatch.setattr(module, "PACKAGE", tmp_path)
    assert git_commit() == "unknown"


def test_a_commit_is_named_in_full_and_changes_are_told(monkeypatch, tmp_path):
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b"]
    (tmp_path / "a.py").write_text("1\n")
    for command in (["init", "-q"], ["add", "a.py"], ["commit", "-qm", "a"]):
        subprocess.run([*git, *command], check=True, capture_output=True)
    monkeypatch.setattr(module, "PACKAGE", tmp_path)
    clean = git_commit()
    (tmp_path / "a.py").write_text("2\n")
    git_commit.cache_clear()
    assert len(clean) == 40
    assert git_commit() == f"{clean}-dirty"
    subprocess.run([*git, "tag", "-a", "-m", "first", "v1.0"], check=True, capture_output=True)
    git_commit.cache_clear()
    assert git_commit() == f"{clean}-dirty"
