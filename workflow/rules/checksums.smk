# The last job of a folder of results writes its list of checksums, for `crackfront verify` and
# `sha256sum --check`. Jobs that change the folder remove the list.
rule checksums:
    input:
        f"{RESULTS}/hysteresis.nc",
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
        expand(
            "{results}/figures/{figure}.{suffix}",
            results=RESULTS,
            figure=SWEEP_FIGURES,
            suffix=["pdf", "png"],
        ),
        f"{RESULTS}/summary.html",
    output:
        f"{RESULTS}/SHA256SUMS",
    log:
        f"{RESULTS}/logs/checksums.log",
    benchmark:
        f"{RESULTS}/benchmarks/checksums.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=30,
    params:
        results=folder,
    shell:
        f"{NEW_LOG}{CRACKFRONT} checksums {{params.results:q}}{TO_LOG}"


rule figure_checksums:
    input:
        expand(
            "{results}/{figure}.{suffix}",
            results=PAPER,
            figure=FIGURES,
            suffix=["nc", "pdf", "png"],
        ),
        expand("{results}/{figure}.gif", results=PAPER, figure=ANIMATED),
        "results/figures/checks.md",
    output:
        "results/figures/SHA256SUMS",
    log:
        "results/figures/logs/checksums.log",
    benchmark:
        "results/figures/benchmarks/checksums.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=1000,
        runtime=30,
    params:
        results=folder,
    shell:
        f"{NEW_LOG}{CRACKFRONT} checksums {{params.results:q}}{TO_LOG}"
