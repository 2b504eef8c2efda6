# `make validate`: the crack-front model against boundary elements. The cycles of the boundary
# elements are resumed from their last load step; the rule owns what is made of them.
def validation_request(wildcards):
    """What a validation is asked for."""
    text = f"{load_validation(Path(VALIDATION))!r}\nversions {PHYSICS_VERSION} and {ROWS_VERSION}\n"
    return requested(VALIDATED, Request("validation", text))


rule validation:
    input:
        f"{VALIDATED}/hysteresis.nc",
        f"{VALIDATED}/picture.nc",
        multiext(f"{VALIDATED}/validation", ".md", ".pdf", ".png"),
        # Listed, since Snakemake does not make a missing input of a file that is there.
        validation_request,


rule validate:
    input:
        validation_request,
    output:
        f"{VALIDATED}/validation.md",
        f"{VALIDATED}/hysteresis.nc",
        f"{VALIDATED}/picture.nc",
        f"{VALIDATED}/SHA256SUMS",
        multiext(f"{VALIDATED}/validation", ".pdf", ".png"),
    log:
        f"{VALIDATED}/logs/validate.log",
    benchmark:
        f"{VALIDATED}/benchmarks/validate.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=8000,
        runtime=1440,
    params:
        configuration=lambda wildcards, output: VALIDATION,
        results=folder,
    shell:
        f"{STUDIES} boundary-elements validate {{params.configuration:q}}"
        f" --output {{params.results:q}}{LOGGED}"
