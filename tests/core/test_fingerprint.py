"""What changes the fingerprint of sources, and with it what is computed anew."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from crackfront.core import fingerprint as module
from crackfront.core.fingerprint import fingerprint, module_digests, solver_fingerprint
from crackfront.simulate.line.schedule import LineSchedule
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import simulation_fingerprint
from crackfront.simulate.sphere.cycle import FullCycle
from crackfront.simulate.sphere.steady import SteadySchedule
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.fingerprints import row_fingerprint
from studies.paper.figure import checks_fingerprint, drawing_fingerprint, figure_fingerprint

KERNEL = "crackfront/core/solver/monotone.py"
RULES = Path(module.ROOT, "workflow/rules")


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """A copy of the sources, whose fingerprints are taken instead."""
    for name in ("crackfront", "studies"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(module.ROOT / name, tmp_path / name, ignore=ignored)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    return tmp_path


def edited(path, *changes):
    """Change a file by regular expressions, each of which must be found."""
    text = path.read_text("utf-8")
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, flags=re.MULTILINE)
        assert count, pattern
    path.write_text(text, "utf-8")


def key_part(kind=FullCycle):
    """What the key of a simulation under a kind of load has of the sources."""
    return simulation_fingerprint.__wrapped__(kind)


def parameters():
    """Fingerprints that are parameters of the rules of the workflow, and the key of simulations."""
    found = {
        "simulate": key_part(),
        "solver": solver_fingerprint.__wrapped__(),
        "row": row_fingerprint.__wrapped__(),
    }
    for path in RULES.glob("*.smk"):
        for rule, body in re.findall(r"^rule (\w+):\n((?:[ #].*\n|\n)+)", path.read_text(), re.M):
            if names := re.search(r"sources=fingerprint\(([^)]*)\)", body):
                found[rule] = fingerprint(*re.findall(r'"([^"]+)"', names[1]))
    for name in ("main-2", "main-3ab", "beyond-roughness"):
        found[f"{name} data"] = figure_fingerprint.__wrapped__(name)
        found[f"{name} drawing"] = drawing_fingerprint.__wrapped__(name)
    return found | {"figure_checks": checks_fingerprint()}


def test_a_fingerprint_is_twelve_hexadecimal_digits():
    assert re.fullmatch("[0-9a-f]{12}", fingerprint("crackfront.core"))


def test_a_fingerprint_is_the_same_in_every_process(monkeypatch):
    code = "from crackfront.core.fingerprint import fingerprint as found; print(found({!r}))"
    command = [sys.executable, "-c", code.format("studies.paper.beyond_animation")]
    found = set()
    for seed in ("0", "1", "2"):
        monkeypatch.setenv("PYTHONHASHSEED", seed)
        found.add(subprocess.run(command, capture_output=True, check=True).stdout)
    assert len(found) == 1


def test_a_name_of_no_module_is_refused():
    with pytest.raises(ValueError, match=r"no module crackfront\.core\.jkr\.none; correct"):
        fingerprint("crackfront.core.jkr.none")


def test_equal_sources_have_equal_fingerprints_wherever_they_lie(sources):
    assert key_part() == simulation_fingerprint(FullCycle)


def test_docstrings_comments_and_blank_lines_change_nothing(sources):
    before = parameters()
    edited(
        sources / KERNEL,
        ('^r"""The fast', 'r"""The very fast'),
        ("^_BETWEEN = 13", "\n# Why.\n_BETWEEN = 13  # so many"),
    )
    edited(
        sources / "crackfront/core/jkr.py",
        ("Radius of the stable smooth contact", "Radius of a stable smooth contact"),
    )
    assert parameters() == before


def test_an_edit_of_the_table_of_a_sweep_makes_no_row_and_no_shard_anew(sources):
    before = parameters()
    edited(sources / "crackfront/sweep/table.py", ("adhesion hysteresis, ", "hysteresis of "))
    after = parameters()
    assert after["row"] == before["row"]
    assert after["aggregate"] != before["aggregate"]
    edited(sources / "crackfront/sweep/rows.py", ('"refused", "defect"', '"defect", "refused"'))
    assert parameters()["row"] != before["row"]


LINE = "crackfront/simulate/line/schedule.py"


@pytest.mark.parametrize(
    ("place", "change"),
    [
        (KERNEL, ("^_BETWEEN = 13", "_BETWEEN = 14")),
        ("crackfront/core/solver/forces.py", (r"reach \* inverse\) \+ 1", "reach * inverse) + 2")),
        ("crackfront/core/units.py", ("CONTACT_MODULUS = 0.75", "CONTACT_MODULUS = 0.7500001")),
        ("crackfront/core/spectrum.py", (r"\(-2 - 2 \* self", "(-2.1 - 2 * self")),
        ("crackfront/core/geometry/line.py", ("_spring_force.*\n.*\n    return", r"\g<0> 2 *")),
        (LINE, ("^_BEHIND = 1.3", "_BEHIND = 1.4")),
        ("crackfront/simulate/tiles.py", (r"= 2 \* math.sqrt", "= 3 * math.sqrt")),
        ("crackfront/core/cycle/follow.py", ("is Status.CONVERGED", "is Status.STEP_LIMIT")),
    ],
)
def test_what_determines_the_numbers_of_a_simulation_changes_its_key(sources, place, change):
    before = key_part(LineSchedule)
    edited(sources / place, change)
    assert key_part(LineSchedule) != before


@pytest.mark.parametrize(
    ("place", "change"),
    [
        (KERNEL, ("^_BETWEEN = 13", "_BETWEEN = 14")),
        ("crackfront/core/geometry/sphere.py", ("perimeter", "circumference")),
        ("crackfront/simulate/sphere/cycle.py", (r"2 \* math.pi", "3 * math.pi")),
    ],
)
def test_what_determines_the_numbers_of_a_sphere_changes_its_key(sources, place, change):
    before = key_part()
    edited(sources / place, change)
    assert key_part() != before


def test_what_determines_straight_fronts_alone_changes_no_key_of_spheres(sources):
    before = key_part()
    edited(sources / LINE, ("^_BEHIND = 1.3", "_BEHIND = 1.4"))
    assert key_part() == before


def test_every_module_that_a_simulation_runs_counts_in_its_key():
    called = set()

    def note(frame, event, _):
        path = Path(frame.f_code.co_filename)
        if event == "call" and path.is_relative_to(module.ROOT / "crackfront"):
            called.add(".".join(path.relative_to(module.ROOT).with_suffix("").parts))

    for name in ("test", "line-test"):
        sweep = load_configuration(module.ROOT / f"config/{name}.yaml")
        simulation = next(iter(sweep.simulations()))
        run_simulation(simulation)  # compiled without a trace, which would take minutes
        before = sys.getprofile()
        sys.setprofile(note)
        try:
            run_simulation(simulation)
        finally:
            sys.setprofile(before)
    counted = module_digests("crackfront.simulate.run", type(simulation.schedule).__module__)
    assert len(called) > 15, called
    assert called <= counted.keys(), called - counted.keys()


@pytest.mark.parametrize(
    "kind", ["crackfront.simulate.run", LineSchedule.__module__, SteadySchedule.__module__]
)
def test_what_shows_plans_stores_or_evaluates_simulations_is_no_part_of_them(kind):
    counted = [name.removeprefix("crackfront.") for name in module_digests(kind)]
    outside = {name for name in counted if not name.startswith(("core.", "simulate."))}
    assert outside <= {"analysis.measures", "analysis.standard_error"}
    planned = {f"simulate.{name}" for name in ("laws", "numerics", "costs", "line.loads", "files")}
    assert not planned & {*counted}


MAIN_3AB = {"main-3ab data", "main-3ab drawing", "figure_checks"}
BEYOND = {"beyond-roughness data", "beyond-roughness drawing"}
REPORTS = {"accuracy_report", "validate"}
DRAWN = {"sweep_figures", "accuracy_report", "validate", "main-2 drawing", "main-3ab drawing"} | {
    "beyond-roughness drawing"
}
LAWS = {"accuracy_study", "row", "aggregate", "fit", *REPORTS, *MAIN_3AB, *BEYOND}
ROUGHNESS, COMPUTED = {"beyond-roughness drawing", "figure_checks"}, {"beyond-roughness data"}
MAIN_2 = {"main-2 data", "main-2 drawing", "figure_checks"}


@pytest.fixture(scope="module")
def before():
    """Fingerprints of the sources as they are, which are those of a copy."""
    return parameters()


@pytest.mark.parametrize(
    ("place", "change", "stale"),
    [
        ("crackfront/plots/style.py", ("^COLUMN, PAGE = 85", "COLUMN, PAGE = 86"), DRAWN),
        ("crackfront/plots/loop.py", ("force", "forces"), {"sweep_figures"}),
        ("crackfront/plots/library.py", ("def plot_loop", "def plot_the_loop"), set()),
        ("crackfront/cli/report.py", ("click.echo", "click.secho"), REPORTS),
        ("crackfront/simulate/laws.csv", ("\n", "\n\n"), LAWS),
        ("studies/accuracy/report.py", ("too few", "few"), {"accuracy_report"}),
        ("studies/accuracy/drawing.py", ("Pareto front", "best"), {"accuracy_report"}),
        ("studies/paper/rings.py", ("^_PATH = 257", "_PATH = 513"), MAIN_2),
        ("studies/paper/main_2.py", (r"0\.8 \* style", "0.9 * style"), MAIN_2),
        ("studies/paper/beyond_roughness.py", ("disorder, ", "disorder: "), ROUGHNESS),
        ("studies/paper/roughness.py", ("^_N_LAG = 60", "_N_LAG = 61"), ROUGHNESS | COMPUTED),
    ],
)
def test_a_change_makes_stale_what_comes_from_its_module_and_nothing_else(
    before, sources, place, change, stale
):
    edited(sources / place, change)
    after = parameters()
    assert {name for name in after if after[name] != before[name]} == stale


@pytest.mark.parametrize(
    "imports",
    [
        "import crackfront.core.added",
        "from crackfront.core import added",
        "from crackfront.core.added import SIZE",
        "def size():\n    from crackfront.core.added import SIZE\n",
        "if not TYPE_CHECKING:\n    from crackfront.core import added\n",
    ],
)
def test_a_module_counts_wherever_and_however_it_is_imported(sources, imports):
    (sources / "crackfront/core/added.py").write_text("SIZE = 1\n")
    importing = sources / "crackfront/core/importing.py"
    importing.write_text(f"import numpy as np\n{imports}\n")
    found = module_digests("crackfront.core.importing")
    assert list(found) == ["crackfront.core.added", "crackfront.core.importing"]
    (sources / "crackfront/core/added.py").write_text("SIZE = 2\n")
    after = module_digests("crackfront.core.importing")
    assert {name for name in found if after[name] != found[name]} == {"crackfront.core.added"}


def test_what_is_imported_for_annotations_alone_does_not_count(sources):
    importing = sources / "crackfront/core/importing.py"
    importing.write_text("SIZE = 1\n")
    before = module_digests("crackfront.core.importing")
    importing.write_text("if TYPE_CHECKING:\n    from crackfront.core import jkr\nSIZE = 1\n")
    assert module_digests("crackfront.core.importing") == before


def test_no_module_imports_a_package_whose_names_are_imported_when_they_are_used():
    names = (
        ".".join(path.relative_to(module.ROOT).with_suffix("").parts)
        for package in ("crackfront", "studies")
        for path in Path(module.ROOT, package).rglob("*.py")
        if path.stem != "__init__"
    )
    lazy = {"crackfront", "crackfront.core"}
    assert [name for name in names if lazy & module_digests(name).keys()] == []


def test_a_package_that_is_left_out_does_not_count_nor_what_only_it_imports():
    drawn = module_digests("crackfront.plots.loop")
    plain = module_digests("crackfront.plots.loop", without=["crackfront.data", "crackfront.core"])
    assert any(name.startswith("crackfront.data.") for name in drawn)
    assert not any(name.startswith(("crackfront.data", "crackfront.core")) for name in plain)
    assert plain.items() <= drawn.items()


def test_every_file_of_data_has_the_name_of_a_module_that_it_counts_with(sources):
    data = [path for suffix in ("csv", "json") for path in sources.rglob(f"*.{suffix}")]
    assert len(data) >= 5
    for path in data:
        name = ".".join(path.relative_to(sources).with_suffix("").parts)
        before = fingerprint(name)
        path.write_bytes(path.read_bytes() + b"\n")
        assert fingerprint(name) != before
