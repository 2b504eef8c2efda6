"""The store: what is finished stays, what is missing or broken is found and run."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from crackfront.data.packs import members, record
from crackfront.sweep.result_packs import RowIndex, pack_paths
from numba.core.errors import NumbaError

from crackfront.cli import main
from crackfront.cli.results import _loop_example
from crackfront.core.outcome import DefectError
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.data.bounds import TooLargeError
from crackfront.data.files import read_dataset
from crackfront.data.provenance import provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import write_checkpoint
from crackfront.simulate.run import run_simulation
from crackfront.sweep import tasks
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.store import Store
from tests.commands import curves

TEST = Path(__file__).parents[2] / "config/test.yaml"
SWEEP = load_configuration(TEST)
FLAT = tuple(SWEEP.simulations(SWEEP.spectra[0]))


@pytest.fixture
def store(tmp_path):
    """An empty store."""
    return Store(tmp_path / "sweep")


@pytest.fixture
def whole(made, store):
    """A copy of the store that was made."""
    shutil.copytree(made.folder, store.folder)
    return store


def run_and_store(store, simulations):
    """Fill a store and return how the simulations ended."""
    return list(tasks.run_and_store(store, simulations, provenance("text")))


def finish(store, sweep):
    """Run a whole sweep to the file of its rows."""
    for shard in sweep.shards():
        run_and_store(store, list(sweep.simulations(shard.item, shard.realisations)))
        store.finish_shard(sweep, shard, provenance("text"))
    store.aggregate(sweep, provenance("text"))


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    """A store with the same of a sweep of another seed."""
    store = Store(tmp_path_factory.mktemp("other") / "sweep")
    finish(store, replace(SWEEP, seed=SWEEP.seed + 1))
    return store


def without(store, *names):
    """Take files out of the packs of a store, by the ends of their names."""
    for path in pack_paths(store.curves):
        kept = [one for one in members(path)[0] if not one.name.endswith(names)]
        path.write_bytes(b"".join(record(one.name, one.content()) for one in kept))


def flip_curve(store, simulation, place=0.5):
    """Change one bit of a curve."""
    [member] = RowIndex(store.curves, simulation.spectrum_name, range(9)).curves(simulation.stem)
    flip(member.path, (member.place + place * member.size + 0.5) / member.path.stat().st_size)
    return member


def test_a_filled_store_lacks_nothing_and_holds_one_curve_a_simulation_in_one_file(store):
    outcomes = run_and_store(store, FLAT)
    assert {finished.status for _, finished in outcomes} == {"lost_contact"}
    assert {simulation for simulation, _ in outcomes} == set(FLAT)
    assert store.inventory(FLAT).missing == ()
    assert len(list(store.curves.iterdir())) == 1
    assert set(curves(store.folder)) == {f"{simulation.stem}.nc" for simulation in FLAT}


def test_the_longest_simulations_start_first(store):
    costs = [
        expected_cost(simulation).seconds for simulation, _ in run_and_store(store, FLAT[::-1])
    ]
    assert costs == sorted(costs, reverse=True)


def test_a_simulation_is_stored_before_the_next_one_starts(store):
    filling = tasks.run_and_store(store, FLAT, provenance())
    first, _ = next(filling)
    assert set(curves(store.folder)) == {f"{first.stem}.nc"}


def test_added_realisations_are_all_that_is_missing(store):
    run_and_store(store, FLAT)
    before = curves(store.folder)
    more = replace(SWEEP, n_realisation=3)
    missing = store.inventory(more.simulations(more.spectra[0])).missing
    assert {simulation.realisation for simulation in missing} == {2}
    run_and_store(store, missing)
    assert before.items() < curves(store.folder).items()


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"solver": replace(FLAT[0].solver, tolerance=1e-7)}, "tolerance"),
        ({"sweep_seed": 2}, "seed"),
        ({"solver": replace(FLAT[0].solver, tolerance=1e-6)}, "tolerance"),
    ],
)
def test_what_is_stale_is_told_with_what_has_changed(store, change, part):
    run_and_store(store, FLAT[:2])
    inventory = store.inventory([replace(FLAT[0], **change), FLAT[1]])
    assert inventory.missing[0].label == FLAT[0].label
    assert inventory.stale_sentence() == f"1 stored simulations are stale: 1 as {part} changed"
    assert store.inventory(FLAT).stale_sentence() == ""


def test_the_reason_is_by_the_stored_key_that_is_nearest(store):
    other = replace(FLAT[0], sweep_seed=2, solver=replace(FLAT[0].solver, tolerance=1e-7))
    for stored in (FLAT[0], other):
        run_and_store(store, [stored])
    for near in (FLAT[0], other):
        sentence = store.inventory([replace(near, sweep_seed=3)]).stale_sentence()
        assert sentence == "1 stored simulations are stale: 1 as seed changed"


def test_a_new_version_of_the_physics_runs_all_again_and_says_so(store, monkeypatch):
    run_and_store(store, FLAT[:2])
    for module in ("store", "result_packs"):
        monkeypatch.setattr(f"crackfront.sweep.{module}.PHYSICS_VERSION", PHYSICS_VERSION + 1)
    inventory = store.inventory(FLAT)
    assert len(inventory.missing) == 4
    assert inventory.stale_sentence() == (
        "2 stored simulations are stale: 2 as version of the physics (now 2) changed"
    )


def test_spectra_of_one_shape_and_two_names_have_rows_of_their_own(store, monkeypatch):
    def refuse(*_, **__):
        raise ValueError("too rough")

    twins = [FLAT[0], replace(FLAT[0], spectrum_name="twin")]
    assert twins[0].key == twins[1].key
    monkeypatch.setattr(tasks, "run_simulation", refuse)
    run_and_store(store, twins)
    rows = [held.row for held in store.stored_results(twins)]
    assert [row.status for row in rows] == ["refused", "refused"]


def test_a_curve_without_a_row_counts(store):
    run_and_store(store, FLAT)
    without(store, ".json")
    assert store.inventory(FLAT).missing == ()


def test_a_row_without_its_curve_does_not_count(store):
    run_and_store(store, FLAT)
    without(store, f"{FLAT[2].stem}.nc")
    assert store.inventory(FLAT).missing == (FLAT[2],)


def test_what_a_job_reads_before_it_starts_is_that_of_its_own_block(whole, monkeypatch):
    read = []
    monkeypatch.setattr(
        "crackfront.sweep.result_packs.members", lambda path: (read.append(path), members(path))[1]
    )
    more = replace(SWEEP, n_realisation=3)
    assert len(whole.inventory(more.simulations(more.spectra[0], range(2, 3))).missing) == 2
    assert read == []
    assert whole.inventory(FLAT[:1]).missing == ()
    assert [path.name.partition(".")[0] for path in read] == ["flat"]


def test_a_failed_simulation_is_stored_with_its_status(store):
    limited = replace(FLAT[0], solver=replace(FLAT[0].solver, max_sweeps=1))
    [(_, finished)] = run_and_store(store, [limited])
    assert finished.status == "step_limit"
    assert store.result(limited).record.status.name == "STEP_LIMIT"
    assert store.inventory([limited]).missing == ()


def test_a_simulation_that_cannot_be_done_is_a_row_and_is_not_tried_again(store):
    impossible = replace(FLAT[0], elastic_energy=0.999999, sweep_seed=5)
    energies = [replace(impossible, realisation=number) for number in range(8)]
    outcomes = run_and_store(store, [*energies, FLAT[0]])
    refused = [one for one, finished in outcomes if finished.status == "refused"]
    assert refused
    assert not {f"{one.stem}.nc" for one in refused} & set(curves(store.folder))
    assert store.inventory([*energies, FLAT[0]]).missing == ()
    rows = [held.row for held in store.stored_results(refused)]
    assert {row.status for row in rows} == {"refused"}
    for row in rows:
        assert "full conformity needs less than w_int" in row.status_sentence
        assert np.isnan(row.w_appr)


OF_THE_MACHINE = {
    "memory": MemoryError(),
    "memory at hand": TooLargeError("tiles would need 1 TB of memory"),
    "disk": OSError(28, "No space left on device"),
    "quota": OSError(122, "Disk quota exceeded"),
    "device": OSError(5, "Input/output error"),
    "thread": RuntimeError("can't start new thread"),
    "netCDF": RuntimeError("NetCDF: HDF error"),
    "compiler": NumbaError("out of memory"),
}


@pytest.mark.parametrize("lacking", OF_THE_MACHINE)
@pytest.mark.parametrize("place", ["run_simulation", "dataset_content"])
def test_what_the_machine_could_not_do_is_never_stored_as_what_physics_did(
    store, monkeypatch, lacking, place
):
    error = OF_THE_MACHINE[lacking]

    def fail(*_, **__):
        raise error

    with monkeypatch.context() as patched:
        patched.setattr(tasks, place, fail)
        with pytest.raises(tasks.NotStoredError, match="; 0 of 2 simulations were st") as caught:
            run_and_store(store, FLAT[:2])
    assert str(error) in str(caught.value) or "start fewer ranks" in str(caught.value)
    assert store.inventory(FLAT[:2]).missing == FLAT[:2]
    assert {finished.status for _, finished in run_and_store(store, FLAT[:2])} == {"lost_contact"}


def test_an_incomplete_sweep_is_not_aggregated(store):
    run_and_store(store, FLAT[1:])
    flat, rough = SWEEP.shards()
    with pytest.raises(ValueError, match=r"1 of 4 simulations are missing .*, the first is flat"):
        store.finish_shard(SWEEP, flat, provenance())
    run_and_store(store, list(SWEEP.simulations(rough.item)))
    store.finish_shard(SWEEP, rough, provenance())
    with pytest.raises(ValueError, match="4 of 8 simulations are in no finished shard"):
        store.aggregate(SWEEP, provenance())
    assert not (store.folder / "hysteresis.nc").exists()


@pytest.mark.parametrize("block", [1, 2])
def test_a_sweep_is_aggregated_from_the_files_of_its_shards_alone_whatever_the_blocks(
    store, made, block
):
    shutil.copytree(made.curves, store.curves)
    for shard in SWEEP.shards(block):
        store.finish_shard(SWEEP, shard, provenance("text"))
    shutil.rmtree(store.curves)
    whole = read_dataset(store.aggregate(SWEEP, provenance("text")))
    assert whole.drop_attrs().identical(read_dataset(made.hysteresis).drop_attrs())
    assert [*whole["curve"].values.flat] == [f"{one.stem}.nc" for one in SWEEP.simulations()]


@pytest.mark.slow
def test_a_table_is_written_in_less_memory_than_its_rows_take(tmp_path):
    script = """
import resource, sys
from dataclasses import fields, replace
from pathlib import Path
import netCDF4, numpy as np
from crackfront.analysis.table import SweepRow
from crackfront.data.provenance import provenance
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.table import write_hysteresis

KINDS = {"float": float, "int": np.int64, "str": "S40"}

def write(n_realisation):
    sweep = replace(load_configuration(Path(sys.argv[1])), n_realisation=n_realisation)
    shape = 1, len(sweep.elastic_energies), n_realisation
    kinds = {one.name: KINDS[one.type] for one in fields(SweepRow)} | {"status": np.int8}
    parts = [[{name: np.zeros(shape, kind) for name, kind in kinds.items()}] for _ in sweep.spectra]
    for [columns] in parts:
        for values in columns.values():
            values.fill(1)
    size = sum(one.nbytes for [columns] in parts for one in columns.values())
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    write_hysteresis(Path(sys.argv[2]), sweep, parts, provenance())
    return 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / size

cache = netCDF4.get_chunk_cache()
write(10)
print(write(50_000))
assert netCDF4.get_chunk_cache() == cache
"""
    command = [sys.executable, "-c", script, str(TEST), str(tmp_path / "hysteresis.nc")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
    assert float(done.stdout) < 1  # beside the rows themselves


def test_rows_that_stand_in_two_files_count_once(made, store):
    shutil.copytree(made.folder, store.folder)
    for shard in SWEEP.shards(1)[:2]:
        store.finish_shard(SWEEP, shard, provenance())
    found = store.progress(SWEEP, SWEEP.spectra[0])
    assert (found.done, found.failed, found.missing) == (4, 0, ())
    whole = read_dataset(store.aggregate(SWEEP, provenance("text")))
    assert whole.equals(read_dataset(made.hysteresis))


def test_a_row_that_is_lost_is_made_of_its_curve(store, made):
    shutil.copytree(made.curves, store.curves)
    without(store, ".json")
    for shard in SWEEP.shards():
        store.finish_shard(SWEEP, shard, provenance())
    whole = read_dataset(store.aggregate(SWEEP, provenance("text")))
    assert whole.equals(read_dataset(made.hysteresis))


def test_what_a_killed_process_left_half_written_is_removed_by_the_next_run(store):
    run_and_store(store, FLAT[:1])
    old, new = (store.folder / "curves" / f".{name}.part" for name in ("old", "new"))
    for path in (old, new):
        path.write_text("half")
    moment = old.stat().st_mtime - 7200
    os.utime(old, (moment, moment))
    run_and_store(store, FLAT[1:2])
    assert not old.exists()
    assert new.exists()


def test_a_defect_that_the_solver_finds_in_itself_is_a_row_and_the_others_run(store, monkeypatch):
    def defective(simulation, **options):
        if simulation == FLAT[1]:
            raise DefectError("the solver moved a site past its equilibrium")
        return run_simulation(simulation, **options)

    monkeypatch.setattr(tasks, "run_simulation", defective)
    ended = {
        one: (finished.status, finished.sentence)
        for one, finished in run_and_store(store, FLAT[:3])
    }
    assert ended.pop(FLAT[1]) == ("defect", "the solver moved a site past its equilibrium")
    assert {status for status, _ in ended.values()} == {"lost_contact"}


_STARTS = """
import os, sys
from pathlib import Path
from crackfront.data.provenance import provenance
from crackfront.sweep.store import Store
from crackfront.sweep.tasks import run_and_store

store, origin = Store(Path(sys.argv[1])), provenance("text")
signal, hold = os.pipe()
starts = []
for _ in range(50):
    starts.append(os.fork())
    if starts[-1] == 0:
        os.close(hold)
        os.read(signal, 1)
        list(run_and_store(store, [], origin))
        os._exit(0)
os.close(hold)
sys.exit(any([os.waitpid(start, 0)[1] for start in starts]))
"""
"""Processes that have all imported and wait for one signal, the end of a pipe."""


@pytest.mark.slow
def test_fifty_starts_in_one_instant_do_not_meet(store):
    command = [sys.executable, "-c", _STARTS, str(store.folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
    assert store.configuration.read_text(encoding="utf-8").startswith("text")
    assert not list(store.folder.rglob(".*.part"))


def flip(path, place=0.5):
    """Change one bit of a file."""
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= 16
    path.write_bytes(content)


@pytest.mark.parametrize("rows", [True, False])
@pytest.mark.parametrize("place", [0.0, 0.3, 0.6, 0.999])
def test_a_curve_with_a_flipped_bit_is_named_and_computed_anew(whole, rows, place):
    expected = [held.row for held in whole.stored_results(FLAT)]
    if not rows:
        without(whole, ".json")
    member = flip_curve(whole, FLAT[1], place)
    inventory = whole.inventory(FLAT)
    assert inventory.missing == (FLAT[1],)
    [sentence] = inventory.unreadable
    assert str(member) in sentence
    assert "is damaged, its checksum is wrong" in sentence
    run_and_store(whole, inventory.missing)
    found = [held.row for held in whole.stored_results(FLAT)]
    assert [row.w_retr for row in found] == [row.w_retr for row in expected]


def test_a_valid_file_of_another_simulation_is_not_believed(store):
    run_and_store(store, FLAT[:2])
    first, second = (f"{one.stem}.nc" for one in FLAT[:2])
    [path], content = pack_paths(store.curves), curves(store.folder)[first]
    path.write_bytes(record(first, content) + record(second, content))
    inventory = store.inventory(FLAT[:2])
    assert inventory.missing == (FLAT[1],)
    assert "is not the result of" in inventory.unreadable[0]


def damaging(checkpoint):
    """What a checkpoint may be: damaged, cut, of another load, or no netCDF at all."""
    content = checkpoint.read_bytes()
    yield content[:200] + bytes([content[200] ^ 1]) + content[201:]
    yield content[: len(content) // 2]
    with xr.open_dataset(checkpoint) as dataset:
        wrong = dataset.load()
    wrong["penetration"] = wrong["penetration"] + 0.5
    wrong.to_netcdf(checkpoint)
    yield checkpoint.read_bytes()
    wrong.drop_vars("turning_front").to_netcdf(checkpoint)
    yield checkpoint.read_bytes()
    yield b"text"


def test_a_checkpoint_that_is_of_no_use_costs_time_and_no_refusal_is_stored(store):
    run_and_store(store, FLAT[:1])
    [expected] = [held.row for held in store.stored_results(FLAT[:1])]
    kept = []
    run_simulation(FLAT[0], keep=lambda make: kept.append(make()))
    path = store.checkpoint(FLAT[0])
    write_checkpoint(path, kept[3], provenance())
    for content in list(damaging(path)):
        shutil.rmtree(store.folder)
        path.parent.mkdir(parents=True)
        path.write_bytes(content)
        [(_, finished)] = run_and_store(store, FLAT[:1])
        assert finished.status == "lost_contact"
        assert finished.sentence.startswith("begun anew without its checkpoint: ")
        [held] = store.stored_results(FLAT[:1])
        assert held.row.w_appr == expected.w_appr
        assert held.row.iterations == expected.iterations
        assert not path.exists()


def test_nothing_is_taken_back_of_a_store_that_is_whole(whole, tmp_path):
    assert list(whole.repair(tmp_path / "none.yaml")) == []
    assert len(list((whole.folder / "shards").glob("*.nc"))) == 2


@pytest.mark.parametrize("damage", ["flipped", "removed"])
def test_the_shard_of_a_curve_that_is_damaged_or_gone_is_taken_back(whole, tmp_path, damage):
    [path, _] = pack_paths(whole.curves)
    flip_curve(whole, FLAT[0]) if damage == "flipped" else without(whole, f"{FLAT[0].stem}.nc")
    told = list(whole.repair(tmp_path / "none.yaml"))
    assert any(f"{path} is damaged" in line for line in told) == (damage == "flipped")
    assert "flat.nc is made anew, as it lacks 1 curve of its simulations" in told[-1]
    assert [path.name for path in (whole.folder / "shards").glob("flat*")] == []


def test_the_table_of_another_configuration_is_refused(whole):
    other = replace(SWEEP, fit=replace(SWEEP.fit, n_bootstrap=7))
    assert whole.table(other).w_appr.shape == (2, 2, 2)
    with pytest.raises(ValueError, match="is the table of another configuration than the one gi"):
        whole.table(replace(SWEEP, n_realisation=1))


def command(*arguments):
    """Exit code and output of a command."""
    result = CliRunner().invoke(main, [*map(str, arguments)])
    return result.exit_code, result.output


def test_the_loop_that_is_drawn_is_one_with_a_value(whole, tmp_path):
    """What is refused or a defect has no curve, and the next realisation is drawn."""
    table = whole.table(SWEEP)
    first = _loop_example(SWEEP, table)
    place = [item.name for item in SWEEP.spectra].index(first.spectrum_name)
    amplitude = SWEEP.elastic_energies.index(first.elastic_energy)
    gone = np.array(table.w_retr)
    gone[place, amplitude, 0] = np.nan
    second = _loop_example(SWEEP, replace(table, w_retr=gone))
    assert (first.realisation, second.realisation) == (0, 1)
    assert replace(second, realisation=0).label == first.label
    gone[place, amplitude] = np.nan
    third = _loop_example(SWEEP, replace(table, w_retr=gone))
    assert third.spectrum_name == first.spectrum_name
    assert third.elastic_energy != first.elastic_energy
