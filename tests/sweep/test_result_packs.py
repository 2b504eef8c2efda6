"""Packs: whole files count, torn and changed ones do not, and two writers do not meet."""

import json
import socket
from dataclasses import replace
from pathlib import Path

import pytest

from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.data.packs import LONGEST_NAME, checked, record
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.result_packs import Entry, RowIndex, new_pack, pack_paths, repair_packs
from crackfront.sweep.rows import failed_row

SWEEP = load_configuration(Path(__file__).parents[2] / "config/test.yaml")
ONE = next(SWEEP.simulations())
ROW = failed_row(ONE, "refused", "too rough: 1 > 0.999")
ENTRY = Entry(ONE.stem, ONE.parameters, PHYSICS_VERSION, ROWS_VERSION, ROW)
OTHER = replace(ENTRY, stem="flat-e0.1-r1-0123456789abcdef")
CURVE = b"curve" * 999


@pytest.fixture
def pack(tmp_path):
    """A pack of this process."""
    return new_pack(tmp_path, "flat", range(2))


def names(folder):
    """Names of the whole files in all packs of a folder, and the number of damaged places."""
    paths = pack_paths(folder)
    whole = [one.name for path in paths for one in checked(path)[0]]
    return whole, sum(checked(path)[1] for path in paths)


def test_what_is_appended_is_read_back_in_order_and_to_the_last_bit(tmp_path, pack):
    pack.append(OTHER.files(CURVE))
    pack.append(replace(ENTRY, row=replace(ROW, w_appr=0.1 + 0.2)).files())
    expected = [f"{OTHER.stem}.nc", f"{OTHER.stem}.json", f"{ONE.stem}.json"]
    assert names(tmp_path) == (expected, 0)
    index = RowIndex(tmp_path, "flat", range(2))
    assert index.entry(ONE.stem).row.w_appr == 0.1 + 0.2
    assert next(index.alike(ONE.stem)).parameters == json.loads(json.dumps(ONE.parameters))


@pytest.mark.parametrize("left", [1, 300, 512, 700, 5000, -1])
def test_a_torn_last_file_does_not_count_and_the_others_do(tmp_path, pack, left):
    pack.append(ENTRY.files())
    [path] = pack_paths(tmp_path)
    whole = path.stat().st_size
    pack.append({"x.nc": CURVE})
    content = path.read_bytes()
    path.write_bytes(content[:left] if left < 0 else content[: whole + left])
    padding = left == -1  # no byte of a file
    assert names(tmp_path) == ([f"{ONE.stem}.json", *["x.nc"] * padding], int(not padding))


def test_no_flipped_bit_of_a_file_counts_and_the_others_do(tmp_path, pack, rng):
    entries = [replace(ENTRY, stem=f"flat-e0.02-r{number}-{number:016}") for number in range(3)]
    for one in entries:
        pack.append(one.files(CURVE))
    [path] = pack_paths(tmp_path)
    content, whole = path.read_bytes(), names(tmp_path)[0]
    for bit in rng.integers(8 * len(content), size=300).tolist():
        changed = bytearray(content)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        found, n_damaged = names(tmp_path)
        assert found in (whole, [one for one in whole if one in found])
        assert len(found) + n_damaged == len(whole)


@pytest.mark.parametrize("content", [b"", bytes(4096), b"text"])
def test_a_pack_without_content_is_damaged(tmp_path, content):
    path = tmp_path / f"flat.0-1.{socket.gethostname()}-1-ab.tar"
    path.write_bytes(content)
    assert names(tmp_path)[0] == []
    [sentence] = repair_packs([path])
    assert sentence.startswith(
        f"{path} is damaged; its whole files stay, the rest is in {path.name}."
    )
    assert not path.exists()


def test_what_is_whole_in_a_damaged_pack_stays_and_the_rest_is_set_aside(tmp_path):
    path = tmp_path / f"flat.0-1.{socket.gethostname()}-1-ab.tar"
    content = (
        record("a.nc", CURVE) + record("b.nc", CURVE).replace(b"v", b"w", 1) + record("c.nc", CURVE)
    )
    path.write_bytes(content)
    assert len(list(repair_packs([path]))) == 1
    assert names(tmp_path) == (["a.nc", "c.nc"], 0)
    assert path.with_name(f"{path.name}.damaged").read_bytes() == content


def test_the_pack_of_a_living_process_stays_as_it_is(tmp_path, pack):
    pack.append(OTHER.files(CURVE))
    [path] = pack_paths(tmp_path)
    with path.open("ab") as file:
        file.write(b"half")
    assert list(repair_packs([path])) == []
    pack.close()
    with path.open("ab") as file:
        file.write(b"half")
    assert len(list(repair_packs([path]))) == 1


def test_two_writers_have_two_files(tmp_path, pack):
    pack.append(ENTRY.files())
    new_pack(tmp_path, "flat", range(2)).append(OTHER.files())
    assert len(pack_paths(tmp_path)) == 2
    assert len(names(tmp_path)[0]) == 2


@pytest.mark.parametrize(
    ("spectrum", "block", "found"),
    [
        ("flat", range(2), 1),
        ("flat", range(1, 9), 1),
        ("flat", range(2, 9), 0),
        ("fla", range(2), 0),
    ],
)
def test_packs_are_found_by_spectrum_and_realisations(tmp_path, pack, spectrum, block, found):
    pack.append(ENTRY.files())
    assert len(pack_paths(tmp_path, spectrum, block)) == found


def test_a_row_of_another_definition_does_not_count(tmp_path, pack):
    pack.append(replace(ENTRY, definition="earlier").files())
    index = RowIndex(tmp_path, "flat", range(2))
    assert index.entry(ONE.stem) is None
    assert next(index.alike(ONE.stem)).parameters == json.loads(json.dumps(ONE.parameters))


def test_what_the_disk_does_not_take_leaves_nothing(tmp_path, monkeypatch, pack):
    pack.append(ENTRY.files())
    [path] = pack_paths(tmp_path)
    before = path.read_bytes()

    def full(_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("crackfront.data.packs.SECONDS_TO_DISK", 0.0)
        patched.setattr("crackfront.data.packs.os.fsync", full)
        with pytest.raises(OSError, match="No space left"):
            pack.append(OTHER.files(CURVE))
        with pytest.raises(OSError, match="No space left"):
            new_pack(tmp_path, "rough", range(2)).append(OTHER.files(CURVE))
    assert pack_paths(tmp_path) == [path]
    assert path.read_bytes() == before
    pack.append(OTHER.files())
    assert len(names(tmp_path)[0]) == 2


def test_the_longest_name_of_a_spectrum_fits_in_a_pack():
    name = "a" * (LONGEST_NAME - 57) + "-01234567"
    one = replace(ONE, spectrum_name=name, elastic_energy=0.000123457, realisation=2**31 - 1)
    assert record(one.stem + ".json", b"")
