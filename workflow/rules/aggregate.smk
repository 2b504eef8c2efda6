rule aggregate:
    input:
        expand("{results}/shards/{shard}.json", results=RESULTS, shard=SHARDS),
    output:
        f"{RESULTS}/hysteresis.nc",
    params:
        sources=fingerprint(
            "crackfront.sweep.table.write_hysteresis",
            "crackfront.sweep.table.sweep_row",
            "crackfront.sweep.table.failed_row",
        ),
        sweep=SWEEP.fingerprint,
    shell:
        "crackfront aggregate {CONFIGURATION:q} --output {RESULTS:q}"
