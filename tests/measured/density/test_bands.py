"""What is found in the densities of scans, held against what was done to them."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.prediction.surface_remarks import scan_remarks, spectrum_remarks
from crackfront.measured.spectrum import draws
from crackfront.measured.spectrum.joining import joint_spectrum
from studies.accuracy.energies import (
    HELD_OUT,
    KINDS,
    PIXEL,
    SIDE,
    scan_energy,
    synthetic_surface,
)


def kind(name):
    """Kind of scans of a name."""
    return next(candidate for candidate in (*KINDS, *HELD_OUT) if candidate.name == name)


@pytest.fixture(scope="module")
def surface_of():
    """A scan of every kind that is asked for, made once, and e_el of one batch of draws."""

    @functools.cache
    def name_and_seed(name):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(draws, "BATCHES", (1,))
            patch.setattr(draws, "BATCH", 2**10)
            return synthetic_surface(kind(name), 0)

    return name_and_seed


def ends(result):
    """Causes of the ends of the first scan, and these in pixels and sides."""
    low, high = result.scans[0].band.ends
    return low.cause, low.wavelength / PIXEL, high.cause, SIDE / high.wavelength


def test_an_undistorted_scan_ends_by_its_pixels_and_by_levelling(surface_of):
    assert ends(surface_of("H = 0.8, end at two points")) == (
        "pixels",
        pytest.approx(4),
        "levelling",
        2,
    )


def test_the_resolution_of_an_optic_is_found_where_it_takes_a_fifth(surface_of):
    cause, pixels, *_ = ends(surface_of("optic, Gaussian"))
    assert cause == "resolution"
    assert pixels == pytest.approx(2 * np.pi / np.sqrt(np.log(1.25)), rel=0.35)


def test_waves_that_a_tip_shapes_are_not_trusted_and_continued(surface_of):
    result = surface_of("tip of 10 um, H = 0.4")
    cause, pixels, *_ = ends(result)
    assert cause == "tip"
    assert 4 < pixels < 60
    assert scan_energy(result).covers
    recorded, estimated = result.recorded, result.half_derivative
    assert 0.1 * estimated.value < recorded.value < estimated.value
    assert any("of e_el is measured" in remark.sentence for remark in spectrum_remarks(result))


def test_grooves_are_no_shifted_rows_and_told(surface_of):
    [scan] = surface_of("self-affine, H = 0.8").scans
    heights = scan.measurement.heights
    assert scan.band.periodic[0] <= 0.5
    grooves = 3 * heights.std() * np.sin(2 * np.pi * 12 * np.arange(len(heights)) / len(heights))
    for added in (grooves, grooves[:, None]):
        band = analysed_scan(replace(scan.measurement, heights=heights + added)).band
        share, wavelength = band.periodic
        assert share > 0.5
        assert wavelength == pytest.approx(SIDE / 12, rel=0.1)
        assert band.stripes == ()


def test_the_noise_of_a_scan_is_found_and_ends_its_band(surface_of, rng):
    [scan] = surface_of("self-affine, H = 0.8").scans
    heights = scan.measurement.heights
    noise = 0.6 * heights.std() * rng.standard_normal(heights.shape)
    band = analysed_scan(replace(scan.measurement, heights=heights + noise)).band
    # The density of white noise is its variance times the area of a point.
    assert band.instrument.noise == pytest.approx(np.var(noise) * PIXEL**2, rel=0.2)
    assert band.shortest.cause == "noise"
    assert scan.band.instrument.noise == 0


def test_shifted_rows_are_found_and_left_out(surface_of, rng):
    surface = surface_of("self-affine, H = 0.8")
    [scan] = surface.scans
    heights = scan.measurement.heights
    shifts = 0.5 * heights.std() * rng.standard_normal((1, heights.shape[1]))
    shifted = analysed_scan(replace(scan.measurement, heights=heights + shifts))
    assert (scan.band.stripes, shifted.band.stripes) == ((), (1,))
    assert shifted.trusted.value == pytest.approx(scan.trusted.value, rel=0.6)
    assert shifted.waves.power.mean() > 1.2 * scan.waves.power.mean()
    notes = "\n".join(scan.sentence for scan in scan_remarks([shifted]))
    assert "waves along y alone" in notes


@pytest.mark.slow
def test_form_that_levelling_leaves_is_found(surface_of):
    cause, _, reason, sides = ends(surface_of("form that is left"))
    assert (cause, reason) == ("pixels", "form")
    assert 2.5 < sides < 6
    assert scan_energy(surface_of("form that is left")).ratio.value == pytest.approx(1, abs=0.3)


def test_a_density_that_ends_is_not_continued(surface_of):
    result = surface_of("end at four pixels")
    assert result.joint.spectrum.short_cutoff == pytest.approx(4 * PIXEL, rel=0.15)


def test_scans_that_agree_join_and_those_that_do_not_are_told(surface_of):
    [scan] = surface_of("self-affine, H = 0.8").scans
    path = scan.measurement.path.with_name("other.al3d")
    rough = replace(scan.measurement, heights=3 * scan.measurement.heights, path=path)
    joint = joint_spectrum([scan, analysed_scan(rough)], numbers=(1,))
    # The standard deviation of two levels, whose densities differ by the square of three.
    assert joint.density.scatter == pytest.approx(np.log(9) / np.sqrt(2), rel=0.01)
    assert joint.density.disagrees(0)
    assert joint.density.disagrees(1)
    assert joint.density.levels[1].value == pytest.approx(9, rel=1e-6)
    energy = joint.draws.mean_square(0.5)
    assert energy.high / energy.low > 3
    again = replace(scan, measurement=replace(scan.measurement, path=path))
    same = joint_spectrum([scan, again], numbers=(1,))
    assert not same.density.disagrees(0)
    assert same.density.scatter == 0


def test_limits_that_are_named_stand_in_place_of_those_that_are_found(surface_of):
    [scan] = surface_of("self-affine, H = 0.8").scans
    band = analysed_scan(scan.measurement, shortest=8 * PIXEL, longest=SIDE / 3).band
    assert [limit.cause for limit in band.ends] == ["named", "named"]
    assert [limit.wavelength for limit in band.ends] == [8 * PIXEL, SIDE / 3]


def test_a_shortest_wave_that_no_points_hold_is_refused(surface_of):
    [scan] = surface_of("self-affine, H = 0.8").scans
    assert analysed_scan(scan.measurement, shortest=2 * PIXEL).band.shortest.cause == "named"
    with pytest.raises(ValueError, match=r"--shortest is .*; name that or more"):
        analysed_scan(scan.measurement, shortest=1.9 * PIXEL)


def test_a_band_of_less_than_an_octave_is_refused(surface_of):
    [scan] = surface_of("self-affine, H = 0.8").scans
    with pytest.raises(ValueError, match=r"less than an octave; use a better scan, or name"):
        analysed_scan(scan.measurement, shortest=SIDE / 3)


def test_intervals_of_distorted_scans_hold_the_truth(surface_of):
    names = (
        *("self-affine, H = 0.8", "optic, Gaussian", "noise", "rows that are shifted"),
        *("end at four pixels", "oblong pixels", "missing points"),
    )
    results = [scan_energy(surface_of(name)) for name in names]
    assert all(result.ratio.low > 0 for result in results)
    assert np.mean([result.covers for result in results]) > 0.85
    assert np.median([abs(result.ratio.value - 1) for result in results]) < 0.2


def test_surfaces_that_are_not_gaussian_are_told_and_known_less_well(surface_of):
    film, deep, scanned = (
        surface_of(name).scans[0]
        for name in ("self-affine, H = 0.8", "deep scratches", "deep scratches, tip of 1 um")
    )
    assert film.unevenness == 0.0
    assert deep.unevenness > 0.03
    assert [*scan_remarks([film])] == []
    for scan_name, sentence in (
        (deep, "differ more than for a Gaussian"),
        (scanned, "into narrow ones; e_el may be 2 times as large"),
    ):
        assert any(sentence in remark.sentence for remark in scan_remarks([scan_name]))


@pytest.mark.slow
def test_intervals_of_two_hundred_scans_hold_the_truth():
    every = [
        (kind, scan_energy(synthetic_surface(kind, number)))
        for kind in KINDS
        for number in range(12)
    ]
    assert len(every) > 200
    assert np.median([abs(scan.ratio.value - 1) for _, scan in every]) < 0.2
    assert np.mean([scan.covers for _, scan in every]) >= 0.9
    assert np.median([scan.factor for kind, scan in every if kind.resolved]) < 1.5
    tips = [scan.covers for kind, scan in every if kind.name == "tip of 1 um"]
    assert np.mean(tips) >= 0.9
