"""The sweep on a real Slurm: through Snakemake with the profile, and in the face of its limits.

`make test-cluster` installs and starts a Slurm of one machine for these tests alone.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

from crackfront.cli import main
from tests.commands import COSTS, stored
from tests.yaml_texts import from_yaml, to_yaml

ROOT = Path(__file__).parents[2]
MPIEXEC = Path(sys.executable).with_name("mpiexec")
SRUN = "srun -K1 --mpi=pmi2"


def slurm_answers():
    """Whether there is a Slurm with an idle node."""
    if shutil.which("sinfo") is None:
        return False
    command = ["sinfo", "--noheader", "--states=idle,mixed"]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    except subprocess.TimeoutExpired:
        return False
    return told.returncode == 0 and bool(told.stdout.strip())


pytestmark = pytest.mark.slurm


@pytest.fixture(autouse=True, scope="module")
def _slurm():
    if not slurm_answers():
        pytest.skip("no Slurm answers here; `make test-cluster` starts one where it can")


def configuration(folder, *changes):
    """A sweep of one spectrum, `config/test.yaml` with changes."""
    lines = (ROOT / "config/test.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    text = "".join(line for line in lines if "name: rough" not in line)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "sweep.yaml"
    path.write_text(text)
    return path


def profile(folder, **simulate):
    """The profile of the repository as a site would adapt it; resources of a shard may change."""
    content = from_yaml((ROOT / "workflow/profiles/slurm/config.yaml").read_text())
    resources = content["set-resources"]["simulate"] | {"tasks": 3} | simulate
    used = {name: value for name, value in resources.items() if value is not None}
    content["set-resources"]["simulate"] = used
    # Every wait between two looks at a job is 10 s longer than the last: looks at 12 and 34 s.
    content |= {"slurm-init-seconds-before-status-checks": 12, "latency-wait": 5, "retries": 1}
    (folder / "profile").mkdir()
    (folder / "profile/config.yaml").write_text(to_yaml(content))
    return folder / "profile"


def environment():
    """Environment of a command: this Python's commands first."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"OMP_NUM_THREADS": "1", "PATH": path}


def snakemake(folder, sweep, target, **simulate):
    """Command that runs the workflow with the profile up to a target."""
    return [
        *(sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")),
        *("--profile", str(profile(folder, **simulate)), "--directory", str(folder)),
        *("--seconds-between-status-checks", "1", "--config", f"sweep={sweep}"),
        *("--", f"results/sweep/{target}"),
    ]


def dataset(folder):
    """File of a sweep, without costs."""
    return xr.load_dataset(folder / "hysteresis.nc").drop_vars(COSTS)


def undisturbed(sweep, folder):
    """File of a sweep that this process has run alone."""
    for command in ("simulate", "aggregate"):
        main([command, str(sweep), "--output", str(folder)], standalone_mode=False)
    return dataset(folder)


def run(command, timeout=850, **options):
    """Run a command to its end."""
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
        env=environment(),
        **options,
    )


def until(condition, seconds=600):
    """Wait for something that must happen."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.1)


WAYS = {
    "serial": ("hysteresis.nc", {"tasks": 1, "mpi": None}),
    "srun": ("shards/flat.nc", {"mpi": SRUN}),
    "mpiexec": ("shards/flat.nc", {"mpi": str(MPIEXEC)}),
}
"""Up to where a sweep runs, and the resources of its shard; None takes one of the profile away."""


@pytest.fixture(scope="module")
def started(tmp_path_factory):
    """Folders, sweeps and processes of all ways at once: they mostly wait between looks at jobs."""
    runs = {}
    for way, (target, resources) in WAYS.items():
        folder = tmp_path_factory.mktemp(way)
        sweep = configuration(folder)
        command = snakemake(folder, sweep, target, **resources)
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment()
        )
        runs[way] = folder, sweep, process
    yield runs
    for _, _, process in runs.values():
        process.kill()
        process.communicate()


@pytest.mark.parametrize("way", WAYS)
def test_the_profile_runs_a_shard_and_the_sweep_is_the_undisturbed_one(started, way):
    folder, sweep, process = started[way]
    target, _ = WAYS[way]
    results = folder / "results/sweep"
    told = process.communicate(timeout=850)[1]
    assert process.returncode == 0, told
    assert "has been submitted with SLURM jobid" in told
    assert [path.name for path in (results / "shards").glob("*.nc")] == ["flat.nc"]
    if target != "hysteresis.nc":
        main(["aggregate", str(sweep), "--output", str(results)], standalone_mode=False)
    assert dataset(results).equals(undisturbed(sweep, folder / "alone"))


def test_ranks_on_two_nodes_find_what_one_process_finds(tmp_path):
    nodes = run(["sinfo", "--noheader", "--Node", "--format=%N"]).stdout.split()
    if len(set(nodes)) < 2:
        pytest.skip("this Slurm has one node")
    sweep, results = configuration(tmp_path), tmp_path / "results"
    ranks = [*SRUN.split(), "-N2", "-n3", sys.executable, "-m", "crackfront"]
    done = run([*ranks, "simulate", str(sweep), "--output", str(results)])
    assert done.returncode == 0, done.stderr
    main(["aggregate", str(sweep), "--output", str(results)], standalone_mode=False)
    assert dataset(results).equals(undisturbed(sweep, tmp_path / "alone"))


def processes(text):
    """Identifiers of processes whose command line holds a text."""
    listed = subprocess.run(
        ["ps", "-ww", "-eo", "pid=,args="], capture_output=True, text=True, check=True
    )
    lines = [line.split(maxsplit=1) for line in listed.stdout.splitlines()]
    return [int(process) for process, command in lines if text in command]


def test_a_rank_that_is_killed_ends_its_job_and_the_retry_goes_on(tmp_path):
    changes = (("angles: 128", "angles: 512"), ("step: 0.1", "step: 0.02"))
    sweep = configuration(tmp_path, *changes, ("realisations: 2", "realisations: 4"))
    results = tmp_path / "results/sweep"
    log = results / "logs/simulate-flat.log"
    first = ["simulate", str(sweep), "--output", str(results), "--realisations", "0-0"]
    main(first, standalone_mode=False)
    before = stored(results)
    command = snakemake(tmp_path, sweep, "shards/flat.nc")
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment()
    ) as process:
        until(lambda: log.is_file() and "[2/6]" in log.read_text())
        os.kill(max(processes(f"-m crackfront simulate {sweep}")), signal.SIGKILL)
        told = process.stderr.read()
    assert process.returncode == 0, told
    assert told.count("has been submitted with SLURM jobid") == 2
    assert len(before) == 2
    assert before.items() <= stored(results).items()
    main(["aggregate", str(sweep), "--output", str(results)], standalone_mode=False)
    assert dataset(results).equals(undisturbed(sweep, tmp_path / "alone"))


def checkpoint_at_the_limit(folder, results, command):
    """What a job has stored of its one simulation when its time is over, and what it printed."""

    def dates():
        return [path.stat().st_mtime_ns for path in results.glob("curves/flat/checkpoint-*.nc")]

    job = ["sbatch", "--parsable", "--ntasks=2", "--time=60", "--signal=TERM@58", "--wrap", command]
    before = dates()
    number = run(job, cwd=folder).stdout.strip()
    until(lambda: dates() not in ([], before))
    time.sleep(3)  # for more than the first states
    # Limits are in minutes: with notice 58 s before its end, the minute that runs is the last.
    used = run(["squeue", "--noheader", "--jobs", number, "--format=%M"]).stdout.split(":")[0]
    run(["scontrol", "update", f"JobId={number}", f"TimeLimit={int(used) + 1}"])
    until(lambda: not run(["squeue", "--noheader", "--jobs", number]).stdout.strip())
    assert "Interrupted. 0 of 1" in (folder / f"slurm-{number}.out").read_text()
    [path] = results.glob("curves/flat/checkpoint-*.nc")
    return xr.load_dataset(path)


def test_a_time_limit_keeps_what_runs_and_the_next_job_goes_on_from_there(tmp_path):
    # It would take ten minutes.
    changes = (("angles: 128", "angles: 2000"), ("step: 0.1", "step: 0.00002"))
    replacements = (("realisations: 2", "realisations: 1"), ("[0.02, 0.1]", "[0.1]"))
    sweep, results = configuration(tmp_path, *changes, *replacements), tmp_path / "results"
    command = f"exec {SRUN} -n 2 {sys.executable} -m crackfront simulate {sweep} "
    command += f"--output {results} --checkpoint 1"
    first, then = (checkpoint_at_the_limit(tmp_path, results, command) for _ in range(2))
    first_radii, more = first["mean_radius"], then["mean_radius"]
    assert 0 < first_radii.size < more.size
    assert more.values[: first_radii.size].tobytes() == first_radii.values.tobytes()
    assert then.attrs["cpu_seconds"] > first.attrs["cpu_seconds"]


def test_the_plain_job_script_runs_a_sweep_to_its_page(tmp_path):
    sweep = configuration(tmp_path)
    script = ROOT / "workflow/sbatch.sh"
    resources = ("--partition=main", "--ntasks=3", "--mem-per-cpu=700M", "--time=4")
    done = run(["sbatch", "--wait", *resources, str(script), str(sweep)], cwd=tmp_path)
    told = "".join(path.read_text() for path in tmp_path.glob("slurm-*.out"))
    assert done.returncode == 0, told
    results = tmp_path / "results/sweep"
    for name in ("fit.md", "summary.html", "figures/loop.png"):
        assert (results / name).stat().st_size > 1000
    assert dataset(results).equals(undisturbed(sweep, tmp_path / "alone"))
