# The surfaces of a sweep, a file for each spectrum, for those who want to look at them: nothing else
# reads them. `snakemake surfaces` makes them.
rule surface_file:
    input:
        TABLE_REQUEST,
    output:
        f"{RESULTS}/surfaces/{{spectrum}}.nc",
    log:
        f"{RESULTS}/logs/surfaces-{{spectrum}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/surfaces-{{spectrum}}.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=megabytes(RANK_BYTES),
        runtime=60,
    params:
        configuration=configuration,
        results=folder_above,
    shell:
        f"{CRACKFRONT} surfaces {{params.configuration:q}}"
        f" --output {{params.results:q}} --spectrum {{wildcards.spectrum}}{LOGGED}"


rule surfaces:
    input:
        expand(
            "{results}/surfaces/{spectrum}.nc",
            results=RESULTS,
            spectrum=[item.name for item in SWEEP.spectra],
        ),
