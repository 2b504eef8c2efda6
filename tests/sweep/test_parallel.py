"""Tasks over ranks: dynamic, the same as without, and no failure that hangs or stays silent."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from crackfront.sweep import parallel
from crackfront.sweep.library import run_sweep
from crackfront.sweep.parallel import default_launcher, launch_ranks, run_tasks
from tests.commands import COSTS, curves, done, table
from tests.commands import run as run_command

ROOT = Path(__file__).parents[2]
TEST = str(ROOT / "config/test.yaml")


def double(number):
    """Twice a number."""
    return 2 * number


def add(task, result):
    """Sum of a task and its result."""
    return task + result


def crackfront(*arguments, ranks=None, timeout=600, **environment):
    """Run the command, directly or as ranks of MPI."""
    command = [sys.executable, "-m", "crackfront", *arguments]
    if ranks is not None:
        mpi = [*default_launcher().split(), "-n", str(ranks), sys.executable, "-m", "mpi4py"]
        command = [*mpi, "-m", "crackfront", *arguments]
    variables = {**os.environ, "OMP_NUM_THREADS": "1", **environment}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, env=variables, check=False
    )


def assert_same_bits(folder, serial):
    """Compare what ranks stored in a folder with the table and states of a run without them."""
    assert table(folder / "hysteresis.nc").identical(table(serial / "hysteresis.nc"))
    found, expected = curves(folder), curves(serial)
    assert found.keys() == expected.keys()
    for name, states in expected.items():
        assert found[name].drop_vars(COSTS).identical(states.drop_vars(COSTS))


def test_without_mpi_tasks_run_one_after_the_other_in_order():
    assert list(run_tasks(double, [3, 1, 2], add)) == [(3, 9), (1, 3), (2, 6)]
    assert not parallel.under_mpi()


@pytest.mark.parametrize(
    "name",
    [
        "PMI_SIZE",
        "MPI_LOCALNRANKS",
        "OMPI_COMM_WORLD_SIZE",
        "MV2_COMM_WORLD_SIZE",
        "SLURM_STEP_NUM_TASKS",
        "JSM_NAMESPACE_SIZE",
        "FLUX_JOB_SIZE",
    ],
)
def test_a_command_that_a_launcher_starts_several_times_is_refused(monkeypatch, name):
    monkeypatch.setenv(name, "3")
    sentence = f"a launcher has started this command 3 times, as {name} says; leave"
    with pytest.raises(ValueError, match=sentence):
        parallel.is_manager(2)
    monkeypatch.setenv("SLURM_PTY_PORT", "40000")
    assert parallel.is_manager(2)
    monkeypatch.delenv("SLURM_PTY_PORT")
    for alone in ("1", "", "none", "-1"):
        monkeypatch.setenv(name, alone)
        assert parallel.is_manager(2)


@pytest.mark.parametrize(
    "name",
    [
        "PMI_RANK",
        "PMIX_RANK",
        "MPI_LOCALRANKID",
        "OMPI_COMM_WORLD_RANK",
        "MV2_COMM_WORLD_RANK",
        "SLURM_PROCID",
        "PALS_RANKID",
        "ALPS_APP_PE",
        "JSM_NAMESPACE_RANK",
        "FLUX_TASK_RANK",
    ],
)
def test_a_process_that_a_launcher_numbers_beyond_the_first_is_refused(monkeypatch, name):
    monkeypatch.setenv("SLURM_PTY_PORT", "40000")  # of a shell in which the launcher was called
    monkeypatch.setenv(name, "1")
    sentence = f"a launcher has started this command several times, {name} is 1; leave"
    with pytest.raises(ValueError, match=sentence):
        parallel.is_manager(2)
    monkeypatch.setenv(name, "0")
    assert parallel.is_manager(2)


def test_a_batch_script_is_one_process_of_a_job_of_many_tasks(monkeypatch):
    for name, value in {"SLURM_NTASKS": "33", "SLURM_PROCID": "0", "SLURM_LOCALID": "0"}.items():
        monkeypatch.setenv(name, value)
    assert parallel.is_manager(32)


@pytest.mark.parametrize("launcher", ["true", "echo", "bash -c", "python"])
def test_a_launcher_that_starts_nothing_is_no_success(tmp_path, launcher):
    told = ("simulate", TEST, "--output", tmp_path, "--ranks", "2", "--launcher", launcher)
    if launcher == "python":
        (tmp_path / "python").write_text("#!/bin/sh\nexit 75\n")
        (tmp_path / "python").chmod(0o755)
        assert run_command(*told[:-1], tmp_path / "python").exit_code == 75
        return
    result = run_command(*told)
    assert result.exit_code == 1
    assert f"the launcher '{launcher}' ended without an error, but 8 of 8 sim" in result.stderr
    assert result.stderr.count("Error") == 1


@pytest.mark.parametrize(("launcher", "reason"), [(" ", "names none"), ("'a", "No closing quot")])
def test_a_launcher_that_is_no_command_line_is_refused(launcher, reason):
    with pytest.raises(ValueError, match=reason):
        launch_ranks(["plan"], 2, launcher, Path())


@pytest.mark.usefixtures("_heeded_signals")
def test_ranks_that_heed_no_signal_end_soon_after_the_second(tmp_path, monkeypatch):
    monkeypatch.setattr(parallel, "_GRACE_SECONDS", 0.3)
    deaf = tmp_path / "deaf"
    deaf.write_text("#!/bin/sh\ntrap '' TERM INT HUP\ntouch $0.begun\nexec sleep 600\n")
    deaf.chmod(0o755)

    def send():
        for name in ("deaf.begun", ".stop-*"):
            while not any(tmp_path.glob(name)):
                time.sleep(0.05)
            os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=send, daemon=True).start()
    assert launch_ranks(["plan"], 2, str(deaf), tmp_path) == -signal.SIGKILL


def test_ranks_do_not_depend_on_who_reads_what_they_print():
    (source, end), (reader, number) = os.pipe(), os.pipe()
    os.close(reader)
    written = threading.Thread(target=parallel._pass_on, args=(source, number))
    written.start()
    for _ in range(20):
        os.write(end, bytes(2**16))  # more than a pipe holds: all of it is taken
    os.close(end)
    written.join(20)
    assert not written.is_alive()
    os.close(source)
    os.close(number)


def test_a_launcher_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="launcher 'no-such-mpiexec' cannot be started"):
        launch_ranks(["plan"], 2, "no-such-mpiexec --flag", Path())


def test_a_launcher_that_is_nowhere_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ValueError, match="there is no mpiexec beside"):
        default_launcher()


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("ranks", [2, 5])
def test_results_are_the_same_bits_on_several_ranks_and_without_mpi(made, tmp_path, capfd, ranks):
    done("simulate", TEST, "--output", tmp_path, "--ranks", ranks)
    assert "[8/8]" in capfd.readouterr().out
    done("aggregate", TEST, "--output", tmp_path)
    # Each process has its high-water mark, and these grow one after the other.
    peaks = {states["peak_memory"].item() for states in curves(tmp_path).values()}
    assert len(peaks) > 1
    assert_same_bits(tmp_path, made.folder)


OWN = """
seed: 0
field: roughness
scales: {radius: 60.0e-6, work_of_adhesion: 63.0e-3, contact_modulus: 0.9333e6}
spectra:
  - {name: film, surface: {file: scan.npy, size: 50, unit: um, height_unit: nm, mask: mask.npy}}
amplitudes: {elastic_energy: [0.02]}
realisations: 2
failed_fraction: 1.0
numerics:
  {angles: 240, samples_per_cutoff: 4, interpolation: cubic, pixels_per_cutoff: 4,
   tile: {roll_offs: 4, cutoffs: 8}, tolerance: 1.0e-6, max_sweeps: 100000, solver: newton}
load: {max_penetration: 4.0e-6, step: 4.0e-7}
fit: {lowest_elastic_energy: 1.0e-3, highest_elastic_energy: 0.1, bootstrap: 200}
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_a_surface_and_a_mask_in_npy_are_read_by_the_manager_alone_and_one_rank_gives_the_same_bits(
    tmp_path, rng
):
    # By NuMPI all ranks of its communicator would read them together.
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(64), np.fft.fftfreq(64)))
    filtered = np.fft.fft2(rng.standard_normal((64, 64))) * np.maximum(waves, 0.03) ** -1.8
    heights, masked = np.fft.ifft2(filtered).real, np.zeros((64, 64))
    masked[10:20, 30:40] = 1.0
    np.save(tmp_path / "scan.npy", 20 * heights / np.std(heights))
    np.save(tmp_path / "mask.npy", masked)
    (tmp_path / "own.yaml").write_text(OWN)
    told = ("simulate", str(tmp_path / "own.yaml"), "--output", str(tmp_path / "own"))
    ranks = crackfront(*told, ranks=2)
    assert ranks.returncode == 0, ranks.stderr
    assert "[2/2]" in ranks.stdout
    done("aggregate", tmp_path / "own.yaml", "--output", tmp_path / "own")
    with pytest.warns(UserWarning, match="2 of 2 simulations have no value: 2 no_steady_part"):
        run_sweep(tmp_path / "own.yaml", tmp_path / "serial", progress=False)
    assert_same_bits(tmp_path / "own", tmp_path / "serial")


@pytest.mark.mpi
def test_a_wrong_number_of_ranks_is_one_sentence_and_no_simulation(tmp_path):
    run = crackfront("simulate", TEST, "--output", str(tmp_path), "--ranks", "2", ranks=2)
    assert run.returncode != 0
    assert run.stderr.count("MPI started 2 ranks where 3 were expected") == 1
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.mpi
def test_a_launcher_of_another_mpi_is_no_silent_serial_run(tmp_path):
    # What such a launcher starts: ranks that each believe to be alone.
    lonely = [sys.executable, "-m", "mpi4py", "-m", "crackfront", "simulate", TEST]
    lonely += ["--output", str(tmp_path), "--ranks", "2"]
    run = subprocess.run(lonely, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode != 0
    assert "MPI started 1 rank where 3 were expected" in run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.mpi
def test_ranks_return_results_of_any_size_and_an_exception_ends_the_job_with_what_runs_kept(
    tmp_path,
):
    script = tmp_path / "failing.py"
    script.write_text(
        "from crackfront.sweep import parallel\n"
        "if parallel.is_manager(2):\n"
        "    for sizes in ([], [7], [10**6, 0, 10**6, 3, 0]):\n"
        "        found = list(parallel.run_tasks(bytes, sizes, lambda _, result: len(result)))\n"
        "        assert sorted(found) == sorted(zip(sizes, sizes))\n"
        "    keep = lambda task, result: print(f'kept {task}: {result}', flush=True)\n"
        "    list(parallel.run_tasks((1).__truediv__, [0, 4], keep))\n"
        "else:\n"
        "    for _ in range(4):\n"
        "        parallel.serve_tasks('operator')\n"
    )
    mpi = [*default_launcher().split(), "-n", "3", sys.executable, "-m", "mpi4py"]
    run = subprocess.run(
        [*mpi, str(script)], capture_output=True, text=True, timeout=600, check=False
    )
    assert run.returncode != 0
    assert "ZeroDivisionError" in run.stderr
    assert run.stdout.count("kept 4: 0.25") == 1
