"""Folders of results and their archives: what is damaged, missing or foreign is found."""

import hashlib
import json
import subprocess
import zipfile

import pytest

from crackfront.simulate.checksums import SUMS
from tests.commands import refused, run

DERIVED = ("shards/flat.nc", "hysteresis.nc", "fit.nc")
NO_RESULTS = ("logs/fit.log", "fit.nc.damaged", "curves/flat/checkpoint-3.nc", "report.html")
PLAIN = ("configuration.yaml", "requests/table-0123.txt", "fit.json", "figures/loop.pdf")


def digest(content):
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def write(path, content):
    """Write a file, and its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


@pytest.fixture
def running(tmp_path):
    """Folder of a sweep without a list, as while it runs."""
    folder = tmp_path / "default"
    for name in (*PLAIN, *NO_RESULTS):
        write(folder / name, f"{name}\n".encode())
    for name in DERIVED:
        content = f"\x89HDF {name}".encode()
        write(folder / name, content)
        write(folder / f"{name}.sha256", f"{digest(content)}  {name}\n".encode())
    write(folder / f"curves/flat/curves-flat-{digest(b'states')[:16]}.nc", b"states")
    return folder


@pytest.fixture
def finished(running):
    """Folder of a finished sweep."""
    assert run("checksums", running).exit_code == 0
    return running


@pytest.fixture
def archive(finished):
    """Archive of it."""
    assert run("archive", finished).exit_code == 0
    return finished.with_name("default.zip")


def curves_of(folder):
    """File of the finished simulations."""
    [path] = folder.glob("curves/flat/curves-*.nc")
    return path


def verified(place):
    """Exit code of the verification of a place, and its answer for machines."""
    result = run("verify", place, "--json")
    return result.exit_code, json.loads(result.stdout)


def test_a_finished_folder_and_its_archive_are_whole(finished, archive):
    n_file = len(PLAIN) + 2 * len(DERIVED) + 1
    for place in (finished, archive):
        code, lines = verified(place)
        assert (code, lines["verified"]) == (0, n_file)


def test_sha256sum_agrees_with_the_list_of_a_folder_and_of_its_archive(finished, archive, tmp_path):
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(tmp_path / "unpacked")
    for folder in (finished, tmp_path / "unpacked/default"):
        subprocess.run(["sha256sum", "--check", "--quiet", SUMS], cwd=folder, check=True)


@pytest.mark.parametrize("name", ["hysteresis.nc", "shards/flat.nc", "curves", "fit.json"])
def test_a_changed_file_is_found_and_not_archived_and_a_damaged_dataset_is_not_signed_again(
    finished, name
):
    path = curves_of(finished) if name == "curves" else finished / name
    path.write_bytes(path.read_bytes() + b"!")
    code, lines = verified(finished)
    assert (code, lines["damaged"]) == (1, [path.relative_to(finished).as_posix()])
    assert "1 damaged" in refused("archive", finished)
    assert not finished.with_name("default.zip").exists()
    if path.suffix == ".nc":
        assert "does not agree with its checksum" in refused("checksums", finished)


def test_a_removed_file_is_missing_and_a_new_one_is_not_in_the_list(finished):
    (finished / "fit.json").unlink()
    (finished / "fit-of-another.json").write_text("{}")
    code, lines = verified(finished)
    assert code == 1
    assert (lines["missing"], lines["unlisted"]) == (["fit.json"], ["fit-of-another.json"])


@pytest.mark.parametrize(
    "changed",
    [
        lambda text: "",
        lambda text: text[:-7],
        lambda text: text + text,
        lambda text: "no list\n",
    ],
    ids=["empty", "cut", "doubled", "other"],
)
def test_a_list_that_is_not_whole_is_not_success(finished, changed):
    (finished / SUMS).write_text(changed((finished / SUMS).read_text()))
    for command in ("verify", "archive"):
        assert "is empty, cut or damaged" in refused(command, finished)


def test_verifying_nothing_is_not_success(running, tmp_path):
    assert "lacks SHA256SUMS" in refused("verify", running)
    assert "is empty" in refused("checksums", tmp_path / "default/figures/none")


def test_links_are_followed_and_a_loop_of_them_ends(running, tmp_path):
    (running / "curves").rename(tmp_path / "scratch")
    (running / "curves").symlink_to(tmp_path / "scratch")
    (running / "requests/loop").symlink_to(running)
    assert run("checksums", running).exit_code == 0
    assert run("archive", running).exit_code == 0
    with zipfile.ZipFile(tmp_path / "default.zip") as packed:
        name = curves_of(running).relative_to(tmp_path).as_posix()
        assert packed.read(name) == b"states"


@pytest.mark.parametrize("name", ["a b", "-n", "back\\slash", "ü", "'quoted'"])
def test_strange_names_are_listed_and_archived(running, name):
    write(running / name, b"content")
    for command in ("checksums", "verify", "archive"):
        assert run(command, running).exit_code == 0
    assert verified(running.with_name("default.zip"))[0] == 0


def test_an_archive_without_curves_is_whole(finished):
    assert run("archive", finished, "--no-curves").exit_code == 0
    code, lines = verified(finished.with_name("default.zip"))
    assert (code, lines["verified"]) == (0, len(PLAIN) + 2 * len(DERIVED))


def test_an_archive_is_a_zip_file_outside_of_the_results(finished):
    assert "name a ZIP file" in refused("archive", finished, "--output", finished / "../x.tar")
    assert "among the results" in refused("archive", finished, "--output", finished / "x.zip")


def test_no_damage_of_an_archive_passes_or_crashes_its_verification(archive):
    content = archive.read_bytes()
    for place in range(0, len(content), 97):
        archive.write_bytes(content[:place] + bytes([content[place] ^ 64]) + content[place + 1 :])
        result = run("verify", archive)
        # A date or an attribute of a member may change, its content may not.
        assert result.exit_code in (0, 1, 2)
        assert result.exception is None or isinstance(result.exception, SystemExit)
    archive.write_bytes(content[: len(content) // 2])
    assert "cannot be read as an archive" in refused("verify", archive)


def test_a_small_archive_that_would_become_huge_is_not_read(tmp_path):
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in "abc":
            packed.writestr(f"bomb/{name}", bytes(2 * 10**7))
    assert "would grow from" in refused("verify", path)
