# From a configuration to the figures: simulate -> aggregate -> fit -> figures.
#
#   snakemake --profile workflow/profiles/default --config sweep=config/test.yaml
#
# Every rule calls `crackfront` or `python -m studies`, which can be called by hand as well. Reading
# this changes nothing in results/: `make` calls `crackfront repair` before, which takes back what is
# damaged or missing. Configurations are parameters of rules, by what they mean: dates decide nothing.
import atexit
import gc
import os
import shlex
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

# Imports make many objects and no garbage, for which Python looks, also as it ends.
gc.set_threshold(1_000_000)
atexit.register(gc.freeze)

sys.path.insert(0, workflow.basedir)  # where the studies stand

from crackfront.data.fingerprint import fingerprint
from crackfront.sweep.configuration import load_configuration, results_folder
from studies.paper.figure import (
    FIGURES,
    SCALES,
    checks_fingerprint,
    drawing_fingerprint,
    figure,
    figure_fingerprint,
    load_figure,
    settings_fingerprint,
)

unknown = set(config) - {"sweep", "ranks", "block", "scale", "validation"}
if unknown:
    raise WorkflowError(
        f"--config knows no {', '.join(sorted(unknown))}; its keys are sweep "
        "(a file), ranks, block (realisations of a job), scale (of the paper's figures), and "
        "validation (a file)"
    )

SCALE = config.get("scale", "quick")
if SCALE not in SCALES:
    raise WorkflowError(f"scale is {SCALE!r}; choose one of {', '.join(SCALES)}")

# The figures of the paper, and the sweep of each scale's SI Fig. S-5.
FIGURE_SETTINGS = os.path.relpath(f"{workflow.basedir}/config/figures")
SWEEPS = {
    scale: load_figure(Path(FIGURE_SETTINGS, "si-5.yaml"), scale).sweep
    for scale in SCALES
}
CONFIGURATION = config.get("sweep", SWEEPS[SCALE])
try:
    RESULTS = str(results_folder(Path(CONFIGURATION)))
    SWEEP = load_configuration(Path(CONFIGURATION))
    SHARDS = {shard.name: shard for shard in SWEEP.shards(config.get("block"))}
except ValueError as error:
    raise WorkflowError(str(error)) from None

SWEEP_FIGURES = ["hysteresis", "loop", "factor"]

# The command stands beside the Python that runs Snakemake, in a folder of any name.
BESIDE = shlex.quote(str(Path(sys.executable).parent))
STUDIES = shlex.quote(str(workflow.basedir))
shell.prefix(
    "set -euo pipefail; export PATH={BESIDE}:$PATH"
    " PYTHONPATH={STUDIES}${{PYTHONPATH:+:$PYTHONPATH}}; "
)


report: "workflow/report/workflow.rst"


wildcard_constraints:
    shard=r"[A-Za-z0-9_-]+(\.\d+-\d+)?",


rule all:
    default_target: True
    input:
        expand(
            "{results}/figures/{figure}.{suffix}",
            results=RESULTS,
            figure=SWEEP_FIGURES,
            suffix=["pdf", "png"],
        ),
        f"{RESULTS}/summary.html",
        f"{RESULTS}/hysteresis.nc",
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
        expand("{results}/shards/{shard}.json", results=RESULTS, shard=SHARDS),


include: "workflow/rules/simulate.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/paper.smk"
include: "workflow/rules/validation.smk"
