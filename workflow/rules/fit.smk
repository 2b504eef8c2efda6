# k, its figures and its page, by one command: starting one costs as much as a small fit.
rule fit:
    input:
        FIT_REQUEST,
        f"{RESULTS}/hysteresis.nc",
    output:
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
        expand("{results}/figures/{figure}.pdf", results=RESULTS, figure=SWEEP_FIGURES),
        *[
            report(
                f"{RESULTS}/figures/{figure}.png",
                caption=f"../report/{figure}.rst",
                category="Figures",
                labels={"figure": figure},
            )
            for figure in SWEEP_FIGURES
        ],
        report(
            f"{RESULTS}/summary.html",
            caption="../report/summary.rst",
            category="Fit, configuration and provenance",
        ),
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
