"""The store: what is finished stays, what is missing or broken is found and run."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from crackfront import store as stores
from crackfront.config import load_configuration
from crackfront.dataset import read_simulation, read_table
from crackfront.provenance import provenance
from crackfront.store import Store

SWEEP = load_configuration(Path(__file__).parents[1] / "config/test.yaml")
FLAT = SWEEP.shard(SWEEP.spectra[0])


@pytest.fixture
def store(tmp_path):
    """An empty store."""
    return Store(tmp_path / "sweep")


def fill(store, simulations):
    """Fill a store and return how the simulations ended."""
    return list(store.fill(simulations, provenance("text")))


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
    costs = [simulation.expected_cost for simulation, _ in fill(store, FLAT[::-1])]
    assert costs == sorted(costs, reverse=True)


def test_a_simulation_is_stored_before_the_next_one_starts(store):
    filling = store.fill(FLAT, provenance())
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
    monkeypatch.setattr("crackfront.scene.parameters.scene_fingerprint", lambda: "newer")
    assert store.inventory(FLAT[:1]).missing == FLAT[:1]


def test_a_failed_simulation_is_stored_with_its_status(store):
    limited = replace(FLAT[0], max_sweeps=1)
    [(_, finished)] = fill(store, [limited])
    assert finished.status == "step_limit"
    assert read_simulation(store.path(limited), limited).record.status.name == "STEP_LIMIT"
    assert store.inventory([limited]).missing == ()


def test_what_prevents_a_simulation_is_a_sentence_and_the_others_run(store):
    impossible = replace(FLAT[0], elastic_energy=0.999999, sweep_seed=5)
    energies = [replace(impossible, realisation=number) for number in range(8)]
    outcomes = fill(store, [*energies, FLAT[0]])
    errors = [finished.error for _, finished in outcomes if finished.error]
    assert errors
    assert all("full conformity needs less than w_int" in error for error in errors)
    assert store.path(FLAT[0]).exists()


def test_a_full_disk_is_a_sentence(store, monkeypatch):
    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(stores, "write_simulation", fail)
    [(_, finished)] = fill(store, FLAT[:1])
    assert "No space left on device" in finished.error


def test_a_manifest_lists_the_files_of_a_spectrum(store):
    path = store.write_manifest(SWEEP.spectra[0], FLAT)
    content = json.loads(path.read_text(encoding="utf-8"))
    assert [entry["key"] for entry in content["simulations"]] == [one.key for one in FLAT]
    assert store.folder / content["simulations"][0]["file"] == store.path(FLAT[0])


def test_an_incomplete_sweep_is_not_aggregated(store):
    fill(store, FLAT[1:])
    with pytest.raises(ValueError, match=r"5 of 8 simulations are missing .*, the first is fl"):
        store.aggregate(SWEEP, provenance())
    assert not (store.folder / "hysteresis.nc").exists()


def test_the_list_of_a_spectrum_with_a_truncated_file_is_taken_back(store):
    for item in SWEEP.spectra:
        fill(store, SWEEP.shard(item))
        store.write_manifest(item, SWEEP.shard(item))
    store.path(FLAT[0]).write_bytes(b"half")
    with pytest.raises(ValueError, match="1 of 8 simulations are missing or unreadable"):
        store.aggregate(SWEEP, provenance())
    assert [path.name for path in (store.folder / "shards").iterdir()] == ["rough.json"]


def test_a_complete_sweep_is_aggregated(store):
    fill(store, [one for item in SWEEP.spectra for one in SWEEP.shard(item)])
    path, statuses = store.aggregate(SWEEP, provenance("text"))
    assert statuses == {"lost_contact": 8}
    assert read_table(path).w_appr.shape == (2, 2, 2)


def test_a_defect_that_the_solver_finds_in_itself_does_not_end_the_sweep(store, monkeypatch):
    def defective(simulation):
        raise RuntimeError("the solver moved a site past its equilibrium")

    monkeypatch.setattr(stores, "run_simulation", defective)
    ended = [finished.error for _, finished in fill(store, FLAT[:2])]
    assert ended == ["the solver moved a site past its equilibrium"] * 2
