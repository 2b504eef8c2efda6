rule fit:
    input:
        f"{RESULTS}/hysteresis.nc",
    output:
        multiext(f"{RESULTS}/fit", ".nc", ".json", ".md"),
    params:
        sources=fingerprint(
            "crackfront.analysis.sweep.fit_sweep",
            "crackfront.sweep.fit_files.write_fit",
            "crackfront.sweep.table.read_table",
        ),
        sweep=SWEEP.fingerprint,
    shell:
        "crackfront fit {CONFIGURATION:q} --output {RESULTS:q}"


rule summary:
    input:
        f"{RESULTS}/hysteresis.nc",
        expand("{results}/figures/{figure}.png", results=RESULTS, figure=SWEEP_FIGURES),
    output:
        report(
            f"{RESULTS}/summary.html",
            caption="../report/summary.rst",
            category="Fit, configuration and provenance",
        ),
    params:
        sources=fingerprint(
            "crackfront.analysis.sweep.fit_sweep",
            "crackfront.analysis.report.fit_table",
            "crackfront.sweep.summary.summary_page",
        ),
        sweep=SWEEP.fingerprint,
    shell:
        "crackfront summary {CONFIGURATION:q} --output {RESULTS:q}"
