"""Tables of rigs: separators, decimals, heads, units and encodings."""

from pathlib import Path

import numpy as np
import pytest

from crackfront.measured.loops.loop_table import read_recording

FORCE, RADIUS = np.array([-1.5e-3, 2.25e-3, 0.5e-3]), np.array([50e-6, 60.5e-6, 70e-6])
ROWS = [("-1.5", "50"), ("2.25", "60.5"), ("0.5", "70")]


def table(
    separator=",", decimal=".", head=("Force (mN)", "Radius (um)"), before="", below=(), more=""
):
    lines = [separator.join(head), *([separator.join(below)] if below else [])]
    lines += [separator.join(row).replace(".", decimal) + more for row in ROWS]
    return before + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "content",
    [
        table().encode(),
        table("\t", ",").encode(),
        table(before="Rig 7\nsample: film\n\n").encode(),
        table(head=("load [mN]", "contact radius / um")).encode(),
        table(head=("F (mN)", "a (µm)")).encode("latin-1"),
        table(head=("Force", "Radius"), below=("mN", "um")).encode(),
        table(head=("Force", "Radius"), below=("[mN]", "[um]")).encode(),
        table(" ", head=("force/mN", "radius/um")).encode(),
        table(head=('"Force (mN)"', '"Radius (um)"')).encode(),
        table(head=("# Force (mN)", "Radius (um)")).encode(),
        table("  ", head=("Force (mN)", "Contact radius (um)")).encode(),
        table().replace("\n", ",\n").replace(",\n", "\n", 1).encode(),
        table(head=("Force (mN)", "Radius (um)", "Contact area (um^2)"), more=",9").encode(),
        b"Speed (um/s);2\nTime;Force (mN);Radius (um);Phase\n"
        b"12:00:01.1;-1,5;50;approach\n12:00:01.2;2,25;60,5;approach\n12:00:01.3;0,5;70;retract\n",
    ],
)
def test_tables_of_common_programs_are_read(content, tmp_path):
    path = tmp_path / "rig.csv"
    path.write_bytes(content)
    recording = read_recording(path, {}, {})
    assert recording.force == pytest.approx(FORCE)
    assert recording.radius == pytest.approx(RADIUS)
    assert recording.displacement is None


@pytest.mark.parametrize("separator", [",", ";"])
@pytest.mark.parametrize("absent", ["", "NaN", "NA", " ", "-"])
def test_a_radius_may_be_absent_out_of_contact(separator, absent, tmp_path):
    path = tmp_path / "rig.csv"
    rows = [("0.1", absent), *ROWS]
    path.write_text("\n".join(map(separator.join, [("Force (mN)", "Radius (um)"), *rows])) + "\n")
    recording = read_recording(path, {}, {})
    np.testing.assert_allclose(recording.radius, [np.nan, *RADIUS])
    np.testing.assert_allclose(recording.force, [1e-4, *FORCE])


@pytest.mark.parametrize(
    ("head", "values"),
    [
        ("Contact area (um^2)", np.pi * (1e6 * RADIUS) ** 2),
        ("area / mm2", np.pi * (1e3 * RADIUS) ** 2),
        ("Contact diameter [um]", 2e6 * RADIUS),
        ("Contact diameter x (um)", 2e6 * RADIUS),
        ("Area of contact (um^2)", np.pi * (1e6 * RADIUS) ** 2),
        ("Area-equivalent radius (um)", 1e6 * RADIUS),
    ],
)
def test_a_camera_may_give_areas_or_diameters(head, values, tmp_path):
    path = tmp_path / "rig.csv"
    rows = zip(1e3 * FORCE, values, strict=True)
    path.write_text(f"Force (mN),{head}\n" + "".join(f"{f},{a:.9g}\n" for f, a in rows))
    assert read_recording(path, {"radius": head}, {}).radius == pytest.approx(RADIUS)


def test_a_unit_stands_in_the_heading_or_in_an_option(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(table())
    with pytest.raises(ValueError, match="has the unit mN, and --force-unit is uN; leave that out"):
        read_recording(path, {}, {"force": "uN"})
    units = {"force": "mN", "radius": "micron"}
    assert read_recording(path, {}, units).force == pytest.approx(FORCE)


def test_columns_are_named_and_units_given_by_options(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(table(head=("Kanal 1", "Kanal 2")))
    named, units = {"force": "Kanal 1", "radius": "kanal 2"}, {"force": "mN", "radius": "um"}
    assert read_recording(path, named, units).radius == pytest.approx(RADIUS)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (table(head=("Force", "Radius (um)")), "'Force' lacks a unit.*--force-unit mN"),
        (table(head=("Kanal 1", "Kanal 2")), "has 0; its headings are 'Kanal 1', 'Kanal 2'"),
        (table(head=("Force (mN)", "Load (mN)")), "2 columns of force"),
        (table().replace("60.5", "60.x"), "line 3: '60.x' in column 2"),
        (table(";").replace("60.5", "60,5"), "decimal points and with decimal commas"),
        (table(head=("Force (mN)", "Radius (kg)")), "the unit kg cannot be converted to m"),
        ("nothing here\n", "lacks a line with two numbers"),
        (table().replace("60.5", "60,5"), "line 3: the row has 3 cells and there are 2 headings"),
        ("force(uN) radius(um)\n0 0.02 1\n1 0.03 1\n", "line 2: .* 3 cells and there are 2"),
        (table(head=("Force (mN)", "Contact area")), "--radius-unit um.2"),
        (table(head=("Force (mN)", "Contact area (um)")), "unit um cannot be converted to m.2"),
        (table(head=("Force (mN)", "Radius (um^2)")), "unit um.2 cannot be converted to m"),
        (table() + '"' + "1,2\n" * 40_000, "close the quote"),
    ],
)
def test_what_is_no_table_of_a_loop_is_refused_with_what_to_do(content, sentence, tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(content)
    with pytest.raises(ValueError, match=sentence):
        read_recording(Path(path), {}, {})
