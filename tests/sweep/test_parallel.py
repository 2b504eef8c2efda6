"""Tasks over ranks: dynamic, the same as without, and no failure that hangs or stays silent."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.data.provenance import provenance
from crackfront.sweep import parallel
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.parallel import default_launcher, launch_ranks, run_tasks
from crackfront.sweep.store import Store
from tests.commands import curves, datasets

ROOT = Path(__file__).parents[2]
TEST = str(ROOT / "config/test.yaml")
COSTS = {"seconds", "cpu_seconds", "peak_memory"}


def double(number):
    """Twice a number."""
    return 2 * number


def add(task, result):
    """Sum of a task and its result."""
    return task + result


def crackfront(*arguments, ranks=None, timeout=120, **environment):
    """Run the command, directly or as ranks of MPI."""
    command = [sys.executable, "-m", "crackfront", *arguments]
    if ranks is not None:
        mpi = [*default_launcher().split(), "-n", str(ranks), sys.executable, "-m", "mpi4py"]
        command = [*mpi, "-m", "crackfront", *arguments]
    variables = {**os.environ, "OMP_NUM_THREADS": "1", **environment}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, env=variables, check=False
    )


def dataset(folder):
    """The aggregated file, without costs and origin."""
    path = Store(folder).aggregate(load_configuration(Path(TEST)), provenance())
    return xr.load_dataset(path).drop_vars(COSTS)


def test_without_mpi_tasks_run_one_after_the_other_in_order():
    assert list(run_tasks(double, [3, 1, 2], add)) == [(3, 9), (1, 3), (2, 6)]
    assert not parallel.under_mpi()


@pytest.mark.parametrize("name", ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE"])
def test_a_command_that_a_launcher_starts_several_times_is_refused(monkeypatch, name):
    monkeypatch.setenv(name, "3")
    with pytest.raises(ValueError, match="a launcher has started this command 3 times; leave"):
        parallel.is_manager(2)
    monkeypatch.setenv("SLURM_PTY_PORT", "40000")
    assert parallel.is_manager(2)
    monkeypatch.delenv("SLURM_PTY_PORT")
    monkeypatch.setenv(name, "1")
    assert parallel.is_manager(2)


def test_a_launcher_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="launcher 'no-such-mpiexec' cannot be started"):
        launch_ranks(["plan"], 2, "no-such-mpiexec --flag", Path())


def test_a_launcher_that_is_nowhere_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ValueError, match="there is no mpiexec beside"):
        default_launcher()


@pytest.mark.mpi
def test_results_are_the_same_bits_for_any_number_of_ranks_and_without_mpi(tmp_path):
    outputs = {name: tmp_path / name for name in ("serial", "mpi1", "mpi2")}
    serial = CliRunner().invoke(main, ["simulate", TEST, "--output", str(outputs["serial"])])
    assert serial.exit_code == 0, serial.output
    runs = [
        crackfront("simulate", TEST, "--output", str(outputs["mpi1"]), ranks=2),
        crackfront("simulate", TEST, "--output", str(outputs["mpi2"]), "--ranks", "2"),
    ]
    for run in runs:
        assert run.returncode == 0, run.stderr
        assert "[8/8]" in run.stdout
    # Each process has its high-water mark, and these grow one after the other.
    contents = curves(outputs["mpi2"]).values()
    peaks = [xr.load_dataset(one, engine="netcdf4")["peak_memory"].item() for one in contents]
    assert len(set(peaks)) > 1
    serial = dataset(outputs["serial"])
    assert np.all(np.isfinite(serial["hysteresis"]))
    for name in ("mpi1", "mpi2"):
        # equals compares names, labels and every value.
        assert serial.equals(dataset(outputs[name]))
        found = datasets(outputs[name])
        for stem, one in datasets(outputs["serial"]).items():
            assert one.equals(found[stem])


@pytest.mark.mpi
def test_a_wrong_number_of_ranks_is_one_sentence_and_no_simulation(tmp_path):
    run = crackfront("simulate", TEST, "--output", str(tmp_path), "--ranks", "2", ranks=2)
    assert run.returncode != 0
    assert run.stderr.count("MPI started 2 rank(s) where 3 were expected") == 1
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.mpi
def test_a_launcher_of_another_mpi_is_no_silent_serial_run(tmp_path):
    # What such a launcher starts: ranks that each believe to be alone.
    lonely = [sys.executable, "-m", "mpi4py", "-m", "crackfront", "simulate", TEST]
    lonely += ["--output", str(tmp_path), "--ranks", "2"]
    run = subprocess.run(lonely, capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode != 0
    assert "MPI started 1 rank(s) where 3 were expected" in run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.mpi
def test_an_exception_in_a_task_ends_the_job_at_once(tmp_path):
    script = tmp_path / "failing.py"
    script.write_text(
        "from crackfront.sweep import parallel\n"
        "if parallel.is_manager(2):\n"
        "    list(parallel.run_tasks((1).__truediv__, [1, 0, 1, 1], max))\n"
        "else:\n"
        "    parallel.serve_tasks('operator')\n"
    )
    mpi = [*default_launcher().split(), "-n", "3", sys.executable, "-m", "mpi4py"]
    run = subprocess.run(
        [*mpi, str(script)], capture_output=True, text=True, timeout=60, check=False
    )
    assert run.returncode != 0
    assert "ZeroDivisionError" in run.stderr
