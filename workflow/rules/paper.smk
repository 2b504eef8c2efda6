# `make figures`: every computed figure of the paper, with its data and its checks. One job computes
# the data of a figure, another draws them, so that a change of the drawing computes nothing again.
PAPER = f"results/figures/{SCALE}"


ANIMATED = [name for name in FIGURES if figure(name).animate]


def expected_seconds(name):
    """Processor time of the data of a figure."""
    parameters = load_figure(Path(FIGURE_SETTINGS, f"{name}.yaml"), SCALE)
    return figure(name).seconds(parameters)


# Those that take longest go first: one that began last would leave the other cores waiting.
LONGEST = sorted(FIGURES, key=expected_seconds)[-5:]


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


def settings_of(wildcards):
    """What the data of a figure are computed from beside the sources."""
    name = getattr(wildcards, "figure", "si-5")
    return settings_fingerprint(Path(FIGURE_SETTINGS, f"{name}.yaml"), SCALE)


rule figure_data:
    output:
        f"{PAPER}/{{figure}}.nc",
    params:
        sources=lambda wildcards: figure_fingerprint(wildcards.figure),
        settings=settings_of,
    shell:
        "python -m studies paper figure {FIGURE_SETTINGS:q}/{wildcards.figure}.yaml --scale {SCALE}"
        " --output results/figures"


use rule figure_data as longest_figure_data with:
    output:
        f"{PAPER}/{{figure}}.nc",
    wildcard_constraints:
        figure="|".join(LONGEST),
    priority: 1


rule figure_of_sweep:
    input:
        f"results/{Path(SWEEPS[SCALE]).stem}/hysteresis.nc",
    output:
        f"{PAPER}/si-5.nc",
    params:
        sources=figure_fingerprint("si-5"),
        fit=fingerprint("crackfront.analysis.sweep.fit_sweep"),
        settings=settings_of,
        sweep=lambda wildcards: load_configuration(Path(SWEEPS[SCALE])).fingerprint,
    shell:
        "python -m studies paper figure {FIGURE_SETTINGS:q}/si-5.yaml --scale {SCALE} --output results/figures"


ruleorder: figure_of_sweep > longest_figure_data > figure_data


rule figure_drawing:
    input:
        f"{PAPER}/{{figure}}.nc",
    output:
        f"{PAPER}/{{figure}}.pdf",
        f"{PAPER}/{{figure}}.png",
    params:
        sources=lambda wildcards: drawing_fingerprint(wildcards.figure),
        settings=settings_of,
    shell:
        "python -m studies paper draw {input:q}"


rule figure_animation:
    input:
        f"{PAPER}/{{figure}}.nc",
    output:
        f"{PAPER}/{{figure}}.pdf",
        f"{PAPER}/{{figure}}.png",
        f"{PAPER}/{{figure}}.gif",
    wildcard_constraints:
        figure="|".join(ANIMATED),
    params:
        sources=lambda wildcards: drawing_fingerprint(wildcards.figure),
        settings=settings_of,
    shell:
        "python -m studies paper draw {input:q}"


rule figure_checks:
    input:
        expand("{results}/{figure}.nc", results=PAPER, figure=FIGURES),
    output:
        "results/figures/checks.md",
    params:
        sources=checks_fingerprint(),
        scale=SCALE,
    shell:
        "python -m studies paper check --output results/figures"
