"""Series of samples: what a row of a table or of YAML says, and what comes of it."""

import numpy as np
import pytest

from crackfront.measured.samples.sample import read_samples
from crackfront.measured.samples.sample_results import predicted_samples
from tests.measured.made import SCENE
from tests.places import ROOT

SPHERE = {
    "modulus": "0.7MPa",
    "poisson": "0.5",
    "radius": "1.25mm",
    "work_of_adhesion": "63mJ/m2",
}

CSV = """\
# a series of films
sample,group,rms (nm),roll-off (um),hurst,short_cutoff,radius (mm),measured hysteresis (mJ/m2)
A,polished,20,2,0.8,20nm,1.25,2
B,rough,40,2,0.8,20nm,,
"""

YAML = """\
samples:
  - sample: A
    group: polished
    rms (nm): 20
    roll_off: 2um
    hurst: 0.8
    short_cutoff: 2e-8 m
    radius: 1.25e-3 m
    measured_hysteresis: 2mJ/m2
  - {sample: B, group: rough, rms: 40nm, roll_off: 2um, hurst: 0.8, short_cutoff: 20nm}
"""

TABLES = {
    "samples.csv": CSV,
    "samples.tsv": CSV.replace(",", "\t"),
    "excel.csv": CSV.replace(",", ";").replace(".", ","),
    "samples.yaml": YAML,
    "list.yml": YAML.removeprefix("samples:\n"),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_row_means_the_same_in_every_form(tmp_path, name):
    path = tmp_path / name
    path.write_text(TABLES[name], encoding="utf-8")
    first, second = read_samples(path, SPHERE)
    assert (first.name, first.group, second.group) == ("A", "polished", "rough")
    assert first.numbers.rms == pytest.approx(20e-9)
    assert first.numbers.roll_off == pytest.approx(2e-6)
    assert first.numbers.short_cutoff == pytest.approx(20e-9)
    assert first.measured["hysteresis"].value == pytest.approx(2e-3)
    assert second.measured == {}
    for table_path in (first, second):
        assert table_path.scales.radius == pytest.approx(SCENE.radius)
        assert table_path.scales.contact_modulus == pytest.approx(SCENE.contact_modulus)


def test_a_sample_may_have_several_scans_psds_and_units(tmp_path):
    for name in ("a-1.txt", "a-2.txt", "b.txt", "psd.csv"):
        (tmp_path / name).write_text("1 2\n")
    path = tmp_path / "samples.csv"
    path.write_text(
        "sample,scans,psd,unit,psd_sides,tip radius (nm),detrend\n"
        "A,a-*.txt,,um,,20,slope\nB,b.txt | a-1.txt,,,,,slope\nC,,psd.csv,,one,,\n"
    )
    first, two, three = read_samples(path, SPHERE)
    assert [file.name for file in first.scans] == ["a-1.txt", "a-2.txt"]
    assert [file.name for file in two.scans] == ["b.txt", "a-1.txt"]
    assert {by.unit for by in first.reading} == {"um"}
    assert {by.detrend for by in (*first.reading, *two.reading)} == {"slope"}
    assert first.reading[0].tip_radius == pytest.approx(20e-9)
    assert (three.psd, three.density.psd_sides) == (tmp_path / "psd.csv", "one")


def test_the_page_shows_the_table_of_the_example_and_its_scans_are_there():
    path = ROOT / "examples/samples.csv"
    assert path.read_text("utf-8") in (ROOT / "docs/surfaces.md").read_text("utf-8")
    first, second = read_samples(path, SPHERE)
    assert [len(sample.scans) for sample in (first, second)] == [2, 1]
    assert first.measured["hysteresis"].value == pytest.approx(27e-3)


@pytest.mark.parametrize("between", [";", "\t"])
def test_a_comma_that_may_separate_thousands_is_refused_unless_another_number_settles_it(
    tmp_path, between
):
    path = tmp_path / "samples.tsv"

    def write(radius, cutoff):
        head = "sample,rms (nm),roll_off (nm),hurst,short_cutoff (nm),radius (um)"
        row = between.join(["A", "20", "9000", "1", cutoff, radius])
        path.write_text(f"{head.replace(',', between)}\n{row}\n")
        return read_samples(path, SPHERE)

    for radius, plain in (("1,250", "1250"), ("12,000", "12000"), ("125,500", "125500")):
        sentence = rf"line 2: radius is '{radius}', .* write '{plain}', or '{radius}0' if"
        with pytest.raises(ValueError, match=sentence):
            write(radius, "20")
    for radius, cutoff in (("1,250", "20,5"), ("1,250", "0,250"), ("1,2500", "20")):
        [sample_row] = write(radius, cutoff)
        assert sample_row.scales.radius == pytest.approx(1.25e-6)
    [sample_row] = write("1250", "20.5")
    assert sample_row.scales.radius == pytest.approx(1.25e-3)
    with pytest.raises(ValueError, match=r"line 2: .* numbers with decimal points and"):
        write("1,250", "20.5")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "A,polished,20",
            "A,polished,20kg",
            "line 3: rms is '20kg', whose unit is not a unit of length",
        ),
        ("B,rough,40", "B,rough,", "line 4: a self-affine surface needs rms, hurst, and either"),
        ("B,rough", "A,rough", "line 4: the sample 'A' is in line 3 as well"),
        ("B,rough", ",rough", "line 4: the name is missing; write it in the column 'sample'"),
        ("0.8,20nm,,", "1.8,20nm,,", "line 4: hurst is '1.8'; it must be less than"),
        ("hurst", "hurts", "line 3: the column 'hurts' is unknown; did you mean hurst"),
        ("group", "scans", "line 3: the surface is given by scans and rms; name"),
        ("B,rough,40,2,0.8,20nm,,", "B,,,,,,,", "line 4: the surface is given by nothing"),
        ("20nm,,", "20nm,,,,5", "line 4: the row has 10 cells and there are 8 headings"),
        ("group", "rms", "line 2: two columns are called 'rms'"),
        ("A,polished,20,2", "A,polished,20,0.001", "line 3: the roll-off, 1 nm, is shorter"),
    ],
)
def test_a_row_that_cannot_be_used_is_refused_with_its_line(tmp_path, old, new, sentence):
    path = tmp_path / "samples.csv"
    assert old in CSV
    path.write_text(CSV.replace(old, new, 1))
    with pytest.raises(ValueError, match=r"samples.csv, line \d+: ") as caught:
        read_samples(path, SPHERE)
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("rms (nm): 20", "rms: 20", "line 2: rms is '20', without a unit"),
        ("radius: 1.25e-3 m", "radius: true", "line 2: radius is 'True', which is not a number"),
        ("measured_hysteresis: 2mJ/m2", "measured_hysteresis: 2", "is '2', without a unit"),
        ("hurst: 0.8", "hurst: [0.8]", "line 2: hurst is [0.8]; it must be a number"),
        ("samples:", "sphere: 1\nsamples:", "has 'sphere' next to samples; remove it"),
        ("sample: A", "sample: \x01", "samples.yaml is not YAML"),
        ("sample: A", "sample: 2020-99-99", "samples.yaml is not YAML"),
    ],
)
def test_yaml_is_read_as_strictly_as_cells(tmp_path, old, new, sentence):
    path = tmp_path / "samples.yaml"
    assert old in YAML
    path.write_text(YAML.replace(old, new, 1))
    with pytest.raises((ValueError, TypeError)) as caught:
        read_samples(path, SPHERE)
    assert sentence in str(caught.value)


def test_what_a_row_lacks_is_refused_before_any_work(tmp_path):
    path = tmp_path / "samples.csv"
    path.write_text("sample,scans\nA,absent.al3d\n")
    with pytest.raises(ValueError, match=r"line 2: .*absent.al3d does not exist; correct"):
        read_samples(path, SPHERE)
    path.write_text(CSV)
    with pytest.raises(ValueError, match=r"line 4: the sphere is incomplete; name all of modulus"):
        read_samples(path, {name: value for name, value in SPHERE.items() if name != "radius"})
    path.write_text("sample,rms\n")
    with pytest.raises(ValueError, match="has 0 samples; write a row for each"):
        read_samples(path, SPHERE)
    incomplete = tmp_path / "samples.yaml"
    incomplete.write_text("samples: {A: 1}\n")
    with pytest.raises(ValueError, match="lacks a list of samples; write 'samples:'"):
        read_samples(incomplete, SPHERE)
    incomplete.write_text("samples:\n  - {sample: A\n  - B: [\n")
    with pytest.raises(ValueError, match=r"samples.yaml, line \d: this is not YAML: "):
        read_samples(incomplete, SPHERE)


def test_a_sample_that_fails_later_keeps_the_rows_of_the_others(tmp_path):
    (tmp_path / "bad.txt").write_text("no scan\n")
    path = tmp_path / "samples.csv"
    path.write_text(
        "sample,scans,rms,roll_off,hurst,short_cutoff,measured_w_retr,measured_w_retr_error\n"
        "bad,bad.txt,,,,,,\ngood,,20nm,2um,0.8,20nm,65mJ/m2,1mJ/m2\n"
        "rough,,20um,2um,0.8,20nm,,\n"
    )
    bad, good, rough = predicted_samples(read_samples(path, SPHERE))
    assert (bad.outcome, bad.prediction) == ("invalid", None)
    assert "bad.txt" in bad.row["remarks"]
    assert good.row["hysteresis_low"] < good.row["hysteresis"] < good.row["hysteresis_high"]
    assert (good.row["at_least"], good.row["none_expected"], good.row["failed"]) == (
        False,
        False,
        "",
    )
    assert good.row["measured_w_retr"] == pytest.approx(65e-3)
    point = good.point("w_retr")
    assert (point.measured.low, point.measured.high) == pytest.approx((63e-3, 67e-3))
    assert point.predicted.value == good.prediction.w_retr.value
    assert rough.outcome == "does not apply"
    assert "full conformity" in rough.row["failed"]
    assert np.isnan(rough.point("w_retr").predicted.value)
