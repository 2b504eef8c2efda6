"""Tables of rigs: separators, decimals, heads, units and encodings."""

import codecs
from pathlib import Path

import numpy as np
import pytest

from crackfront.experiment.recording import read_recording

FORCE, RADIUS = np.array([-1.5e-3, 2.25e-3, 0.5e-3]), np.array([50e-6, 60.5e-6, 70e-6])
ROWS = [("-1.5", "50"), ("2.25", "60.5"), ("0.5", "70")]


def table(separator=",", decimal=".", head=("Force (mN)", "Radius (um)"), before="", below=()):
    lines = [separator.join(head), *([separator.join(below)] if below else [])]
    lines += [separator.join(row).replace(".", decimal) for row in ROWS]
    return before + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "content",
    [
        table().encode(),
        table("\t").encode(),
        table(";", ",").encode(),
        table("\t", ",").encode(),
        table(before="Rig 7\nsample: film\n\n").encode(),
        table(before="# made by hand\n").encode(),
        table(head=("load [mN]", "contact radius / um")).encode(),
        table(head=("F (mN)", "a (µm)")).encode("latin-1"),
        table(head=("F (mN)", "a (µm)")).encode("utf-16"),
        codecs.BOM_UTF8 + table().encode(),
        table(head=("Force", "Radius"), below=("mN", "um")).encode(),
        table(head=("Force", "Radius"), below=("[mN]", "[um]")).encode(),
        table(" ", head=("force/mN", "radius/um")).encode(),
        table().replace("\n", "\r\n").encode(),
        table(head=('"Force (mN)"', '"Radius (um)"')).encode(),
        table(head=("# Force (mN)", "Radius (um)")).encode(),
    ],
)
def test_tables_of_common_programs_are_read(content, tmp_path):
    path = tmp_path / "rig.csv"
    path.write_bytes(content)
    found = read_recording(path, {}, {})
    assert found.force == pytest.approx(FORCE)
    assert found.radius == pytest.approx(RADIUS)
    assert found.displacement is None


def test_columns_are_named_and_units_given_by_options(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(table(head=("Kanal 1", "Kanal 2")))
    named, units = {"force": "Kanal 1", "radius": "kanal 2"}, {"force": "mN", "radius": "um"}
    assert read_recording(path, named, units).radius == pytest.approx(RADIUS)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (table(head=("Force", "Radius (um)")), "'Force' has no unit.*--force-unit mN"),
        (table(head=("Kanal 1", "Kanal 2")), "needs two of force, radius, displacement"),
        (table(head=("Force (mN)", "Load (mN)")), "2 columns of force"),
        (table().replace("60.5", "60.x"), "'60.x' in row 2"),
        (table(";").replace("60.5", "60,5"), "decimal points and with decimal commas"),
        (table(head=("Force (mN)", "Radius (kg)")), "the unit kg cannot be converted to m"),
        ("nothing here\n", "no line with two numbers"),
        ("", "no line with two numbers"),
    ],
)
def test_what_is_no_table_of_a_loop_is_refused_with_what_to_do(content, sentence, tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(content)
    with pytest.raises(ValueError, match=sentence):
        read_recording(Path(path), {}, {})
