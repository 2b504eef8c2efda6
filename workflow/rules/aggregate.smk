rule aggregate:
    input:
        expand("{results}/shards/{shard}.json", results=RESULTS, shard=SHARDS),
    output:
        f"{RESULTS}/hysteresis.nc",
    params:
        sources=package_fingerprint(),
        sweep=SWEEP.fingerprint,
    shell:
        "crackfront aggregate {CONFIGURATION:q} --output {RESULTS:q}"
