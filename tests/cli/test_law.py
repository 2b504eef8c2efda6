"""`crackfront law`: what it prints, and one sentence for what it cannot answer."""

import json
import math

import pytest
from click.testing import CliRunner

import crackfront as cf
from crackfront.analysis.law import pinning_factor, shipped_law
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.cli import main
from crackfront.core.spectrum import SelfAffineSpectrum

FRONT = {"--w-rms": "0.4", "--g": "inf"}
SPHERE = {"--spectrum": "0.005,0.1,0.3", "--elastic-energy": "0.05", "--contact-radius": "1.9"}


def run(options, *more):
    """Result of the command."""
    parts = [part for item in options.items() for part in item]
    return CliRunner().invoke(main, ["law", *parts, *more])


def answer(options, *more):
    """JSON object that the command prints."""
    result = run(options, *more, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_a_front_has_the_k_of_the_law_in_both_branches():
    answered, k = answer(FRONT | {"--g": "7"}), pinning_factor(0.4, 7.0)
    assert (answered["k"], answered["k_low"], answered["k_high"]) == pytest.approx(
        (k.factor.value, k.factor.low, k.factor.high)
    )
    assert answered["k_appr"] == answered["k_retr"] == answered["k"]
    assert (answered["w_rms"], answered["g"]) == (0.4, 7.0)
    for name in ("statistical", "numerical", "model", "negative_share", "warning"):
        assert answered[name] == getattr(k, name)


def test_an_infinite_front_is_json_that_is_read_everywhere():
    text = run(FRONT, "--json").stdout
    content = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert content["g"] == "inf"
    assert content["k"] == cf.pinning_factor(0.4, math.inf).factor.value
    assert content["k"] > answer(FRONT | {"--g": "10"})["k"]


@pytest.mark.parametrize("field", ["roughness", "chemical"])
def test_a_sphere_has_its_lengths_and_the_k_of_its_branches(field):
    content = answer(SPHERE, "--field", field)
    law = sphere_factors(field, SelfAffineSpectrum(0.005, 0.1, 0.3), 0.05, 1.9)
    assert (content["k"], content["k_low"], content["k_high"]) == pytest.approx(
        (law.both.value, law.both.low, law.both.high)
    )
    assert content["k_appr"] == law.approach.factor.value > content["k_retr"]
    assert content["l_kappa"] == law.spring
    assert content["g"] == pytest.approx(content["l_kappa"] / content["larkin_length"])
    assert content["w_rms"] == pytest.approx(2 * math.sqrt(0.05))


def test_what_was_not_measured_is_told():
    assert answer(FRONT)["measured"]["g"] == list(shipped_law().size)
    result = run(FRONT | {"--w-rms": "1.9"})
    assert "beyond what was measured: w_rms 1.9 w_int is above" in result.output
    content = answer(FRONT | {"--g": "0.1"})
    assert "hysteresis begins" in content["warning"]
    assert content["k_low"] == 0


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({}, "the options are incomplete; name --w-rms and --g, or else --spectrum"),
        (SPHERE | {"--g": "3"}, "are mixed; name either of them"),
        (FRONT | {"--w-rms": "2"}, "w_rms is 2.0; it must be less than 2"),
        (SPHERE | {"--spectrum": "0.005,0.1"}, "--spectrum is '0.005,0.1'; write short cutoff"),
    ],
)
def test_what_cannot_be_answered_is_refused_with_a_sentence(options, sentence):
    result = run(options)
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.output
    [told] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    assert sentence in told


def test_a_breadth_is_that_of_the_law_and_narrows_the_interval():
    answered, k = answer(FRONT, "--breadth", "0.92"), pinning_factor(0.4, math.inf, breadth=0.92)
    assert (answered["k"], answered["breadth"]) == (k.factor.value, 0.92)
    anybody = answer(FRONT)
    assert answered["k_high"] - answered["k_low"] < anybody["k_high"] - anybody["k_low"]
    assert "breadth 0.92" in run(FRONT, "--breadth", "0.92").stdout


def test_a_flat_spectrum_is_named_by_its_cutoff():
    flat = answer(SPHERE | {"--spectrum": "0.05"})
    assert flat == answer(SPHERE | {"--spectrum": "0.05,0.05,0.3"})
