# `make accuracy`: the numerical errors of every scene, their laws, tables and figures.
ACCURACY = "results/accuracy"
MEASURED = [
    f"{shape}-{energy}"
    for shape in ("chemical", "flat", "h08", "h03")
    for energy in ("0.001", "0.0025", "0.01", "0.04", "0.16", "0.4")
]
UNSEEN = [
    *("c015-0.005", "c015-0.02", "c015-0.08", "c015-0.25"),
    *("f013-0.0015", "f013-0.003", "f013-0.01", "f013-0.06", "f013-0.14"),
    *("f013-0.25", "f013-0.4", "band-0.005", "band-0.03", "band-0.1"),
    *("h02-0.005", "h02-0.02", "h02-0.4", "h05-0.0015", "h05-0.003", "h05-0.01"),
    *("h05-0.06", "h05-0.14", "h05-0.25", "h05-0.4", "h09-0.02", "h09-0.06"),
    "h09-0.25",
]
EXPECTED = [
    *("octaves-0.01", "octaves-0.02", "octaves-0.05", "octaves-0.1", "octaves-0.2"),
    *("band-0.005", "f013-0.003", "h02-0.02", "h09-0.02"),
]
COVERED = [scene for scene in MEASURED if scene.endswith(("-0.01", "-0.16", "-0.4"))]


wildcard_constraints:
    study="settings|requested|unseen|expected|averages|coverage",
    scene="[a-z0-9.-]+",


def accuracy_surfaces(wildcards):
    """Surfaces of a study: many where few of them have an avalanche."""
    if wildcards.study == "expected":
        return 64
    is_weak = wildcards.scene.endswith(("-0.001", "-0.0025", "-0.01"))
    return 24 if wildcards.study == "settings" and is_weak else 8


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
    log:
        f"{ACCURACY}/logs/{{study}}-{{scene}}.log",
    benchmark:
        f"{ACCURACY}/benchmarks/{{study}}-{{scene}}.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=240,
    params:
        versions=(PHYSICS_VERSION, ROWS_VERSION),
        surfaces=accuracy_surfaces,
        results=folder,
    shell:
        f"{STUDIES} accuracy scene {{wildcards.scene}} --study {{wildcards.study}}"
        f" --realisations {{params.surfaces}} --output {{params.results:q}}{LOGGED}"


rule accuracy_report:
    input:
        expand("{results}/settings-{scene}.nc", results=ACCURACY, scene=MEASURED),
        expand(
            "{results}/requested-{scene}.nc",
            results=ACCURACY,
            scene=[*MEASURED, "small-0.04", "large-0.04"],
        ),
        expand(
            "{results}/unseen-{scene}.nc",
            results=ACCURACY,
            scene=[*MEASURED, "small-0.04", "large-0.04", *UNSEEN],
        ),
        expand("{results}/expected-{scene}.nc", results=ACCURACY, scene=EXPECTED),
        expand("{results}/coverage-{scene}.nc", results=ACCURACY, scene=COVERED),
        f"{ACCURACY}/averages-flat-0.04.nc",
    output:
        f"{ACCURACY}/accuracy.md",
        f"{ACCURACY}/laws.csv",
        f"{ACCURACY}/SHA256SUMS",
        expand(
            "{results}/{figure}.{suffix}",
            results=ACCURACY,
            figure=["work-precision", "laws"],
            suffix=["pdf", "png"],
        ),
    log:
        f"{ACCURACY}/logs/report.log",
    benchmark:
        f"{ACCURACY}/benchmarks/report.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        versions=ROWS_VERSION,
        results=folder,
    shell:
        f"{STUDIES} accuracy report --output {{params.results:q}}{LOGGED}"
