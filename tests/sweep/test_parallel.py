"""Ranks: what they compute is what one process computes, and nothing that ends them hangs."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import xarray as xr

from crackfront.sweep import parallel
from tests.commands import run, stored
from tests.places import ROOT, TEST

MPIEXEC = Path(sys.executable).with_name("mpiexec")
COSTS = ["seconds", "cpu_seconds", "peak_memory"]
N_SIMULATION = 24


def launched(n_rank, *arguments):
    """Command line of ranks of this Python."""
    return [str(MPIEXEC), "-n", str(n_rank), sys.executable, *map(str, arguments)]


@pytest.fixture(scope="session")
def configuration(tmp_path_factory):
    """Configuration of simulations that take some seconds together."""
    path = tmp_path_factory.mktemp("ranks") / "ranks.yaml"
    text = (ROOT / "config/test.yaml").read_text()
    path.write_text(text.replace("realisations: 2", f"realisations: {N_SIMULATION // 4}"))
    return path


@pytest.fixture(scope="session")
def undisturbed(configuration):
    """Table of one process that nothing disturbed."""
    return table(configuration, configuration.parent / "undisturbed")


def table(configuration, folder):
    """Table of a sweep of which this process simulates what is missing, without costs."""
    for name in ("simulate", "aggregate"):
        assert run(name, configuration, "--output", folder).exit_code == 0
    return xr.load_dataset(folder / "hysteresis.nc").drop_vars(COSTS)


def processes(folder):
    """Numbers of the processes whose command line names a folder, and their command lines."""
    commands = {}
    for path in Path("/proc").glob("[0-9]*"):
        try:
            words = (path / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if os.fsencode(folder) in words and int(path.name) != os.getpid():
            commands[int(path.name)] = words[0].decode()
    return commands


@contextlib.contextmanager
def started(configuration, folder, n_rank=3, until=4, checkpoint="0.1"):
    """Ranks of a sweep, once some of its simulations have finished."""
    command = ["-m", "crackfront", "simulate", configuration, "--output", folder]
    command += ["--checkpoint", checkpoint]
    output = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(launched(n_rank, "-u", *command), **output) as process:
        assert any(line.startswith(f"[{until}/") for line in process.stdout)
        yield process


def left_running(folder, seconds=10):
    """Processes of a sweep that are still there after some time."""
    until = time.monotonic() + seconds
    while (left := processes(folder)) and time.monotonic() < until:
        time.sleep(0.1)
    return left


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.parametrize("n_rank", [2, 3, 6])
def test_any_number_of_ranks_gives_the_table_of_one_process(
    configuration, undisturbed, tmp_path, n_rank
):
    command = ["-m", "crackfront", "simulate", configuration, "--output", tmp_path]
    subprocess.run(launched(n_rank, *command), check=True, capture_output=True)
    assert table(configuration, tmp_path).equals(undisturbed)


@pytest.mark.mpi
def test_ranks_that_are_told_to_end_go_on_to_the_table_of_one_process(made, tmp_path):
    # Frequent checkpoints take time, so that the signal comes long before the end.
    with started(TEST, tmp_path, n_rank=2, until=1, checkpoint="0.01") as process:
        process.send_signal(signal.SIGTERM)
        output, _ = process.communicate(timeout=20)
    assert process.returncode == 75
    assert "run the same command to continue" in output
    kept = stored(tmp_path)
    assert 1 <= len(kept) < 8
    undisturbed = xr.load_dataset(made.hysteresis).drop_vars(COSTS)
    assert table(TEST, tmp_path).equals(undisturbed)
    assert kept.items() <= stored(tmp_path).items()


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.parametrize("victim", ["rank", "manager", "launcher"])
def test_ranks_that_are_killed_lose_nothing_that_they_stored(
    configuration, undisturbed, tmp_path, victim
):
    with started(configuration, tmp_path) as process:
        running = processes(tmp_path)
        ranks = sorted(number for number, name in running.items() if name == sys.executable)
        assert len(ranks) == 3
        victims = {"rank": ranks[-1], "manager": ranks[0], "launcher": process.pid}
        os.kill(victims[victim], signal.SIGKILL)
        process.communicate(timeout=20)
        assert process.returncode != 0
    assert not left_running(tmp_path)
    kept = stored(tmp_path)
    assert 0 < len(kept) < N_SIMULATION
    assert table(configuration, tmp_path).equals(undisturbed)
    assert kept.items() <= stored(tmp_path).items()


@pytest.mark.slow
@pytest.mark.mpi
def test_an_exception_of_a_task_ends_all_ranks_with_its_traceback(tmp_path):
    script = tmp_path / "tasks.py"
    script.write_text(
        "from crackfront.sweep.parallel import ranks\n"
        "def divided(task, idle):\n"
        "    return 12 // task\n"
        "if __name__ == '__main__':\n"
        "    with ranks() as workers:\n"
        "        if workers is not None:\n"
        "            kept = list(workers.run(divided, [3, 2], lambda task, result: result))\n"
        "            print(sorted(kept))\n"
        "            list(workers.run(divided, [0, *[3] * 50], lambda task, result: result))\n"
    )
    command = launched(2, "-m", "mpi4py", script)
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode != 0
    assert "[(2, 6), (3, 4)]" in ended.stdout
    assert "ZeroDivisionError" in ended.stderr


@pytest.mark.slow
@pytest.mark.mpi
def test_bad_input_is_one_sentence_of_all_ranks(tmp_path):
    command = ["-m", "crackfront", "simulate", tmp_path / "absent.yaml"]
    ended = subprocess.run(
        launched(2, *command), capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == 2
    assert ended.stderr.count("absent.yaml cannot be read") == 1


@pytest.mark.filterwarnings("ignore:suspicious MPI execution environment")
def test_a_launcher_of_another_library_is_named(monkeypatch):
    # MPICH, which mpi4py is installed with, does not read it.
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "3")
    with pytest.raises(ValueError, match="sees one each"), parallel.ranks():
        pass


def test_a_batch_script_with_several_tasks_is_one_process(monkeypatch):
    monkeypatch.setenv("SLURM_NTASKS", "32")
    with parallel.ranks() as workers:
        kept = list(workers.run(lambda task, _: 2 * task, [3, 1], lambda task, result: result))
    assert kept == [(3, 6), (1, 2)]


def test_a_task_that_ends_while_the_others_are_given_up_is_kept():
    began, go_on, kept = threading.Event(), threading.Event(), []

    def wait(task, idle):
        if task == "long":
            began.set()
            assert go_on.wait(10)

    with ThreadPoolExecutor(2) as pool:
        runs = parallel.Ranks(pool, 2).run(
            wait, ["long", "short"], lambda task, result: kept.append(task)
        )
        next(runs)
        assert began.wait(10)
        go_on.set()
        runs.close()
    assert kept == ["short", "long"]


def test_a_result_is_kept_although_others_cannot_be_written_meanwhile():
    began, given_up, kept = threading.Event(), threading.Event(), []

    def wait(task, idle):
        began.set()
        assert given_up.wait(10)

    def fail():
        if began.is_set():
            given_up.set()
            raise OSError("no space left")

    with ThreadPoolExecutor(1) as pool:
        runs = parallel.Ranks(pool, 1).run(
            wait, ["task"], lambda task, result: kept.append(task), fail
        )
        with pytest.raises(OSError, match="no space left"):
            list(runs)
    assert kept == ["task"]


def test_a_container_with_too_little_shared_memory_is_told_the_remedy(monkeypatch):
    monkeypatch.setenv("PMI_SIZE", "3")
    monkeypatch.setattr(parallel, "_SHARED_BYTES", 1e15)
    with pytest.raises(ValueError, match=r"/dev/shm has .* --shm-size"), parallel.ranks():
        pass
