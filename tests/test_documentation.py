"""The pages: what they show runs, and says what is true."""

import doctest
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot
from scipy import stats

import crackfront as cf
from crackfront import __all__
from crackfront.cli import main
from crackfront.simulate.checksums import digest_path, file_digest, sums_text
from crackfront.sweep.configuration import Configuration, load_configuration
from crackfront.sweep.section import ConfigurationError
from studies.__main__ import STUDIES
from studies.numbers import stored
from studies.quotes import read_quotes
from tests.commands import slow
from tests.places import ROOT, TEST
from tests.yaml_texts import from_yaml, to_yaml

DOCS = ROOT / "docs"


@pytest.fixture
def _elsewhere(tmp_path, monkeypatch):
    """A folder for what the pages write, with the examples, and no other figure of pyplot."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    pyplot.close("all")
    yield
    pyplot.close("all")


def run_examples(page):
    """Run the ten examples of a page or more, and compare their output; the names they define."""
    # The end of a block would pass for output.
    text = page.read_text().replace("```", "")
    test = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    outcome = doctest.DocTestRunner().run(test, clear_globs=False)
    assert outcome.attempted >= 10
    assert outcome.failed == 0
    return test.globs


def fit_stored_study():
    """Put the stored table of the worked study where its sweep would write it, and fit it."""
    table = Path("results/hurst/hysteresis.nc")
    table.parent.mkdir(parents=True)
    shutil.copy(DOCS / "reference/hurst.nc", table)
    digest_path(table).write_text(sums_text({table.name: file_digest(table)}))
    main(["fit", str(ROOT / "config/hurst.yaml")], standalone_mode=False)


def test_the_tests_that_pages_name_exist():
    files = {path.name: path.read_text() for path in (ROOT / "tests").rglob("test_*.py")}
    defined = re.findall(r"def (test_\w+)", " ".join(files.values()))
    named = set()
    for page in DOCS.rglob("*.md"):
        named |= set(re.findall(r"`((?:test_|\.\.\.)[\w.]+)`", page.read_text()))
    assert len(named) > 25
    for name in named - set(files):
        pattern = name.replace("...", r"\w*")
        assert any(re.fullmatch(pattern, test) for test in defined), name


def test_the_page_of_the_core_gives_what_it_shows():
    run_examples(DOCS / "core.md")


@pytest.mark.slow
@pytest.mark.usefixtures("_elsewhere")
def test_the_tutorial_gives_what_it_shows():
    run_examples(DOCS / "tutorial.md")
    assert Path("loop.png").stat().st_size > 10_000
    assert Path("loop.nc").is_file()


@pytest.mark.slow
@pytest.mark.usefixtures("_elsewhere")
def test_the_page_of_sweeps_computes_the_fit_repeats_a_row_and_compares_results():
    configuration = ROOT / "config/test.yaml"
    table = cf.run_sweep(configuration, "results/test", progress=False)
    cf.run_sweep(configuration, "results/again", progress=False)
    cf.run_sweep(ROOT / "config/jumps.yaml", "results/jumps", progress=False)
    fit_stored_study()
    shown = run_examples(DOCS / "sweeps.md")
    factor = shown["fit"].factor
    assert shown["study"]["k"].values == pytest.approx(factor.sel(bound="value").values, rel=1e-12)
    half_widths = (factor.sel(bound="high") - factor.sel(bound="value")).values
    assert shown["half_width"].values == pytest.approx(half_widths, rel=0.05)  # a bootstrap
    exponent = shown["fit"].exponent.sel(bound="value").values
    assert shown["exponent"].values == pytest.approx(exponent, rel=1e-9)
    force = table.pull_off_force.sel(spectrum="flat", amplitude=0.1, realisation=0).item()
    assert shown["third"].force.min().item() == force


def test_the_page_of_sweeps_shows_the_configuration_of_its_study():
    text = (DOCS / "sweeps.md").read_text()
    shown = from_yaml(re.search(r"```yaml\n(.*?)```", text, re.DOTALL)[1])
    shipped = from_yaml((ROOT / "config/hurst.yaml").read_text())
    assert shown.pop("numerics").items() <= shipped["numerics"].items()
    assert {"spectra", "amplitudes", "realisations", "load"} == shown.keys()
    assert {key: shipped[key] for key in shown} == shown


def test_the_page_of_sweeps_states_k_of_the_kept_sweeps_of_surfaces_of_any_kind():
    expected = []
    for name in ("bandpass", "anisotropic", "skewed"):
        with xr.open_dataset(DOCS / f"reference/{name}.nc") as table:
            k = (table.hysteresis / (2 * table.e_el)).mean("amplitude")
        n = k.sizes["realisation"]
        reach = k.std("realisation", ddof=1) * stats.t.ppf(0.975, n - 1) / np.sqrt(n)
        pairs = zip(k.mean("realisation").values, reach.values, strict=True)
        expected += [f"{value:.2f} ± {bar:.2f}" for value, bar in pairs]
    page = (DOCS / "sweeps.md").read_text()
    rows = re.findall(r"\| (\d\.\d\d ± \d\.\d\d) \|$", page, re.MULTILINE)
    assert rows == expected


def test_the_page_of_sweeps_shows_spectra_that_a_configuration_may_have(tmp_path):
    section = (DOCS / "sweeps.md").read_text().partition("## Surfaces of any kind")[2]
    shown = from_yaml(re.search(r"```yaml\n(.*?)```", section, re.DOTALL)[1])
    scales = {"radius": 1e-3, "work_of_adhesion": 0.05, "contact_modulus": 1e6}
    content = from_yaml(TEST.read_text()) | shown | {"scales": scales}
    (tmp_path / "sweep.yaml").write_text(to_yaml(content))
    configuration = load_configuration(tmp_path / "sweep.yaml")
    assert len(configuration.spectra) == 5


def test_the_page_of_sweeps_converts_the_penetrations_of_its_sweep_in_metres(tmp_path):
    section = (DOCS / "sweeps.md").read_text().partition("### In metres")[2]
    shown = from_yaml(re.search(r"```yaml\n(.*?)```", section, re.DOTALL)[1])
    (tmp_path / "sweep.yaml").write_text(to_yaml(from_yaml(TEST.read_text()) | shown))
    configuration = load_configuration(tmp_path / "sweep.yaml")
    unit = cf.Scales(**dict(configuration.scales)).vertical
    load = configuration.load
    assert load.max_penetration / unit == pytest.approx(1.5, rel=0.01)
    assert load.steady.start / unit == pytest.approx(1.0, rel=0.01)


def test_the_shortest_configuration_of_its_page_needs_each_of_its_keys(tmp_path):
    page = (ROOT / "config/README.md").read_text()
    shown = from_yaml(re.search(r"```yaml\n(.*?)```", page, re.DOTALL)[1])
    path = tmp_path / "shortest.yaml"
    path.write_text(to_yaml(shown))
    assert load_configuration(path).fit.lowest_elastic_energy is None
    for key in shown:
        path.write_text(to_yaml({name: shown[name] for name in shown if name != key}))
        with pytest.raises(ConfigurationError, match=f"key {key} is missing"):
            load_configuration(path)


@pytest.mark.usefixtures("_elsewhere")
@pytest.mark.parametrize(
    ("page", "command"), [slow("surfaces.md", "predict"), ("loops.md", "loop")]
)
def test_the_first_command_of_a_page_prints_what_the_page_shows(page, command, capsys):
    text = (DOCS / page).read_text()
    typed = re.search(rf"```sh\n(?:\.venv/bin/)?crackfront ({command} (?:.*\\\n)*.*)\n", text)[1]
    arguments = [
        name
        for word in shlex.split(typed.replace("\\\n", " "))
        for name in (sorted(map(str, Path().glob(word))) if "*" in word else [word])
    ]
    drawn = ["--no-figure"] if command == "predict" else []
    main([*arguments, *drawn], standalone_mode=False)
    shown = re.search(r"```text\n(.*?)```", text, re.DOTALL)[1]
    assert capsys.readouterr().out.splitlines() == shown.splitlines()


@pytest.mark.slow
@pytest.mark.usefixtures("_elsewhere")
def test_the_python_of_the_first_page_runs():
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "index.md").read_text(), re.DOTALL)
    assert len(blocks) == 1
    exec(compile(blocks[0], "index.md", "exec"), {})
    assert len(pyplot.get_fignums()) == 1


def test_every_link_of_a_page_to_a_file_leads_to_one():
    dead = []
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS.rglob("*.md")):
        text = re.sub(r"```python\n.*?```", "", path.read_text(), flags=re.DOTALL)
        links = re.findall(r"\]\(([^)#\s]+)", text)
        local_links = [link for link in links if not re.match(r"\w+:", link)]
        dead += [(path.name, link) for link in local_links if not (path.parent / link).exists()]
    assert dead == []


def test_pages_show_the_stored_numbers_that_they_quote(monkeypatch):
    monkeypatch.chdir(ROOT)
    studies = {name: stored(name) for name in STUDIES}
    quotes = read_quotes()
    assert len(quotes) > 40
    lacking = [quote for quote in quotes if not quote.is_shown(studies)]
    assert [f"{quote.page}: {quote.text(studies)}" for quote in lacking] == []


def test_the_page_of_the_command_line_names_every_command_and_exit_code():
    page = (DOCS / "command-line.md").read_text()
    for name in main.commands:
        assert f"`crackfront {name}`" in page
    epilog = main.epilog or ""
    assert re.findall(r"^\| (\d+) \|", page, re.MULTILINE) == re.findall(
        r"^  (\d+) ", epilog, re.MULTILINE
    )


def test_every_key_of_a_configuration_has_a_meaning_and_no_other_key():
    schema = Configuration.model_json_schema()
    sections = {"file": schema} | schema["$defs"]
    keys = {
        (name.removesuffix("Section"), key)
        for name, section in sections.items()
        for key in section["properties"]
    }
    page = (ROOT / "config/README.md").read_text()
    told = set(re.findall(r"^\| (\w+) \| `(\w+)` \| \w.* \|$", page, re.MULTILINE))
    assert keys == told


def test_the_page_of_the_reference_names_the_whole_library():
    page = (DOCS / "reference-pages.md").read_text()
    functions = {name for name in __all__ if name.islower() and name[0] != "_"}
    named = set(re.findall(r"^   (?:~[\w.]*\.)?(\w+)$", page, re.MULTILINE))
    assert functions <= named
