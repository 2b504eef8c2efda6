"""The store: what is finished stays, what is missing or broken is found and run."""

import json
import os
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from crackfront.data.files import leftover_parts, read_dataset
from crackfront.data.provenance import provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_simulation
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import journal, tasks
from crackfront.sweep import table as tables
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.journal import Entry, Journal
from crackfront.sweep.store import Store
from crackfront.sweep.table import read_table

SWEEP = load_configuration(Path(__file__).parents[1] / "config/test.yaml")
FLAT = SWEEP.shard(SWEEP.spectra[0])


@pytest.fixture
def store(tmp_path):
    """An empty store."""
    return Store(tmp_path / "sweep")


def fill(store, simulations):
    """Fill a store and return how the simulations ended."""
    return list(tasks.fill(store, simulations, provenance("text")))


def states(store):
    """Names and moments of the stored files."""
    files = (store.folder / "curves").iterdir()
    return {path.name: path.stat().st_mtime_ns for path in files}


def test_an_empty_store_lacks_everything(store):
    inventory = store.inventory(FLAT)
    assert inventory.missing == FLAT
    assert inventory.unreadable == ()


def test_a_filled_store_lacks_nothing_and_holds_one_file_a_simulation(store):
    outcomes = fill(store, FLAT)
    assert {finished.status for _, finished in outcomes} == {"lost_contact"}
    assert {simulation for simulation, _ in outcomes} == set(FLAT)
    assert store.inventory(FLAT).missing == ()
    assert set(states(store)) == {f"{simulation.stem}.nc" for simulation in FLAT}


def test_the_longest_simulations_start_first(store):
    costs = [expected_cost(simulation).seconds for simulation, _ in fill(store, FLAT[::-1])]
    assert costs == sorted(costs, reverse=True)


def test_a_simulation_is_stored_before_the_next_one_starts(store):
    filling = tasks.fill(store, FLAT, provenance())
    first, _ = next(filling)
    assert store.path(first).exists()
    assert len(states(store)) == 1


def test_added_realisations_are_all_that_is_missing(store):
    fill(store, FLAT)
    before = states(store)
    more = replace(SWEEP, n_realisation=3)
    missing = store.inventory(more.shard(more.spectra[0])).missing
    assert {simulation.realisation for simulation in missing} == {2}
    fill(store, missing)
    assert before.items() < states(store).items()


def test_a_truncated_file_is_named_and_computed_anew_and_the_others_are_not(store):
    fill(store, FLAT)
    before = states(store)
    broken = store.path(FLAT[1])
    content = broken.read_bytes()
    broken.write_bytes(content[: len(content) // 2])
    inventory = store.inventory(FLAT)
    assert inventory.missing == (FLAT[1],)
    assert len(inventory.unreadable) == 1
    assert str(broken) in inventory.unreadable[0]
    fill(store, inventory.missing)
    after = states(store)
    assert {name for name in before if before[name] != after[name]} == {broken.name}
    assert store.inventory(FLAT).missing == ()


def test_a_file_of_an_older_solver_is_not_found(store, monkeypatch):
    fill(store, FLAT[:1])
    monkeypatch.setattr("crackfront.simulate.simulation.simulation_fingerprint", lambda: "newer")
    assert store.inventory(FLAT[:1]).missing == FLAT[:1]


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"solver": replace(FLAT[0].solver, tolerance=1e-7)}, "numerics"),
        ({"sweep_seed": 2}, "seed"),
        ({"solver": replace(FLAT[0].solver, max_sweeps=7)}, "numerics"),
    ],
)
def test_what_is_stale_is_told_with_what_has_changed(store, change, part):
    fill(store, FLAT[:2])
    inventory = store.inventory([replace(FLAT[0], **change), FLAT[1]])
    assert [item.label for item in inventory.stale] == [FLAT[0].label]
    assert inventory.stale_sentence() == f"1 stored simulations are stale: 1 as {part} changed"
    assert store.inventory(FLAT).stale_sentence() == ""


def test_a_new_solver_makes_all_stale_by_its_sources(store, monkeypatch):
    fill(store, FLAT[:2])
    monkeypatch.setattr("crackfront.simulate.simulation.simulation_fingerprint", lambda: "newer")
    inventory = store.inventory(FLAT)
    assert len(inventory.missing) == 4
    assert inventory.stale_sentence() == "2 stored simulations are stale: 2 as sources changed"


def test_a_part_that_keys_did_not_have_before_is_told_as_changed(store):
    old = Entry("0" * 16, FLAT[0].label, {"kind": FLAT[0].parts["kind"]}, definition="older")
    Journal(store.folder / "journals").append(old)
    [stale] = store.inventory(FLAT[:1]).stale
    assert set(stale.changed) == set(FLAT[0].parts) - {"kind"}


def test_spectra_of_one_shape_and_two_names_have_rows_of_their_own(store, monkeypatch):
    def refuse(*_, **__):
        raise ValueError("too rough")

    twins = [FLAT[0], replace(FLAT[0], spectrum_name="twin")]
    assert twins[0].key == twins[1].key
    monkeypatch.setattr(tasks, "run_simulation", refuse)
    fill(store, twins)
    rows = [held.row for held in store.holdings(twins)]
    assert [row.status for row in rows] == ["refused", "refused"]


def test_a_file_without_a_line_in_a_journal_counts(store):
    fill(store, FLAT)
    for path in (store.folder / "journals").iterdir():
        path.unlink()
    assert store.inventory(FLAT).missing == ()


def test_a_line_in_a_journal_without_its_file_does_not_count(store):
    fill(store, FLAT)
    store.path(FLAT[2]).unlink()
    assert store.inventory(FLAT).missing == (FLAT[2],)


def test_a_failed_simulation_is_stored_with_its_status(store):
    limited = replace(FLAT[0], solver=replace(FLAT[0].solver, max_sweeps=1))
    [(_, finished)] = fill(store, [limited])
    assert finished.status == "step_limit"
    assert read_simulation(store.path(limited), limited).record.status.name == "STEP_LIMIT"
    assert store.inventory([limited]).missing == ()


def test_a_simulation_that_cannot_be_done_is_a_row_and_is_not_tried_again(store):
    impossible = replace(FLAT[0], elastic_energy=0.999999, sweep_seed=5)
    energies = [replace(impossible, realisation=number) for number in range(8)]
    outcomes = fill(store, [*energies, FLAT[0]])
    refused = [one for one, finished in outcomes if finished.status == "refused"]
    assert refused
    assert store.path(FLAT[0]).exists()
    assert not any(store.path(one).exists() for one in refused)
    assert store.inventory([*energies, FLAT[0]]).missing == ()
    rows = [held.row for held in store.holdings(refused)]
    assert {row.status for row in rows} == {"refused"}
    for row in rows:
        assert "full conformity needs less than w_int" in row.status_sentence
        assert np.isnan(row.w_appr)


def test_a_disk_that_is_full_ends_the_run_at_once_with_a_sentence(store, monkeypatch):
    def fail(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(tasks, "write_simulation", fail)
        [(_, finished)] = fill(store, FLAT)
    assert finished.status == tasks.NOT_STORED
    assert "No space left on device" in finished.sentence
    assert store.inventory(FLAT).missing == FLAT


def test_a_manifest_lists_the_files_of_a_shard(store):
    [shard, *_] = SWEEP.shards(1)
    simulations = SWEEP.shard(shard.item, shard.realisations)
    path = store.write_manifest(shard, simulations)
    assert path.name == "flat.0-0.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    assert [entry["key"] for entry in content["simulations"]] == [one.key for one in simulations]
    assert store.folder / content["simulations"][0]["file"] == store.path(simulations[0])


def test_an_incomplete_sweep_is_not_aggregated(store):
    fill(store, FLAT[1:])
    with pytest.raises(ValueError, match=r"5 of 8 simulations are missing .*, the first is fl"):
        store.aggregate(SWEEP, provenance())
    assert not (store.folder / "hysteresis.nc").exists()


@pytest.mark.parametrize(
    ("block", "left"),
    [(None, ["rough.json"]), (1, ["flat.1-1.json", "rough.0-0.json", "rough.1-1.json"])],
)
def test_the_list_of_a_shard_with_a_truncated_file_is_taken_back(store, block, left):
    for shard in SWEEP.shards(block):
        simulations = SWEEP.shard(shard.item, shard.realisations)
        fill(store, simulations)
        store.write_manifest(shard, simulations)
    store.path(FLAT[0]).write_bytes(b"half")
    with pytest.raises(ValueError, match="1 of 8 simulations are missing or unreadable"):
        store.aggregate(SWEEP, provenance())
    assert sorted(path.name for path in (store.folder / "shards").iterdir()) == left


def test_a_complete_sweep_is_aggregated(store):
    fill(store, [one for item in SWEEP.spectra for one in SWEEP.shard(item)])
    path, statuses = store.aggregate(SWEEP, provenance("text"))
    assert statuses == {"lost_contact": 8}
    assert read_table(path).w_appr.shape == (2, 2, 2)


def test_a_sweep_is_aggregated_the_same_whatever_is_held_at_once(store, monkeypatch):
    simulations = list(SWEEP.simulations())
    fill(store, simulations[:3])
    # Some files have no line in a journal any more.
    for path in (store.folder / "journals").iterdir():
        path.unlink()
    fill(store, simulations[3:])
    whole = read_dataset(store.aggregate(SWEEP, provenance("text"))[0])
    monkeypatch.setattr(journal, "ROWS_AT_ONCE", 3)
    monkeypatch.setattr(tables, "ROWS_AT_ONCE", 1)
    parts = read_dataset(store.aggregate(SWEEP, provenance("text"))[0])
    assert parts.drop_attrs().identical(whole.drop_attrs())
    assert [*whole["curve"].values.flat] == [f"{one.stem}.nc" for one in simulations]


@pytest.mark.parametrize("curves", [True, False])
def test_an_archive_holds_what_was_archived_under_checksums_that_fit(store, tmp_path, curves):
    fill(store, list(SWEEP.simulations()))
    store.aggregate(SWEEP, provenance("text"))
    (store.folder / "curves/.killed.part").write_text("half")
    (store.folder / "elsewhere").symlink_to(__file__)
    os.utime(store.folder / "hysteresis.nc", (0, 0))  # written under a clock at 1970
    path = tmp_path / "sweep.zip"
    n_file = store.archive(path, curves=curves)
    with zipfile.ZipFile(path) as archive:
        assert len(archive.namelist()) == n_file + 1
        archive.extractall(tmp_path / "unpacked")
    unpacked = tmp_path / "unpacked/sweep"
    done = subprocess.run(
        ["sha256sum", "--check", "SHA256SUMS"],
        cwd=unpacked,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.count(": OK") == n_file
    names = {str(file.relative_to(unpacked)) for file in unpacked.rglob("*") if file.is_file()}
    wanted = {"hysteresis.nc", "configuration.yaml", "SHA256SUMS"}
    wanted |= {f"curves/{one.stem}.nc" for one in SWEEP.simulations()} if curves else set()
    assert {name for name in names if not name.startswith("journals/")} == wanted


def test_a_sweep_that_was_not_run_is_not_archived(store, tmp_path):
    fill(store, FLAT[:1])
    with pytest.raises(ValueError, match=r"holds no hysteresis.nc; run the sweep before it is ar"):
        store.archive(tmp_path / "sweep.zip", curves=True)


def test_what_a_killed_process_left_half_written_is_removed_by_the_next_run(store):
    fill(store, FLAT[:1])
    old, new = (store.folder / "curves" / f".{name}.part" for name in ("old", "new"))
    for path in (old, new):
        path.write_text("half")
    moment = old.stat().st_mtime - 7200
    os.utime(old, (moment, moment))
    fill(store, FLAT[1:2])
    assert not old.exists()
    assert new.exists()


def test_a_defect_that_the_solver_finds_in_itself_is_a_row_and_the_others_run(store, monkeypatch):
    def defective(simulation, **options):
        if simulation == FLAT[1]:
            raise RuntimeError("the solver moved a site past its equilibrium")
        return run_simulation(simulation, **options)

    monkeypatch.setattr(tasks, "run_simulation", defective)
    ended = {one: (finished.status, finished.sentence) for one, finished in fill(store, FLAT[:3])}
    assert ended.pop(FLAT[1]) == ("defect", "the solver moved a site past its equilibrium")
    assert {status for status, _ in ended.values()} == {"lost_contact"}


def test_memory_that_does_not_suffice_ends_the_run_and_leaves_no_row(store, monkeypatch):
    def devour(*_, **__):
        raise MemoryError

    monkeypatch.setattr(tasks, "run_simulation", devour)
    [(_, finished)] = fill(store, FLAT)
    assert finished.status == tasks.NOT_STORED
    assert "start fewer ranks" in finished.sentence
    assert store.inventory(FLAT).missing == FLAT


def test_a_part_that_its_writer_renames_meanwhile_is_left_alone(tmp_path, monkeypatch):
    glob = Path.glob
    gone = tmp_path / ".renamed.part"
    monkeypatch.setattr(Path, "glob", lambda folder, pattern: [*glob(folder, pattern), gone])
    assert leftover_parts(tmp_path) == []


def test_keys_are_made_of_stored_simulations_alone_as_they_take_long(store, monkeypatch):
    fill(store, FLAT[:1])
    many, asked, key = replace(SWEEP, n_realisation=300), [], Simulation.key.fget
    monkeypatch.setattr(Simulation, "key", property(lambda one: asked.append(one) or key(one)))
    assert len(store.inventory(many.simulations()).missing) == many.n_simulation - 1
    assert len(asked) < 10
