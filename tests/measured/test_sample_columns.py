"""Tables of samples as people have them: other columns, zeros, Excel, and hostile YAML."""

import time

import pytest

from crackfront.measured.samples.sample import read_samples
from crackfront.measured.samples.sample_results import predicted_samples
from tests.measured.test_samples import SPHERE

NUMBERS = "rms,roll_off,hurst,short_cutoff"
VALUES = "20nm,2um,0.8,20nm"


def samples_of(path, text, **options):
    path.write_text(text, encoding="utf-8")
    return read_samples(path, SPHERE | options)


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("0", 0.0),
        ("0.0", 0.0),
        ("0mJ/m2", 0.0),
        ("-3", -3e-3),
        ("\u22123", -3e-3),
        ("-3 mJ/m2", -3e-3),
        ("+3", 3e-3),
        ("25", 25e-3),
    ],
)
def test_a_measured_value_may_be_zero_or_negative(tmp_path, cell, value):
    head = f"sample,{NUMBERS},measured_hysteresis (mJ/m2),measured_hysteresis_error (mJ/m2)"
    [sample] = samples_of(tmp_path / "samples.csv", f"{head}\nA,{VALUES},{cell},2\n")
    measured = sample.measured["hysteresis"]
    assert (measured.value, measured.low, measured.high) == pytest.approx(
        (value, value - 4e-3, value + 4e-3)
    )


def test_a_force_and_a_value_in_yaml_may_be_zero_or_negative(tmp_path):
    numbers = "rms: 20nm, roll_off: 2um, hurst: 0.8, short_cutoff: 20nm"
    [sample] = samples_of(
        tmp_path / "samples.yaml",
        f"- {{sample: A, {numbers}, measured_pull_off_force: 0, measured_w_appr (mJ/m2): -3}}",
    )
    assert sample.measured["pull_off_force"].value == 0
    assert sample.measured["w_appr"].value == pytest.approx(-3e-3)


@pytest.mark.parametrize(
    ("column", "cell"),
    [
        ("measured_hysteresis", "-3kg"),
        ("measured_hysteresis", "-3"),
        ("measured_hysteresis", "--3mJ/m2"),
        ("measured_hysteresis", "0kg"),
        ("radius", "-3mm"),
        ("radius", "0mm"),
    ],
)
def test_other_quantities_stay_positive_and_all_need_their_unit(tmp_path, column, cell):
    with pytest.raises(ValueError, match=rf"samples\.csv, line 2: {column} is "):
        samples_of(tmp_path / "samples.csv", f"sample,{NUMBERS},{column}\nA,{VALUES},{cell}\n")


def test_other_columns_are_copied_as_they_are(tmp_path):
    head = f"sample;{NUMBERS};Rq (nm);date (2024);remarks".replace(",", ";")
    [sample] = samples_of(
        tmp_path / "samples.csv",
        f"{head}\nA;{VALUES};1,250;3.5.;dusty\n".replace("20nm,2um,0.8,20nm", "20nm;2um;0.8;20nm"),
    )
    assert sample.further == {"Rq (nm)": "1,250", "date (2024)": "3.5.", "remarks": "dusty"}
    [result] = predicted_samples([sample])
    assert (result.row["Rq (nm)"], result.row["remarks (table)"]) == ("1,250", "dusty")
    assert result.row["remarks"] != "dusty"


@pytest.mark.parametrize("column", ["scan", "Radius 1", "modulsu", "measured-hysteresis2"])
def test_a_column_like_an_option_is_taken_for_a_misprint(tmp_path, column):
    with pytest.raises(ValueError, match="did you mean"):
        samples_of(tmp_path / "samples.csv", f"sample,{NUMBERS},{column}\nA,{VALUES},1\n")


@pytest.mark.parametrize("first", ["sep=;", "SEP=;", '"sep=;"'])
def test_the_first_line_of_excel_states_the_separator(tmp_path, first):
    text = "sample;rms;roll_off;hurst;short_cutoff;a,b,c,d,e,f\nA;20nm;2um;0,8;20nm;x\n"
    [sample] = samples_of(tmp_path / "samples.csv", f"{first}\n{text}")
    assert (sample.numbers.hurst, sample.further) == (0.8, {"a,b,c,d,e,f": "x"})
    with pytest.raises(ValueError, match="line 3: "):
        samples_of(tmp_path / "samples.csv", f"{first}\n{text.replace('2um', '2kg')}")


def test_yaml_that_repeats_anchors_or_nests_is_a_sentence_at_once(tmp_path):
    begin = time.process_time()
    anchors = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 10)
    )
    nested = "".join(f"  {line}\n" for line in anchors.splitlines())
    with pytest.raises(ValueError, match="line 2: a3 is a value of many parts"):
        samples_of(tmp_path / "samples.yaml", f"samples:\n- sample: A\n{nested}  scans: *a9\n")
    with pytest.raises(ValueError, match="nested too deeply"):
        samples_of(tmp_path / "samples.yaml", "- " + "{a: " * 5000)
    assert time.process_time() - begin < 20
