"""Lines and maps as points: the same verdict in every unit, with the digits that are printed."""

import numpy as np
import pytest

from tests.measured.made import read, refusal

COUNT = 200
UNITS = {"m": 1.0, "mm": 1e3, "um": 1e6, "nm": 1e9}


@pytest.fixture
def line(rng):
    """Heights of a line, in m."""
    return 1e-7 * np.cumsum(rng.standard_normal(COUNT))


def write(path, positions, heights, unit="um", digits="%.10g", separator=" "):
    """Points of a line whose positions and heights are in m."""
    factor = UNITS[unit]
    rows = zip(factor * positions, factor * heights, strict=True)
    path.write_text("".join(f"{digits % x}{separator}{z:.10g}\n" for x, z in rows))
    return path


@pytest.mark.parametrize("unit", UNITS)
def test_no_verdict_on_spacings_depends_on_the_unit(tmp_path, line, unit):
    uneven = np.cumsum(np.where(np.arange(COUNT) % 2, 0.1e-6, 0.9e-6))
    path = write(tmp_path / "uneven.xyz", uneven, line, unit)
    assert "not equally spaced" in refusal(path, unit=unit)
    for digits in ("%.4g", "%.5g", "%.8e"):
        even = write(tmp_path / "even.xyz", 0.123456e-6 * np.arange(COUNT), line, unit, digits)
        measurement = read(even, unit=unit, detrend="center")
        assert measurement.size == pytest.approx((0.123456e-6 * COUNT,), rel=1e-4)
        np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-14)


@pytest.mark.parametrize(
    "order", [slice(None, None, -1), np.random.default_rng(0).permutation(COUNT)]
)
def test_a_line_is_the_same_in_any_order_of_its_points(tmp_path, line, order):
    places = 0.2e-6 * np.arange(COUNT)
    measurement = read(write(tmp_path / "one.xyz", places, line), unit="um")
    reordered = read(write(tmp_path / "other.xyz", places[order], line[order]), unit="um")
    np.testing.assert_array_equal(measurement.heights, reordered.heights)
    mirrored = read(write(tmp_path / "mirrored.xyz", -places, line), unit="um")
    np.testing.assert_allclose(mirrored.heights, measurement.heights[::-1], atol=1e-18)


@pytest.mark.parametrize(
    ("places", "sentence"),
    [
        (lambda rng: np.sort(rng.uniform(0, 40, COUNT)), "not equally spaced"),
        (lambda rng: 0.2 * (np.arange(COUNT) + 0.1 * rng.standard_normal(COUNT)), "not equally"),
        (lambda rng: np.tile(0.2 * np.arange(COUNT // 2), 2), "names the position 0 twice"),
        (lambda rng: 0.2 * np.arange(COUNT) * (1 + 1e-3 * np.arange(COUNT)), "not equally spaced"),
        (lambda rng: np.round(0.004 * np.arange(COUNT), 2), "with more digits"),
    ],
)
def test_points_on_no_regular_line_are_refused(tmp_path, rng, line, places, sentence):
    path = write(tmp_path / "line.xyz", 1e-6 * places(rng), line)
    assert sentence in refusal(path, unit="um")


def test_omitted_and_invalid_points_of_a_line_are_missing(tmp_path, line):
    kept = np.ones(COUNT, dtype=bool)
    kept[[50, 51, 120]] = False
    places = 0.153e-6 * np.arange(COUNT)
    path = write(tmp_path / "line.xyz", places[kept], line[kept], "um", "%.2f")
    assert read(path, unit="um").missing == pytest.approx(3 / COUNT)
    rows = zip(1e3 * places, 1e3 * line, kept, strict=True)
    flagged = tmp_path / "line.hfm"
    flagged.write_text(
        "X;Y;valid\n[mm];[mm];[1/0]\n" + "".join(f"{x:.6f};{z:.9f};{v:d}\n" for x, z, v in rows)
    )
    measurement = read(flagged)
    assert measurement.missing == pytest.approx(3 / COUNT)
    assert measurement.size == pytest.approx((0.153e-6 * COUNT,))


HEADS = {
    "x (um),z (nm)\n": ",",
    "x/um,z/nm\n": ",",
    "x [um]\tz [nm]\n": "\t",
    "# x [um] z [nm]\n": " ",
    "x;z\n(µm);(nm)\n": ";",
}


@pytest.mark.parametrize("head", HEADS)
def test_units_in_the_heads_of_columns_are_those_of_the_points(tmp_path, line, head):
    path, between = tmp_path / "line.csv", HEADS[head]
    cells = [(f"{0.1 * i:.4f}", f"{1e9 * z:.6f}") for i, z in enumerate(line)]
    path.write_text(head + "".join(f"{between.join(row)}\n" for row in cells), encoding="utf-8")
    measurement = read(path, detrend="center")
    assert measurement.size == pytest.approx((0.1e-6 * COUNT,))
    np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-14)
    assert "leave out --height-unit nm" in refusal(path, height_unit="nm")


COLUMNS = {
    "z (nm),x (um)": "{z},{x}",
    "height [nm],position [um]": "{z},{x}",
    "n,x (um),z (nm)": "{i},{x},{z}",
    "t (s),x (um),z (nm)": "{i},{x},{z}",
    "x (um),z (nm),quality": "{x},{z},97",
    "quality,z (nm),x (um),signal (V)": "97,{z},{x},0.5",
    "x-axis (um),quality,quality 2,z height (nm)": "{x},97,1,{z}",
}


@pytest.mark.parametrize("head", COLUMNS)
def test_columns_are_those_that_heads_name_x_and_z(tmp_path, line, head):
    path = tmp_path / "line.csv"
    cells = (
        COLUMNS[head].format(i=i, x=f"{0.1 * i:.4f}", z=f"{1e9 * z:.6f}")
        for i, z in enumerate(line)
    )
    path.write_text("\n".join([head, *cells]))
    measurement = read(path, detrend="center")
    assert measurement.size == pytest.approx((0.1e-6 * COUNT,))
    np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-14)


@pytest.mark.parametrize(
    "head",
    [
        *("x (um),z", "x,z (nm)", "x (um),z (V)", "a,b (um),c (nm)"),
        *("x (mm),y (um),z (nm)", "z (nm),z (um),x (um)", "height (nm),time (s)", "x (px),z (nm)"),
    ],
)
def test_heads_that_do_not_state_a_length_for_each_column_are_refused(tmp_path, line, head):
    path = tmp_path / "line.csv"
    first = "{0}," if head.count(",") > 1 else ""
    rows = (f"{first.format(0.1 * i)}{0.1 * i:.4f},{1e9 * z:.6f}" for i, z in enumerate(line))
    path.write_text("\n".join([head, *rows]))
    for options in ({}, {"unit": "um"}):
        message = refusal(path, **options)
        assert "its columns are" in message
        assert "--unit" not in message


def test_a_line_of_a_stylus_with_one_decimal_is_read_in_its_units(tmp_path, line):
    head = "Scan Parameters,,,\nStylus,Radius: 12.5 µm\n\nScan Data,,,\n\nLateral µm,Raw nm,,\n"
    rows = "".join(f"{0.153 * i:.1f},{1e9 * z:.6f},,\n" for i, z in enumerate(line))
    path = tmp_path / "dektak.csv"
    path.write_bytes((head + rows).encode("latin-1"))
    measurement = read(path, detrend="center")
    assert measurement.size == pytest.approx((0.153e-6 * COUNT,), rel=1e-3)
    assert measurement.tip_radius == pytest.approx(12.5e-6)
    np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-14)


@pytest.mark.parametrize("columns", ["{i} {x} {z}", "{x} 3.0 {z}", "7 {x} {z}"])
def test_a_line_in_three_columns_is_a_line(tmp_path, line, columns):
    rows = (columns.format(i=i, x=f"{0.2 * i:.4g}", z=f"{1e6 * z:.9g}") for i, z in enumerate(line))
    path = tmp_path / "line.xyz"
    path.write_text("\n".join(rows))
    measurement = read(path, unit="um", detrend="center")
    assert measurement.size == pytest.approx((0.2e-6 * COUNT,))
    np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-14)


def test_decimal_commas_in_one_column_are_no_two_columns(tmp_path, line):
    path = tmp_path / "line.txt"
    path.write_text("".join(f"{1e6 * z:.6f}\n".replace(".", ",") for z in line))
    measurement = read(path, unit="um", size="40", detrend="center")
    np.testing.assert_allclose(measurement.heights, line - line.mean(), atol=1e-12)


def rows_of(heights, step=0.4, digits="%.6g", kept=None):
    """Points of a map, in um."""
    return [
        f"{digits % (step * i)} {digits % (step * j)} {1e6 * heights[i, j]:.9g}"
        for i, j in np.ndindex(*heights.shape)
        if kept is None or kept[i, j]
    ]


@pytest.mark.parametrize(
    ("step", "digits"), [(0.4, "%.6g"), (0.416666, "%.1f"), (0.416666, "%.2f"), (1 / 3, "%.3e")]
)
@pytest.mark.parametrize("order", ["rows", "shuffled", "counted"])
def test_a_map_of_rounded_points_is_read_in_any_order(tmp_path, rng, noise, step, digits, order):
    rows = rows_of(noise, step, digits)
    if order == "shuffled":
        rows = [rows[place] for place in rng.permutation(len(rows))]
    elif order == "counted":
        rows = [f"{number} {row}" for number, row in enumerate(rows)]
    path = tmp_path / "map.xyz"
    path.write_text("\n".join(rows))
    measurement = read(path, unit="um", detrend="center")
    assert measurement.size == pytest.approx((48e-6 * step,) * 2, rel=1e-3)
    np.testing.assert_allclose(measurement.heights, noise - noise.mean(), atol=1e-14)


@pytest.mark.parametrize("what", ["scattered", "hole", "column"])
def test_omitted_points_of_a_map_are_missing(tmp_path, rng, noise, what):
    kept = np.ones(noise.shape, dtype=bool)
    if what == "scattered":
        kept[rng.uniform(size=noise.shape) < 0.03] = False
    else:
        kept[7, :] = what == "hole"
        kept[20:24, 10:20] = what != "hole"
    kept[0, 0] = kept[-1, -1] = False
    path = tmp_path / "map.xyz"
    path.write_text("\n".join(rows_of(noise, 0.416666, "%.2f", kept)))
    measurement = read(path, unit="um", detrend="center")
    assert measurement.missing == pytest.approx(1 - kept.mean())
    assert measurement.size == pytest.approx((20e-6, 20e-6), rel=1e-4)
    offset = (measurement.heights - noise)[kept]
    np.testing.assert_allclose(offset, offset.mean(), atol=1e-12)


def test_points_that_are_no_grid_are_refused(tmp_path, rng, noise):
    path = tmp_path / "map.xyz"
    scattered = np.column_stack([rng.uniform(0, 20, (900, 2)), rng.standard_normal(900)])
    np.savetxt(path, scattered)
    assert "not equally spaced" in refusal(path, unit="um")
    rows = rows_of(noise)
    path.write_text("\n".join([*rows, rows[5]]))
    assert "names the position 0, 2 twice" in refusal(path, unit="um")
    path.write_text("\n".join([*rows[:900], "part two", *rows[900:]]))
    assert "line 901: 'part two' stands between points" in refusal(path, unit="um")
