"""What a command says of the keys that changed since the last run."""

import json
from pathlib import Path

import pytest

from crackfront.sweep.changed_keys import change_sentence
from tests.commands import done

TEST = Path(__file__).parents[2] / "config/test.yaml"


def changed(folder, *replacements):
    """The configuration `test` with other texts in it."""
    text = TEST.read_text("utf-8")
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    path = folder / "sweep.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("step: 0.1", "step: 0.2", ["load.step", "0.1", "0.2"]),
        ("seed: 1", "seed: 7", ["seed", "1", "7"]),
        ("[0.02, 0.1]", "[0.02, 0.05]", ["amplitudes.elastic_energy", "[0.02, 0.05]"]),
        ("roll_off: 0.2, ", "", ["spectra.rough.roll_off", "removed"]),
        ("name: rough", "name: other", ["spectra.other.hurst", "new", "spectra.rough.name"]),
    ],
)
def test_a_changed_key_is_named_in_full_with_its_values(tmp_path, old, new, parts):
    sentence = change_sentence(TEST, changed(tmp_path, (old, new)))
    assert all(part in sentence for part in parts)


def test_comments_order_and_spelling_of_numbers_are_no_change(tmp_path):
    same = changed(tmp_path, ("seed: 1\n", ""), ("tolerance: 1e-6", "tolerance: 0.000001"))
    same.write_text(f"{same.read_text()}seed: 1 # last\n")
    assert change_sentence(TEST, same) == ""


def test_without_an_earlier_run_nothing_is_said(tmp_path):
    assert change_sentence(tmp_path / "configuration.yaml", TEST) == ""


def test_a_plan_names_the_keys_until_the_sweep_has_run_with_them(tmp_path):
    store = tmp_path / "out"
    sweep = changed(tmp_path, ("realisations: 2", "realisations: 1"))

    def plan():
        printed = done("plan", sweep, "--output", store).stdout
        content = json.loads(done("plan", sweep, "--output", store, "--json").stdout)["changed"]
        assert content in printed
        return content

    assert plan() == ""
    done("simulate", sweep, "--output", store)
    done("aggregate", sweep, "--output", store)
    assert plan() == ""
    changed(tmp_path, ("realisations: 2", "realisations: 1"), ("bootstrap: 500", "bootstrap: 200"))
    assert "fit.bootstrap" in plan()
    done("fit", sweep, "--output", store)
    assert plan() == ""
