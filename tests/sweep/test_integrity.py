"""Folders of results and their archives: what is damaged, missing or foreign is found."""

import hashlib
import json
import os
import re
import shutil
import socket
import subprocess
import zipfile

import pytest

from crackfront.data.digests import SUMS, sums_text
from tests.commands import refused, run

DERIVED = ("shards/flat.nc", "hysteresis.nc", "fit.nc")
PLAIN = ("configuration.yaml", "requests/table-0123.txt", "fit.json", "figures/loop.pdf")


def digest(content):
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def write(path, content):
    """Write a file, and its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return path


def write_derived(path, content):
    """Write a file and its checksum next to it."""
    write(path, content)
    write(path.with_name(f"{path.name}.sha256"), f"{digest(content)}  {path.name}\n".encode())


@pytest.fixture
def running(tmp_path):
    """Folder of a sweep without a list, as while it runs."""
    folder = tmp_path / "default"
    for name in PLAIN:
        write(folder / name, f"{name}\n".encode())
    for name in DERIVED:
        write_derived(folder / name, f"\x89HDF {name}".encode())
    for name in ("curves-0-7", "batch-8"):
        write(folder / f"curves/flat/{name}-{digest(name.encode())[:16]}.nc", name.encode())
    write(folder / "logs/fit.log", b"text")
    write(folder / "fit.nc.damaged", b"text")
    write(folder / f"curves/flat/checkpoint-3-{16 * '0'}.nc", b"text")
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
    """File of the curves in the folder."""
    [path] = folder.glob("curves/flat/curves-*.nc")
    return path


def flip(path, place=0):
    """Flip a bit of a file."""
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)


def verified(place):
    """Exit code of the verification of a place, and its answer for machines."""
    result = run("verify", place, "--json")
    assert "Traceback" not in result.output
    return result.exit_code, json.loads(result.stdout)


def test_a_finished_folder_and_its_archive_are_whole(finished, archive):
    for place in (finished, archive):
        code, answer = verified(place)
        assert (code, answer["whole"]) == (0, True)
        assert answer["listed"] == answer["verified"] == len(PLAIN) + 2 * len(DERIVED) + 2
        assert "nothing is damaged or missing" in run("verify", place).stdout


def test_sha256sum_agrees_with_the_list_of_a_folder_and_of_an_unpacked_archive(
    finished, archive, tmp_path
):
    zipfile.ZipFile(archive).extractall(tmp_path / "elsewhere")
    for folder in (finished, tmp_path / "elsewhere/default"):
        command = ["sha256sum", "--check", "--strict", SUMS]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
        assert done.stdout.count(": OK") == len(PLAIN) + 2 * len(DERIVED) + 2


@pytest.mark.parametrize("name", ["hysteresis.nc", "shards/flat.nc", "fit.json", "curves"])
def test_a_flipped_bit_is_found_and_neither_listed_nor_archived(finished, name):
    path = curves_of(finished) if name == "curves" else finished / name
    flip(path)
    code, answer = verified(finished)
    assert (code, answer["damaged"]) == (1, [str(path.relative_to(finished))])
    listed = (finished / SUMS).read_text()
    assert str(path) in refused("checksums", finished)
    assert (finished / SUMS).read_text() == listed
    assert str(path) in refused("archive", finished)
    assert list(finished.parent.iterdir()) == [finished]


@pytest.mark.parametrize("name", ["hysteresis.nc", "shards/flat.nc", "curves"])
def test_damage_is_found_while_there_is_no_list_and_is_not_signed(running, name):
    path = curves_of(running) if name == "curves" else running / name
    flip(path)
    code, answer = verified(running)
    assert (code, answer["damaged"]) == (1, [str(path.relative_to(running))])
    assert f"{path} is damaged" in refused("checksums", running)
    assert not (running / SUMS).exists()


def test_every_flipped_bit_and_every_cut_of_a_file_counts(finished):
    path = finished / "fit.json"
    content = path.read_bytes()
    changed = [content[:length] for length in range(len(content))]
    for bit in range(8 * len(content)):
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        changed.append(bytes(flipped))
    for other in changed:
        path.write_bytes(other)
        assert verified(finished)[1]["damaged"] == ["fit.json"]


def test_a_removed_file_is_missing_and_the_folder_is_not_archived(finished):
    (finished / "fit.nc").unlink()
    code, answer = verified(finished)
    assert (code, answer["missing"]) == (1, ["fit.nc"])
    assert "fit.nc is missing" in refused("archive", finished)


def test_a_derived_file_needs_its_checksum(running):
    (running / "fit.nc.sha256").unlink()
    assert verified(running)[1]["missing"] == ["fit.nc.sha256"]
    assert f"{running / 'fit.nc'} has no checksum" in refused("checksums", running)


def test_a_checksum_without_its_file_says_what_is_missing(running):
    (running / "shards/flat.nc").unlink()
    assert verified(running)[1]["missing"] == ["shards/flat.nc"]
    assert "flat.nc is missing" in refused("checksums", running)


@pytest.mark.parametrize("content", [b"", b"text\n", b"\xff" * 80, b"x" * 10**6])
def test_a_damaged_checksum_is_no_proof(running, content):
    (running / "fit.nc.sha256").write_bytes(content)
    assert verified(running)[1]["damaged"] == ["fit.nc"]
    assert "fit.nc is damaged" in refused("checksums", running)


def test_a_file_that_the_list_does_not_name_is_not_success(finished):
    write(finished / "figures/other.png", b"other")
    code, answer = verified(finished)
    assert (code, answer["unlisted"]) == (1, ["figures/other.png"])
    assert "figures/other.png" in refused("archive", finished)
    assert run("checksums", finished).exit_code == 0
    assert verified(finished)[0] == 0


def test_a_folder_without_a_list_is_checked_and_is_not_whole(running):
    code, answer = verified(running)
    assert (code, answer["verified"]) == (1, len(DERIVED) + 2)
    assert not answer["damaged"]
    assert not answer["missing"]
    assert f"has no {SUMS}" in answer["fault"]
    assert "crackfront checksums" in run("verify", running).stderr
    assert f"has no {SUMS}" in refused("archive", running)


def test_verifying_nothing_is_not_success(tmp_path):
    folder = tmp_path / "empty"
    folder.mkdir()
    result = run("verify", folder)
    assert result.exit_code == 1
    assert "Nothing was verified" in result.stderr
    assert "has no files" in refused("checksums", folder)
    assert f"has no {SUMS}" in refused("archive", folder)


LINE = f"{64 * 'a'}  fit.json\n"
LISTS = {
    "empty": ("", "is empty"),
    "truncated": (LINE[:-1], "is truncated"),
    "cut": (f"{LINE}{LINE[:30]}\n", "line 2 is not a checksum"),
    "doubled": (2 * LINE, "names fit.json twice"),
    "blank line": (f"{LINE}\n", "line 2 is not a checksum"),
    "upward": (f"{64 * 'a'}  ../fit.json\n", "not a path within the folder"),
    "absolute": (f"{64 * 'a'}  /etc/passwd\n", "not a path within the folder"),
    "null": (f"{64 * 'a'}  a\0b\n", "not a path within the folder"),
    "text": ("no list\n", "line 1 is not a checksum"),
    "bytes": (f"{64 * 'a'}  \udcff\n", "is not UTF-8"),
}


@pytest.mark.parametrize(("text", "reason"), LISTS.values(), ids=LISTS)
def test_a_list_that_is_not_whole_says_so_to_every_command(finished, archive, text, reason):
    path = finished / SUMS
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    assert str(path) in refused("archive", finished)
    assert reason in refused("checksums", finished)
    with zipfile.ZipFile(archive.with_name("other.zip"), "w") as other:
        other.write(finished / "fit.json", "default/fit.json")
        other.write(path, f"default/{SUMS}")
    for place in (finished, archive.with_name("other.zip")):
        code, answer = verified(place)
        assert code == 1
        assert reason in answer["fault"]
        assert SUMS in answer["fault"]
    path.unlink()
    assert run("checksums", finished).exit_code == 0
    assert verified(finished)[0] == 0


def test_a_list_that_lost_lines_leaves_files_unlisted(finished):
    lines = (finished / SUMS).read_text().splitlines(keepends=True)
    (finished / SUMS).write_text("".join(lines[:-3]))
    code, answer = verified(finished)
    assert (code, len(answer["unlisted"])) == (1, 3)


@pytest.mark.parametrize("linked", ["curves", "curves/flat", "hysteresis.nc"])
def test_links_are_followed(running, tmp_path, linked):
    target = tmp_path / "elsewhere"
    shutil.move(running / linked, target)
    (running / linked).symlink_to(target)
    assert run("checksums", running).exit_code == 0
    assert run("archive", running).exit_code == 0
    names = zipfile.ZipFile(tmp_path / "default.zip").namelist()
    assert len(names) == len(PLAIN) + 2 * len(DERIVED) + 2 + 1
    assert f"default/{curves_of(running).relative_to(running)}" in names
    assert verified(tmp_path / "default.zip")[0] == verified(running)[0] == 0


def test_damage_behind_a_link_is_found(running, tmp_path):
    shutil.move(running / "curves", tmp_path / "elsewhere")
    (running / "curves").symlink_to(tmp_path / "elsewhere")
    flip(curves_of(running))
    assert verified(running)[1]["damaged"] == [str(curves_of(running).relative_to(running))]


def test_a_link_to_nothing_is_missing_and_its_folder_not_signed(finished, tmp_path):
    shutil.move(finished / "curves", tmp_path / "elsewhere")
    (finished / "curves").symlink_to(tmp_path / "nowhere")
    code, answer = verified(finished)
    assert code == 1
    assert "curves" in answer["missing"]
    for command in ("checksums", "archive"):
        assert f"{finished / 'curves'} is a link to nothing" in refused(command, finished)


def test_a_loop_of_links_ends(finished):
    (finished / "figures/again").symlink_to(finished)
    (finished / "itself").symlink_to("itself")
    code, answer = verified(finished)
    assert (code, answer["irregular"]) == (1, ["figures/again"])
    (finished / "itself").unlink()
    assert verified(finished)[0] == 0
    assert run("archive", finished).exit_code == 0


def test_pipes_and_sockets_are_named_and_never_opened(running, monkeypatch):
    os.mkfifo(running / "curves/flat/pipe.nc")
    os.mkfifo(running / "fit.md.sha256")
    monkeypatch.chdir(running)  # the name of a socket is short
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("socket")
    for command in ("checksums", "archive"):
        assert run(command, running).exit_code == 0
    result = run("verify", running)
    assert result.exit_code == 0
    for name in ("curves/flat/pipe.nc", "fit.md.sha256", "socket"):
        assert f"not a regular file: {name}\n" in result.stdout


def test_a_listed_file_that_became_a_pipe_is_missing(finished):
    (finished / "fit.json").unlink()
    os.mkfifo(finished / "fit.json")
    assert verified(finished)[1]["missing"] == ["fit.json"]
    assert "fit.json is missing" in refused("archive", finished)


@pytest.mark.parametrize("name", ["-n", "a b", "back\\slash", "é", "a\tb", "a\rb", "a\u2028b"])
def test_strange_names_are_listed_and_archived(running, name):
    write(running / name, b"content")
    for command in ("checksums", "archive", "verify"):
        assert run(command, running).exit_code == 0
    assert verified(running.with_name("default.zip"))[0] == 0


@pytest.mark.parametrize(("name", "line"), [(b"\xff", "\\udcff"), (b"two\nlines", "two\\nlines")])
def test_names_that_no_list_can_have_are_told_in_one_line(finished, name, line):
    write(finished / os.fsdecode(name), b"content")
    for command in ("checksums", "archive"):
        assert f"{line} has a" in refused(command, finished)
    result = run("verify", finished)
    assert result.exit_code == 1
    assert f"not in {SUMS}: {line}" in result.stdout.splitlines()


def test_an_archive_without_curves_is_whole(finished):
    assert run("archive", finished, "--no-curves").exit_code == 0
    code, answer = verified(finished.with_name("default.zip"))
    assert (code, answer["listed"]) == (0, len(PLAIN) + 2 * len(DERIVED))


def test_an_archive_is_a_zip_file_outside_of_the_results_with_their_whole_name(finished):
    told = ("archive", finished, "--output")
    assert "name a ZIP file" in refused(*told, finished.parent / "default.tar.gz")
    assert "among the results" in refused(*told, finished / "default.zip")
    folder = finished.rename(finished.with_name("of.2026"))
    assert run("archive", folder).exit_code == 0
    assert [path.name for path in folder.parent.glob("*.zip")] == ["of.2026.zip"]


def test_an_archive_is_named_after_its_folder_wherever_it_is_called_from(finished, monkeypatch):
    monkeypatch.chdir(finished / "figures")
    assert run("archive", "..").exit_code == 0
    monkeypatch.chdir(finished)
    assert run("archive", ".").exit_code == 0
    names = zipfile.ZipFile(finished.with_name("default.zip")).namelist()
    assert {name.partition("/")[0] for name in names} == {"default"}


def test_an_archive_takes_the_place_of_a_link_to_itself(finished):
    path = finished.with_name("default.zip")
    path.symlink_to(path.name)
    assert run("archive", finished).exit_code == 0
    assert not path.is_symlink()


def test_an_old_archive_stays_if_the_folder_is_damaged(finished, archive):
    content = archive.read_bytes()
    flip(finished / "fit.json")
    refused("archive", finished)
    assert archive.read_bytes() == content


def test_a_damaged_member_of_an_archive_costs_no_other_one(archive):
    with zipfile.ZipFile(archive) as opened:
        [entry] = [one for one in opened.infolist() if one.filename.endswith("hysteresis.nc")]
    flip(archive, entry.header_offset + 30 + len(entry.filename))
    code, answer = verified(archive)
    assert (code, answer["damaged"]) == (1, ["hysteresis.nc"])


def test_no_flipped_byte_of_an_archive_crashes_its_verification(archive):
    content = archive.read_bytes()
    for place in range(0, len(content), 7):
        changed = bytearray(content)
        changed[place] ^= 0xFF
        archive.write_bytes(changed)
        result = run("verify", archive)
        assert isinstance(result.exception, SystemExit | None), (place, result.exception)


@pytest.mark.parametrize("content", [b"", b"PK\5\6" + bytes(18), b"text", b"PK"])
def test_a_file_that_is_not_a_whole_archive_is_not_success(tmp_path, content):
    (tmp_path / "sweep.zip").write_bytes(content)
    result = run("verify", tmp_path / "sweep.zip")
    assert result.exit_code == 1
    assert len(result.stderr.splitlines()) == 1


def test_what_is_neither_a_folder_nor_an_archive_is_refused(tmp_path):
    write(tmp_path / "fit.md", b"text")
    assert "is neither a folder of results nor its archive" in refused(
        "verify", tmp_path / "fit.md"
    )
    assert "does not exist" in refused("verify", tmp_path / "nothing")


@pytest.mark.parametrize("compression", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2])
def test_a_small_archive_that_would_become_huge_is_not_read(tmp_path, compression):
    path = tmp_path / "bomb.zip"
    content = bytes(3 * 10**7)
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr("default/hysteresis.nc", content)
        archive.writestr(f"default/{SUMS}", sums_text({"hysteresis.nc": digest(content)}))
    assert path.stat().st_size < 10**5
    sentence = refused("verify", path)
    assert "hysteresis.nc" in sentence
    assert ("more than 1000 times" in sentence) == (compression == zipfile.ZIP_DEFLATED)


@pytest.mark.parametrize(
    "name", ["../fit.json", "/fit.json", "default/../../fit.json", "./fit.json"]
)
def test_an_archive_that_leads_out_of_its_folder_is_not_read(archive, name):
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr(name, "text")
    assert f"contains {name}, which would be unpacked outside" in refused("verify", archive)


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_an_archive_with_two_files_of_one_name_is_not_read(archive):
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr("default/fit.json", "text")
    assert "contains default/fit.json twice" in refused("verify", archive)


def test_an_encrypted_archive_is_not_read(archive):
    content = bytearray(archive.read_bytes())
    # The bit is in the head of each member and in the list at the end.
    for sign, place in {b"PK\x03\x04": 6, b"PK\x01\x02": 8}.items():
        start = next(re.finditer(re.escape(sign), bytes(content))).start()
        content[start + place] |= 1
    archive.write_bytes(content)
    assert "is encrypted; unpack it with its password" in refused("verify", archive)


def test_an_archive_without_a_list_is_not_whole(tmp_path):
    path = tmp_path / "sweep.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("default/fit.json", "text")
    code, answer = verified(path)
    assert (code, answer["verified"]) == (1, 0)
    assert f"has no {SUMS}" in answer["fault"]
