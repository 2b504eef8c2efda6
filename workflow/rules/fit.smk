rule fit:
    input:
        FIT_REQUEST,
        f"{RESULTS}/hysteresis.nc",
    output:
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
    log:
        f"{RESULTS}/logs/fit.log",
    benchmark:
        f"{RESULTS}/benchmarks/fit.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        configuration=configuration,
        results=folder,
    shell:
        f"{NEW_LOG}{CRACKFRONT} fit {{params.configuration:q}}"
        f" --output {{params.results:q}}{TO_LOG}"


rule summary:
    input:
        FIT_REQUEST,
        f"{RESULTS}/hysteresis.nc",
        f"{RESULTS}/fit.nc",
        expand("{results}/figures/{figure}.png", results=RESULTS, figure=SWEEP_FIGURES),
    output:
        report(
            f"{RESULTS}/summary.html",
            caption="../report/summary.rst",
            category="Fit, configuration and provenance",
        ),
    log:
        f"{RESULTS}/logs/summary.log",
    benchmark:
        f"{RESULTS}/benchmarks/summary.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        configuration=configuration,
        results=folder,
    shell:
        f"{NEW_LOG}{CRACKFRONT} summary {{params.configuration:q}}"
        f" --output {{params.results:q}}{TO_LOG}"
