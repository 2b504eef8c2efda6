# One job a shard, spread over MPI ranks inside; its output is the rows of the shard. Each finished
# simulation stands in `curves/`, which no rule declares: Snakemake deletes what a failed job
# declares, and they must survive.
rule simulate:
    output:
        f"{RESULTS}/shards/{{shard}}.nc",
    log:
        f"{RESULTS}/logs/simulate-{{shard}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/simulate-{{shard}}.tsv"
    # What takes all cores comes before what takes one, which would leave the others waiting: jobs
    # are chosen by the sum of their priorities. The longest of them comes first.
    priority: lambda wildcards: 100 + SECONDS[wildcards.shard]
    threads: RANKS
    resources:
        # Tasks and a launcher are a profile's. What is not done in time goes on in the next job.
        cpus_per_task=1,
        mem_mb_per_cpu=megabytes(RANK_BYTES),
        runtime=240,
    params:
        # Changes with the parameters of the simulations and with the versions.
        request=lambda wildcards: shard_request(
            FIRSTS[SHARDS[wildcards.shard].item.name],
            SHARDS[wildcards.shard].realisations,
        ),
        spectrum=lambda wildcards: SHARDS[wildcards.shard].item.name,
        block=lambda wildcards: block_option(SHARDS[wildcards.shard]),
        # No reason to run a job again, as a function of resources is none to Snakemake.
        ranks=lambda wildcards, resources, threads: rank_options(resources, threads),
        configuration=configuration,
        results=folder_above,
    shell:
        # The command takes the shell's place, so that it gets the notice before a time limit.
        f": > {{log:q}}; exec {CRACKFRONT} simulate {{params.configuration:q}}"
        f" --output {{params.results:q}} --spectrum {{params.spectrum}}"
        f" --realisations {{params.block}} {{params.ranks}}{SIMULATED}"
