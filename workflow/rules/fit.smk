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
