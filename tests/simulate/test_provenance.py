"""The origin that every file states."""

import subprocess
import sys

import pytest

from crackfront import __version__
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.simulate import provenance as module
from crackfront.simulate.provenance import git_commit, provenance


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
    assert (origin.physics_version, origin.rows_version) == (PHYSICS_VERSION, ROWS_VERSION)
    assert origin.configuration == "seed: 1\n"


def test_outside_of_a_repository_the_commit_is_unknown(monkeypatch, tmp_path):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    monkeypatch.setattr(module, "PACKAGE", tmp_path)
    assert git_commit() == "unknown"


def test_a_commit_is_named_in_full_and_changes_but_those_of_pages(monkeypatch, tmp_path):
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b"]
    monkeypatch.setattr(module, "PACKAGE", tmp_path)
    (tmp_path / "docs").mkdir()
    pages, source = tmp_path / "docs" / "a.md", tmp_path / "a.py"
    pages.write_text("1\n")
    source.write_text("1\n")
    for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "a"], ["tag", "-am", "b", "v"]):
        subprocess.run([*git, *command], check=True, capture_output=True)
    pages.write_text("what the sources gave\n")
    clean = git_commit()
    assert len(clean) == 40
    source.write_text("2\n")
    git_commit.cache_clear()
    assert git_commit() == f"{clean}-dirty"
