# `make accuracy`: the numerical errors of every scene, their laws, tables and figures.
ACCURACY = "results/accuracy"
MEASURED = [
    f"{shape}-{energy}"
    for shape in ("chemical", "flat", "h08", "h03")
    for energy in ("0.0025", "0.01", "0.04", "0.16")
]
COVERED = [scene for scene in MEASURED if scene.endswith(("-0.01", "-0.16"))]


wildcard_constraints:
    study="knobs|asked|averages|coverage",
    scene="[a-z0-9.-]+",


rule accuracy:
    input:
        multiext(f"{ACCURACY}/", "accuracy.md", "laws.csv"),
        expand(
            "{results}/{figure}.{suffix}",
            results=ACCURACY,
            figure=["work-precision", "laws"],
            suffix=["pdf", "png"],
        ),


rule accuracy_study:
    output:
        f"{ACCURACY}/{{study}}-{{scene}}.nc",
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront accuracy {wildcards.scene} --study {wildcards.study} --output {ACCURACY:q}"


rule accuracy_report:
    input:
        expand("{results}/knobs-{scene}.nc", results=ACCURACY, scene=MEASURED),
        expand(
            "{results}/asked-{scene}.nc",
            results=ACCURACY,
            scene=[*MEASURED, "small-0.04", "large-0.04"],
        ),
        expand("{results}/coverage-{scene}.nc", results=ACCURACY, scene=COVERED),
        f"{ACCURACY}/averages-flat-0.04.nc",
    output:
        f"{ACCURACY}/accuracy.md",
        f"{ACCURACY}/laws.csv",
        expand(
            "{results}/{figure}.{suffix}",
            results=ACCURACY,
            figure=["work-precision", "laws"],
            suffix=["pdf", "png"],
        ),
    params:
        sources=package_fingerprint(),
    shell:
        "crackfront accuracy-report --output {ACCURACY:q}"
