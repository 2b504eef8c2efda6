"""Tables of loops as laboratories write them: headings, branches side by side, segments."""

import gzip

import numpy as np
import pytest

from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.loop_table import read_recording
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, loop

WHOLE = loop(0)
COLUMNS = {
    "force": 1e6 * WHOLE.force,
    "radius": 1e6 * WHOLE.radius,
    "travel": 1e9 * WHOLE.displacement,
}
TURN = int(np.argmax(WHOLE.displacement))


def table(headings, columns, separator=","):
    """Text of a table; a missing number is an empty cell."""
    cells = [
        ["" if np.isnan(value) else f"{value:.9g}" for value in row]
        for row in zip(*columns, strict=True)
    ]
    return "\n".join(map(separator.join, [headings, *cells])) + "\n"


@pytest.fixture
def read(tmp_path):
    """Write a text and read its recording."""

    def reading(text, named=None, units=None):
        path = tmp_path / "rig.csv"
        path.write_text(text)
        return read_recording(path, named or {}, units or {})

    return reading


@pytest.mark.parametrize(
    ("headings", "separator"),
    [
        (("Kraft (uN)", "Kontaktradius (um)", "Weg (nm)"), ";"),
        (("Normalkraft [uN]", "Kontaktradius [um]", "Eindringtiefe [nm]"), "\t"),
        (("Load, uN", "Contact radius, um", "Displacement, nm"), "\t"),
        (("force_uN", "radius_um", "displacement_nm"), ","),
        (("Force (uN)", "Radius (um)", "Piezo (nm)"), ","),
        (("Force (uN)", "Radius (um)", "Z piezo (nm)"), ","),
    ],
)
def test_headings_of_laboratories_are_read(headings, separator, read):
    recording = read(table(headings, COLUMNS.values(), separator))
    assert recording.force == pytest.approx(WHOLE.force, rel=1e-6)
    assert recording.radius == pytest.approx(WHOLE.radius, rel=1e-6)
    assert recording.displacement == pytest.approx(WHOLE.displacement, rel=1e-6)


def test_a_german_diameter_or_area_is_a_radius(read):
    for heading, values in (
        ("Kontaktdurchmesser (um)", 2 * COLUMNS["radius"]),
        ("Kontaktfläche (um^2)", np.pi * COLUMNS["radius"] ** 2),
    ):
        recording = read(table(("Kraft (uN)", heading), [COLUMNS["force"], values]))
        assert recording.radius == pytest.approx(WHOLE.radius, rel=1e-6)


def split(names, *, is_reversed=False):
    """Columns of approach and of retraction, filled up to one length."""
    parts = []
    for rows in (slice(0, TURN + 1), slice(TURN, None)):
        step = -1 if is_reversed and rows.start else 1
        parts += [COLUMNS[name][rows][::step] for name in names]
    length = max(map(len, parts))
    return [np.append(part, np.full(length - len(part), np.nan)) for part in parts]


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize(
    "headings",
    [
        ("Force (uN)", "Radius (um)", "Force (uN)", "Radius (um)"),
        ("Force (uN)", "Radius (um)", "Force.1 (uN)", "Radius.1 (um)"),
        (
            "Force approach (uN)",
            "Radius approach (um)",
            "Force retract (uN)",
            "Radius retract (um)",
        ),
        ("Loading force (uN)", "Loading a (um)", "Unloading force (uN)", "Unloading a (um)"),
    ],
)
def test_branches_side_by_side_are_one_loop(headings, is_reversed, read):
    recording = read(table(headings, split(("force", "radius"), is_reversed=is_reversed)))
    rig = Rig(RADIUS, MODULUS)
    expected = analyse_loop(loop(0, without="displacement"), rig)
    result = analyse_loop(recording, rig)
    assert result.w_appr.value == pytest.approx(expected.w_appr.value, rel=0.01)
    assert result.w_retr.value == pytest.approx(expected.w_retr.value, rel=0.01)
    assert any("side by side" in remark for remark in result.remarks)


def test_a_travel_that_stands_once_belongs_to_both_branches(read):
    path = np.linspace(-1.0, 1.0, 200)
    columns = [path, path**2, path**3]
    recording = read(table(("Piezo (um)", "Force approach (uN)", "Force retract (uN)"), columns))
    assert recording.displacement == pytest.approx(1e-6 * np.append(path, path[::-1]))
    assert recording.force == pytest.approx(1e-6 * np.append(path**2, path[::-1] ** 3))


@pytest.mark.parametrize("above", ["", "# Segment {}\n", "Segment {}\n", "\n\n", "retract {}\n\n"])
def test_segments_with_headings_between_them_are_one_loop(above, read):
    headings = ("Force (uN)", "Radius (um)")
    texts = []
    for number, rows in enumerate((slice(0, TURN), slice(TURN, None))):
        columns = [COLUMNS[name][rows] for name in ("force", "radius")]
        texts.append(above.format(number) + table(headings, columns))
    recording = read("".join(texts))
    assert recording.force == pytest.approx(WHOLE.force, rel=1e-6)


def test_rows_without_values_keep_their_moment(read):
    recording = read("Force (uN),Radius (um)\n1,2\nnan,nan\n3,4\n")
    assert recording.force.size == 3


def test_a_damaged_number_is_still_an_error(read):
    with pytest.raises(ValueError, match="line 3"):
        read("Force (uN),Radius (um)\n1,2\n1.x,3\n3,4\n")


def test_a_displacement_that_was_chosen_is_named(read):
    headings = ("Force (uN)", "Indentation (nm)", "Piezo (nm)")
    recording = read(table(headings, [COLUMNS["force"], COLUMNS["travel"], 2 * COLUMNS["travel"]]))
    assert recording.displacement == pytest.approx(WHOLE.displacement, rel=1e-6)
    [remark] = recording.remarks
    assert "'Indentation (nm)', not 'Piezo (nm)'" in remark
    assert "--displacement" in remark


@pytest.mark.parametrize(
    ("heading", "stiffness", "text"),
    [
        ("Indentation (nm)", 1e3, "leave out --stiffness"),
        ("Indentation (nm)", None, "without the bending of the machine"),
        ("Piezo (nm)", None, "give --stiffness"),
    ],
)
def test_a_stiffness_that_is_used_twice_is_named(heading, stiffness, text, read):
    recording = read(table(("Force (uN)", heading), [COLUMNS["force"], COLUMNS["travel"]]))
    result = analyse_loop(recording, Rig(RADIUS, MODULUS, stiffness=stiffness))
    assert any(text in remark for remark in result.remarks)


def test_a_table_with_one_column_names_all_headings_and_what_was_read(read):
    with pytest.raises(ValueError, match=r"has 1: 'Force \(uN\)' is the force") as error:
        read("Force (uN),Kanal 7 (V)\n1,2\n2,3\n")
    assert "'Kanal 7 (V)'" in str(error.value)
    assert "--force" in str(error.value)


def test_the_remedy_names_a_column_that_may_be_the_missing_one(read):
    with pytest.raises(ValueError, match=r"--displacement 'Height \(nm\)'"):
        read("Time (s),Force (uN),Height (nm)\n1,2,3\n2,3,4\n")
    with pytest.raises(ValueError, match=r"--force 'Zug \(uN\)'"):
        read("Time (s),Zug (uN),Radius (nm)\n1,2,3\n2,3,4\n")


def test_an_error_of_a_unit_names_file_and_column(read):
    with pytest.raises(ValueError, match=r"rig\.csv: column 'Radius \(kg\)'"):
        read("Force (uN),Radius (kg)\n1,2\n2,3\n")


def test_a_unit_of_a_missing_column_is_an_error(read):
    with pytest.raises(ValueError, match=r"--displacement-unit is nm.*lacks a column of displacem"):
        read(table(("Force (uN)", "Radius (um)"), [[1, 2], [3, 4]]), units={"displacement": "nm"})


def test_a_compressed_table_is_named_with_the_remedy(tmp_path):
    path = tmp_path / "rig.csv.gz"
    path.write_bytes(gzip.compress(b"Force (uN),Radius (um)\n1,2\n"))
    with pytest.raises(ValueError, match=r"rig\.csv\.gz is compressed.*gunzip"):
        read_recording(path, {}, {})


@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
@pytest.mark.parametrize("place", [1, 3, 5])
@pytest.mark.parametrize(
    "damage",
    [
        lambda row: ["#", *row[1:]],
        lambda row: [f"#{row[0]}", *row[1:]],
        lambda row: ["%", *row[1:]],
        lambda row: [";;", *row[1:]],
    ],
    ids=["comment for a number", "comment", "%", ";"],
)
def test_a_row_of_a_loop_is_never_dropped_as_a_comment(read, separator, place, damage):
    rows = [["Force_uN", "Radius_um", "Displacement_nm"], *([f"{n}.5"] * 3 for n in range(5))]
    rows[place] = damage(rows[place])
    with pytest.raises(ValueError, match=rf"rig\.csv, line {place + 1}: .*(nan|row|heading)"):
        read("".join(f"{separator.join(row)}\n" for row in rows))


def test_a_sign_for_the_first_of_two_numbers_is_an_error(read):
    with pytest.raises(ValueError, match=r"rig\.csv, line 3: .*nan"):
        read("Force_uN,Radius_um\n1,2\n#,3\n3,4\n")


@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
def test_a_number_that_a_single_row_lacks_never_shifts_its_columns(read, separator):
    rows = [["Force_uN", "Radius_um", "Displacement_nm"], *([f"{n}.5"] * 3 for n in range(5))]
    del rows[3][0]
    with pytest.raises(ValueError, match=r"rig\.csv, line 4: .*2 cells.*write nan"):
        read("".join(f"{separator.join(row)}\n" for row in rows))


def test_rows_out_of_contact_may_end_before_their_last_column(read):
    recording = read("Force_uN,Displacement_nm,Radius_um\n1,2,3\n2,3\n3,4\n4,5,6\n5,6\n")
    assert np.isnan(recording.radius).tolist() == [False, True, True, False, True]
