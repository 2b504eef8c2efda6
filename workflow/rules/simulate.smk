# What a stage is asked for, in a small file whose name ends with the digest of its text. Another
# configuration asks for another file, which is newer than what the stage made before; so dates alone
# say what belongs to it, whatever Snakemake remembers. The file of the earlier request goes.


localrules:
    request,


rule request:
    output:
        "{folder}/requests/{request}.txt",
    params:
        text=lambda wildcards: REQUESTS[f"{wildcards.request}.txt"].text,
        siblings=lambda wildcards: REQUESTS[f"{wildcards.request}.txt"].siblings,
    shell:
        'find "$(dirname {output:q})" -maxdepth 1 -name {params.siblings:q} -delete'
        " && printf %s {params.text:q} > {output:q}"


# Expected costs of a simulation, for each spectrum and amplitude.
COSTS = {
    item.name: [expected_cost(first) for first in SWEEP.one_per_amplitude(item)]
    for item in SWEEP.spectra
}
RANK_BYTES = max(cost.memory for costs in COSTS.values() for cost in costs)
SECONDS = {
    name: len(shard.realisations) * sum(cost.seconds for cost in COSTS[shard.item.name])
    for name, shard in SHARDS.items()
}


SHORT_SECONDS = (
    30  # of processor time: starting ranks on all cores costs more than they save
)


def shard_cores(cores):
    """One core where twice as many shards are left, or they are short; else all cores in turn.

    Shards side by side must also fit into memory.
    """
    n_left = sum(not Path(RESULTS, f"shards/{name}.nc").exists() for name in SHARDS)
    is_short = max(SECONDS.values()) < SHORT_SECONDS
    side_by_side = (
        n_left >= 2 * cores or is_short
    ) and cores * RANK_BYTES < memory_at_hand()
    return 1 if side_by_side else cores


RANKS = config.get("ranks", shard_cores(workflow.resource_settings.cores or 1))


# Of simulations a terminal shows one bar of the whole sweep, and what goes wrong; a log all lines.
SIZES = {
    name: len(SWEEP.elastic_energies) * len(shard.realisations)
    for name, shard in SHARDS.items()
}
BAR = SweepBar(SIZES, Path(RESULTS))
SIMULATED = (
    " >> {log:q} 2> >(trap '' INT TERM HUP; exec tee --append {log:q} >&2)"
    if BAR.terminal
    else LOGGED
)


def block_option(shard):
    """First and last realisation of a job."""
    return f"{shard.realisations.start}-{shard.realisations.stop - 1}"


# One job a shard, spread over MPI ranks inside; its output is the rows of the shard. Finished
# simulations are in `curves/`, which no rule declares: Snakemake deletes what a failed job declares,
# and they must survive. One rank hands out the work and hardly needs a core.
rule simulate:
    input:
        lambda wildcards: SHARD_REQUESTS[wildcards.shard],
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
        # A profile may set both: Slurm lets a launcher start two tasks or more, and no launcher one.
        tasks=lambda wildcards, threads: threads + 1 if threads > 1 else 1,
        mpi=lambda wildcards, threads: launcher() if threads > 1 else "",
        cpus_per_task=1,
        mem_mb_per_cpu=megabytes(RANK_BYTES),
        runtime=240,  # minutes; what is not done by then goes on in the next job
    params:
        spectrum=lambda wildcards: SHARDS[wildcards.shard].item.name,
        block=lambda wildcards: block_option(SHARDS[wildcards.shard]),
        # One task needs no launcher. As a function of resources this is not a reason to run again.
        launch=lambda wildcards, resources: (
            f"{resources.mpi or launcher()} -n {resources.tasks}"
            if resources.tasks > 1
            else ""
        ),
        configuration=configuration,
        results=folder_above,
    shell:
        # The command takes the shell's place, so that it gets the notice before a time limit.
        f": > {{log:q}}; export OMP_NUM_THREADS=1; exec {{params.launch}}"
        f" {PYTHON} -m crackfront simulate {{params.configuration:q}}"
        f" --output {{params.results:q}} --spectrum {{params.spectrum}}"
        f" --realisations {{params.block}}{SIMULATED}"
