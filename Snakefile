# From a configuration to the figures: simulate -> aggregate -> fit -> figures.
#
#   snakemake --profile workflow/profiles/default --config sweep=config/test.yaml
#
# Every rule calls the command `crackfront`, which can be called by hand as well.
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

from crackfront.config import (
    SCALES,
    ConfigurationError,
    figure_files,
    load_configuration,
    load_figure,
)
from crackfront.figures import FIGURES, figure_fingerprint
from crackfront.provenance import package_fingerprint
from crackfront.sweep import shard_fingerprint

unknown = set(config) - {"sweep", "ranks", "scale"}
if unknown:
    raise WorkflowError(
        f"--config knows no {', '.join(sorted(unknown))}; its keys are sweep (a file), ranks, scale"
    )

SCALE = config.get("scale", "quick")
if SCALE not in SCALES:
    raise WorkflowError(f"scale is {SCALE!r}; choose one of {', '.join(SCALES)}")

# The sweep of each scale's SI Fig. S-5.
SWEEPS = {
    scale: load_figure(Path("config/figures/si-5.yaml"), scale).sweep
    for scale in SCALES
}
CONFIGURATION = config.get("sweep", SWEEPS[SCALE])
RESULTS = f"results/{Path(CONFIGURATION).stem}"
try:
    SWEEP = load_configuration(Path(CONFIGURATION))
except ConfigurationError as error:
    raise WorkflowError(str(error)) from None

# The command stands beside the Python that runs Snakemake.
shell.prefix(f"set -euo pipefail; export PATH='{Path(sys.executable).parent}':$PATH; ")


wildcard_constraints:
    spectrum="[A-Za-z0-9_-]+",


rule all:
    default_target: True
    input:
        expand(
            "{results}/figures/{figure}.{suffix}",
            results=RESULTS,
            figure=["hysteresis", "loop", "factor"],
            suffix=["pdf", "png"],
        ),
        f"{RESULTS}/fit.md",


include: "workflow/rules/simulate.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/paper.smk"
