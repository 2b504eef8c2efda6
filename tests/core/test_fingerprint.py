"""What changes the fingerprint of sources, and with it the key of every simulation."""

import re
import shutil

import pytest

from crackfront.core import fingerprint as module
from crackfront.core.fingerprint import fingerprint
from crackfront.data.provenance import package_fingerprint
from crackfront.simulate.simulation import simulation_fingerprint
from studies.paper.figure import figure_fingerprint

KERNEL = "core/solver/monotone.py"


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A copy of the package, whose fingerprints are taken instead."""
    copy = tmp_path / "crackfront"
    shutil.copytree(module.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(module, "PACKAGE", copy)
    return copy


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


def test_a_fingerprint_is_twelve_hexadecimal_digits():
    assert re.fullmatch("[0-9a-f]{12}", fingerprint("core"))


def test_equal_sources_have_equal_fingerprints(package):
    assert key_part() == simulation_fingerprint()


def test_a_known_fingerprint_is_read_and_a_damaged_one_is_found_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    found = fingerprint("core/units.py")
    [kept] = (tmp_path / "crackfront/fingerprints").iterdir()
    with monkeypatch.context() as patch:
        patch.setattr(module.ast, "parse", None)
        assert fingerprint("core/units.py") == found
    for damaged in ("", found[:5], "no digits here", "\xff"):
        kept.write_text(damaged, "latin-1")
        assert fingerprint("core/units.py") == kept.read_text("ascii") == found


def test_what_is_known_of_a_source_is_not_taken_for_what_only_a_part_of_it_reaches(package):
    place = "core/units.py"
    assert fingerprint(place) != fingerprint(reached={place: ["CONTACT_MODULUS"]})
    assert fingerprint(place) == fingerprint(place)


def test_a_mended_docstring_a_comment_and_an_annotation_change_no_key(package):
    before = key_part()
    edited(
        package / KERNEL,
        ('^r"""The fast', 'r"""The very fast'),
        ("^_ROUNDS = 12", "# Why.\n_ROUNDS: int = 12"),
    )
    edited(
        package / "core/jkr.py", ("-> Array:", "-> ArrayLike:"), ("Contact radius a", "Radius a")
    )
    assert key_part() == before


def test_a_function_that_moves_changes_no_key(package):
    before = key_part()
    source = (package / "core/jkr.py").read_text("utf-8")
    start = source.index("def pull_off_force")
    end = source.index("\n\n\n", start)
    (package / "core/jkr.py").write_text(
        source[:start] + source[end + 3 :] + "\nfrom crackfront.core.pull import pull_off_force\n",
        "utf-8",
    )
    (package / "core/pull.py").write_text(source[start:end] + "\n", "utf-8")
    assert key_part() == before


def test_a_local_module_that_is_renamed_changes_no_key(package):
    before = key_part()
    (package / "core/jkr.py").rename(package / "core/smooth.py")
    for path in package.rglob("*.py"):
        text = path.read_text("utf-8")
        text = re.sub(r"\bjkr\.", "smooth.", text.replace("import jkr", "import smooth"))
        path.write_text(text.replace("core.jkr", "core.smooth"), "utf-8")
    assert key_part() == before


@pytest.mark.parametrize(
    ("place", "change"),
    [
        (KERNEL, ("^_ROUNDS = 12", "_ROUNDS = 13")),
        ("core/solver/forces.py", (r"reach \* inverse\) \+ 1", "reach * inverse) + 2")),
        ("core/units.py", ("CONTACT_MODULUS = 0.75", "CONTACT_MODULUS = 0.7500001")),
        ("simulate/simulation.py", ("math.ceil", "math.floor")),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_changed_constant_or_call_changes_the_key(package, place, change):
    before = key_part()
    edited(package / place, change)
    assert key_part() != before


def test_what_no_simulation_uses_changes_no_key(package):
    before = key_part()
    for place in (*module.NO_PART, "plots/style.py", "cli/sweep.py"):
        with (package / place).open("a", encoding="utf-8") as file:
            file.write("ADDED = 1\n")
    assert key_part() == before


RINGS = "studies/paper/main_2.py"


@pytest.mark.parametrize(
    ("place", "change", "counts"),
    [
        (RINGS, ("^_PATH = 257", "_PATH = 513"), True),
        (RINGS, (r"\+ 0\.5\) / count", "+ 0.4) / count"), True),
        (RINGS, ('variable\\("contact radius"', 'variable("radius"'), True),
        (RINGS, (r"0\.8 \* PAGE", "0.9 * PAGE"), False),
        (RINGS, ("^_REACH = 2.2", "_REACH = 2.3"), False),
        (RINGS, ("^_ROUND_OFF = 1e-9", "_ROUND_OFF = 1e-8"), False),
        ("studies/paper/main_1d.py", ("^TOLERANCE = 1e-13", "TOLERANCE = 1e-12"), False),
        ("studies/paper/rings.py", ("^INNERMOST = 1e-3", "INNERMOST = 2e-3"), True),
        ("plots/parts.py", ('"mutation_scale": 8', '"mutation_scale": 9'), False),
    ],
    ids=lambda value: str(value),
)
def test_what_the_data_of_a_figure_come_from_changes_its_fingerprint_alone(
    package, place, change, counts
):
    before = figure_fingerprint.__wrapped__("main-2")
    edited(package / place, change)
    assert (figure_fingerprint.__wrapped__("main-2") != before) == counts


def test_equal_names_of_two_modules_are_told_apart(package):
    places = "core/one.py", "core/other.py"
    before = None
    for values in ((1, 2), (2, 1)):
        for place, value in zip(places, values, strict=True):
            text = f"_SIZE = {value}\n\n\ndef {place[5:8]}():\n    return _SIZE\n"
            (package / place).write_text(text, "utf-8")
        assert fingerprint(*places) != before
        before = fingerprint(*places)


def test_data_count_byte_by_byte(package):
    before = fingerprint("simulate/laws.csv")
    with (package / "simulate/laws.csv").open("a", encoding="utf-8") as file:
        file.write("\n")
    assert fingerprint("simulate/laws.csv") != before


def test_the_fingerprint_of_the_package_changes_with_any_source(package):
    before = package_fingerprint.__wrapped__()
    edited(package / "cli/sweep.py", ("default=60.0", "default=61.0"))
    assert package_fingerprint.__wrapped__() != before
