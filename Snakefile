# From a configuration to the figures: simulate -> aggregate -> fit -> figures.
#
#   snakemake --profile workflow/profiles/default --config sweep=config/test.yaml
#
# Every rule calls the command `crackfront`, which can be called by hand as well.
import os
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

from crackfront.data.provenance import package_fingerprint
from crackfront.studies.paper.figure import (
    FIGURES,
    SCALES,
    figure,
    figure_files,
    figure_fingerprint,
    load_figure,
)
from crackfront.sweep.configuration import load_configuration, results_folder
from crackfront.sweep.sweep import shard_fingerprint

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

# The command stands beside the Python that runs Snakemake.
shell.prefix(f"set -euo pipefail; export PATH='{Path(sys.executable).parent}':$PATH; ")


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


include: "workflow/rules/simulate.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/paper.smk"
include: "workflow/rules/validation.smk"
