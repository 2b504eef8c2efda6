# One job a shard, spread over MPI ranks inside. The finished simulations stand in `curves/`,
# which no rule declares: Snakemake deletes what a failed job declares, and they must survive.
import shlex


def rank_options(resources, threads):
    """How many ranks simulate and what starts them, where a profile says so."""
    # The rank that hands out the work is a task of the profile, and no thread of this machine.
    ranks = resources.get("tasks", threads + 1) - 1
    launcher = resources.get("mpi")
    return f"--ranks {ranks}" + (
        f" --launcher {shlex.quote(launcher)}" if launcher else ""
    )


def block_option(shard):
    """First and last realisation of a job."""
    return f"{shard.realisations.start}-{shard.realisations.stop - 1}"


rule simulate:
    output:
        f"{RESULTS}/shards/{{shard}}.json",
    # What takes all cores comes before what takes one, which would leave the others waiting: jobs
    # are chosen by the sum of their priorities.
    priority: 100
    threads: int(config.get("ranks", workflow.resource_settings.cores or 1))
    params:
        # Changes with everything that determines the simulations, the solver's sources included.
        fingerprint=lambda wildcards: SWEEP.shard_fingerprint(SHARDS[wildcards.shard]),
        spectrum=lambda wildcards: SHARDS[wildcards.shard].item.name,
        block=lambda wildcards: block_option(SHARDS[wildcards.shard]),
        # No reason to run a job again, as a function of resources is none to Snakemake.
        ranks=lambda wildcards, resources, threads: rank_options(resources, threads),
    shell:
        # The command takes the shell's place, so that it gets the notice before a time limit.
        "exec crackfront simulate {CONFIGURATION:q} --output {RESULTS:q}"
        " --spectrum {params.spectrum} --realisations {params.block} {params.ranks}"
