# One job a spectrum, spread over MPI ranks inside. The finished simulations stand in `curves/`,
# which no rule declares: Snakemake deletes what a failed job declares, and they must survive.
rule simulate:
    output:
        f"{RESULTS}/shards/{{spectrum}}.json",
    threads: int(config.get("ranks", workflow.cores or 1))
    params:
        # Changes with everything that determines the simulations, the solver's sources included.
        fingerprint=lambda wildcards: shard_fingerprint(
            SWEEP.shard(SWEEP.named(wildcards.spectrum))
        ),
    shell:
        "crackfront simulate {CONFIGURATION:q} --output {RESULTS:q}"
        " --spectrum {wildcards.spectrum} --ranks {threads}"
