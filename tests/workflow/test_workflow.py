"""The whole workflow by Snakemake on the configuration `test`, with real ranks of MPI."""

import base64
import contextlib
import json
import os
import pty
import re
import shlex
import shutil
import subprocess
import sys
import termios
import time
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest
import xarray as xr

import crackfront as cf
from crackfront.simulate.checksums import DAMAGED_SUFFIX
from tests.commands import done, simulated
from tests.places import ROOT

COSTS = {"seconds", "cpu_seconds", "peak_memory"}


def command(folder, *settings, sweep=ROOT / "config/test.yaml", ranks=2, plan=False):
    """Command that runs the workflow in a folder of its own; None leaves the ranks to it."""
    chosen = [] if ranks is None else [f"ranks={ranks}"]
    return [
        *(sys.executable, str(ROOT / "workflow/run.py"), *(["--plan", str(sweep)] if plan else [])),
        *("--snakefile", str(ROOT / "Snakefile")),
        *("--profile", str(ROOT / "workflow/profiles/default"), "--directory", str(folder)),
        *("--cores", "2", "--config", f"sweep={sweep}", *chosen, *settings),
    ]


def snakemake(folder, *arguments, shown=subprocess.PIPE, errors=subprocess.PIPE, **options):
    """Run the workflow in a folder of its own."""
    return subprocess.run(
        command(folder, *arguments, **options),
        stdout=shown,
        stderr=errors,
        cwd=folder,
        text=True,
        timeout=900,
        check=False,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )


def finished(folder, *settings, **options):
    """What the workflow and its jobs say of a run to the end without Snakemake's records."""
    shutil.rmtree(folder / ".snakemake", ignore_errors=True)
    for log in folder.glob("results/*/logs/*.log"):
        log.unlink()
    ended = snakemake(folder, *settings, **options)
    assert ended.returncode == 0, ended.stderr
    logs = sorted(folder.glob("results/*/logs/*.log"))
    return "".join([ended.stdout, *(log.read_text(encoding="utf-8") for log in logs)])


def states(folder):
    """Names and moments of all results, without logs and benchmarks."""
    files = [path for path in folder.rglob("*") if path.suffix not in (".log", ".tsv")]
    return {path: path.stat().st_mtime_ns for path in files if path.is_file()}


def made(results, before):
    """Names of results that were made since then, without what no rule declares, and requests."""
    changed = (path for path, moment in states(results).items() if before.get(path) != moment)
    names = {str(path.relative_to(results)) for path in changed}
    return {name for name in names if not name.startswith(("requests", "curves", "configuration"))}


def copied_sweep(folder):
    """Copy of the configuration `test` in a folder."""
    return Path(shutil.copy(ROOT / "config/test.yaml", folder))


def run_on_terminal(folder, sweep, *targets):
    """What a terminal of 24 by 100 letters shows of a run as `make` calls it, without MPI."""
    terminal, side = pty.openpty()
    termios.tcsetwinsize(side, (24, 100))
    with os.fdopen(terminal, encoding="utf-8", errors="replace", newline="") as shown:
        read = ThreadPoolExecutor().submit(_everything, shown)
        with os.fdopen(side, "wb") as output:
            settings = ("--", *targets) if targets else ()
            both = {"shown": output, "errors": output}
            ended = snakemake(folder, *settings, sweep=sweep, ranks=1, plan=True, **both)
        text = read.result()
    assert ended.returncode == 0, text
    assert "fit.md" in (folder / "results" / sweep.stem / "logs/fit.log").read_text()
    return text


def _everything(terminal):
    """What a terminal shows until nothing more can write to it."""
    text = ""
    with contextlib.suppress(OSError):  # the end of a terminal is an error of input
        while part := terminal.read(1):
            text += part
    return text


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Folder of a whole run without MPI."""
    folder = tmp_path_factory.mktemp("whole")
    run_on_terminal(folder, copied_sweep(folder))
    return folder


def test_a_run_says_what_is_to_run_and_shows_one_bar(tmp_path):
    sweep, results = flat_sweep(tmp_path), tmp_path / "results/sweep"
    shown = run_on_terminal(tmp_path, sweep, "results/sweep/fit.md")
    assert shown.startswith("4 simulations = ")
    assert "profile" not in shown  # which Snakemake announces
    assert re.search(r"\r +0%\|.*\| 0/4 ", shown)
    assert re.search(r"\r100%\|.*\| 4/4 ", shown)
    log = (results / "logs/simulate-flat.log").read_bytes()
    assert b"\r" not in log
    assert log.count(b"/4] ") == 4
    assert "/4] " not in shown


def zero_sector(path):
    """Zero the sector of 512 bytes that has most others."""
    content = bytearray(path.read_bytes())
    full = max(range(0, len(content), 512), key=lambda start: 512 - content[start:][:512].count(0))
    content[full : full + 512] = bytes(len(content[full : full + 512]))
    path.write_bytes(content)


def harm(results):
    """Damage files of all kinds, and date one to the future."""
    for name in ("fit.json", "figures/loop.pdf"):
        (results / name).write_bytes(b"{")
    for name in ("shards/flat.nc", "hysteresis.nc"):
        zero_sector(results / name)
    date(2096, results / "summary.html")


def contents(folder):
    """Names, moments and bytes of all results."""
    return {path: (moment, path.read_bytes()) for path, moment in states(folder).items()}


NOT_FOLLOWED = {
    b"Mixed rules and functions in same snakefile.",
    b"No log directive defined",
    b"Specify a conda environment or container for each rule.",
}
"""Advice of `--lint` that is not followed.

Functions stand with their rules, the rule `request` prints nothing, and one environment serves all
rules.
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "verb", ["dry-run", "list-rules", "lint", "dag", "summary", "report=a.html"]
)
def test_reading_the_workflow_changes_nothing_even_where_files_are_damaged(tmp_path, whole, verb):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    harm(tmp_path / "results/test")
    before = contents(tmp_path / "results")
    read = [*command(tmp_path, sweep=tmp_path / "test.yaml"), f"--{verb}"]
    shown = subprocess.run(read, capture_output=True, timeout=600, check=False)
    assert shown.returncode == (verb == "lint"), shown.stderr
    advice = set(re.findall(rb"^ +\* (.*):$", shown.stderr, re.MULTILINE))
    assert advice == (NOT_FOLLOWED if verb == "lint" else set())
    assert contents(tmp_path / "results") == before


@pytest.mark.slow
def test_a_million_simulations_are_planned(tmp_path):
    sweep = tmp_path / "sweep.yaml"
    text = (ROOT / "config/test.yaml").read_text(encoding="utf-8")
    sweep.write_text(text.replace("realisations: 2", "realisations: 250000"))
    options = "--dry-run", "--quiet", "reason"  # and the number of jobs is shown
    planned = snakemake(tmp_path, "block=1000", *options, sweep=sweep)
    assert planned.returncode == 0, planned.stderr
    assert re.search(r"^simulate +500$", planned.stdout, re.MULTILINE)


def seen_in_browser(page, profile):
    """A page as Chromium sees it when its scripts have run, without any network."""
    options = (
        *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
        *("--disable-background-networking", "--disable-component-update"),
        *("--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=10000", "--dump-dom"),
    )
    done = subprocess.run(
        ["chromium", *options, f"--user-data-dir={profile}", page.as_uri()],
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
    )
    return done.stdout


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("chromium"), reason="needs chromium: apt-get install chromium")
def test_the_report_is_one_page_that_a_browser_shows_without_a_network(tmp_path, whole):
    report = tmp_path / "report.html"
    ended = snakemake(whole, "--report", str(report), sweep=whole / "test.yaml", ranks=1)
    assert ended.returncode == 0, ended.stderr
    text = report.read_text(encoding="utf-8")
    for name in ("figures/hysteresis.png", "figures/loop.png", "figures/factor.png"):
        content = (whole / "results/test" / name).read_bytes()
        assert base64.b64encode(content).decode() in text
    seen = seen_in_browser(report, tmp_path / "profile")
    for words in ("a crack front that roughness pins", "Figures", "Fit, configuration and"):
        assert words in " ".join(seen.split())
    summary = seen_in_browser(whole / "results/test/summary.html", tmp_path / "profile")
    # Both open on the sentences of the fit, and on its figures.
    fit = (whole / "results/test/fit.md").read_text(encoding="utf-8")
    first = re.search(r"The factor k of .*? is not constant", fit)
    assert first
    for page in (seen, summary):
        assert first[0] in page
        assert 'alt="loop"' in page
    assert "<td>lost_contact (complete)</td><td>8</td>" in summary
    assert "<th>midpoint slope m</th>" in summary
    for item in ("git_commit", "command", "platform", "seed of the sweep"):
        assert f"<td>{item}</td>" in summary
    assert (ROOT / "config/test.yaml").read_text(encoding="utf-8").splitlines()[-1] in summary


def flat_sweep(folder):
    """The configuration `test` with one spectrum."""
    path = folder / "sweep.yaml"
    lines = (ROOT / "config/test.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(line for line in lines if "name: rough" not in line))
    return path


def date(moment, *paths):
    """Give files the date of another year."""
    seconds = datetime(moment, 1, 1, tzinfo=UTC).timestamp()
    for path in paths:
        os.utime(path, (seconds, seconds))


def planned_rules(folder, sweep):
    """Names of the rules that the workflow would run without Snakemake's records."""
    printed = finished(folder, "--dry-run", sweep=sweep, ranks=1)
    return {name for line in re.findall(r"^ {8}(.+)$", printed, re.M) for name in line.split(", ")}


@pytest.fixture
def sweep(tmp_path, whole):
    """Configuration of a finished sweep in a folder without Snakemake's records."""
    shutil.copytree(whole / "results", tmp_path / "results")
    return copied_sweep(tmp_path)


@pytest.mark.slow
def test_a_whole_run_makes_all_results_and_of_what_is_finished_nothing_is_planned(tmp_path, sweep):
    assert made(tmp_path / "results/test", {}) >= FITTED | TABLE | SHARDS
    assert planned_rules(tmp_path, sweep) == set()


def stated_factor(results):
    """Sentence on k of the page of a fit."""
    [sentence] = re.findall(r"^- k of this sweep.*", (results / "fit.md").read_text(), re.MULTILINE)
    return sentence


FITTED = {
    *("fit.nc", "fit.nc.sha256", "fit.json", "fit.md", "summary.html"),
    *(
        f"figures/{name}.{suffix}"
        for name in ("factor", "hysteresis", "loop")
        for suffix in ("pdf", "png")
    ),
    "SHA256SUMS",
}
TABLE = {"hysteresis.nc", "hysteresis.nc.sha256"}
SHARDS = {
    *("shards/flat.nc", "shards/flat.nc.sha256"),
    *("shards/rough.nc", "shards/rough.nc.sha256"),
}
CHANGES = {
    "seed: 1": ("seed: 2", 8),
    "realisations: 2": ("realisations: 3", 4),
    "angles: 128": ("angles: 160", 8),
    "max_sweeps: 100000": ("max_sweeps: 200000", 0),
    "bootstrap: 500": ("bootstrap: 600", 0),
    "lowest_elastic_energy: 0.02": ("lowest_elastic_energy: 0.1", 0),
}
"""Lines of the configuration, others for them, and how many simulations these lack."""


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("line", CHANGES)
def test_what_a_change_concerns_runs_again_and_of_a_change_back_nothing_is_simulated(
    tmp_path, sweep, line
):
    results = tmp_path / "results/test"
    first = stated_factor(results)
    table = xr.load_dataset(results / "hysteresis.nc")
    changed, n_simulated = CHANGES[line]
    fit_alone = "bootstrap" in line or "lowest" in line
    for old, new, expected in ((line, changed, n_simulated), (changed, line, 0)):
        sweep.write_text(sweep.read_text().replace(old, new))
        date(2001, sweep)  # no date matters
        before = states(results)
        printed = finished(tmp_path, sweep=sweep, ranks=1)
        assert len(simulated(printed)) == expected
        assert made(results, before) == FITTED | (set() if fit_alone else TABLE | SHARDS)
        # The answer is that of this configuration, and its requests are the only ones.
        assert stated_factor(results) in printed
        if n_simulated or "lowest" in line:
            assert (stated_factor(results) == first) == (new == line)
        assert new in (results / "summary.html").read_text()
        assert len(list((results / "requests").iterdir())) == 4
        assert finished(tmp_path, sweep=sweep, ranks=1).count("Execute") == 0
    assert stated_factor(results) == first
    again = xr.load_dataset(results / "hysteresis.nc")
    assert again.drop_vars(COSTS).identical(table.drop_vars(COSTS).assign_attrs(again.attrs))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_of_a_copy_without_dates_nothing_is_simulated(tmp_path, sweep):
    results, table = tmp_path / "results/test", "results/test/hysteresis.nc"
    expected = xr.load_dataset(tmp_path / table)
    shutil.move(tmp_path / "results", tmp_path / "original")
    # In an order in which requests are the newest.
    shutil.copytree(tmp_path / "original", tmp_path / "results", copy_function=shutil.copyfile)
    date(2001, *(results / "shards").iterdir())
    for path in (results / "requests").iterdir():
        os.utime(path)
    printed = finished(tmp_path, sweep=sweep, ranks=1)
    assert simulated(printed) == set()
    assert xr.load_dataset(tmp_path / table).equals(expected)


FAULTS = {
    "shards/flat.nc": {"shards/flat.nc", "shards/flat.nc.sha256"} | TABLE | FITTED,
    "hysteresis.nc": TABLE | FITTED,
    "fit.nc": FITTED,
}
"""Files, and what is made again where they are damaged."""


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", FAULTS)
def test_what_a_plan_sets_aside_is_made_again_and_no_more(tmp_path, sweep, name):
    results = tmp_path / "results/test"
    expected = xr.load_dataset(results / name)
    zero_sector(results / name)
    told = done("plan", sweep, "--output", results)
    assert f"{name} is damaged and was set aside" in told.stderr
    assert (results / f"{name}{DAMAGED_SUFFIX}").is_file()
    before = states(results)
    printed = finished(tmp_path, sweep=sweep, ranks=1)
    assert simulated(printed) == set()
    assert made(results, before) == FAULTS[name]
    assert xr.load_dataset(results / name).equals(expected)
    assert finished(tmp_path, sweep=sweep, ranks=1).count("Execute") == 0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_what_is_removed_is_made_again_and_the_same(tmp_path, sweep):
    results = tmp_path / "results/test"
    names = "fit.json", "figures/factor.pdf", "summary.html", "SHA256SUMS", "shards/flat.nc"
    expected = json.loads((results / "fit.json").read_text())["columns"]
    table = xr.load_dataset(results / "hysteresis.nc")
    for name in names:
        (results / name).unlink()
        assert simulated(finished(tmp_path, sweep=sweep, ranks=1)) == set()
        assert (results / name).is_file()
    assert json.loads((results / "fit.json").read_text())["columns"] == expected
    assert xr.load_dataset(results / "hysteresis.nc").equals(table)
    assert done("verify", results).exit_code == 0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_forcing_rewrites_from_stored_rows_and_without_curves_simulates(tmp_path, sweep):
    results = tmp_path / "results/test"
    expected = xr.load_dataset(results / "hysteresis.nc")
    before = states(results)
    printed = finished(tmp_path, "--forcerun", "simulate", sweep=sweep, ranks=1)
    assert simulated(printed) == set()
    assert {"shards/flat.nc", "shards/rough.nc"} < made(results, before)
    assert xr.load_dataset(results / "hysteresis.nc").equals(expected)
    shutil.rmtree(results / "curves/flat")
    printed = finished(tmp_path, "--forcerun", "simulate", sweep=sweep, ranks=1)
    assert {label.split()[0] for label in simulated(printed)} == {"flat"}
    dataset = xr.load_dataset(results / "hysteresis.nc")
    assert dataset.drop_vars(COSTS).equals(expected.drop_vars(COSTS))


@pytest.mark.slow
@pytest.mark.parametrize(("realisations", "launches"), [(2, 0), (50_000, 1)])
def test_short_shards_take_one_core_each_and_long_ones_all_cores(tmp_path, realisations, launches):
    sweep = flat_sweep(tmp_path)
    content = sweep.read_text().replace("realisations: 2", f"realisations: {realisations}")
    sweep.write_text(content)
    shown = "--dry-run", "--printshellcmds", "--quiet", "host"
    printed = finished(tmp_path, *shown, sweep=sweep, ranks=None, errors=subprocess.STDOUT)
    assert printed.count("mpiexec -n") == launches


@pytest.mark.slow
def test_two_configurations_of_one_name_raise_an_error(tmp_path):
    sweep, results = copied_sweep(tmp_path), tmp_path / "results/test"
    block = ("--spectrum", "flat", "--realisations", "0-0")
    done("simulate", sweep, "--output", results, *block)
    (tmp_path / "other").mkdir()
    second_path = tmp_path / "other/test.yaml"
    second_path.write_text(sweep.read_text().replace("seed: 1", "seed: 2"))
    before = contents(tmp_path / "results")
    ended = snakemake(tmp_path, sweep=second_path, ranks=1)
    assert ended.returncode != 0
    assert re.search(r"results/test has the results of .*test.yaml, another conf", ended.stderr)
    assert "Traceback" not in ended.stderr
    assert contents(tmp_path / "results") == before


@pytest.mark.slow
def test_a_clone_may_stand_under_a_name_with_quotes_and_braces(tmp_path):
    clone = tmp_path / 'it\'s a {clone} "of mine"'
    clone.mkdir()
    for name in ("Snakefile", "workflow", "config"):
        (clone / name).symlink_to(ROOT / name)
    (clone / ".venv").symlink_to(Path(sys.executable).parents[1])
    python = clone / ".venv/bin" / Path(sys.executable).name
    sweep = flat_sweep(clone)
    for target in ("results/sweep/fit.md", "results/figures/quick/main-1d.pdf"):
        done = subprocess.run(
            [
                *(python, "-m", "snakemake", "--snakefile", clone / "Snakefile", "--cores", "1"),
                *("--profile", clone / "workflow/profiles/default", "--directory", clone),
                *("--config", f"sweep={sweep}", "ranks=1", "--", target),
            ],
            capture_output=True,
            text=True,
            timeout=900,
            check=False,
            cwd=tmp_path,
        )
        assert done.returncode == 0, done.stderr
        assert (clone / target).is_file()


def test_make_takes_a_configuration_in_a_folder_of_any_name():
    name = "my dir/it's; $$(one)/mine.yaml"
    told = ["make", "--dry-run", "all", f"SWEEP={name}"]
    done = subprocess.run(told, capture_output=True, text=True, check=True, timeout=600, cwd=ROOT)
    lines = done.stdout.splitlines()
    taken = name.replace("$$", "$")
    [started] = [shlex.split(line) for line in lines if "--config" in line]
    assert started[started.index("--plan") + 1] == taken
    assert started[-2:] == ["--config", f"sweep={taken}"]
    assert any("results/mine/fit.md" in line for line in lines)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["{a: b.yaml}", "[a]", "1"])
def test_a_configuration_that_snakemake_reads_as_no_text_is_refused(tmp_path, name):
    done = snakemake(tmp_path, "--dry-run", sweep=name)
    assert done.returncode != 0
    assert re.search(r"sweep is .*; give the name of a file", done.stdout + done.stderr)
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "hurst", "settings", "sentence"),
    [
        ("sweep", 1.8, (), "spectra[1]: hurst is 1.8; it must"),
        ("sweep", 0.8, ("rank=2",), "unknown key of --config: rank; its keys are sweep (a file)"),
        ("a; rm -rf b", 0.8, (), "the results are named after 'a; rm -rf b.yaml'"),
        ("sweep", 0.8, ("scale=coarse",), "scale is 'coarse'; choose one of quick, paper"),
    ],
)
def test_the_workflow_refuses_what_is_wrong_before_it_starts(
    tmp_path, name, hurst, settings, sentence
):
    sweep = tmp_path / f"{name}.yaml"
    text = (ROOT / "config/test.yaml").read_text(encoding="utf-8")
    sweep.write_text(text.replace("hurst: 0.8", f"hurst: {hurst}"))
    done = snakemake(tmp_path, *settings, sweep=sweep)
    assert done.returncode != 0
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "results").exists()


OTHER = """
rule mine:
    input: "theirs/results/sweep/fit.json"
    output: "mine.json"
    shell: "cp {{input}} {{output}}"
module crackfront:
    snakefile: {snakefile!r}
    config: {{"sweep": "sweep.yaml", "ranks": 1, "block": 1}}
    prefix: "theirs"
use rule * from crackfront as cf_*
"""


@pytest.mark.slow
def test_another_workflow_takes_the_rules_under_names_and_in_a_folder_of_its_own(tmp_path):
    flat_sweep(tmp_path)
    (tmp_path / "Snakefile").write_text(OTHER.format(snakefile=str(ROOT / "Snakefile")))
    called = [sys.executable, "-m", "snakemake", "--cores", "2"]
    done = subprocess.run(called, capture_output=True, text=True, check=True, cwd=tmp_path)
    assert "cf_simulate" in done.stderr
    assert "factor" in json.loads((tmp_path / "mine.json").read_text())["columns"]
    shards = {path.stem for path in (tmp_path / "theirs/results/sweep/shards").glob("*.nc")}
    assert shards == {"flat.0-0", "flat.1-1"}


@pytest.mark.slow
def test_the_job_that_a_killed_snakemake_leaves_goes_on_and_the_next_waits_for_it(tmp_path):
    sweep = flat_sweep(tmp_path)
    text = sweep.read_text()
    sweep.write_text(text.replace("angles: 128", "angles: 512").replace("step: 0.1", "step: 0.02"))
    log, table = tmp_path / "results/sweep/logs/simulate-flat.log", "results/sweep/hysteresis.nc"
    with subprocess.Popen(
        command(tmp_path, sweep=sweep, ranks=1),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        while not (log.is_file() and simulated(log.read_text())):
            time.sleep(0.02)
            assert process.poll() is None
        process.kill()
    printed = finished(tmp_path, "--", table, sweep=sweep, ranks=1)
    assert simulated(printed) == set()
    dataset = xr.load_dataset(tmp_path / table).drop_vars(COSTS)
    undisturbed = cf.run_sweep(sweep, tmp_path / "undisturbed", progress=False).drop_vars(COSTS)
    assert dataset.equals(undisturbed)


VALIDATION = """
seed: 5
short_cutoff: 0.6
side: 5.12
tolerance: 1.0e-3
loads: {max_penetration: 0.45, step: 0.15, shown_penetration: 0.15}
front: {n_angle: 32, spacing: 0.1}
cases:
  - {n_point: 48, interaction_range: 0.70, elastic_energies: [0.02]}
"""


@pytest.mark.slow
def test_the_workflow_makes_a_figure_of_the_paper_and_validates_the_model(tmp_path):
    configuration = tmp_path / "tiny.yaml"
    configuration.write_text(VALIDATION)
    targets = "validation", "results/figures/quick/main-1d.pdf"
    done = snakemake(tmp_path, f"validation={configuration}", "--", *targets)
    assert done.returncode == 0, done.stderr
    figure = {path.name for path in (tmp_path / "results/figures/quick").glob("*.*")}
    assert figure == {"main-1d.nc", "main-1d.pdf", "main-1d.png"}
    made = {path.name for path in (tmp_path / "results/tiny").iterdir()}
    assert {"validation.md", "validation.pdf", "hysteresis.nc", "picture.nc"} <= made
    assert sum(name.startswith("n48-g0.7-e0.02-") for name in made) == 1
    assert not (tmp_path / "results/test").exists()
