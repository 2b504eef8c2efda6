# What the rules share: the settings of a run, checked, and functions that say how a job is run.
import os
import shlex
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

BASE = Path(workflow.current_basedir).parents[1]
sys.path.insert(0, str(BASE))  # where the studies stand

from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.core.resources import memory_at_hand
from crackfront.simulate.costs import expected_cost
from crackfront.sweep.changed_keys import change_sentence
from crackfront.sweep.feasibility import check_feasible
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.results_folder import check_configuration, results_folder
from crackfront.sweep.requests import (
    Request,
    fit_request,
    shard_request,
    table_request,
)
from crackfront.sweep.watching import SweepBar
from studies.boundary_elements.parameters import load_validation
from studies.paper.figure import (
    FIGURES,
    SCALES,
    figure,
    figure_sources,
    files_of_figure,
    load_figure,
    sweep_of_figure,
)

unknown = set(config) - {"sweep", "ranks", "block", "scale", "validation"}
if unknown:
    raise WorkflowError(
        f"unknown key of --config: {', '.join(sorted(unknown))}; its keys are sweep "
        "(a file), ranks, block (realisations of a job), scale (of the paper's figures), and "
        "validation (a file)"
    )

SCALE = config.get("scale", "quick")
if SCALE not in SCALES:
    raise WorkflowError(f"scale is {SCALE!r}; choose one of {', '.join(SCALES)}")
if not isinstance(config.get("ranks", 1), int) or config.get("ranks", 1) < 1:
    raise WorkflowError(
        f"ranks is {config['ranks']!r}; give a whole number of 1 or more"
    )


def shipped(path):
    """A file of this repository, from the folder in which the workflow runs."""
    return os.path.relpath(BASE / path)


# What stages are asked for, by the names of their files: the rule `request` writes them.
REQUESTS = {}


def requested(folder, request):
    """File of a request among the results in a folder, an input of its stage."""
    path = f"{folder}/requests/{request.name}"
    REQUESTS[request.name] = request
    return path


# The figures of the paper, and the sweep of each scale's SI Fig. S-5.
FIGURE_SETTINGS = shipped("config/figures")
SWEEPS = {
    scale: shipped(sweep_of_figure(Path(FIGURE_SETTINGS, "si-5.yaml"), scale))
    for scale in SCALES
}
CONFIGURATION = config.get("sweep", SWEEPS[SCALE])
VALIDATION = config.get("validation", shipped("config/validation.yaml"))
for key, name in (("sweep", CONFIGURATION), ("validation", VALIDATION)):
    if not isinstance(name, str):  # what Snakemake reads as another value
        raise WorkflowError(f"{key} is {name!r}; give the name of a file")
try:
    RESULTS = str(results_folder(Path(CONFIGURATION)))
    SWEEP = load_sweep(Path(CONFIGURATION))
    check_feasible(SWEEP, Path(CONFIGURATION))
    check_configuration(Path(CONFIGURATION), Path(RESULTS))
    SHARDS = {shard.name: shard for shard in SWEEP.shards(config.get("block"))}
    VALIDATED = str(results_folder(Path(VALIDATION)))
    check_configuration(Path(VALIDATION), Path(VALIDATED))
except (OSError, ValueError) as error:
    raise WorkflowError(str(error)) from None

# The reasons of Snakemake name requests by digests; these are the keys that changed them.
CHANGED = change_sentence(Path(RESULTS, "configuration.yaml"), Path(CONFIGURATION))
if CHANGED and workflow.is_main_process:
    print(CHANGED, file=sys.stderr)

SHARD_REQUESTS = {
    name: requested(RESULTS, shard_request(SWEEP, shard))
    for name, shard in SHARDS.items()
}
TABLE_REQUEST = requested(RESULTS, table_request(SWEEP))
FIT_REQUEST = requested(RESULTS, fit_request(SWEEP))
SWEEP_FIGURES = ["hysteresis", "loop", "factor"]


# Commands stand next to the Python that runs Snakemake, in a folder of any name. What they print is
# shown and kept; tee outlives the signals that end what it shows.
def command(name):
    """A command of the environment as shells and Snakemake read it."""
    path = shlex.quote(str(Path(sys.executable).parent / name))
    return path.replace("{", "{{").replace("}", "}}")


def launcher():
    """The mpiexec of the environment, or of the system (`make env MPI=system`)."""
    path = Path(sys.executable).parent / "mpiexec"
    return shlex.quote(str(path)) if path.exists() else "mpiexec"


def importable(path):
    """Setting of a shell by which Python finds modules in a folder."""
    quoted = shlex.quote(str(path)).replace("{", "{{").replace("}", "}}")
    return f"PYTHONPATH={quoted}${{{{PYTHONPATH:+:$PYTHONPATH}}}} "


CRACKFRONT = command("crackfront")
PYTHON = command("python")
STUDIES = importable(BASE) + PYTHON + " -m studies"
# Targets of the output of a command: the log and the user, or only errors to the user as well;
# such a command begins with a new log.
LOGGED = " > >(trap '' INT TERM HUP; exec tee {log:q}) 2>&1"
TO_LOG = " >> {log:q} 2> >(trap '' INT TERM HUP; exec tee --append {log:q} >&2)"
NEW_LOG = ": > {log:q}; "


# Functions of an output are not a reason to run a job again, and know a module's prefix of paths.
def folder(wildcards, output):
    """Folder of the first file of a rule."""
    return str(Path(output[0]).parent)


def folder_above(wildcards, output):
    """Folder above the folder of the first file of a rule."""
    return str(Path(output[0]).parents[1])


def configuration(wildcards, output):
    """File of the configuration of the sweep."""
    return CONFIGURATION


def megabytes(number):
    """Memory to ask for where a number of bytes is expected. (Units: MB)

    A job on a cluster also runs Snakemake twice, 0.3 GB each.
    """
    return max(1000, int(number * 1.5e-6) + 1)


def minutes(seconds):
    """Time to ask for where some seconds are expected, which on slower machines are more."""
    return 10 + int(seconds * 3 / 60)
