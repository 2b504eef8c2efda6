"""Measured surfaces: what is read, what follows from it, and one sentence for what cannot be."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import get_window

from crackfront.core.adhesion import half_derivative_mean_square, rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION, Scales
from crackfront.topography.bands import scan as scan_of
from crackfront.topography.densities import cosine_window, periodogram, profile_density
from crackfront.topography.instruments import library_scan, surface_library
from crackfront.topography.measures import measured_mean_square, measured_surface
from crackfront.topography.options import ReadingOptions, parsed_options
from crackfront.topography.reading import Measurement, read_measurements
from crackfront.topography.tile import measured_adhesion, zero_load_radius
from studies.accuracy import scans
from studies.paper.si_6 import profile_periodogram

SHIPPED = tuple(sorted((Path(__file__).parents[2] / "examples/scans").glob("*.al3d")))

SIDE = 20e-6
SPECTRUM = SelfAffineSpectrum(0.4e-6, 3e-6, hurst=0.8, plateau=1e-26)


@pytest.mark.parametrize("name", ["hann", "blackman"])
def test_windows_are_those_of_scipy_to_the_bit(name):
    for count in (8, 9, 144, 1000):
        assert np.array_equal(cosine_window(name, count), get_window(name, count))


def map_heights(rng, n_point=128, spectrum=SPECTRUM, side=SIDE):
    """Heights of a map whose edges do not fit together."""
    return gaussian_field(spectrum, 2 * n_point, 2 * side, rng)[:n_point, :n_point]


def periodic_measurement(heights, side=SIDE, shortest=None):
    """A map that is one period of its surface, all waves trusted down to two pixels."""
    pixel = side / len(heights)
    shortest = 2 * pixel if shortest is None else shortest
    return Measurement(
        Path("periodic"), "", "", "", (side, side), heights, True, 0.0, shortest, side * (1 + 1e-9)
    )


def write_al3d(path, heights, side=SIDE, comment="test"):
    """An AL3D file of a map."""
    path.write_bytes(scans.al3d(heights, side / len(heights), comment))
    return path


def write_line(path, heights, pixel):
    """A text file of a line, in two columns without units."""
    np.savetxt(path, np.column_stack([pixel * np.arange(heights.size), heights]))
    return path


SOFT = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
SMALL = Scales(radius=2e-5, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)


@pytest.fixture
def heights(rng):
    return map_heights(rng)


@pytest.fixture
def scan(tmp_path, heights):
    return write_al3d(tmp_path / "scan.al3d", heights)


def half(surface):
    """Mean square half-derivative of a surface's spectrum, with its standard error."""
    return surface.joint.estimate(lambda spectrum: spectrum.mean_square(0.5))


def refusal(paths, **given):
    """Sentence for files that are refused."""
    with pytest.raises(ValueError, match=r".") as caught:
        measured_surface(read_measurements(paths, parsed_options(ReadingOptions, given)))
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_the_shipped_scans_are_small_and_say_that_they_are_synthetic():
    assert len(SHIPPED) == 2
    assert sum(path.stat().st_size for path in SHIPPED) < 200e3
    for item in read_measurements(SHIPPED):
        assert item.format == "al3d"
        assert item.comment.startswith("SYNTHETIC, not a measurement")


def test_the_shipped_scans_are_those_that_their_command_writes(tmp_path):
    scans.write_scans(tmp_path)
    made = read_measurements(sorted(tmp_path.glob("*.al3d")))
    for one, other in zip(made, read_measurements(SHIPPED), strict=True):
        assert one.path.name == other.path.name
        assert one.size == other.size
        assert one.heights == pytest.approx(other.heights, abs=1e-12)


def test_the_spectrum_of_the_shipped_scans_is_that_of_nanodiamond():
    surface = measured_surface(read_measurements(SHIPPED))
    fit, truth = surface.joint.fit, SelfAffineSpectrum(0.1e-6, 2.1e-6, 1.0, 8.4e-27)
    for found, value in ((fit.roll_off, 2.1e-6), (fit.hurst, 1.0), (fit.plateau, 8.4e-27)):
        assert 0.99 * found[1] < value < 1.01 * found[2]
    assert fit.has_roll_off
    assert 0.2 < fit.misfit < 1.5
    found = half(surface)
    assert found.value == pytest.approx(truth.mean_square(0.5), rel=0.1)
    assert found.low < truth.mean_square(0.5) < found.high < 1.5 * found.low
    assert surface.joint.shares.measured > 0.9


def test_the_measures_of_a_periodic_map_are_ours_and_the_librarys(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    measurement = periodic_measurement(heights)
    pixel = SIDE / 128
    library = library_scan(heights, measurement.size, periodic=True)
    found = [measured_mean_square(scan_of(measurement), order) for order in (0.0, 0.5, 1.0)]
    assert found[0] == pytest.approx(np.mean(heights**2), rel=1e-9)
    assert found[0] == pytest.approx(library.moment_power_spectrum(order=0), rel=1e-9)
    assert found[1] == pytest.approx(half_derivative_mean_square(heights, pixel), rel=1e-9)
    assert found[1] == pytest.approx(library.variance_half_derivative(), rel=1e-9)
    slopes = library.moment_power_spectrum(order=2)
    assert found[2] == pytest.approx(slopes, rel=1e-9)


def test_our_density_of_profiles_is_the_librarys(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    library = library_scan(heights, (SIDE, SIDE), periodic=True)
    _, density = library.power_spectrum_from_profile(resampling_method=None, reliable=False)
    ours = profile_periodogram(heights, SIDE / 128)
    assert ours == pytest.approx(density[1:], rel=1e-9, abs=1e-9 * ours.max())


@pytest.mark.parametrize("is_line", [False, True])
def test_densities_scatter_about_the_spectrum_as_their_modes_say(rng, is_line):
    levels = []
    for _ in range(40):
        heights = map_heights(rng)
        measurement = replace(
            periodic_measurement(heights, shortest=0.625e-6), periodic=False, longest=10e-6
        )
        if is_line:
            line = replace(measurement, heights=heights[:, 0], size=(SIDE,))
            density = profile_density(line).within(0.625e-6, 10e-6)
            expected = SPECTRUM.profile_density(density.wavevector)
        else:
            density = periodogram(measurement).density().within(0.625e-6, 10e-6)
            expected = SPECTRUM.density(density.wavevector)
        # The level of the whole density, relative to that of the spectrum.
        level = np.average(density.value / expected, weights=density.modes) - 1
        levels.append(level * np.sqrt(np.sum(density.modes)))
    assert abs(np.mean(levels)) < 0.6
    assert 0.6 < np.std(levels) < 1.4


def test_the_uncertainty_of_a_fit_covers_the_truth(rng, tmp_path):
    truth, scores = SPECTRUM.mean_square(0.5), []
    for number in range(12):
        path = write_al3d(tmp_path / f"{number}.al3d", map_heights(rng))
        found = half(measured_surface(read_measurements([path])))
        assert found.low < truth < found.high < 2.25 * found.low
        scores.append((found.value - truth) / found.standard_error)
    assert np.std(scores) > 0.3


def test_a_second_measurement_widens_the_wavelengths(rng, tmp_path, scan):
    fine = SelfAffineSpectrum(0.08e-6, 3e-6, 0.8, 1e-26)
    heights = map_heights(rng, spectrum=fine, side=5e-6)
    detail = write_al3d(tmp_path / "detail.al3d", heights, 5e-6)
    alone = measured_surface(read_measurements([scan])).joint
    both = measured_surface(read_measurements([scan, detail])).joint
    assert both.shortest == pytest.approx(4 * 5e-6 / 128, rel=0.1)
    assert both.longest == pytest.approx(alone.longest) == pytest.approx(10e-6, rel=0.15)
    assert both.fit.hurst[1] < 0.8 < both.fit.hurst[2]
    widths = [high - low for _, low, high in (both.fit.hurst, alone.fit.hurst)]
    assert widths[0] < widths[1]
    assert not any(both.density.disagrees(index) for index in range(2))


def test_the_shortest_wavelength_may_be_named(scan):
    [one] = measured_surface(read_measurements([scan]), shortest=1e-6, longest=8e-6).scans
    assert [(limit.cause, limit.wavelength) for limit in one.band.ends] == [
        ("named", 1e-6),
        ("named", 8e-6),
    ]
    assert one.trusted.wavevector.max() < 2 * np.pi / 1e-6
    assert one.trusted.wavevector.min() > 2 * np.pi / 8e-6


@pytest.mark.parametrize(
    ("known", "low", "high"),
    [
        ({"resolution": {"value": 0.9, "unit": "um"}}, 0.9e-6, 0.9e-6),
        ({"tip_radius": {"value": 0.5, "unit": "um"}}, 0.7e-6, 2.5e-6),
        ({"resolution": {"value": 10, "unit": "nm"}}, 0.625e-6, 0.625e-6),
    ],
)
def test_the_reliability_that_a_file_states_bounds_the_wavelengths(
    tmp_path, heights, known, low, high
):
    info = {"instrument": {"name": "test", "parameters": known}}
    library = surface_library().Topography(heights, (SIDE, SIDE), unit="m", info=info)
    library.to_netcdf(str(tmp_path / "scan.nc"))
    [measurement] = read_measurements([tmp_path / "scan.nc"])
    assert measurement.format == "nc"
    assert low * (1 - 1e-6) <= measurement.shortest <= high * (1 + 1e-6)


def test_a_channel_without_heights_is_refused(monkeypatch, scan):
    module = surface_library().IO.Reader
    monkeypatch.setattr(
        module.ChannelInfo, "data_kind", property(lambda channel: module.DataKind.PHASE)
    )
    assert "channel 'Default' holds phase, no heights" in refusal([scan])


def test_a_channel_of_another_quantity_that_is_taken_for_heights_is_refused(monkeypatch, scan):
    kind = surface_library().IO.Reader.ChannelInfo
    monkeypatch.setattr(kind, "unit", property(lambda channel: ("nm", None)))
    assert "channel 'Default' holds another quantity, no heights; export" in refusal([scan])


def test_the_surface_does_not_depend_on_a_tilt_or_a_curvature(tmp_path, heights, scan):
    x = np.linspace(0, 1, len(heights))[:, None]
    bent = heights + 1e-5 * x + 3e-5 * x**2 - 2e-5 * x.T**2
    other = write_al3d(tmp_path / "bent.al3d", bent)
    straight, found = (measured_surface(read_measurements([path])) for path in (scan, other))
    assert half(found).value == pytest.approx(half(straight).value, rel=1e-4)
    [raw] = read_measurements([other], ReadingOptions(detrend="center"))
    assert np.ptp(raw.heights) > 10 * np.ptp(straight.scans[0].measurement.heights)


def test_line_scans_stand_for_an_isotropic_surface(rng, tmp_path):
    truth = SPECTRUM.mean_square(0.5)
    heights = 1e6 * map_heights(rng)
    paths = [
        write_line(tmp_path / f"{number}.xyz", heights[:, 25 * number], 20 / 128)
        for number in range(5)
    ]
    surface = measured_surface(read_measurements(paths, ReadingOptions(unit="um")))
    assert all(one.density.is_profile for one in surface.scans)
    assert all(one.measurement.is_line for one in surface.scans)
    found = half(surface)
    assert found.low < truth < found.high < 4 * found.low


def test_a_line_scan_is_no_field(rng, tmp_path):
    path = write_line(tmp_path / "line.xyz", 1e6 * map_heights(rng)[0], 20 / 128)
    [measurement] = read_measurements([path], ReadingOptions(unit="um"))
    with pytest.raises(ValueError, match="is a line scan, which is no field"):
        measured_adhesion(measurement, SOFT)


def test_unequally_spaced_lines_are_refused(rng, tmp_path):
    places = np.sort(rng.uniform(0, 20, 128))
    np.savetxt(tmp_path / "line.xyz", np.column_stack([places, rng.standard_normal(128)]))
    assert "not equally spaced" in refusal([tmp_path / "line.xyz"], unit="um")


def test_a_few_missing_points_are_interpolated(rng, tmp_path, heights, scan):
    holes = heights.copy()
    holes[rng.uniform(size=holes.shape) < 0.03] = np.nan
    path = write_al3d(tmp_path / "holes.al3d", holes)
    [whole], [filled] = read_measurements([scan]), read_measurements([path])
    assert filled.missing == pytest.approx(np.mean(np.isnan(holes)))
    assert np.all(np.isfinite(filled.heights))
    assert np.std(filled.heights - whole.heights) < 0.05 * np.std(whole.heights)
    ratio = measured_mean_square(scan_of(filled), 0.5) / measured_mean_square(scan_of(whole), 0.5)
    assert ratio == pytest.approx(1, abs=0.02)


def test_many_missing_points_are_refused(rng, tmp_path, heights):
    heights[rng.uniform(size=heights.shape) < 0.2] = np.nan
    path = write_al3d(tmp_path / "holes.al3d", heights)
    assert "20% of the points are missing" in refusal([path])


def test_oblong_pixels_are_read_and_made_square_for_a_field(tmp_path, heights, scan):
    [whole] = read_measurements([scan])
    content = scans.al3d(heights[:, ::2], SIDE / 128, "oblong")
    narrow, wide = f"{SIDE / 128:.10g}".encode(), f"{SIDE / 64:.10g}".encode()
    at = content.index(b"PixelSizeYMeter") + 20
    assert content[at : at + len(narrow)] == narrow
    path = tmp_path / "oblong.al3d"
    path.write_bytes(content[:at] + wide.ljust(30, b"\0") + content[at + 30 :])
    [oblong] = read_measurements([path])
    assert oblong.pixels == pytest.approx((SIDE / 128, SIDE / 64))
    assert oblong.shortest == pytest.approx(4 * SIDE / 64)
    square = replace(whole, shortest=oblong.shortest)
    both = [measured_adhesion(item, SOFT) for item in (square, oblong)]
    assert both[1].pixel == pytest.approx(both[0].pixel)
    assert both[1].e_el == pytest.approx(both[0].e_el, rel=0.02)


def test_units_and_sizes_that_a_file_lacks_must_be_named(tmp_path, heights, scan):
    path = tmp_path / "plain.txt"
    np.savetxt(path, 1e6 * heights)
    assert "read as asc, states no unit of length; name it, as in --unit um" in refusal([path])
    assert "states no size" in refusal([path], unit="um")
    assert "--unit kg is no unit of length" in refusal([path], unit="kg", size=(20.0, 20.0))
    assert "2 dimension(s)" in refusal([path], unit="um", size=(20.0,))
    [given] = read_measurements([path], ReadingOptions(unit="um", size=(20.0, 20.0)))
    assert given.size == pytest.approx((20e-6, 20e-6))
    assert np.std(given.heights) == pytest.approx(
        np.std(read_measurements([scan])[0].heights), rel=1e-6
    )


def test_units_and_sizes_that_a_file_states_are_not_overruled(scan):
    assert "states its own unit, m" in refusal([scan], unit="nm")
    assert "states its own size" in refusal([scan], size=(1.0, 1.0))


def test_files_that_cannot_be_read_are_refused(rng, tmp_path, scan):
    noise, empty, cut = (tmp_path / name for name in ("noise.al3d", "empty.al3d", "cut.al3d"))
    noise.write_bytes(rng.bytes(5001))
    empty.write_bytes(b"")
    cut.write_bytes(scan.read_bytes()[:2000])
    assert "in no format that SurfaceTopography reads" in refusal([noise])
    assert "is empty" in refusal([empty])
    assert "cut.al3d" in refusal([cut])
    with pytest.raises(FileNotFoundError):
        read_measurements([tmp_path / "absent.al3d"])


def test_surfaces_without_a_spectrum_are_refused(tmp_path, heights, scan):
    flat = write_al3d(tmp_path / "flat.al3d", np.zeros((64, 64)))
    tiny = write_al3d(tmp_path / "tiny.al3d", heights[:24, :24])
    assert "all heights are equal" in refusal([flat])
    assert "a spectrum needs 2 octaves" in refusal([tiny])
    assert "named twice" in refusal([scan, scan])
    assert "no file is named" in refusal([])
    assert "detrend is 'spline'" in refusal([scan], detrend="spline")


def test_a_missing_library_is_named_with_the_command_that_installs_it(monkeypatch, scan):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    assert "pip install '.[surfaces]'" in refusal([scan])


def test_a_surface_without_plateau_says_so(rng, tmp_path):
    steep = SelfAffineSpectrum(0.4e-6, 40e-6, 0.8, 1e-22)
    path = write_al3d(tmp_path / "steep.al3d", map_heights(rng, spectrum=steep))
    fit = measured_surface(read_measurements([path])).joint.fit
    assert not fit.has_roll_off
    assert fit.roll_off[0] > 5e-6


def test_anisotropy_is_the_ratio_of_the_slopes(rng, tmp_path, scan):
    stretched = map_heights(rng, n_point=256)[::1, ::2][:128, :128]
    path = write_al3d(tmp_path / "aniso.al3d", stretched)
    isotropic, anisotropic = (
        scan_of(read_measurements([one])[0]).band.anisotropy for one in (scan, path)
    )
    assert 0.8 < isotropic < 1.25
    assert anisotropic < 0.7


def test_the_tile_of_a_map_is_its_mirror_images_around_it(scan):
    [measurement] = read_measurements([scan])
    adhesion = measured_adhesion(measurement, SOFT)
    assert adhesion.work_of_adhesion.shape == (256, 256)
    assert adhesion.pixel * SOFT.lateral == pytest.approx(SIDE / 128)
    mean = np.mean(adhesion.work_of_adhesion) / WORK_OF_ADHESION
    assert mean == pytest.approx(1 - adhesion.e_el)
    measured = SOFT.contact_modulus / 4 * measured_mean_square(scan_of(measurement), 0.5)
    found = adhesion.e_el * SOFT.work_of_adhesion
    assert found == pytest.approx(measured, rel=0.25)
    # The sum over x leaves a function of y alone, even about the edges of the scan.
    along_front = adhesion.work_of_adhesion.sum(axis=0)
    assert along_front == pytest.approx(np.roll(along_front[::-1], 128), rel=1e-9)


def test_the_apex_is_above_the_centre_of_the_scan(scan):
    [measurement] = read_measurements([scan])
    places = np.arange(128) - 64
    bump = 1e-9 * np.exp(-(places[:, None] ** 2 + places**2) / 50)
    adhesion = measured_adhesion(replace(measurement, heights=bump), SOFT)
    deviation = np.abs(adhesion.work_of_adhesion - np.mean(adhesion.work_of_adhesion))
    x, y = np.unravel_index(np.argmax(deviation), deviation.shape)
    assert abs(int(x) - 128) <= 8
    assert abs(int(y) - 128) <= 1


def test_a_periodic_map_is_a_tile_as_it_stands(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    adhesion = measured_adhesion(periodic_measurement(heights), SOFT)
    expected = rough_adhesion(heights / SOFT.vertical, SIDE / 128 / SOFT.lateral)
    assert adhesion.pixel == pytest.approx(expected.pixel)
    assert adhesion.work_of_adhesion == pytest.approx(expected.work_of_adhesion, rel=1e-9)


def test_a_map_of_odd_and_unequal_sides_has_a_tile(tmp_path, rng):
    heights = map_heights(rng)[:100, :71]
    content = scans.al3d(heights, SIDE / 128, "unequal")
    (tmp_path / "scan.al3d").write_bytes(content)
    [measurement] = read_measurements([tmp_path / "scan.al3d"])
    assert measurement.size == pytest.approx((100 * SIDE / 128, 71 * SIDE / 128))
    adhesion = measured_adhesion(measurement, SOFT)
    assert adhesion.work_of_adhesion.shape == (200, 142)
    found = adhesion.e_el * SOFT.work_of_adhesion
    measured = SOFT.contact_modulus / 4 * measured_mean_square(scan_of(measurement), 0.5)
    assert found == pytest.approx(measured, rel=0.4)


def test_a_scan_smaller_than_the_contact_is_tiled_or_refused(scan):
    [measurement] = read_measurements([scan])
    assert 2 * zero_load_radius(SOFT) > SIDE > 2 * zero_load_radius(SMALL)
    with pytest.raises(ValueError, match="is smaller than the contact at zero load"):
        measured_adhesion(measurement, SOFT, "within")
    tiled, within = (measured_adhesion(measurement, SMALL, place) for place in ("tiled", "within"))
    assert np.array_equal(tiled.work_of_adhesion, within.work_of_adhesion)


def test_a_map_too_rough_for_full_conformity_is_no_field(tmp_path, heights):
    path = write_al3d(tmp_path / "rough.al3d", 20 * heights)
    with pytest.raises(ValueError, match="full conformity needs less than"):
        measured_adhesion(read_measurements([path])[0], SOFT)
