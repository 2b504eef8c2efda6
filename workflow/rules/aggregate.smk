rule aggregate:
    input:
        CONFIGURATION,
        expand(
            "{results}/shards/{spectrum}.json",
            results=RESULTS,
            spectrum=[item.name for item in SWEEP.spectra],
        ),
    output:
        f"{RESULTS}/hysteresis.nc",
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront aggregate {CONFIGURATION:q} --output {RESULTS:q}"
