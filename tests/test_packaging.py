"""The package: its version from git or without, its wheel, and what cites it."""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile
from itertools import chain

import numpy as np
import pytest
from packaging.version import Version

from crackfront import pinning_factor
from tests.places import ROOT
from tests.yaml_texts import from_yaml

pytestmark = pytest.mark.skipif(
    not (ROOT / ".git").exists(), reason="these sources are no clone of the repository"
)

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
COMING = PROJECT["tool"]["setuptools_scm"]["fallback_version"]
CITATION = from_yaml((ROOT / "CITATION.cff").read_text())


def told(*command, **options):
    """What a command prints."""
    done = subprocess.run(
        [str(part) for part in command],
        check=True,
        capture_output=True,
        text=True,
        timeout=600,
        **options,
    )
    return done.stdout.strip()


def scm_version(folder):
    """Version that a build of a folder would have."""
    return told(sys.executable, "-m", "setuptools_scm", cwd=folder).splitlines()[-1]


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """Sources as a release's tarball holds them."""
    folder = tmp_path_factory.mktemp("archive")
    told("git", "-C", ROOT, "archive", "--output", folder / "sources.tar", "HEAD")
    with tarfile.open(folder / "sources.tar") as sources:
        sources.extractall(folder / "sources", filter="data")
    return folder / "sources"


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A clone of the last commit without tags."""
    folder = tmp_path_factory.mktemp("clone") / "clone"
    told("git", "clone", "-q", "--depth", "1", "--no-tags", f"file://{ROOT}", folder)
    return folder


@pytest.fixture(scope="module")
def built(clone, tmp_path_factory):
    """Archive and wheel of a release: of a tagged clone, by the tools that are installed."""
    folder = tmp_path_factory.mktemp("built")
    tagged, dist = shutil.copytree(clone, folder / "clone", symlinks=True), folder / "dist"
    told("git", "-C", tagged, "tag", "v7.1.0")
    # The wheel is built from the archive.
    told(sys.executable, "-m", "build", "--no-isolation", "--outdir", dist, tagged)
    return dist / "crackfront-7.1.0.tar.gz", dist / "crackfront-7.1.0-py3-none-any.whl"


@pytest.mark.slow
def test_a_clone_without_tags_has_the_coming_version_and_names_its_commit(clone):
    commit = told("git", "-C", ROOT, "rev-parse", "--short=7", "HEAD")
    clone_version = scm_version(clone)
    assert clone_version.startswith(COMING.replace("dev0", "dev"))
    assert f"+g{commit}" in clone_version


@pytest.mark.slow
def test_sources_without_git_have_the_coming_version_and_a_tarball_names_its_commit(
    archive, tmp_path
):
    commit = told("git", "-C", ROOT, "rev-parse", "HEAD")
    assert f"commit: {commit}" in (archive / ".git_archival.txt").read_text()
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        (tmp_path / name).write_bytes((archive / name).read_bytes())
    assert scm_version(tmp_path) == scm_version(archive) == COMING


def test_the_changelog_begins_with_the_coming_version_and_the_citation_has_the_last_release():
    changelog = (ROOT / "CHANGELOG.md").read_text()
    sections = re.findall(r"^## (\S+)(?: - (\S+))?$", changelog, re.MULTILINE)
    coming = Version(COMING).base_version
    assert sections[0][0] == coming
    releases = [(version, day) for version, day in sections if day]
    cited = (CITATION["version"], str(CITATION.get("date-released", "")))
    assert cited == (releases[0] if releases else (coming, ""))


@pytest.mark.slow
def test_the_archive_holds_all_that_is_committed_and_the_wheel_the_package_alone_which_runs(
    built, tmp_path
):
    committed = set(told("git", "-C", ROOT, "ls-tree", "-r", "--name-only", "HEAD").splitlines())
    with tarfile.open(built[0]) as sources:
        assert committed <= {name.partition("/")[2] for name in sources.getnames()}
    names = {name for name in zipfile.ZipFile(built[1]).namelist() if ".dist-info/" not in name}
    assert "crackfront/analysis/law.json" in names
    assert names == {name for name in committed if name.startswith("crackfront/")}
    # In an empty environment.
    empty = tmp_path / "empty"
    told(sys.executable, "-m", "venv", "--without-pip", empty)
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", empty)
    told(*pip, "install", "--quiet", "--no-deps", "--no-index", built[1])
    # The packages that it needs are those of the tests.
    [site] = empty.glob("lib/python*/site-packages")
    (site / "needed.pth").write_text(sysconfig.get_path("purelib"))
    told(*pip, "check")
    command = (empty / "bin/python", "-I", empty / "bin/crackfront")
    assert told(*command, "--version").endswith(" 7.1.0")
    content = json.loads(told(*command, "law", "--w-rms", "0.4", "--g", "inf", "--json"))
    assert content["k"] == pinning_factor(0.4, np.inf).factor.value


def test_the_recipe_has_the_version_and_needs_of_the_package():
    recipe = from_yaml((ROOT / "recipe/recipe.yaml").read_text())
    assert recipe["context"]["version"] == CITATION["version"]
    assert PROJECT["project"]["requires-python"] == f">={recipe['context']['python_min']}"
    texts = (PROJECT["project"]["dependencies"], PROJECT["build-system"]["requires"])
    run, host = ([line.lower().replace(">=", " >=") for line in listed] for listed in texts)
    requirements = [
        line.replace("matplotlib-base", "matplotlib") for line in recipe["requirements"]["run"]
    ]
    assert requirements == ["python >=${{ python_min }}", *run]
    assert recipe["requirements"]["host"] == ["python ${{ python_min }}.*", "pip", *host]


def test_contributing_says_what_every_package_is_for():
    project = PROJECT["project"]
    extras = project["optional-dependencies"].values()
    needed = [*project["dependencies"], *PROJECT["build-system"]["requires"], *chain(*extras)]
    packages = {re.match(r"[\w.-]+", line)[0] for line in needed} - {"crackfront"}
    page = (ROOT / "CONTRIBUTING.md").read_text()
    table = page[page.index("## Dependencies") : page.index("## Releases")]
    rows = [line.split("|") for line in table.splitlines() if line.startswith("|")]
    named = [name for row in rows[2:] for name in row[1].strip().split(", ")]
    assert sorted(named) == sorted(packages)


def test_it_is_imported_in_the_folder_beside_its_clone(tmp_path):
    """A folder that bears its name, and holds no package itself, does not hide it."""
    (tmp_path / "crackfront").symlink_to(ROOT, target_is_directory=True)
    code = "import crackfront; print(crackfront.__version__)"
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert ran.returncode == 0, ran.stderr
