# `make validate`: the crack-front model against boundary elements. The cycles of the boundary
# elements are resumed from their last load step; the rule owns what is made of them.
VALIDATION = config.get("validation", "config/validation.yaml")
VALIDATED = str(results_folder(Path(VALIDATION)))


rule validation:
    input:
        f"{VALIDATED}/validation.md",


rule validate:
    input:
        VALIDATION,
    output:
        f"{VALIDATED}/validation.md",
        f"{VALIDATED}/differences.nc",
        f"{VALIDATED}/picture.nc",
        multiext(f"{VALIDATED}/validation", ".pdf", ".png"),
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront validate {input:q} --output {VALIDATED:q}"
