"""The store: what belongs stays, what is missing, older or damaged is made again, and no more."""

import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.core.resources import TooLargeError
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.simulate.checksums import (
    DIGITS_IN_NAME,
    MERGED,
    digest_path,
    file_digest,
    is_whole,
    sums_text,
)
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.cycle_files import write_checkpoint
from crackfront.simulate.provenance import Provenance, provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.storage import (
    UnreadableFileError,
    read_dataset,
    write_derived,
    write_named_by_digest,
)
from crackfront.sweep import batches, tasks
from crackfront.sweep.curves import curve_files, write_curves
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import sweep_row
from crackfront.sweep.run_sweep import run_sweep
from crackfront.sweep.store import Store
from tests.commands import done, refused, run, simulated, slow, stored, table
from tests.places import TEST

LINE = Path(__file__).parents[1] / "line-test.yaml"
SWEEP = load_sweep(TEST)
ALL = {item.label for item in SWEEP.simulations()}
pytestmark = pytest.mark.usefixtures("remembered", "empty_figures")
FLAT, ROUGH = ({label for label in ALL if name in label} for name in ("flat", "rough"))


@pytest.fixture
def configuration(tmp_path):
    """The configuration `test`, to be changed."""
    return shutil.copy(TEST, tmp_path / "sweep.yaml")


@pytest.fixture
def folder(made, tmp_path):
    """A copy of the results that were made of it."""
    shutil.copytree(made.folder, tmp_path / "sweep")
    (tmp_path / "sweep/configuration.path").unlink()
    return tmp_path / "sweep"


def change(configuration, *texts):
    """Replace texts of a configuration."""
    content = configuration.read_text(encoding="utf-8")
    for old, new in zip(texts[::2], texts[1::2], strict=True):
        assert old in content
        content = content.replace(old, new)
    configuration.write_text(content, encoding="utf-8")


def simulate(configuration, folder, *more):
    """Labels of the simulations that the command runs."""
    return simulated(done("simulate", configuration, "--output", folder, *more).stdout)


def aggregated(configuration, folder):
    """The table that is made of what a folder has."""
    done("aggregate", configuration, "--output", folder)
    return table(folder / "hysteresis.nc")


def in_batches(configuration, folder):
    """Store simulations in a batch each, as a process leaves them that is killed in the end."""
    sweep, store = load_sweep(configuration), Store(folder)
    shards = [
        (shard, [*sweep.simulations(shard.item, shard.realisations)]) for shard in sweep.shards()
    ]
    for _ in tasks.run_and_store(store, shards, provenance("text"), 0.0):
        pass
    return sweep, store


def raise_version(monkeypatch, name):
    """State a higher version wherever it is looked up; return it."""
    versions = {"PHYSICS_VERSION": PHYSICS_VERSION, "ROWS_VERSION": ROWS_VERSION}
    versions[name] += 1
    for path, module in [*sys.modules.items()]:
        if path.startswith("crackfront") and hasattr(module, name):
            monkeypatch.setattr(module, name, versions[name])
    _, _, *defaults = Provenance.__init__.__defaults__
    monkeypatch.setattr(Provenance.__init__, "__defaults__", (*versions.values(), *defaults))
    return versions[name]


WITHOUT_FLAT = "spectra:\n  -"
WITH_FLAT = "spectra:\n  - {name: flat, short_cutoff: 0.1, hurst: 1.0}\n  -"


@pytest.mark.parametrize(
    ("less", "more", "mark"),
    [
        slow("elastic_energy: [0.02]", "elastic_energy: [0.02, 0.1]", "e_el=0.1"),
        slow(WITHOUT_FLAT, WITH_FLAT, "flat"),
    ],
)
def test_what_is_added_is_all_that_runs_and_the_rest_stays(
    configuration, made, tmp_path, less, more, mark
):
    folder = tmp_path / "sweep"
    change(configuration, more, less)
    assert len(simulate(configuration, folder)) == 4
    before = stored(folder)
    change(configuration, less, more)
    ran = simulate(configuration, folder)
    assert len(ran) == 4
    assert all(mark in label for label in ran)
    assert before.items() < stored(folder).items()
    assert aggregated(configuration, folder).equals(table(made.hysteresis))


@pytest.mark.parametrize(
    ("old", "new"), [("seed: 1", "seed: 2"), slow("tolerance: 1e-6", "tolerance: 1e-7")]
)
def test_what_is_changed_and_changed_back_is_not_mixed_and_runs_once(
    configuration, folder, tmp_path, old, new
):
    first = table(folder / "hysteresis.nc")
    change(configuration, old, new)
    key = old.partition(":")[0]
    assert f"8 with another {key}" in done("plan", configuration, "--output", folder).stdout
    assert "8 of 8 simulations" in refused("aggregate", configuration, "--output", folder)
    assert "another configuration" in refused("fit", configuration, "--output", folder)
    assert len(simulate(configuration, folder)) == 8
    run_sweep(configuration, tmp_path / "alone", progress=False)
    alone = table(tmp_path / "alone/hysteresis.nc")
    assert aggregated(configuration, folder).equals(alone)
    assert not np.any(alone["w_retr"] == first["w_retr"])
    change(configuration, new, old)
    assert simulate(configuration, folder) == set()
    assert aggregated(configuration, folder).equals(first)


def test_blocks_of_realisations_may_change_between_runs(configuration, made, tmp_path):
    folder, count = tmp_path / "sweep", 0
    for blocks in (["--spectrum", "flat", "--realisations", "1-1"], ["--realisations", "0-0"], []):
        ran = simulate(configuration, folder, *blocks)
        assert ran
        count += len(ran)
    assert count == 8
    assert aggregated(configuration, folder).equals(table(made.hysteresis))
    for block in ("0-0", "1-1"):
        assert simulate(configuration, folder, "--realisations", block) == set()
    shutil.rmtree(folder / "curves")
    for path in (folder / "shards").glob("[!.]*t.nc*"):
        path.unlink()  # leaves the blocks of one and the whole of the other
    assert aggregated(configuration, folder).equals(table(made.hysteresis))


def test_a_higher_limit_of_sweeps_runs_again_what_reached_the_lower_one(
    configuration, made, tmp_path
):
    change(configuration, "max_sweeps: 100000", "max_sweeps: 10")
    folder = tmp_path / "sweep"
    output = done("simulate", configuration, "--output", folder).stdout
    stopped = set(re.findall(r"\] (.+?): step_limit", output))
    assert 0 < len(stopped) < 8
    change(configuration, "max_sweeps: 10", "max_sweeps: 100000")
    plan = json.loads(done("plan", configuration, "--output", folder, "--json").stdout)
    assert plan["missing"] == len(stopped)
    assert simulate(configuration, folder) == stopped
    result, expected = aggregated(configuration, folder), table(made.hysteresis)
    assert result.drop_vars("max_sweeps").equals(expected.drop_vars("max_sweeps"))
    change(configuration, "max_sweeps: 100000", "max_sweeps: 10")
    assert simulate(configuration, folder) == set()


def test_a_new_version_of_the_physics_runs_all_again_says_so_and_mixes_nothing(
    configuration, folder, tmp_path, monkeypatch
):
    before, first = stored(folder), table(folder / "hysteresis.nc")
    version = raise_version(monkeypatch, "PHYSICS_VERSION")
    sentence = f"8 stored simulations belong to an older version of the physics (now {version})"
    assert sentence in done("plan", configuration, "--output", folder).stdout
    assert sentence in done("status", folder).stdout
    status = json.loads(done("status", folder, "--json").stdout)
    assert status["reasons_to_run_again"] == [f"{sentence} and run again"]
    assert simulate(configuration, folder, "--spectrum", "flat") == FLAT
    sentence = sentence.replace("8", "4")
    assert sentence in done("plan", configuration, "--output", folder).stdout
    assert "4 of 8 simulations are in no fin" in refused(
        "aggregate", configuration, "--output", folder
    )
    assert simulate(configuration, folder) == ROUGH
    assert "older version" not in done("plan", configuration, "--output", folder).stdout
    assert aggregated(configuration, folder).equals(first)
    after = stored(folder)
    assert after.keys() == before.keys()
    assert not any(after[name] == before[name] for name in before)


def test_states_of_an_older_version_are_removed_with_realisations_that_are_not_asked_for(
    configuration, folder, monkeypatch
):
    change(configuration, "realisations: 2", "realisations: 1")
    raise_version(monkeypatch, "PHYSICS_VERSION")
    assert len(simulate(configuration, folder, "--spectrum", "flat")) == 2
    assert len([*folder.glob("curves/flat/*.nc")]) == 1


def test_a_part_of_a_shard_has_its_part_of_the_costs(made):
    flat = SWEEP.spectra[0]
    [summary] = made.shard_summaries(flat)
    whole, half = (summary.inventory(SWEEP.series(flat), range(n), 1.0) for n in (2, 1))
    assert half.cpu_seconds == pytest.approx(whole.cpu_seconds / 2)
    assert (whole.done, half.done) == (4, 2)


def test_a_new_version_of_rows_remakes_them_from_states_and_runs_nothing(
    configuration, folder, monkeypatch
):
    before = stored(folder)
    raise_version(monkeypatch, "ROWS_VERSION")
    monkeypatch.setattr(
        "crackfront.sweep.finished_shards.sweep_row",
        lambda result: replace(sweep_row(result), w_appr=0.0),
    )
    assert "8 of 8 simulations" in refused("aggregate", configuration, "--output", folder)
    assert simulate(configuration, folder) == set()
    assert stored(folder) == before
    assert np.all(aggregated(configuration, folder)["w_appr"] == 0)


def test_a_column_that_stored_rows_lack_is_made_from_their_states(
    configuration, folder, monkeypatch
):
    first = table(folder / "hysteresis.nc")
    for path in (folder / "curves").glob("*/*.nc"):
        lacking = read_dataset(path).drop_vars("pull_off_force")
        path.unlink()
        write_curves(path.parent, MERGED, path.parent.name, lacking, provenance("text"))
    raise_version(monkeypatch, "ROWS_VERSION")
    assert simulate(configuration, folder) == set()
    made_anew = aggregated(configuration, folder)["pull_off_force"]
    assert made_anew.equals(first["pull_off_force"])


def test_a_simulation_that_fails_is_a_row_is_not_tried_again_and_costs_no_other(
    configuration, made, tmp_path, monkeypatch, remembered
):
    folder, (invalid, defect, *_) = tmp_path / "sweep", SWEEP.simulations()
    errors = {invalid: ValueError("too rough"), defect: DefectError("a jump")}

    def fail(simulation, **options):
        if simulation in errors:
            raise errors[simulation]
        return remembered(simulation, **options)

    change(configuration, "realisations: 2", "realisations: 2\nfailed_fraction: 0.5")
    with monkeypatch.context() as patched:
        patched.setattr(tasks, "run_simulation", fail)
        assert simulate(configuration, folder) == ALL
    assert simulate(configuration, folder) == set()
    assert done("status", folder).stdout.splitlines()[1].split()[:4] == ["flat", "2", "2", "0"]
    told = done("aggregate", configuration, "--output", folder).stderr
    for words in ("2 of 8 simulations", "1 invalid", "too rough", "1 defect", "a jump"):
        assert words in told
    [summary] = Store(folder).shard_summaries(SWEEP.spectra[0])
    assert summary.n_failed.tolist() == [2, 0]
    rows, expected = table(folder / "hysteresis.nc"), table(made.hysteresis)
    with_value = np.isfinite(rows["w_appr"])
    assert np.count_nonzero(with_value) == 6
    assert rows["w_appr"].where(with_value, expected["w_appr"]).equals(expected["w_appr"])


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


def test_what_the_machine_could_not_compute_is_no_row_and_runs_again(
    configuration, tmp_path, monkeypatch
):
    folder = tmp_path / "sweep"
    told = ("simulate", configuration, "--output", folder, "--spectrum", "flat")
    for error in OF_THE_MACHINE.values():

        def fail(*_, error=error, **__):
            raise error

        with monkeypatch.context() as patched:
            patched.setattr(tasks, "run_simulation", fail)
            result = run(*told)
        assert result.exit_code == 1
        [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
        assert str(error) in sentence or "start fewer ranks" in sentence
        assert stored(folder) == {}
    assert simulated(done(*told).stdout) == FLAT


@pytest.mark.parametrize("lacking", ["disk", slow("device"), slow("netCDF")])
def test_what_the_machine_could_not_store_runs_again(
    configuration, made, tmp_path, monkeypatch, lacking
):
    error, folder, write = OF_THE_MACHINE[lacking], tmp_path / "sweep", batches.write_curves

    def fail_after_three(folder, *arguments):
        if len(curve_files(folder)) == 3:
            raise error
        return write(folder, *arguments)

    told = ("simulate", configuration, "--output", folder, "--checkpoint", "0")
    with monkeypatch.context() as patched:
        patched.setattr(batches, "write_curves", fail_after_three)
        result = run(*told)
    assert result.exit_code == 1, result.output
    assert isinstance(result.exception, SystemExit)
    [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    assert str(error) in sentence
    n_stored = len(stored(folder))
    assert n_stored >= 3
    assert len(simulate(configuration, folder)) == 8 - n_stored
    assert aggregated(configuration, folder).equals(table(made.hysteresis))


def test_results_of_several_processors_are_reported(configuration, tmp_path, monkeypatch):
    folder = tmp_path / "sweep"
    with monkeypatch.context() as patched:
        patched.setattr("crackfront.simulate.provenance._arithmetic", lambda: "another")
        patched.setattr(Provenance, "here", lambda origin: replace(origin, arithmetic="another"))
        simulate(configuration, folder, "--spectrum", "flat", "--realisations", "0-0")
    plan = ("plan", configuration, "--output", folder)
    assert "may in their last digits" not in done(*plan).stdout
    simulate(configuration, folder, "--spectrum", "flat")
    words = "stored simulations differ in their origin, and may in their last digits: another; "
    assert words in done(*plan).stdout
    assert len(xr.load_dataset(folder / "shards/flat.nc").arithmetic_of_rows.split("; ")) == 2


def test_plan_and_status_open_shards_and_no_curves_of_finished_ones(configuration, folder):
    os.truncate(damaged_curves := next((folder / "curves/flat").glob("*.nc")), 100)
    plan = done("plan", configuration, "--output", folder)
    assert " 4/4" in plan.stdout
    status = done("status", folder)
    for result in (plan, status, done("simulate", configuration, "--output", folder)):
        assert "damaged" not in result.output
    assert "8 of 8 simulations have ended" in status.stdout
    assert damaged_curves.exists()


SECTOR = 512


def zeroed(content):
    """Content with a sector of zeros, of those that are none the first beyond the middle."""
    first = len(content) // 2 // SECTOR * SECTOR
    while not any(content[first : first + SECTOR]):
        first += SECTOR
    return content[:first] + bytes(SECTOR) + content[first + SECTOR :]


def flipped(content):
    """Content with one bit changed, in the metadata at its beginning."""
    return content[:200] + bytes([content[200] ^ 1]) + content[201:]


HARM = {
    "a zeroed sector": zeroed,
    "a flipped bit": flipped,
    "truncated": lambda content: content[: len(content) // 2],
    "emptied": lambda content: b"",
}


def harm(path, name):
    """Damage a file."""
    path.write_bytes(HARM[name](path.read_bytes()))
    assert not is_whole(path)


def assert_set_aside(path, result):
    """The command has said once that a file is damaged, and renamed it."""
    words = f"{path} is damaged and was set aside as {path.name}.damaged"
    assert result.output.count(words) == 1
    assert path.with_name(f"{path.name}.damaged").exists()
    assert "Traceback" not in result.output


@pytest.mark.parametrize(
    "how", ["a flipped bit", *(slow(name) for name in HARM if name != "a flipped bit")]
)
def test_damaged_curves_are_set_aside_and_computed_again_and_no_others(
    configuration, folder, made, how
):
    before = stored(folder)
    [path] = (folder / "curves/flat").glob("*.nc")
    harm(path, how)
    (folder / "shards/flat.nc").unlink()
    result = done("simulate", configuration, "--output", folder)
    assert_set_aside(path, result)
    assert simulated(result.stdout) == FLAT
    kept = {name for name, seconds in stored(folder).items() if before[name] == seconds}
    assert {name.partition("-")[0] for name in kept} == {"rough"}
    assert aggregated(configuration, folder).equals(table(made.hysteresis))


@pytest.mark.slow
@pytest.mark.parametrize("how", HARM)
def test_a_damaged_batch_costs_its_own_simulations(configuration, made, tmp_path, how):
    folder = tmp_path / "sweep"
    in_batches(configuration, folder)
    path = min((folder / "curves/rough").glob("batch-*.nc"))
    with xr.open_dataset(path) as dataset:
        assert dataset.sizes["simulation"] == 1
    harm(path, how)
    result = done("plan", configuration, "--output", folder)
    assert_set_aside(path, result)
    assert len(ran := simulate(configuration, folder)) == 1
    assert ran < ROUGH
    assert aggregated(configuration, folder).equals(table(made.hysteresis))


@pytest.mark.parametrize(
    ("command", "how"), [("status", "a zeroed sector"), ("aggregate", "a flipped bit")]
)
def test_a_damaged_shard_is_set_aside_and_derived_again_without_simulating(
    configuration, folder, command, how
):
    first = table(folder / "hysteresis.nc")
    path = folder / "shards/rough.nc"
    harm(path, how)
    about = [folder] if command == "status" else [configuration, "--output", folder]
    result = run(command, *about)
    assert_set_aside(path, result)
    assert result.exit_code == (2 if command == "aggregate" else 0)
    assert simulate(configuration, folder) == set()
    assert is_whole(path)
    assert aggregated(configuration, folder).equals(first)


@pytest.mark.parametrize(("command", "how"), [("plan", "truncated"), ("fit", "emptied")])
def test_a_damaged_table_is_set_aside_and_aggregated_again(configuration, folder, command, how):
    path = folder / "hysteresis.nc"
    first = table(path)
    harm(path, how)
    result = run(command, configuration, "--output", folder)
    assert_set_aside(path, result)
    assert result.exit_code == (0 if command == "plan" else 2)
    assert "workflow" in result.stderr
    assert not (folder / "fit.nc").exists()
    assert aggregated(configuration, folder).equals(first)


def store_texts_as_characters(path):
    """Rewrite a file as earlier versions wrote it, with texts as arrays of characters."""
    dataset = xr.load_dataset(path)
    texts = [name for name, values in dataset.variables.items() if values.dtype.kind in "OU"]
    assert texts
    dataset.to_netcdf(path, encoding={name: {"dtype": "S1", "zlib": True} for name in texts})
    return file_digest(path)


@pytest.mark.slow
def test_results_with_texts_as_characters_are_read_and_grow(configuration, made, folder):
    for curves in [*folder.glob("curves/*/*.nc")]:
        digest = store_texts_as_characters(curves)[:DIGITS_IN_NAME]
        curves.rename(curves.with_stem(f"{curves.stem.rpartition('-')[0]}-{digest}"))
    for rows in [*folder.glob("shards/*.nc")]:
        digest_path(rows).write_text(sums_text({rows.name: store_texts_as_characters(rows)}))
    (folder / "hysteresis.nc").unlink()
    before = stored(folder)
    change(configuration, "realisations: 2", "realisations: 3")
    added = simulate(configuration, folder)
    assert len(added) == 4
    assert all("r=2" in label for label in added)
    assert before.items() < stored(folder).items()
    grown = aggregated(configuration, folder).sel(realisation=[0, 1])
    assert grown.equals(table(made.hysteresis))


def test_a_plan_sets_a_damaged_fit_aside_and_a_fit_makes_the_same_again(configuration, folder):
    path = folder / "fit.nc"
    done("fit", configuration, "--output", folder)
    first = xr.load_dataset(path)
    harm(path, "a zeroed sector")
    assert_set_aside(path, done("plan", configuration, "--output", folder))
    done("fit", configuration, "--output", folder)
    assert xr.load_dataset(path).equals(first)


@pytest.mark.parametrize("how", ["missing", "of another file"])
def test_a_shard_without_its_checksum_is_derived_again(configuration, folder, how):
    beside = folder / "shards/flat.nc.sha256"
    if how == "missing":  # as after a kill between both files
        beside.unlink()
    else:
        shutil.copy(folder / "shards/rough.nc.sha256", beside)
    first = table(folder / "shards/flat.nc")
    result = done("simulate", configuration, "--output", folder)
    assert_set_aside(folder / "shards/flat.nc", result)
    assert simulated(result.stdout) == set()
    assert table(folder / "shards/flat.nc").equals(first)


@pytest.mark.parametrize("how", ["truncated", "of another load", "without a front"])
def test_a_checkpoint_that_is_of_no_use_costs_time_and_is_no_refusal(made, tmp_path, how):
    simulation, kept = next(SWEEP.simulations()), []
    run_simulation(simulation, keep=lambda make: kept.append(make()))
    store, [shard, _] = Store(tmp_path), SWEEP.shards()
    folder, name = store.curve_folder(shard), f"checkpoint-{simulation.stem}"
    path = write_checkpoint(folder, name, kept[3], provenance())
    if how in HARM:
        harm(path, how)
    else:
        dataset = xr.load_dataset(path)
        path.unlink()
        later = dataset.assign(penetration=dataset["penetration"] + 0.5)
        wrong = later if how == "of another load" else dataset.drop_vars("turning_front")
        write_named_by_digest(folder, name, wrong, provenance())
    [(_, outcome)] = tasks.run_and_store(store, [(shard, [simulation])], provenance("text"))
    assert outcome.status == "lost_contact"
    assert outcome.sentence.startswith("begun anew without its checkpoint: ")
    force, expected = (item.result(SWEEP, simulation).record.states.force for item in (store, made))
    assert force.tobytes() == expected.tobytes()
    assert not [*folder.glob("checkpoint-*.nc")]
    assert len([*folder.glob("checkpoint-*.nc.damaged")]) == 1


@pytest.mark.parametrize(
    ("name", "value"), [("w_appr", 9.97e36), ("w_retr", -1e3), ("e_el", 9.97e36)]
)
def test_a_fit_rejects_rows_with_values_that_no_contact_can_have(folder, name, value):
    path = folder / "hysteresis.nc"
    dataset = read_dataset(path)
    dataset[name][1, 0, 1] = value
    write_derived(path, dataset, provenance())
    sentence = refused("fit", TEST, "--output", folder)
    assert f"{name} is up to" in sentence
    assert "aggregate the sweep again" in sentence
    assert not (folder / "fit.nc").exists()


MADE = {"shard-flat": "shards/flat.nc", "shard-rough": "shards/rough.nc"}
MADE |= {"table": "hysteresis.nc", "fit": "fit.nc"}


def test_each_stage_writes_what_it_was_asked_for_before_its_results_and_removes_what_it_was(
    configuration, folder
):
    earlier = {path.name for path in (folder / "requests").iterdir()}
    change(configuration, "realisations: 2", "realisations: 1")
    for command in ("simulate", "aggregate", "fit"):
        done(command, configuration, "--output", folder)
    names = {path.name for path in (folder / "requests").iterdir()}
    assert len(names) == len(MADE)
    assert names.isdisjoint(earlier)
    for stage, name in MADE.items():
        digest = xr.load_dataset(folder / name).attrs["request"]
        request = folder / "requests" / f"{stage}-{digest}.txt"
        assert request.stat().st_mtime_ns < (folder / name).stat().st_mtime_ns
    change(configuration, "highest_elastic_energy: 0.1", "highest_elastic_energy: 0.05")
    done("fit", configuration, "--output", folder)
    replaced = names - {path.name for path in (folder / "requests").iterdir()}
    assert {name.partition("-")[0] for name in replaced} == {"fit"}


def test_two_configurations_of_one_name_in_two_folders_do_not_share_results(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, seed in (("a", 1), ("b", 2)):
        Path(name).mkdir()
        shutil.copy(TEST, f"{name}/sweep.yaml")
        change(Path(name, "sweep.yaml"), "seed: 1", f"seed: {seed}")
    simulate("a/sweep.yaml", "results/sweep", "--spectrum", "flat", "--realisations", "0-0")
    for command in ("plan", "simulate", "aggregate", "fit"):
        sentence = refused(command, "b/sweep.yaml")
        assert "results/sweep has the results of a/sweep.yaml, another configuration" in sentence
    shutil.move("a", "moved")
    done("plan", "b/sweep.yaml")


def test_results_in_the_layout_of_an_older_version_are_refused_and_left_alone(folder):
    (folder / "curves/flat.0-1.host-1-ab.tar").write_bytes(b"")
    before = sorted(folder.rglob("*"))
    for command in ("plan", "simulate", "aggregate", "fit"):
        sentence = refused(command, TEST, "--output", folder)
        assert "in the layout of an older version" in sentence
        assert "start a new folder" in sentence
    assert "start a new folder" in refused("status", folder)
    assert sorted(folder.rglob("*")) == before


RECORDED = "realisations: 2", "realisations: 1\nrecord: [fronts, energy]"


@pytest.mark.parametrize("original", [slow(TEST), LINE])
def test_recorded_fronts_and_energies_survive_batches_and_merging_to_the_last_bit(
    tmp_path, monkeypatch, remembered, original
):
    configuration, folder = shutil.copy(original, tmp_path / "sweep.yaml"), tmp_path / "sweep"
    change(configuration, *RECORDED)
    failing, *simulations = load_sweep(configuration).simulations()

    def fail(simulation, **options):
        if simulation == failing:
            raise ValueError("too rough")
        return remembered(simulation, **options)

    monkeypatch.setattr(tasks, "run_simulation", fail)
    sweep, store = in_batches(configuration, folder)
    expected = [remembered(simulation).record for simulation in simulations]
    for kind in ("batch", "curves"):
        files = {path.name.partition("-")[0] for path in (folder / "curves").glob("*/*.nc")}
        assert files == {kind}
        for simulation, record in zip(simulations, expected, strict=True):
            assert same(store.result(sweep, simulation).record, record)
            assert record.fronts.shape[0] == record.dissipated_energy.size > 1
        with pytest.raises(UnreadableFileError, match="which failed"):
            store.result(sweep, failing)
        assert simulate(configuration, folder) == set()


@pytest.mark.slow
def test_batches_that_a_kill_left_beside_the_merged_file_are_removed(configuration, tmp_path):
    folder = tmp_path / "sweep"
    change(configuration, "realisations: 2", "realisations: 1")
    in_batches(configuration, folder)
    batches = {path: path.read_bytes() for path in folder.glob("curves/*/batch-*.nc")}
    assert simulate(configuration, folder) == set()
    expected = aggregated(configuration, folder)
    assert len(batches) == 4
    assert len([*folder.glob("curves/*/*.nc")]) == 2
    for path, content in batches.items():
        path.write_bytes(content)
    for path in folder.glob("shards/*.nc"):
        path.unlink()
    assert simulate(configuration, folder) == set()
    assert aggregated(configuration, folder).equals(expected)
    assert len([*folder.glob("curves/*/*.nc")]) == 2


def same(record, expected):
    """Whether two records, or parts of them, agree in every bit."""
    if is_dataclass(record):
        names = [field.name for field in fields(record)]
        return all(same(getattr(record, name), getattr(expected, name)) for name in names)
    if isinstance(record, np.ndarray):
        return record.dtype == expected.dtype and record.tobytes() == expected.tobytes()
    return record == expected


def test_recorded_fronts_are_written_before_they_fill_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(batches, "_MOST_WAITING_BYTES", 1)
    shard = SWEEP.shards()[0]
    runs = [replace(run, record_fronts=True) for run in SWEEP.simulations(shard.item)]
    store = Store(tmp_path)
    outcomes = tasks.run_and_store(store, [(shard, runs)], provenance("text"), 1e6)
    next(outcomes)
    assert len(curve_files(store.curve_folder(shard))) == 1
    outcomes.close()


def test_the_longest_simulations_start_first(tmp_path, monkeypatch):
    def fail(*_, **__):
        raise ValueError("too rough")

    monkeypatch.setattr(tasks, "run_simulation", fail)
    shard = SWEEP.shards()[0]
    runs = [*SWEEP.simulations(shard.item)][::-1]
    ended = tasks.run_and_store(Store(tmp_path), [(shard, runs)], provenance("text"))
    costs = [expected_cost(simulation).seconds for simulation, _ in ended]
    assert costs == sorted(costs, reverse=True)


_STARTS = """
import os, sys
from pathlib import Path
from crackfront.simulate.provenance import provenance
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
def test_fifty_starts_in_one_instant_do_not_meet(tmp_path):
    store = Store(tmp_path)
    command = [sys.executable, "-c", _STARTS, str(store.folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
    assert store.configuration.read_text(encoding="utf-8").startswith("text")
    assert not list(store.folder.rglob(".*.part"))
