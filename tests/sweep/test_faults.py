"""Faults that happen to processes: nothing stored is lost, and the table is the undisturbed one."""

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest
import xarray as xr

from crackfront.cli import main
from crackfront.simulate.checksums import is_whole
from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep.curves import curve_files
from crackfront.sweep.run_sweep import run_sweep
from tests.commands import done, simulated, slow, stored, table
from tests.commands import run as run_command
from tests.places import TEST

N_SIMULATION = 8
BATCH_SECONDS = "0.1"
"""Time between batches, less than that of a simulation."""


def command(configuration, folder, *more):
    """The command that fills a folder."""
    start = [sys.executable, "-m", "crackfront", "simulate", str(configuration)]
    return [*start, "--output", str(folder), *more]


def run(*arguments):
    """Result of a command."""
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    return subprocess.run(
        arguments, capture_output=True, text=True, timeout=600, check=False, env=environment
    )


def continued(configuration, folder):
    """How many simulations the same command runs now; then the sweep is complete."""
    before = stored(folder)
    done("simulate", configuration, "--output", folder)
    after = stored(folder)
    assert len(after) == N_SIMULATION
    return sum(before.get(name) != seconds for name, seconds in after.items())


@contextmanager
def running(configuration, folder, *more, until=3):
    """A run in a process of its own that has stored some simulations."""
    with subprocess.Popen(
        command(configuration, folder, "--checkpoint", BATCH_SECONDS, *more),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        process_group=0,
    ) as process:
        for line in process.stdout:
            if line.startswith(f"[{until}/"):
                break
        yield process


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A configuration whose simulations last until they are killed, and its undisturbed folder."""
    folder = tmp_path_factory.mktemp("undisturbed")
    text = TEST.read_text(encoding="utf-8")
    text = text.replace("angles: 128", "angles: 256")
    configuration = folder / "sweep.yaml"
    configuration.write_text(text.replace("step: 0.1", "step: 0.05"))
    run_sweep(configuration, folder / "alone", progress=False)
    return configuration, folder / "alone"


@pytest.fixture
def configuration(undisturbed):
    """The configuration of the runs that are killed."""
    return undisturbed[0]


@pytest.fixture
def same(undisturbed):
    """Whether the table of what a folder has is the undisturbed one."""
    return lambda folder: _same_table(*undisturbed, folder)


def _same_table(configuration, alone, folder):
    """Whether two folders of a configuration have the same table; that of the second is made."""
    done("aggregate", configuration, "--output", folder)
    return table(folder / "hysteresis.nc").equals(table(alone / "hysteresis.nc"))


@contextmanager
def forked(configuration, folder, *more, until):
    """Number of a fork of this process that runs a sweep, once it has stored some simulations."""
    reading, writing = os.pipe()
    told = ["simulate", configuration, "--output", folder, *more]
    process = os.fork()
    if process == 0:
        try:
            sys.stdout = os.fdopen(writing, "w", buffering=1, encoding="utf-8")
            main([str(word) for word in told])
        finally:
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as printed:
        assert any(line.startswith(f"[{until}/") for line in printed)
        try:
            yield process
        finally:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)


# Threads of what runs the tests are not in the fork.
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_a_kill_at_any_moment_costs_what_is_in_no_batch_and_corrupts_nothing(made, tmp_path, rng):
    n_finished = int(rng.integers(1, 3))
    # Each simulation takes longer and is a batch, which is written before its line is printed.
    with forked(TEST, tmp_path, "--checkpoint", "0.01", until=n_finished):
        time.sleep(rng.uniform(0, 0.05))
    assert_whole(tmp_path)
    kept = stored(tmp_path)
    assert n_finished <= len(kept) < N_SIMULATION
    assert continued(TEST, tmp_path) == N_SIMULATION - len(kept)
    assert kept.items() <= stored(tmp_path).items()
    assert_tidy(tmp_path)
    assert _same_table(TEST, made.folder, tmp_path)


@pytest.mark.slow
def test_ten_kills_at_random_moments_lose_nothing_that_was_stored(
    configuration, same, tmp_path, rng
):
    kept, folder = {}, tmp_path / "sweep"
    told = command(configuration, folder, "--checkpoint", BATCH_SECONDS)
    for _ in range(10):
        with subprocess.Popen(told, stdout=subprocess.DEVNULL, process_group=0) as process:
            try:
                process.wait(rng.uniform(1, 3))
            except subprocess.TimeoutExpired:
                process.kill()
        assert_whole(folder)
        assert kept.items() <= (kept := stored(folder)).items()
    assert continued(configuration, folder) == N_SIMULATION - len(kept)
    assert_tidy(folder)
    assert same(folder)


def assert_whole(folder):
    """All files of finished simulations and all checkpoints are as they were written."""
    for path in folder.glob("curves/*/[!.]*.nc"):
        assert is_whole(path), path


def assert_tidy(folder):
    """Each shard has one file of curves; nothing half-written is there, and no checkpoint."""
    for shard in (folder / "curves").iterdir():
        [path] = curve_files(shard)
        assert {*shard.iterdir()} == {path, shard / ".lock"}


@pytest.mark.slow
@pytest.mark.parametrize("first", ["ends", "is killed"])
def test_a_second_writer_of_a_shard_waits_and_computes_nothing_twice(
    configuration, same, tmp_path, first
):
    told = command(configuration, tmp_path)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with (
        running(configuration, tmp_path, until=2) as first_writer,
        subprocess.Popen(told, **pipes) as second_writer,
    ):
        os.kill(first_writer.pid, signal.SIGSTOP)  # until the other one has begun
        waiting = second_writer.stderr.readline()
        assert waiting.startswith("Warning: another process simulates flat in ")
        assert "already; waiting for its results" in waiting
        os.kill(first_writer.pid, signal.SIGCONT if first == "ends" else signal.SIGKILL)
        first_writer.stdout.read()
        first_writer.wait()
        kept = stored(tmp_path)
        output = second_writer.communicate()[0]
    assert second_writer.returncode == 0
    if first == "ends":
        assert (first_writer.returncode, len(kept)) == (0, N_SIMULATION)
    assert len(simulated(output)) == N_SIMULATION - len(kept)
    assert kept.items() <= stored(tmp_path).items()
    assert same(tmp_path)


@pytest.mark.slow
@pytest.mark.usefixtures("_heeded_signals")
@pytest.mark.parametrize("told", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_stores_what_runs_and_ends_cleanly(configuration, same, tmp_path, told):
    with running(configuration, tmp_path) as process:
        process.send_signal(told)
        output = process.stdout.read()
    assert process.returncode == 75
    assert output.count("Stopping at the next load step") == output.count("Interrupted. ") == 1
    assert not any(word in output for word in ("Error", "Traceback", "Abort"))
    kept = len(stored(tmp_path))
    assert 3 <= kept < N_SIMULATION
    # A simulation that has not come to its first state, or just ends, leaves none.
    assert len([*tmp_path.glob("curves/*/checkpoint-*.nc")]) <= 1
    assert continued(configuration, tmp_path) == N_SIMULATION - kept
    assert_tidy(tmp_path)
    assert same(tmp_path)


@pytest.mark.slow
def test_a_killed_process_goes_on_from_its_last_checkpoint(
    configuration, same, tmp_path, monkeypatch
):
    with running(configuration, tmp_path, "--checkpoint", "0", until=1) as process:
        while not any(tmp_path.glob("curves/*/checkpoint-*.nc")):
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGSTOP)
        assert "running: flat, rough\n" in done("status", tmp_path).stdout
        process.kill()
    assert done("status", tmp_path).stdout.endswith("stores any\n")
    *_, checkpoint = tmp_path.glob("curves/*/checkpoint-*.nc")
    force = xr.load_dataset(checkpoint)["force"]
    kept = len(stored(tmp_path))
    resumed = {}

    def noted(simulation, **how):
        if "resume" in how:
            resumed[simulation] = run_simulation(simulation, **how)
            return resumed[simulation]
        return run_simulation(simulation, **how)

    monkeypatch.setattr("crackfront.sweep.tasks.run_simulation", noted)
    assert continued(configuration, tmp_path) == N_SIMULATION - kept
    [(simulation, result)] = resumed.items()
    assert checkpoint.name.startswith(f"checkpoint-{simulation.stem}-")
    ended = result.record.states.force
    assert force.size < ended.size
    assert ended[: force.size].tobytes() == force.values.tobytes()
    assert same(tmp_path)


@pytest.fixture
def small_disk(tmp_path):
    """A file system of its own that holds some of the simulations only."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=384k", "tmpfs", str(folder)]
    if os.getuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("only root can mount a file system of a chosen size, and not everywhere")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


@pytest.mark.slow
def test_a_full_disk_ends_the_run_and_room_lets_it_go_on(configuration, same, small_disk):
    told = ("simulate", configuration, "--output", small_disk / "out")
    told += ("--checkpoint", BATCH_SECONDS)
    result = run_command(*told)
    assert result.exit_code == 1, result.output
    assert isinstance(result.exception, SystemExit)
    [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    assert "the machine could not compute or store it" in sentence
    assert "No space left on device" in sentence
    assert_whole(small_disk / "out")
    kept = len(stored(small_disk / "out"))
    assert 1 <= kept < N_SIMULATION
    subprocess.run(["mount", "-o", "remount,size=8m", str(small_disk)], check=True)
    assert continued(configuration, small_disk / "out") == N_SIMULATION - kept
    assert same(small_disk / "out")


@pytest.mark.slow
def test_a_folder_that_is_read_only_is_refused_before_anything_runs(
    configuration, same, small_disk
):
    subprocess.run(["mount", "-o", "remount,size=8m", str(small_disk)], check=True)
    folder = small_disk / "out"
    done("simulate", configuration, "--output", folder, "--spectrum", "flat")
    kept = len(stored(folder))
    subprocess.run(["mount", "-o", "remount,ro,size=8m", str(small_disk)], check=True)
    result = run_command("simulate", configuration, "--output", folder)
    assert result.exit_code == 2
    assert "Read-only file system; check the path and its permissions" in result.stderr
    assert simulated(result.stdout) == set()
    assert len(result.stderr.splitlines()) == 1
    subprocess.run(["mount", "-o", "remount,rw,size=8m", str(small_disk)], check=True)
    assert continued(configuration, folder) == N_SIMULATION - kept
    assert same(folder)


@pytest.mark.parametrize("moment", [slow(0), 4e9])
def test_the_dates_of_files_make_no_simulation_run_again(made, tmp_path, moment):
    folder = shutil.copytree(made.folder, tmp_path / "sweep")
    for path in folder.rglob("*"):
        os.utime(path, (moment, moment))
    assert continued(TEST, folder) == 0
    assert _same_table(TEST, made.folder, folder)
