# From a configuration to the figures: simulate -> aggregate -> fit with its figures.
#
#   snakemake --profile workflow/profiles/default --config sweep=config/test.yaml
#
# Every rule calls `crackfront` or `python -m studies`, which can be called by hand as well. What a
# stage was asked for is a small file in `requests/`; dates decide what runs again. Reading this
# changes nothing in results/.
# Other workflows use it as a module (docs/cluster.md).
include: "workflow/rules/common.smk"


report: "workflow/report/workflow.rst"


wildcard_constraints:
    shard=r"[A-Za-z0-9_-]+(\.\d+-\d+)?",


rule all:
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
        f"{RESULTS}/SHA256SUMS",
        # Listed, since Snakemake does not make a missing input of a file that is there.
        expand("{results}/shards/{shard}.nc", results=RESULTS, shard=SHARDS),
        [*SHARD_REQUESTS.values(), TABLE_REQUEST, FIT_REQUEST],


onstart:
    BAR.begin()


onsuccess:
    BAR.end()


onerror:
    BAR.end()


include: "workflow/rules/simulate.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/paper.smk"
include: "workflow/rules/validation.smk"
include: "workflow/rules/surfaces.smk"
include: "workflow/rules/checksums.smk"
