"""The page of a prediction: it needs no other file, and has the numbers of the command."""

import json
from base64 import b64decode
from html import unescape

import pytest

import crackfront as cf
from crackfront.measured.page.report import prediction_report
from tests.commands import refused, run
from tests.measured.made import SCENE

NUMBERS = ("--rms", "20nm", "--roll-off", "2um", "--hurst", "0.8", "--short-cutoff", "20nm")
SPHERE = ("--poisson", "0.5", "--radius", "1.25mm", "--work-of-adhesion", "63mJ/m2")


@pytest.mark.parametrize(("modulus", "code"), [("0.7MPa", 0), ("100GPa", 4)])
def test_a_page_has_what_the_command_prints_or_the_reasons_for_nothing(tmp_path, modulus, code):
    path = tmp_path / "page.html"
    words = ("predict", *NUMBERS, *SPHERE, "--modulus", modulus, "--no-figure", "--report", path)
    result = run(*words)
    assert result.exit_code == code
    assert f"report: {path}" in result.output
    page = unescape(path.read_text(encoding="utf-8"))
    assert "src=" not in page.replace('src="data:', "")
    content = json.loads(run(*words, "--json").stdout)
    severe = [item for item in content["remarks"] if item["severity"] in ("fails", "reservation")]
    assert severe
    for remark in severe:
        assert remark["sentence"] in page
    assert ("paper, k = 3" in page) == (code == 0)
    assert ("<td>hysteresis</td>" in page) == (code == 0)


def test_a_page_contains_its_figure_and_escapes_names(monkeypatch):
    rough = cf.self_affine_surface(rms="20nm", roll_off="2um", hurst=0.8, short_cutoff="20nm")
    prediction = cf.predict(rough, SCENE)
    page = prediction_report(prediction, "k <b> 2")
    data = page.split("base64,")[1].split('"')[0]
    assert b64decode(data).startswith(b"\x89PNG")
    assert "k &lt;b&gt; 2" in page
    assert "base64" not in prediction_report(prediction, with_figure=False)


def test_a_page_replaces_no_file_of_another_kind(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("mine")
    words = ("predict", *NUMBERS, *SPHERE, "--modulus", "0.7MPa", "--no-figure", "--report", path)
    assert "--report is" in refused(*words)
    assert path.read_text() == "mine"
    assert "--csv writes rows alone" in refused(*words[:-1], tmp_path / "a.html", "--csv", "-")
