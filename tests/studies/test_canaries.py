"""Canaries: a number that moved by more than a tenth of its error is reported."""

from dataclasses import replace

import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.canaries import STUDIES, canaries
from studies.numbers import STORED, Number, store, stored
from tests.places import ROOT


@pytest.fixture
def two_canaries(monkeypatch):
    """Canaries of boundary elements and of the fit of the law alone, which take two seconds."""
    quick = {("law", "fit"), ("boundary-elements", "coefficient")}
    chosen = {name: canary for name, canary in canaries().items() if name in quick}
    monkeypatch.setattr("studies.canaries.canaries", lambda: chosen)
    monkeypatch.chdir(ROOT)


@pytest.mark.usefixtures("two_canaries")
def test_numbers_that_did_not_move_are_within_a_tenth_of_their_errors():
    done = CliRunner().invoke(main, ["canaries"])
    assert done.exit_code == 0, done.output
    assert "4 numbers" in done.output
    assert "0 moved by more than a tenth of their error" in done.output


@pytest.mark.usefixtures("two_canaries")
def test_a_stored_number_that_was_changed_is_reported_in_units_of_its_error(tmp_path, monkeypatch):
    study, name = "boundary-elements", "coefficient, c"
    number = stored(study).canaries[name]
    for link in ("docs/reference/validation", "config"):
        (tmp_path / link).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / link).symlink_to(ROOT / link)
    monkeypatch.chdir(tmp_path)
    store(study, canaries={name: replace(number, value=number.value + 3 * number.error)})
    done = CliRunner().invoke(main, ["canaries", study])
    assert done.exit_code == 1
    last = done.output.splitlines()[-1]
    assert last.startswith(f"MOVED: {study}: {name}: ")
    assert last.endswith("moved by 3 errors")
    kept = CliRunner().invoke(main, ["canaries", study, "--keep"])
    assert kept.exit_code == 0, kept.output
    assert stored(study).canaries[name].value == pytest.approx(number.value)
    assert CliRunner().invoke(main, ["canaries", study]).exit_code == 0


def test_every_canary_is_stored_with_errors_and_no_other_number(monkeypatch):
    monkeypatch.chdir(ROOT)
    stored_canaries = {study: stored(study).canaries for study in STUDIES}
    names = {
        (study, name.split(", ")[0])
        for study, numbers in stored_canaries.items()
        for name in numbers
    }
    assert names == set(canaries())
    assert all(number.error for numbers in stored_canaries.values() for number in numbers.values())


def test_a_canary_that_was_never_stored_says_what_to_run(tmp_path, monkeypatch):
    (tmp_path / STORED).parent.mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "studies.canaries.canaries", lambda: {("law", "fit"): lambda: {"k": Number(3.0, 0.1)}}
    )
    done = CliRunner().invoke(main, ["canaries"])
    assert "'fit, k' of law is not stored; run python -m studies canaries --keep" in done.output
