rule fit:
    input:
        CONFIGURATION,
        f"{RESULTS}/hysteresis.nc",
    output:
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront fit {CONFIGURATION:q} --output {RESULTS:q}"


rule summary:
    input:
        CONFIGURATION,
        f"{RESULTS}/hysteresis.nc",
        f"{RESULTS}/fit.md",
        expand("{results}/figures/{figure}.png", results=RESULTS, figure=SWEEP_FIGURES),
    output:
        report(
            f"{RESULTS}/summary.html",
            caption="../report/summary.rst",
            category="Fit, configuration and provenance",
        ),
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront summary {CONFIGURATION:q} --output {RESULTS:q}"
