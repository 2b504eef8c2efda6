rule aggregate:
    input:
        CONFIGURATION,
        expand("{results}/shards/{shard}.json", results=RESULTS, shard=SHARDS),
    output:
        f"{RESULTS}/hysteresis.nc",
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront aggregate {CONFIGURATION:q} --output {RESULTS:q}"
