"""Files that claim too much, or contain something else than heights."""

import bz2
import gzip
import lzma
import struct
import zipfile

import netCDF4
import numpy as np
import pytest

from crackfront.core.resources import TooLargeError
from crackfront.measured.options import ReadingOptions
from crackfront.measured.samples.sample import read_samples
from crackfront.measured.scan import containers
from crackfront.measured.scan.channels import is_doubtful
from crackfront.measured.scan.instruments import list_channels, raw_scan
from tests.measured.made import refusal

DEPTH = 50_000


def container(path, name, text):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, text)
    return path


@pytest.mark.parametrize("name", ["index.json", "meta.yml"])
def test_metadata_that_are_nested_too_deeply_are_a_sentence(tmp_path, name):
    path = container(tmp_path / "deep.zip", name, '{"a": ' * DEPTH + "0" + "}" * DEPTH)
    message = refusal(path)
    assert "nested" in message
    assert "download it again" in message


@pytest.mark.parametrize("name", ["index.json", "meta.yml"])
def test_large_metadata_are_not_unpacked(tmp_path, name, monkeypatch):
    monkeypatch.setattr(containers, "_content", lambda *_: pytest.fail("the file is unpacked"))
    path = container(tmp_path / "large.zip", name, " " * 20_000_000)
    assert "would unpack to 20" in refusal(path)


def test_measurements_that_fill_the_memory_together_are_not_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr(containers, "memory_at_hand", lambda: 8 * 1.5e6)
    entry = '{"datafile": {"original": "map.txt"}}'
    path = container(
        tmp_path / "many.zip",
        "index.json",
        f'{{"surfaces":[{{"topographies":[{entry},{entry}]}}]}}',
    )
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("map.txt", " " * 1_000_000)
    assert "2 files" in refusal(path)


@pytest.mark.parametrize("counts", [(3_000_000_000,), (60_000, 50_000)])
def test_netcdf_that_claims_more_points_than_fit_is_an_error_before_it_is_read(tmp_path, counts):
    path = tmp_path / "large.nc"
    with netCDF4.Dataset(path, "w") as file:
        for name, count in zip("xy", counts, strict=False):
            file.createDimension(name, count)
            file.createVariable(name, "f8", (name,), zlib=True).units = "m"
        file.createVariable("heights", "f8", tuple("xy"[: len(counts)]), zlib=True).units = "m"
    assert path.stat().st_size < 10_000
    with pytest.raises(TooLargeError, match="3000000000 points"):
        list_channels(path)


@pytest.mark.parametrize("module", [gzip, bz2, lzma])
def test_a_compressed_file_says_which_command_unpacks_it(tmp_path, module):
    path = tmp_path / "map.txt.gz"
    path.write_bytes(module.compress(b"1 2\n3 4\n"))
    assert "unpack it, as with" in refusal(path)
    with pytest.raises(ValueError, match="unpack it, as with"):
        read_samples(path, {})


def test_a_text_in_a_zip_file_is_to_be_unpacked(tmp_path):
    assert "unpack it" in refusal(container(tmp_path / "map.zip", "map.txt", "1 2\n3 4\n"))


def test_an_unevenly_spaced_line_states_its_spacings(tmp_path, rng):
    places = np.cumsum(1 + rng.integers(0, 2, 100))
    path = tmp_path / "line.txt"
    path.write_text("".join(f"{place} {rng.normal():.4f}\n" for place in places))
    message = refusal(path, unit="um")
    assert "along x are 1 to 2 apart" in message
    assert "equal steps" in message


def write_sur(path, heights, kind=2, n_object=1, unit="µm", quantity=b"Z"):
    n_x, n_y = heights.shape
    data = heights.astype("<i4")
    units = [text.encode("latin-1") for text in ["µm", "µm", unit, "µm", "µm", unit]]
    head = struct.pack(
        "<12s4H30s30s5H2IH4iI3f16s16s16s",
        b"DIGITAL SURF",
        *(0, n_object, 1, kind),
        *(b"", b""),
        *(0, 0, 0, 0, 0),
        *(0, 0),
        32,
        *(data.min(), data.max(), n_x, n_y, data.size),
        *(0.5, 0.5, 1e-3),
        *(b"X", b"Y", quantity),
    )
    head += struct.pack("<16s16s16s16s16s16s3f", *units, 1, 1, 1)
    path.write_bytes(head.ljust(512, b"\0") + data.tobytes())
    return path


@pytest.mark.parametrize(
    ("options", "content"),
    [
        ({"kind": 10}, "intensities, not heights"),
        ({"unit": "%"}, "in '%', which is not a length"),
        ({"unit": ""}, "not a length"),
    ],
)
def test_sur_files_without_heights_say_what_they_contain(tmp_path, noise, options, content):
    message = refusal(write_sur(tmp_path / "scan.sur", 1e10 * noise, **options))
    assert content in message
    assert "export the" in message


def test_the_type_of_a_sur_file_says_that_it_has_heights_and_not_the_name_of_its_axis(
    tmp_path, noise
):
    path = write_sur(tmp_path / "scan.sur", 1e10 * noise, quantity=b"Intensity")
    [channel] = list_channels(path)
    assert channel.quantity == "height"
    assert "another quantity" not in str(channel)
    assert not is_doubtful(raw_scan(path, ReadingOptions()).channel)


def test_the_first_of_several_objects_of_a_sur_file_is_read_and_says_so(tmp_path, noise):
    path = write_sur(tmp_path / "scan.sur", 1e10 * noise, n_object=2)
    assert "the first of 2 objects" in raw_scan(path, ReadingOptions()).channel


def write_opd(path, blocks):
    """A Wyko file of blocks: their names, types and bytes."""
    entries = [(b"Directory", 1, bytes(24 * (1 + len(blocks)))), *blocks]
    heads = (struct.pack("<16shlH", name, kind, len(data), 0) for name, kind, data in entries)
    path.write_bytes(b"\1\0" + b"".join([*heads, *(data for _, _, data in blocks)]))
    return path


WAVELENGTH = (b"Wavelength", 7, struct.pack("<f", 630))


def test_a_wyko_file_without_heights_says_so(tmp_path):
    image = struct.pack("<3H", 8, 8, 1) + bytes(64)
    message = refusal(write_opd(tmp_path / "scan.opd", [(b"Intensity", 3, image), WAVELENGTH]))
    assert "lacks an array of numbers" in message
    assert "export the heights" in message


def test_a_wyko_file_with_two_blocks_of_heights_says_which_is_read_and_how_to_choose(tmp_path):
    grid = struct.pack("<3H", 8, 8, 4)
    heights = [
        (name, 3, grid + np.full((8, 8), height, "<f4").tobytes())
        for name, height in ((b"RAW_DATA", 1), (b"OPD", 2))
    ]
    pixel = (b"Pixel_size", 7, struct.pack("<f", 1e-3))
    path = write_opd(tmp_path / "scan.opd", [WAVELENGTH, pixel, *heights])
    default, second = (raw_scan(path, ReadingOptions(channel=channel)) for channel in (None, "OPD"))
    assert default.channel.startswith("'RAW_DATA', 0 of 2")
    assert second.channel.startswith("'OPD', 1 of 2")
    assert all("--channel" in scan.channel for scan in (default, second))
    np.testing.assert_allclose(second.topography.heights(), 2 * default.topography.heights())


@pytest.mark.parametrize("n_byte", [100, 130, 20_000, 30_000])
def test_an_array_that_ends_early_is_an_error_and_not_unused_memory(tmp_path, rng, n_byte):
    path = tmp_path / "scan.npy"
    np.save(path, rng.standard_normal((64, 64)))
    path.write_bytes(path.read_bytes()[:n_byte])
    message = refusal(path, unit="um", size="20")
    assert "scan.npy" in message
    assert "ends before its last number; export it" in message


@pytest.mark.parametrize(
    "array",
    [np.zeros((2, 2, 2)), np.eye(8, dtype=complex), np.array([[None]]), np.zeros((0, 3))],
)
def test_an_array_without_real_heights_of_a_map_or_line_is_an_error(tmp_path, array):
    path = tmp_path / "scan.npy"
    np.save(path, array)
    message = refusal(path, unit="um", size="20")
    assert "scan.npy" in message
    assert message.endswith(("save the real heights of a map or of a line", "again"))
