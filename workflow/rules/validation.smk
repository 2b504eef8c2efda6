# `make validate`: the crack-front model against boundary elements. The cycles of the boundary
# elements are resumed from their last load step; the rule owns what is made of them.
from studies.boundary_elements.parameters import load_validation

VALIDATION = config.get("validation", "config/validation.yaml")
VALIDATED = str(results_folder(Path(VALIDATION)))


rule validation:
    input:
        f"{VALIDATED}/hysteresis.nc",
        f"{VALIDATED}/picture.nc",
        multiext(f"{VALIDATED}/validation", ".md", ".pdf", ".png"),


rule validate:
    output:
        f"{VALIDATED}/validation.md",
        f"{VALIDATED}/hysteresis.nc",
        f"{VALIDATED}/picture.nc",
        multiext(f"{VALIDATED}/validation", ".pdf", ".png"),
    params:
        sources=fingerprint("studies.boundary_elements.study.write_validation"),
        settings=lambda wildcards: repr(load_validation(Path(VALIDATION))),
    shell:
        "python -m studies boundary-elements validate {VALIDATION:q} --output {VALIDATED:q}"
