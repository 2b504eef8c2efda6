rule sweep_figures:
    input:
        CONFIGURATION,
        f"{RESULTS}/hysteresis.nc",
    output:
        expand(
            "{results}/figures/{figure}.{suffix}",
            results=RESULTS,
            figure=["hysteresis", "loop", "factor"],
            suffix=["pdf", "png"],
        ),
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront figures {CONFIGURATION:q} --output {RESULTS:q}"
