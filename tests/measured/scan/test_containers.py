"""Containers of contact.engineering: all measurements of a surface, with their units and sizes."""

import io
import json
import zipfile

import numpy as np
import pytest
from ruamel.yaml import YAML
from SurfaceTopography import Topography
from SurfaceTopography.Container.IO.CE import write_containers
from SurfaceTopography.Container.SurfaceContainer import InMemorySurfaceContainer

import crackfront as cf
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements

SIDE = 10e-6
CENTER = ReadingOptions(detrend="center")


def maps(rng, number=2):
    """Heights of maps without correlation."""
    return [1e-8 * rng.standard_normal((48, 48)) for _ in range(number)]


def texts(heights, factor):
    """Rows of a map, which states neither unit nor size."""
    file = io.BytesIO()
    np.savetxt(file, factor * heights.T, fmt="%.12e")
    return file.getvalue()


def entry(name, **more):
    """Metadata of a measurement whose text is in nanometres, of a side in micrometres."""
    return {
        "name": name,
        "datafile": {"original": f"{name}.txt"},
        "size": [10.0, 10.0],
        "unit": "µm",
        "height_scale": 1e-3,
        **more,
    }


def container(path, surfaces, files, metadata="meta.yml"):
    """A ZIP file of surfaces, named by the entries of their measurements."""
    content = {"surfaces": [{"name": n, "topographies": t} for n, t in surfaces.items()]}
    with zipfile.ZipFile(path, "w") as archive:
        text = io.StringIO()
        if metadata.endswith("json"):
            json.dump(content, text)
        else:
            YAML(typ="safe").dump(content, text)
        archive.writestr(metadata, text.getvalue())
        for name, data in files.items():
            archive.writestr(name, data)
    return path


@pytest.mark.parametrize("metadata", ["meta.yml", "index.json"])
def test_all_measurements_of_a_surface_have_the_units_and_sizes_of_the_container(
    tmp_path, rng, metadata
):
    heights = maps(rng)
    files = {f"{name}.txt": texts(item, 1e9) for name, item in zip("ab", heights, strict=True)}
    entries = [entry("a"), entry("b", size=[5.0, 5.0])]
    path = container(tmp_path / "film.zip", {"film": entries}, files, metadata)
    measurements = read_measurements([path], CENTER)
    assert [str(item.path) for item in measurements] == [f"{path}/a", f"{path}/b"]
    assert [item.size[0] for item in measurements] == pytest.approx([SIDE, SIDE / 2])
    for item, expected in zip(measurements, heights, strict=True):
        np.testing.assert_allclose(item.heights, expected - expected.mean(), atol=1e-17)
    assert "film: b" in str(cf.list_channels(path)[1])


def test_a_container_of_the_library_is_read(tmp_path, rng):
    heights = maps(rng)
    scans = [
        Topography(item, (SIDE, SIDE), unit="m", info={"name": name})
        for name, item in zip("ab", heights, strict=True)
    ]
    path = tmp_path / "film.zip"
    write_containers([InMemorySurfaceContainer(scans)], str(path))
    measurements = read_measurements([path], CENTER)
    for item, expected in zip(measurements, heights, strict=True):
        assert item.size == pytest.approx((SIDE, SIDE))
        np.testing.assert_allclose(item.heights, expected - expected.mean(), atol=1e-17)


def instrument(**lengths):
    """Metadata of an instrument, each of whose lengths is a value and a unit."""
    parameters = {name: {"value": value, "unit": unit} for name, (value, unit) in lengths.items()}
    return {"name": "stylus", "type": "contact-based", "parameters": parameters}


@pytest.mark.parametrize("metadata", ["meta.yml", "index.json"])
def test_the_instrument_of_a_container_counts_as_if_the_file_stated_it(tmp_path, rng, metadata):
    [heights] = maps(rng, 1)
    stated = instrument(tip_radius=(5, "µm"), resolution=(1, "µm"))
    entries = [entry("a", instrument=stated), entry("b", instrument=None)]
    files = dict.fromkeys(("a.txt", "b.txt"), texts(heights, 1e9))
    files["b.txt"] = texts(heights[::-1], 1e9)
    path = container(tmp_path / "film.zip", {"film": entries}, files, metadata)
    measured, bare = read_measurements([path], CENTER)
    assert (measured.tip_radius, measured.shortest) == pytest.approx((5e-6, 1e-6))
    assert measured.tip_wavelength > 1e-6
    assert (bare.tip_radius, bare.tip_wavelength) == (0, 0)
    assert bare.shortest == pytest.approx(4 * SIDE / 48)
    named, _ = read_measurements([path], ReadingOptions(tip_radius="1um"))
    assert named.tip_radius == pytest.approx(1e-6)


def test_one_of_several_surfaces_is_chosen_by_name_or_number(tmp_path, rng):
    heights = maps(rng)
    files = {f"{name}.txt": texts(item, 1e9) for name, item in zip("ab", heights, strict=True)}
    surfaces = {"smooth": [entry("a")], "rough": [entry("b")]}
    path = container(tmp_path / "films.zip", surfaces, files)
    with pytest.raises(ValueError, match=r"2 surfaces; .*--surface: 0 'smooth' \(1.*; 1 'rough'"):
        read_measurements([path])
    for wanted in ("rough", "1"):
        [measurement] = read_measurements([path], ReadingOptions(surface=wanted))
        assert measurement.path.name == "b"
    with pytest.raises(ValueError, match="no surface '2'; choose"):
        read_measurements([path], ReadingOptions(surface="2"))


def test_what_is_no_container_or_a_damaged_one_is_refused_with_a_sentence(tmp_path, rng, scan):
    with pytest.raises(ValueError, match="not a container of surfaces; leave --surface out"):
        read_measurements([scan], ReadingOptions(surface="0"))
    lacking = container(tmp_path / "lacking.zip", {"film": [entry("a")]}, {})
    with pytest.raises(ValueError, match=r"lacks 'a.txt', which it lists"):
        read_measurements([lacking])
    empty = container(tmp_path / "empty.zip", {"film": []}, {})
    with pytest.raises(ValueError, match=r"meta.yml does not state .*: surfaces.0.topographies"):
        read_measurements([empty])
    locked = container(tmp_path / "locked.zip", {"film": [entry("a")]}, {"a.txt": b"1"})
    content = bytearray(locked.read_bytes())
    place = content.rindex(b"PK\x01\x02")
    content[place + 8] |= 1
    locked.write_bytes(content)
    with pytest.raises(ValueError, match="is encrypted; unpack it with its password"):
        read_measurements([locked])


def test_a_measurement_that_cannot_be_used_is_left_out_with_a_sentence(tmp_path, rng):
    [good] = maps(rng, 1)
    points = np.column_stack([[0.0, 1.0, 2.0, 3.7, 5.0, 6.1, 7.0, 8.4], rng.standard_normal(8)])
    line = io.BytesIO()
    np.savetxt(line, points, header="x z")
    files = {"good.txt": texts(good, 1e9), "uneven.txt": line.getvalue()}
    entries = [entry("uneven", size=[8.4], height_scale=1.0), entry("good")]
    two_surfaces = container(tmp_path / "both.zip", {"rough": entries}, files)
    [measurement] = read_measurements([two_surfaces], CENTER)
    assert measurement.path == two_surfaces / "good"
    [sentence] = measurement.unusable
    assert sentence.startswith(f"{two_surfaces / 'uneven'}: ")
    assert "not equally spaced" in sentence
    alone = container(tmp_path / "alone.zip", {"rough": entries[:1]}, files)
    with pytest.raises(ValueError, match="not equally spaced"):
        read_measurements([alone], CENTER)
