"""What changes the fingerprint of sources, and with it what is computed anew."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from crackfront.data import fingerprint as module
from crackfront.data.fingerprint import fingerprint
from crackfront.simulate.simulation import simulation_fingerprint
from crackfront.sweep.table import row_fingerprint
from studies.paper.figure import checks_fingerprint, drawing_fingerprint, figure_fingerprint

KERNEL = "crackfront/core/solver/monotone.py"
RULES = Path(module.ROOT, "workflow/rules")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder for copies of the sources, of which those are parsed once that no test changes."""
    return tmp_path_factory.mktemp("sources")


@pytest.fixture
def sources(folder, monkeypatch):
    """A copy of the sources, whose fingerprints are taken instead."""
    for name in ("crackfront", "studies"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.rmtree(folder / name, ignore_errors=True)
        shutil.copytree(module.ROOT / name, folder / name, ignore=ignored)
    monkeypatch.setattr(module, "ROOT", folder)
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    return folder


def edited(path, *changes):
    """Change a file by regular expressions, each of which must be found."""
    text = path.read_text("utf-8")
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, flags=re.MULTILINE)
        assert count, pattern
    path.write_text(text, "utf-8")


def key_part():
    """What the key of a simulation has of the sources."""
    return simulation_fingerprint.__wrapped__()


def parameters():
    """Fingerprints that are parameters of the rules of the workflow, and the key of simulations."""
    found = {"simulate": key_part(), "row": row_fingerprint.__wrapped__()}
    for path in RULES.glob("*.smk"):
        for rule, body in re.findall(r"^rule (\w+):\n((?:[ #].*\n|\n)+)", path.read_text(), re.M):
            if names := re.search(r"sources=fingerprint\(([^)]*)\)", body):
                found[rule] = fingerprint(*re.findall(r'"([^"]+)"', names[1]))
    for name in ("main-2", "main-3ab"):
        found[f"{name} data"] = figure_fingerprint.__wrapped__(name)
        found[f"{name} drawing"] = drawing_fingerprint.__wrapped__(name)
    return found | {"figure_checks": checks_fingerprint()}


def test_a_fingerprint_is_twelve_hexadecimal_digits():
    assert re.fullmatch("[0-9a-f]{12}", fingerprint("crackfront.core"))


def test_a_fingerprint_is_the_same_in_every_process(tmp_path, monkeypatch):
    code = "from crackfront.data.fingerprint import fingerprint as found; print(found(*{}))"
    command = [sys.executable, "-c", code.format(["studies.paper.beyond_animation"])]
    found = set()
    for seed in ("0", "1", "2"):
        monkeypatch.setenv("PYTHONHASHSEED", seed)
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / seed))
        found.add(subprocess.run(command, capture_output=True, check=True).stdout)
    assert len(found) == 1


def test_an_unknown_name_is_refused():
    with pytest.raises(ValueError, match=r"no module or definition crackfront\.core\.jkr\.none"):
        fingerprint("crackfront.core.jkr.none")


def test_equal_sources_have_equal_fingerprints_wherever_they_lie(sources):
    assert key_part() == simulation_fingerprint()


def test_a_known_fingerprint_is_read_and_a_damaged_one_is_found_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    found = fingerprint("crackfront.core.units")
    [kept] = (tmp_path / "crackfront/fingerprints").iterdir()
    with monkeypatch.context() as patch:
        patch.setattr(module, "_Reach", None)
        assert fingerprint("crackfront.core.units") == found
    for damaged in ("", found[:5], "[]", '{"files": 1}', "\xff"):
        kept.write_text(damaged, "latin-1")
        assert fingerprint("crackfront.core.units") == found
        assert json.loads(kept.read_text())["fingerprint"] == found


def test_a_mended_docstring_a_comment_and_an_annotation_change_nothing(sources):
    before = parameters()
    edited(
        sources / KERNEL,
        ('^r"""The fast', 'r"""The very fast'),
        ("^_BETWEEN = 13", "# Why.\n_BETWEEN: int = 13"),
    )
    edited(
        sources / "crackfront/core/jkr.py",
        ("-> Array:", "-> ArrayLike:"),
        ("Radius of the stable smooth contact", "Radius of a stable smooth contact"),
    )
    assert parameters() == before


def test_a_function_that_moves_changes_nothing(sources):
    before = parameters()
    path = sources / "crackfront/core/jkr.py"
    source = path.read_text("utf-8")
    start = source.index("def pull_off_force")
    end = source.index("\n\n\n", start)
    left = source[:start] + source[end + 3 :]
    path.write_text(f"{left}\nfrom crackfront.core.pull import pull_off_force\n", "utf-8")
    path.with_name("pull.py").write_text(source[start:end] + "\n", "utf-8")
    assert parameters() == before


def test_a_local_module_that_is_renamed_changes_no_key(sources):
    before = key_part()
    (sources / "crackfront/core/jkr.py").rename(sources / "crackfront/core/smooth.py")
    for path in sources.rglob("*.py"):
        text = path.read_text("utf-8")
        text = re.sub(r"\bjkr\.", "smooth.", text.replace("import jkr", "import smooth"))
        path.write_text(text.replace("core.jkr", "core.smooth"), "utf-8")
    assert key_part() == before


@pytest.mark.parametrize(
    ("place", "change"),
    [
        (KERNEL, ("^_BETWEEN = 13", "_BETWEEN = 14")),
        ("crackfront/core/solver/forces.py", (r"reach \* inverse\) \+ 1", "reach * inverse) + 2")),
        ("crackfront/core/units.py", ("CONTACT_MODULUS = 0.75", "CONTACT_MODULUS = 0.7500001")),
        ("crackfront/core/spectrum.py", (r"\(-2 - 2 \* self", "(-2.1 - 2 * self")),
        ("crackfront/core/spectrum.py", (r"np.where\(q <= 1 \+ 1e-12", "np.where(q <= 1 + 1e-11")),
        ("crackfront/core/geometry/line.py", ("_spring_force.*\n.*\n    return", r"\g<0> 2 *")),
        ("crackfront/simulate/line/schedule.py", ("^_BEHIND = 1.3", "_BEHIND = 1.4")),
        ("crackfront/core/cycle/follow.py", ("is Status.CONVERGED", "is Status.STEP_LIMIT")),
        ("crackfront/simulate/tiles.py", (r"= 2 \* math.sqrt", "= 3 * math.sqrt")),
    ],
)
def test_what_determines_the_numbers_of_a_simulation_changes_its_key(sources, place, change):
    before = key_part()
    edited(sources / place, change)
    assert key_part() != before


def test_every_function_that_a_simulation_runs_counts_in_its_key(tmp_path):
    program = """
import sys
from pathlib import Path
from crackfront.data import fingerprint as module
from crackfront.simulate.run import run_simulation
from crackfront.sweep.configuration import load_configuration

root = module.ROOT / "crackfront"
called = set()

def note(frame, event, _):
    code = frame.f_code
    if event == "call" and Path(code.co_filename).is_relative_to(root):
        name = ".".join(Path(code.co_filename).relative_to(root.parent).with_suffix("").parts)
        called.add((name, code.co_qualname.partition(".")[0]))

simulations = [next(iter(load_configuration(Path(f"config/{name}.yaml")).simulations()))
               for name in ("test", "line-test")]
for simulation in simulations:
    run_simulation(simulation)  # compiled without a trace, which would take minutes
    sys.setprofile(note)
    run_simulation(simulation)
    sys.setprofile(None)
counted = {(one.module.name, name)
           for one in module._Reach(["crackfront.simulate.run.run_simulation"])._counted
           for name in one.defined}
missed = {one for one in called - counted if one[0] not in module._NO_PART}
assert len(called) > 60, len(called)
assert not missed, missed
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=module.ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


FIGURES = "main-2 drawing", "main-3ab drawing", "main-3ab data"
DRAWN = {"sweep_figures", "accuracy_report", "validate", *FIGURES[:2]}
LAWS = {"accuracy_study", "accuracy_report", "row", "aggregate", FIGURES[2]}


MAIN_2 = {"main-2 data", "main-2 drawing", "figure_checks"}
"""What the rings of main-2 are in."""


@pytest.mark.parametrize(
    ("place", "change", "stale"),
    [
        ("crackfront/plots/style.py", ("^COLUMN, PAGE = 85", "COLUMN, PAGE = 86"), DRAWN),
        ("crackfront/plots/loop.py", ("force", "forces"), {"sweep_figures"}),
        ("crackfront/plots/library.py", ("def plot_loop", "def plot_the_loop"), set()),
        ("crackfront/cli/report.py", ("click.echo", "click.secho"), set()),
        ("crackfront/simulate/instabilities.py", ("middle", "halfway"), {"main-3ab data"}),
        ("crackfront/simulate/laws.csv", ("\n", "\n\n"), LAWS),
        (
            "studies/accuracy/study.py",
            ("time.process_time", "time.perf_counter"),
            {"accuracy_study"},
        ),
        ("studies/accuracy/report.py", ("laws.csv", "law.csv"), {"accuracy_report"}),
        ("studies/paper/rings.py", ("^_PATH = 257", "_PATH = 513"), MAIN_2),
        ("studies/paper/rings.py", (r"\+ 0\.5\) / count", "+ 0.4) / count"), MAIN_2),
        ("studies/paper/main_2.py", (r"0\.8 \* style", "0.9 * style"), {"main-2 drawing"}),
        ("studies/paper/main_2.py", ("^_ROUND_OFF = 1e-9", "_ROUND_OFF = 1e-8"), {"figure_checks"}),
    ],
)
def test_a_change_makes_stale_what_comes_from_it_and_nothing_else(sources, place, change, stale):
    before = parameters()
    edited(sources / place, change)
    after = parameters()
    assert {name for name in after if after[name] != before[name]} == stale


def test_equal_names_of_two_modules_are_told_apart(sources):
    names = "one", "other"
    before = None
    for values in ((1, 2), (2, 1)):
        for name, value in zip(names, values, strict=True):
            text = f"_SIZE = {value}\n\n\ndef {name}():\n    return _SIZE\n"
            (sources / f"crackfront/core/{name}.py").write_text(text, "utf-8")
        found = fingerprint(*(f"crackfront.core.{name}" for name in names))
        assert found != before
        before = found
