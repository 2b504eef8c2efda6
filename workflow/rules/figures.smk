rule sweep_figures:
    input:
        FIT_REQUEST,
        f"{RESULTS}/hysteresis.nc",
    output:
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
    log:
        f"{RESULTS}/logs/figures.log",
    benchmark:
        f"{RESULTS}/benchmarks/figures.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        configuration=configuration,
        results=folder_above,
    shell:
        f"{NEW_LOG}{CRACKFRONT} figures {{params.configuration:q}}"
        f" --output {{params.results:q}}{TO_LOG}"
