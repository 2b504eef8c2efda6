rule aggregate:
    input:
        TABLE_REQUEST,
        expand("{results}/shards/{shard}.nc", results=RESULTS, shard=SHARDS),
    output:
        f"{RESULTS}/hysteresis.nc",
    log:
        f"{RESULTS}/logs/aggregate.log",
    benchmark:
        f"{RESULTS}/benchmarks/aggregate.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        configuration=configuration,
        results=folder,
    shell:
        f"{NEW_LOG}{CRACKFRONT} aggregate {{params.configuration:q}}"
        f" --output {{params.results:q}}{TO_LOG}"
