"""The file of a shard: its rows, its fingerprint, and that planning costs no look at rows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.versions import ROWS_VERSION
from crackfront.data.digests import digest_path, file_digest
from crackfront.data.files import damaged_files, read_dataset
from crackfront.data.provenance import provenance
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.rows import failed_row
from crackfront.sweep.shards import covering, finished_shard, shard_request, write_shard
from crackfront.sweep.store import Store, lost_curves

SWEEP = load_configuration(Path(__file__).parents[2] / "config/test.yaml")
FLAT, ROUGH = SWEEP.shards()


def fingerprint(sweep=SWEEP, shard=FLAT):
    """Fingerprint of a shard of a sweep."""
    return shard_request(sweep.one_per_amplitude(shard.item), shard.realisations)


def rows(shard=FLAT):
    """Rows of a shard; its last simulation has no value."""
    found = [
        replace(failed_row(one, "steady", ""), w_appr=0.1 * number, cpu_seconds=2.0)
        for number, one in enumerate(SWEEP.simulations(shard.item, shard.realisations))
    ]
    return [*found[:-1], replace(found[-1], status="refused")]


@pytest.fixture
def path(tmp_path):
    """File of the shard of flat surfaces."""
    path = tmp_path / "shards/flat.nc"
    write_shard(path, SWEEP, FLAT, rows(), ["one", "another"], provenance("text"))
    return path


def test_the_fingerprint_of_a_shard_changes_with_its_simulations_alone():
    before = fingerprint()
    more = replace(SWEEP, n_realisation=3)
    fewer = replace(SWEEP, spectra=(FLAT.item,))
    assert fingerprint(more, more.shards()[0]) != before
    assert fingerprint(SWEEP, ROUGH) != before
    assert fingerprint(replace(SWEEP, seed=SWEEP.seed + 1)) != before
    assert fingerprint(fewer) == before


def test_the_fingerprint_of_a_shard_changes_with_the_definition_of_rows(monkeypatch):
    before = fingerprint()
    monkeypatch.setattr("crackfront.sweep.shards.ROWS_VERSION", ROWS_VERSION + 1)
    assert fingerprint() != before


def test_the_file_of_a_shard_has_the_rows_and_says_which_they_are(path):
    dataset = read_dataset(path)
    assert dict(dataset.sizes) == {"spectrum": 1, "amplitude": 2, "realisation": 2}
    assert np.array_equal(dataset.w_appr.values, [[[0.0, 0.1], [0.2, 0.1 * 3]]])
    found = finished_shard(path)
    assert found.fingerprint == fingerprint()
    assert (found.spectrum, found.realisations) == ("flat", range(2))
    assert (found.failed, found.cpu_seconds) == (1, 8.0)
    assert found.arithmetic == {"one", "another"}


def test_what_is_finished_is_known_without_a_look_at_rows_and_packs(path, monkeypatch):
    store = Store(path.parents[1])
    monkeypatch.setattr("crackfront.sweep.store.shard_columns", None)
    monkeypatch.setattr("crackfront.sweep.store.RowIndex", None)
    assert store.is_finished(SWEEP, FLAT)
    assert not store.is_finished(SWEEP, ROUGH)
    found = store.progress(SWEEP, FLAT.item)
    assert (found.done, found.failed, found.missing) == (3, 1, ())


def test_a_shard_of_another_sweep_counts_where_its_simulations_are_the_same(path):
    store, item = Store(path.parents[1]), FLAT.item
    for n_realisation in (1, 2, 3):
        sweep = replace(SWEEP, n_realisation=n_realisation)
        found = store.progress(sweep, item)
        assert found.stored == 2 * min(n_realisation, 2)
        assert {one.realisation for one in found.missing} == set(range(2, n_realisation))
    assert store.progress(replace(SWEEP, seed=7), item).stored == 0


def flipped(content, bit):
    """Content with one bit changed."""
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def test_no_flipped_bit_and_no_lost_sector_of_a_shard_is_believed_and_hdf5_sees_none(
    path, monkeypatch, rng
):
    def refuse(*_, **__):
        raise AssertionError("HDF5 opens a damaged file")

    content, store = path.read_bytes(), Store(path.parents[1])
    monkeypatch.setattr("crackfront.sweep.shards.netCDF4.Dataset", refuse)
    monkeypatch.setattr("crackfront.data.files.read_dataset", refuse)
    bits = rng.integers(8 * len(content), size=300).tolist()
    damaged = [flipped(content, bit) for bit in [0, 8 * len(content) - 1, *bits]]
    for start in range(0, len(content), 512):
        sector = content[start : start + 512]
        lost = content[:start] + bytes(len(sector)) + content[start + 512 :]
        damaged += [lost] if any(sector) else []
    damaged += [content[:size] for size in (0, 1, 4096, len(content) - 1)]
    for changed in [*damaged, content + b"\0"]:
        path.write_bytes(changed)
        assert finished_shard(path) is None
        assert damaged_files(store.folder) == [path]
        assert [*lost_curves(store.folder)] == []


@pytest.mark.parametrize("damage", ["removed", "emptied", "of another", "flipped"])
def test_a_shard_without_its_checksum_is_not_believed_and_made_anew(path, damage):
    beside, store = digest_path(path), Store(path.parents[1])
    stated = beside.read_bytes()
    assert stated.decode() == f"{file_digest(path)}  flat.nc\n"
    contents = {
        "emptied": b"",
        "of another": b"0" * 64 + stated[64:],
        "flipped": flipped(stated, 9),
    }
    if damage == "removed":
        beside.unlink()
    else:
        beside.write_bytes(contents[damage])
    assert finished_shard(path) is None
    configuration = Path(__file__).parents[2] / "config/test.yaml"
    [sentence] = store.repair(configuration)
    assert sentence.startswith(str(path))
    assert "made anew" in sentence
    assert not path.exists()


@pytest.mark.parametrize("content", [b"", b"text", "half"])
def test_a_file_without_content_is_no_finished_shard(path, content):
    path.write_bytes(path.read_bytes()[:3000] if content == "half" else content)
    assert finished_shard(path) is None
    assert not Store(path.parents[1]).is_finished(SWEEP, FLAT)


@pytest.mark.parametrize(
    ("blocks", "taken"),
    [
        ([(0, 5)], [(0, 5)]),
        ([(0, 2), (2, 5)], [(0, 2), (2, 5)]),
        ([(0, 2), (0, 5), (2, 5)], [(0, 5)]),
        ([(0, 3), (2, 5)], [(0, 3), (3, 5)]),
        ([(1, 2), (3, 9)], [(1, 2), (3, 5)]),
        ([(5, 9)], []),
    ],
)
def test_no_realisation_of_overlapping_shards_is_taken_twice(path, blocks, taken):
    files = [replace(finished_shard(path), realisations=range(*block)) for block in blocks]
    assert [part for _, part in covering(files, 5)] == [range(*part) for part in taken]
