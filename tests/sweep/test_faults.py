"""Faults that really happen to a sweep: nothing is lost, and the dataset is the undisturbed one."""

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray as xr

from crackfront.data.provenance import provenance
from crackfront.simulate.run import run_simulation
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.store import Store
from tests.commands import curves, datasets, slow
from tests.commands import run as run_command

TEST = Path(__file__).parents[2] / "config/test.yaml"
COSTS = {"seconds", "cpu_seconds", "peak_memory"}
N_SIMULATION = 12


def table(path):
    """An aggregated file, without costs and origin."""
    found = xr.load_dataset(path).drop_vars(COSTS)
    found.attrs = {}
    return found


def dataset(configuration, folder):
    """The same of what a folder holds now."""
    return table(Store(folder).aggregate(load_configuration(configuration), provenance()))


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


def stored(folder):
    """Names and contents of the stored simulations, which say when each was run."""
    return {name: content for name, content in curves(folder).items() if content is not None}


def repaired(configuration, folder):
    """Sentences about what the workflow sets aside before it plans."""
    return list(Store(folder).repair(configuration))


def rerun(configuration, folder, *more):
    """Run again what is missing; the number of simulations that were run."""
    before = stored(folder)
    done = run_command("simulate", configuration, "--output", folder, *more)
    assert done.exit_code == 0, done.output
    after = stored(folder)
    assert len(after) == load_configuration(configuration).n_simulation
    return sum(before.get(name) != content for name, content in after.items())


@contextmanager
def running(configuration, folder, *more, until=3):
    """A run in a process of its own that has stored some simulations."""
    with subprocess.Popen(
        command(configuration, folder, *more),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        process_group=0,
    ) as process:
        for line in process.stdout:
            if line.startswith(f"[{until}/"):
                break
        yield process


def children(process):
    """Identifiers and command lines of the descendants of a process."""
    listing = ["ps", "-ww", "-eo", "pid=,ppid=,args="]
    listed = subprocess.run(listing, capture_output=True, text=True, check=True).stdout
    rows = [line.split(maxsplit=2) for line in listed.splitlines()]
    found = {process}
    for _ in rows:
        found |= {int(child) for child, parent, _ in rows if int(parent) in found}
    names = {int(child): name for child, _, name in rows}
    return {child: names[child] for child in found - {process}}


def gone(processes, seconds=20):
    """Whether processes end in time."""
    for _ in range(10 * seconds):
        if not any(Path(f"/proc/{one}").exists() for one in processes):
            return True
        time.sleep(0.1)
    return False


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A configuration whose simulations last until they are killed, and its undisturbed folder."""
    folder = tmp_path_factory.mktemp("undisturbed")
    text = TEST.read_text(encoding="utf-8")
    text = text.replace("angles: 128", "angles: 512").replace("realisations: 2", "realisations: 3")
    configuration = folder / "sweep.yaml"
    configuration.write_text(text.replace("step: 0.1", "step: 0.05"))
    done = run_command("simulate", configuration, "--output", folder / "alone")
    assert done.exit_code == 0, done.output
    return configuration, folder / "alone"


@pytest.fixture
def configuration(undisturbed):
    """The configuration of the runs that are killed."""
    return undisturbed[0]


@pytest.fixture(scope="module")
def expected(undisturbed):
    """The undisturbed dataset of that configuration."""
    return dataset(*undisturbed)


@pytest.fixture
def same(configuration, expected):
    """Whether a folder holds that dataset."""
    return lambda folder: dataset(configuration, folder).identical(expected)


@pytest.fixture
def same_as_made(made):
    """Whether a folder holds the undisturbed dataset of the configuration `test`."""
    expected = table(made.hysteresis)
    return lambda folder: dataset(TEST, folder).identical(expected)


@pytest.fixture
def copied(made, tmp_path):
    """A copy of the undisturbed folder of the configuration `test`."""
    return shutil.copytree(made.folder, tmp_path / "copy")


@pytest.mark.mpi
@pytest.mark.parametrize(("victim", "again"), [("rank", "1"), slow("launcher", "2")])
def test_a_killed_rank_or_launcher_ends_the_job_and_costs_what_was_running(
    configuration, same, tmp_path, victim, again
):
    with running(configuration, tmp_path, "--ranks", "2") as process:
        found = children(process.pid)
        ranks = {one for one, name in found.items() if name.startswith(sys.executable)}
        launchers = {one for one, name in found.items() if "mpiexec" in name.split()[0]}
        assert len(ranks) == 3
        os.kill(max(ranks) if victim == "rank" else min(launchers), signal.SIGKILL)
        output = process.stdout.read()
    assert process.returncode == 1
    assert "the same command continues with the others" in output
    assert gone(found)
    kept = len(stored(tmp_path))
    assert 3 <= kept < N_SIMULATION
    assert rerun(configuration, tmp_path, "--ranks", again) == N_SIMULATION - kept
    assert same(tmp_path)


@pytest.mark.mpi
@pytest.mark.slow
def test_ranks_end_with_the_command_that_started_them_and_nothing_is_computed_twice(
    configuration, same, tmp_path
):
    with running(configuration, tmp_path, "--ranks", "2") as process:
        found = children(process.pid)
        process.kill()
    assert gone(found, 5)
    kept = len(stored(tmp_path))
    assert 3 <= kept < N_SIMULATION
    done = run(*command(configuration, tmp_path))
    assert f"[1/{N_SIMULATION - kept}]" in done.stdout
    assert same(tmp_path)


@pytest.mark.slow
def test_of_two_controllers_at_the_same_shard_one_waits_for_the_other(
    configuration, same, tmp_path
):
    told = command(configuration, tmp_path)
    # At once, as by a launcher that states nothing.
    with (
        subprocess.Popen(told, stdout=subprocess.DEVNULL) as one,
        subprocess.Popen(told, stdout=subprocess.DEVNULL) as other,
    ):
        one.wait()
        other.wait()
    assert one.returncode == other.returncode == 0
    packs = (tmp_path / "curves").glob("*.tar")
    assert len({path.name.rsplit("-", 2)[1] for path in packs}) == 1
    assert rerun(configuration, tmp_path) == 0
    assert same(tmp_path)


@pytest.mark.usefixtures("_heeded_signals")
@pytest.mark.parametrize(
    ("ranks", "told"),
    [(1, signal.SIGINT), slow(1, signal.SIGTERM)]
    + [
        pytest.param(2, told, marks=[pytest.mark.mpi, pytest.mark.slow])
        for told in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
    ],
)
def test_a_signal_stores_what_runs_and_ends_cleanly(configuration, same, tmp_path, ranks, told):
    with running(configuration, tmp_path, "--ranks", str(ranks)) as process:
        found = children(process.pid)
        # As a terminal does it, which knows the group alone and not the ranks.
        os.killpg(process.pid, told)
        output = process.stdout.read()
    assert process.returncode == 75
    assert output.count("Stopping at the next load step") == output.count("Interrupted. ") == 1
    assert not any(word in output for word in ("Error", "Traceback", "Abort"))
    assert gone(found)
    kept = len(stored(tmp_path))
    assert 3 <= kept < N_SIMULATION
    # A simulation that has not come to its first state, or just ends, leaves none.
    assert len(list((tmp_path / "checkpoints").iterdir())) <= ranks
    assert not list(tmp_path.rglob(".stop-*"))
    assert rerun(configuration, tmp_path) == N_SIMULATION - kept
    assert not any((tmp_path / "checkpoints").iterdir())
    assert same(tmp_path)


@pytest.mark.slow
def test_a_killed_process_goes_on_from_its_last_checkpoint(same_as_made, tmp_path, monkeypatch):
    with running(TEST, tmp_path, "--checkpoint", "0", until=1) as process:
        while not any((tmp_path / "checkpoints").glob("[!.]*.nc")):
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGSTOP)
        assert f"process {process.pid} on " in run_command("status", tmp_path).stdout
        process.kill()
    assert run_command("status", tmp_path).stdout.endswith("stores any\n")
    [checkpoint] = (tmp_path / "checkpoints").glob("[!.]*.nc")
    known = xr.load_dataset(checkpoint)["force"]
    kept = len(stored(tmp_path))
    resumed = []

    def noted(simulation, **how):
        resumed.append("resume" in how)
        return run_simulation(simulation, **how)

    monkeypatch.setattr("crackfront.sweep.tasks.run_simulation", noted)
    assert rerun(TEST, tmp_path) == 8 - kept
    assert sum(resumed) == 1
    ended = datasets(tmp_path)[checkpoint.name]["force"]
    assert known.size < ended.size
    assert ended.values[: known.size].tobytes() == known.values.tobytes()
    assert same_as_made(tmp_path)


@pytest.fixture
def small_disk(tmp_path):
    """A file system of its own that holds some of the simulations only."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=192k", "tmpfs", str(folder)]
    if os.getuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("only root can mount a file system of a chosen size, and not everywhere")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_full_disk_ends_the_run_and_room_lets_it_go_on(configuration, same, small_disk):
    done = run_command("simulate", configuration, "--output", small_disk / "out")
    assert done.exit_code == 1
    assert isinstance(done.exception, SystemExit)
    assert "the machine could not compute or store it" in done.stderr
    assert "No space left on device" in done.stderr
    kept = len(stored(small_disk / "out"))
    assert 1 <= kept < N_SIMULATION
    grow = ["mount", "-o", "remount,size=8m", str(small_disk)]
    subprocess.run(grow, check=True)
    assert rerun(configuration, small_disk / "out") == N_SIMULATION - kept
    assert same(small_disk / "out")


@pytest.mark.slow
def test_a_folder_that_is_read_only_is_refused_before_anything_runs(
    configuration, same, small_disk
):
    subprocess.run(["mount", "-o", "remount,size=8m", str(small_disk)], check=True)
    assert run(*command(configuration, small_disk / "out", "--spectrum", "flat")).returncode == 0
    kept = len(stored(small_disk / "out"))
    subprocess.run(["mount", "-o", "remount,ro,size=8m", str(small_disk)], check=True)
    done = run(*command(configuration, small_disk / "out"))
    assert done.returncode == 2
    assert "Read-only file system; check the path and its permissions" in done.stderr
    assert "[1/" not in done.stdout
    assert len(done.stderr.splitlines()) == 1
    subprocess.run(["mount", "-o", "remount,rw,size=8m", str(small_disk)], check=True)
    assert rerun(configuration, small_disk / "out") == N_SIMULATION - kept
    assert same(small_disk / "out")


@pytest.mark.parametrize(("left", "lost"), [(0, 4), (100, 4), (-4000, 1), (-1000, 0)])
def test_what_a_truncated_pack_lost_is_computed_anew_and_no_more(same_as_made, copied, left, lost):
    path = min((copied / "curves").glob("*.tar"))
    path.write_bytes(path.read_bytes()[:left])
    assert run_command("verify", copied).exit_code == 1
    assert repaired(TEST, copied)
    assert rerun(TEST, copied) == lost
    assert same_as_made(copied)
    assert run_command("verify", copied).exit_code == 0


FILES = ("configuration.yaml", "hysteresis.nc", "fit.nc", "fit.json", "fit.md", "summary.html")
FILES += ("figures/loop.png", "figures/factor.pdf", "shards/flat.nc", "curves/*.tar")
HARM = {
    "emptied": lambda content: b"",
    "halved": lambda content: content[: len(content) // 2],
    "zeroed": lambda content: bytes(len(content)),
}


ALONE = [{name: harm} for name in FILES for harm in HARM]
ALL = {name: list(HARM)[place % len(HARM)] for place, name in enumerate(FILES)}
MADE_BY = {"curves": "simulate", "shards": "simulate", "hysteresis": "aggregate", "fit": "fit"}
MADE_BY |= {"configuration": "fit", "figures": "figures", "summary": "summary"}
"""Commands that make the files whose names begin so, in the order of the workflow."""


@pytest.mark.parametrize("lost", [ALL, *map(slow, ALONE)], ids=lambda lost: " ".join(lost))
def test_files_that_lost_their_content_are_found_not_archived_and_made_anew(
    finished, tmp_path, lost
):
    folder = shutil.copytree(finished, tmp_path / "sweep")
    assert {path.name for path in folder.glob("*.*")} <= set(FILES)
    harmed = [min(folder.glob(name)) for name in lost]
    for path, harm in zip(harmed, lost.values(), strict=True):
        path.write_bytes(HARM[harm](path.read_bytes()))
    verified = run_command("verify", folder)
    assert verified.exit_code == 1
    for path in harmed:
        assert f"damaged: {path.relative_to(folder)}" in verified.output
    archived = run_command("archive", folder)
    assert archived.exit_code == 2
    assert any(f"the first is {path}" in archived.stderr for path in harmed)
    # What the workflow does before it plans, and the commands of the files then.
    told = repaired(TEST, folder)
    assert all(any(str(path) in one for one in told) for path in harmed)
    parts = {path.relative_to(folder).parts[0].partition(".")[0] for path in harmed}
    for command in dict.fromkeys(MADE_BY[part] for part in MADE_BY if part in parts):
        assert run_command(command, TEST, "--output", folder).exit_code == 0
    assert run_command("verify", folder).exit_code == 0
    assert run_command("archive", folder).exit_code == 0


@pytest.mark.parametrize("content", [b"", b"PK\5\6" + bytes(18), b"text"])
def test_an_archive_without_content_is_damaged(tmp_path, content):
    (tmp_path / "sweep.zip").write_bytes(content)
    found = run_command("verify", tmp_path / "sweep.zip")
    assert found.exit_code == 1
    assert "damaged: sweep.zip" in found.output


@pytest.mark.parametrize("moment", [slow(0), 4e9])
def test_a_clock_that_jumps_makes_nothing_older_or_newer(same_as_made, copied, moment):
    for path in copied.rglob("*"):
        os.utime(path, (moment, moment))
    assert rerun(TEST, copied) == 0
    lost = min((copied / "curves").glob("*.tar"))
    lost.unlink()
    assert "it lacks 4 curves of its simulations" in repaired(TEST, copied)[-1]
    assert rerun(TEST, copied) == 4
    assert same_as_made(copied)
