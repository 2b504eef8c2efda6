import numpy as np
import pytest

from crackfront.core.adhesion import half_derivative_mean_square
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field

# Shapes of SI Fig. S-5 on a small tile: flat, H below, at and above one half.
SHAPES = [
    SelfAffineSpectrum(0.1, 0.1, 0.8),
    SelfAffineSpectrum(0.05, 0.25, 0.3),
    SelfAffineSpectrum(0.05, 0.25, 0.5),
    SelfAffineSpectrum(0.05, 0.25, 0.8),
]
LENGTH = 1.0


def seeded(seed):
    return np.random.default_rng(seed)


def wavevectors(n_point):
    along = 2 * np.pi * np.fft.fftfreq(n_point, LENGTH / n_point)
    return np.hypot(along[:, None], along[None, :])


@pytest.mark.parametrize("spectrum", SHAPES)
def test_the_same_generator_gives_the_same_surface_on_every_grid_that_resolves_it(spectrum):
    coarse = gaussian_field(spectrum, 42, LENGTH, seeded(1))
    fine = gaussian_field(spectrum, 126, LENGTH, seeded(1))
    even = gaussian_field(spectrum, 84, LENGTH, seeded(1))
    assert np.allclose(coarse, fine[::3, ::3], atol=1e-12 * np.abs(fine).max())
    assert np.allclose(coarse, even[::2, ::2], atol=1e-12 * np.abs(fine).max())


@pytest.mark.parametrize("spectrum", SHAPES)
def test_one_realisation_serves_all_amplitudes(spectrum):
    weak = gaussian_field(spectrum.with_elastic_energy(0.002), 64, LENGTH, seeded(5))
    strong = gaussian_field(spectrum.with_elastic_energy(0.15), 64, LENGTH, seeded(5))
    assert np.allclose(strong, np.sqrt(0.15 / 0.002) * weak, rtol=0, atol=1e-13 * strong.max())


@pytest.mark.parametrize("spectrum", SHAPES)
def test_no_mode_lies_beyond_the_cutoff_and_the_mean_is_zero(spectrum, rng):
    heights = gaussian_field(spectrum, 90, LENGTH, rng)
    power = np.abs(np.fft.fft2(heights, norm="forward")) ** 2
    beyond = wavevectors(90) > 2 * np.pi / spectrum.short_cutoff * (1 + 1e-9)
    assert np.all(power[beyond] < 1e-28 * power.max())
    assert power[0, 0] < 1e-28 * power.max()


def test_every_mode_has_the_variance_that_the_spectrum_gives_it():
    spectrum = SelfAffineSpectrum(0.2, 0.5, 0.6, plateau=2.0)
    n_point, n_seed = 12, 3000
    rng = seeded(11)
    power = np.zeros((n_point, n_point))
    for _ in range(n_seed):
        heights = gaussian_field(spectrum, n_point, LENGTH, rng)
        power += np.abs(np.fft.fft2(heights, norm="forward")) ** 2 / n_seed
    expected = spectrum.density(wavevectors(n_point)) / LENGTH**2
    expected[0, 0] = 0.0
    held = expected > 0
    # |h|^2 of a complex Gaussian has a relative deviation of one; six of them, over 80 modes.
    assert np.abs(power[held] / expected[held] - 1).max() < 6 / np.sqrt(n_seed)
    assert np.all(power[~held] < 1e-20)


@pytest.mark.parametrize("spectrum", SHAPES)
def test_heights_are_gaussian_in_the_mean_over_seeds(spectrum):
    rng = seeded(13)
    heights = np.array([gaussian_field(spectrum, 42, LENGTH, rng)[::7, ::7] for _ in range(300)])
    kurtosis = np.mean(heights**4) / np.mean(heights**2) ** 2
    assert kurtosis == pytest.approx(3.0, abs=0.2)
    assert np.mean(heights**3) / np.mean(heights**2) ** 1.5 == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize("spectrum", SHAPES)
def test_measured_elastic_energy_is_the_requested_one_in_the_mean_over_seeds(spectrum):
    n_point, n_seed = 42, 200
    rng = seeded(14)
    measured = np.array(
        [
            half_derivative_mean_square(
                gaussian_field(spectrum, n_point, LENGTH, rng), LENGTH / n_point
            )
            for _ in range(n_seed)
        ]
    )
    error = measured.std() / np.sqrt(n_seed)
    # A sum over the tile's modes against an integral: a few per cent on so small a tile.
    requested = spectrum.mean_square(0.5)
    assert measured.mean() == pytest.approx(requested, abs=5 * error + 0.03 * requested)
    # Single tiles differ, which is why both are reported.
    assert measured.std() > 0.01 * requested


def test_the_nyquist_modes_are_left_out_at_a_cutoff_of_exactly_two_pixels(rng):
    heights = gaussian_field(SHAPES[0], 20, LENGTH, rng)
    modes = np.abs(np.fft.fft2(heights, norm="forward"))
    assert modes[10].max() < 1e-15 * modes.max() + 1e-16
    assert modes[:, 10].max() < 1e-15 * modes.max() + 1e-16
    assert modes[9].max() > 0.01 * modes.max()


def test_a_cutoff_below_two_pixels_is_refused_with_what_to_do(rng):
    with pytest.raises(
        ValueError,
        match=r"short cutoff 0\.1 is below two pixels \(0\.105263\); refine the grid or raise",
    ):
        gaussian_field(SHAPES[0], 19, LENGTH, rng)


def test_a_tile_that_holds_no_mode_is_refused(rng):
    with pytest.raises(ValueError, match=r"tile of side 0\.05 is shorter than the short cutoff"):
        gaussian_field(SHAPES[0], 64, 0.05, rng)
