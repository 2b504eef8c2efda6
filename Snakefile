# From a configuration to the figures: simulate -> aggregate -> fit -> figures.
#
#   snakemake --profile workflow/profiles/default --config sweep=config/test.yaml
#
# Every rule calls `crackfront` or `python -m studies`, which can be called by hand as well. Reading
# this changes nothing in results/: `make` calls `crackfront repair` before, which takes back what is
# damaged or missing. Configurations are parameters of rules, by what they mean: dates decide nothing.
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
        # A shard that was taken back is made again although the table is there.
        expand("{results}/shards/{shard}.nc", results=RESULTS, shard=SHARDS),


onstart:
    BAR.begin()


onsuccess:
    BAR.end()


onerror:
    BAR.end()


include: "workflow/rules/simulate.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/fit.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/checksums.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/paper.smk"
include: "workflow/rules/validation.smk"
