"""The pages: what they show runs, and says what is true."""

import doctest
import json
import re
import shlex
from pathlib import Path

import pytest
from matplotlib import pyplot

import crackfront as cf
from crackfront import __all__
from crackfront.cli import main
from crackfront.measured.options import ReadingOptions
from crackfront.sweep.configuration import Configuration
from studies.numbers import stored
from tests.commands import slow
from tests.places import ROOT

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
    found = doctest.DocTestRunner().run(test, clear_globs=False)
    assert found.attempted >= 10
    assert found.failed == 0
    return test.globs


def test_the_tests_that_pages_name_exist():
    files = {path.name: path.read_text() for path in (ROOT / "tests").rglob("test_*.py")}
    defined = re.findall(r"def (test_\w+)", " ".join(files.values()))
    named = set()
    for page in DOCS.rglob("*.md"):
        named |= set(re.findall(r"`((?:test_|\.\.\.)[\w.]+)`", page.read_text()))
    assert len(named) > 40
    for name in named - set(files):
        pattern = name.replace("...", r"\w*")
        assert any(re.fullmatch(pattern, one) for one in defined), name


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
def test_the_page_of_sweeps_computes_the_fit_takes_out_a_loop_and_compares_results():
    configuration = ROOT / "config/test.yaml"
    table = cf.run_sweep(configuration, "results/test", progress=False)
    cf.run_sweep(configuration, "results/again", progress=False)
    main(["fit", str(configuration)], standalone_mode=False)
    shown = run_examples(DOCS / "sweeps.md")
    stored = json.loads(Path("results/test/fit.json").read_text())["columns"]
    for name, found in (("factor", shown["k"]), ("exponent", shown["exponent"])):
        assert found.item() == pytest.approx(stored[f"pooled_{name}"]["values"][0], rel=1e-12)
    force = table.pull_off_force.sel(spectrum="flat", amplitude=0.1, realisation=0).item()
    assert shown["loop"].force.min().item() == force


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
        here = [link for link in links if not re.match(r"\w+:", link)]
        dead += [(path.name, link) for link in here if not (path.parent / link).exists()]
    assert dead == []


QUOTED = [
    # page, text with {} for the number, study, name, format of its value and error
    *(
        (page, *quote)
        for page in ("README.md", "docs/index.md", "paper.md")
        for quote in (
            ("k is {} at vanishing", "law", "k at vanishing disorder", "{:.2f} ± {:.2f}"),
            ("{} for a flat spectrum", "law", "k at s = 0.84, a flat spectrum", "{:.2f} ± {:.2f}"),
            (
                "{} for H = 0.8",
                "law",
                "k at s = 0.84, H = 0.8 over three octaves",
                "{:.2f} ± {:.2f}",
            ),
            ("at g = {} with", "law", "g of k = 3 at vanishing disorder", "{:.1f}"),
            (
                "s = {} in the infinite",
                "law",
                "s of k = 3 in the infinite contact",
                "{:.2f} ± {:.2f}",
            ),
            ("the {} of 90 pairs", "law", "spheres with g above 1", "{:g}"),
            ("of {} pairs", "law", "spheres", "{:g}"),
            ("agree with it to {} rms", "law", "rms difference of spheres", "{:.1%}"),
        )
    ),
    ("README.md", "has {} times the", "paper", "nanodiamond, measured over prediction", "{:.1f}"),
    ("README.md", "is {} at the rough", "boundary-elements", "ratio at e_el = 0.177", "{:.2f}"),
    (
        "paper.md",
        "takes {} times less time, at an error of 1%",
        "accuracy",
        "times faster than the authors, chemical-0.04, 1%",
        "{:.0f}",
    ),
    (
        "paper.md",
        "take {} times less time",
        "speed",
        "newton faster, flat 0.02, w_rms 0.05, N 4096, step 0.1",
        "{:.1f}",
    ),
    (
        "paper.md",
        "and {} times less at the 0.84",
        "speed",
        "newton faster, flat 0.02, w_rms 0.84, N 4096, step 0.1",
        "{:.1f}",
    ),
    ("paper.md", "by {} of the", "boundary-elements", "median difference of the force", "{:.2%}"),
    ("paper.md", "and {} of 54 jumps", "boundary-elements", "shared jumps of the front", "{:g}"),
    ("paper.md", "of {} jumps", "boundary-elements", "jumps of the front", "{:g}"),
    ("paper.md", "c = {}, a factor", "boundary-elements", "coefficient", "{:.2f} ± {:.2f}"),
    ("paper.md", "of {} at 0.18", "boundary-elements", "ratio at e_el = 0.177", "{:.2f}"),
    ("paper.md", "in {} of the hardest", "accuracy", "coverage of the hardest scans", "{:.0%}"),
    ("paper.md", "gives {} $", "paper", "nanodiamond, front", "{:.1f} ± {:.1f}"),
    ("paper.md", "elements, {} $", "paper", "nanodiamond, prediction", "{:.0f} ± {:.0f}"),
]
"""Numbers of the pages without blocks."""


@pytest.mark.parametrize(("page", "text", "study", "name", "form"), QUOTED)
def test_a_quoted_number_is_the_stored_one(page, text, study, name, form, monkeypatch):
    monkeypatch.chdir(ROOT)
    number = stored(study).numbers[name]
    words = " ".join(Path(page).read_text().split())
    assert text.format(form.format(number.value, number.error)) in words


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
        for name, one in sections.items()
        for key in one["properties"]
    }
    page = (ROOT / "config/README.md").read_text()
    told = set(re.findall(r"^\| (\w+) \| `(\w+)` \| \w.* \|$", page, re.MULTILINE))
    options = {("Surface", name) for name in ReadingOptions.model_fields}
    assert keys - options == told


def test_the_page_of_the_reference_names_the_whole_library():
    page = (DOCS / "reference-pages.md").read_text()
    functions = {name for name in __all__ if name.islower() and name[0] != "_"}
    named = set(re.findall(r"^   (?:~[\w.]*\.)?(\w+)$", page, re.MULTILINE))
    assert functions <= named
