rule sweep_figures:
    input:
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
    params:
        sources=fingerprint(
            "crackfront.analysis.steady.steady_adhesion",
            "crackfront.analysis.sweep.fit_sweep",
            "crackfront.plots.loop",
            "crackfront.plots.style.save_figure",
            "crackfront.plots.sweep",
        ),
        sweep=SWEEP.fingerprint,
    shell:
        "crackfront figures {CONFIGURATION:q} --output {RESULTS:q}"
