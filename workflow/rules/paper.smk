# `make figures`: every computed figure of the paper, with its data and its checks. One job computes
# the data of a figure, another draws them, so that a change of the drawing computes nothing again.
PAPER = f"results/figures/{SCALE}"
# Names, as reading this must not import what computes the figures.
ANIMATED = ["beyond-animation", "beyond-video"]


def expected_seconds(name):
    """Processor time of the data of a figure of the paper."""
    parameters = load_figure(Path(FIGURE_SETTINGS, f"{name}.yaml"), SCALE)
    return figure(name).seconds(parameters)


def figure_request(name):
    """What a figure of the paper is asked for."""
    parameters = load_figure(Path(FIGURE_SETTINGS, f"{name}.yaml"), SCALE)
    text = f"{parameters!r}\nversions {PHYSICS_VERSION} and {ROWS_VERSION}\n"
    return requested(PAPER, Request(name, text))


def figure_inputs(wildcards):
    """What data of a figure are computed from: its request, module, and files of its parameters."""
    name = getattr(wildcards, "figure", "si-5")
    parameters = load_figure(Path(FIGURE_SETTINGS, f"{name}.yaml"), SCALE)
    files = files_of_figure(parameters)
    return [figure_request(name), str(figure_sources(name)[0]), *files]


def figure_drawing_module(wildcards):
    """Module that draws and checks a figure of the paper."""
    return str(figure_sources(wildcards.figure)[1])


def figure_file(wildcards, output):
    """Configuration of a figure of the paper, which has the same name as its data."""
    return f"{FIGURE_SETTINGS}/{Path(output[0]).stem}.yaml"


wildcard_constraints:
    figure="(main|si|beyond)-[a-z0-9-]+",


ruleorder: figure_animation > figure_drawing


rule figures:
    input:
        expand(
            "{results}/{figure}.{suffix}",
            results=PAPER,
            figure=FIGURES,
            suffix=["nc", "pdf", "png"],
        ),
        expand("{results}/{figure}.gif", results=PAPER, figure=ANIMATED),
        "results/figures/checks.md",
        "results/figures/SHA256SUMS",
        # Listed, since Snakemake does not make a missing input of a file that is there.
        lambda wildcards: [figure_request(name) for name in FIGURES],


rule figure_data:
    input:
        figure_inputs,
    output:
        f"{PAPER}/{{figure}}.nc",
    log:
        f"{PAPER}/logs/{{figure}}-data.log",
    benchmark:
        f"{PAPER}/benchmarks/{{figure}}-data.tsv"
    # The longest begins first: if it began last, the other cores would wait for it.
    priority: lambda wildcards: expected_seconds(wildcards.figure)
    resources:
        cpus_per_task=1,
        mem_mb=5000,
        runtime=lambda wildcards: minutes(expected_seconds(wildcards.figure)),
    params:
        file=figure_file,
        results=folder_above,
    shell:
        f"{STUDIES} paper figure {{params.file:q}} --scale {SCALE}"
        f" --output {{params.results:q}}{LOGGED}"


rule figure_of_sweep:
    input:
        figure_inputs,
        table=f"results/{Path(SWEEPS[SCALE]).stem}/hysteresis.nc",
    output:
        f"{PAPER}/si-5.nc",
    log:
        f"{PAPER}/logs/si-5-data.log",
    benchmark:
        f"{PAPER}/benchmarks/si-5-data.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=2000,
        runtime=60,
    params:
        file=figure_file,
        results=folder_above,
    shell:
        f"{STUDIES} paper figure {{params.file:q}} --scale {SCALE}"
        f" --output {{params.results:q}}{LOGGED}"


ruleorder: figure_of_sweep > figure_data


rule figure_drawing:
    input:
        figure_drawing_module,
        data=f"{PAPER}/{{figure}}.nc",
    output:
        f"{PAPER}/{{figure}}.pdf",
        f"{PAPER}/{{figure}}.png",
    log:
        f"{PAPER}/logs/{{figure}}-drawing.log",
    benchmark:
        f"{PAPER}/benchmarks/{{figure}}-drawing.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=4000,
        runtime=30,
    shell:
        f"{STUDIES} paper draw {{input.data:q}}{LOGGED}"


rule figure_animation:
    input:
        figure_drawing_module,
        data=f"{PAPER}/{{figure}}.nc",
    output:
        f"{PAPER}/{{figure}}.pdf",
        f"{PAPER}/{{figure}}.png",
        f"{PAPER}/{{figure}}.gif",
    log:
        f"{PAPER}/logs/{{figure}}-drawing.log",
    benchmark:
        f"{PAPER}/benchmarks/{{figure}}-drawing.tsv"
    wildcard_constraints:
        figure="|".join(ANIMATED),
    resources:
        cpus_per_task=1,
        mem_mb=4000,
        runtime=30,
    shell:
        f"{STUDIES} paper draw {{input.data:q}}{LOGGED}"


rule figure_checks:
    input:
        expand("{results}/{figure}.nc", results=PAPER, figure=FIGURES),
        lambda wildcards: [figure_sources(name)[1] for name in FIGURES],
    output:
        "results/figures/checks.md",
    log:
        "results/figures/logs/checks.log",
    benchmark:
        "results/figures/benchmarks/checks.tsv"
    resources:
        cpus_per_task=1,
        mem_mb=4000,
        runtime=30,
    params:
        scale=SCALE,
        results=folder,
    shell:
        f"{STUDIES} paper check --output {{params.results:q}}{LOGGED}"
