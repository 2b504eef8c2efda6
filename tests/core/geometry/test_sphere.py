import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core.geometry.sphere import half_laplacian, line_energy
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

COUNTS = [1, 4, 5, 7, 8, 13, 16, 30, 31, 64]


def angles(n_angle):
    return 2 * np.pi * np.arange(n_angle) / n_angle


def stiffness_matrix(n_angle):
    return np.array([half_laplacian(row) for row in np.eye(n_angle)])


@st.composite
def fronts(draw):
    n_angle = draw(st.integers(4, 40))
    seed = draw(st.integers(0, 2**32 - 1))
    return 1.5 + 0.3 * np.random.default_rng(seed).standard_normal(n_angle)


@pytest.mark.parametrize("n_angle", COUNTS)
def test_every_resolved_mode_is_multiplied_by_its_order(n_angle):
    for order in range((n_angle - 1) // 2 + 1):
        for shift in (0.0, 0.4):
            wave = np.cos(order * angles(n_angle) + shift)
            assert np.allclose(half_laplacian(wave), order * wave, atol=1e-12)


@pytest.mark.parametrize("n_angle", [4, 8, 30, 64])
def test_the_alternating_mode_of_an_even_grid_is_multiplied_by_half_the_count(n_angle):
    zigzag = (-1.0) ** np.arange(n_angle)
    assert np.allclose(half_laplacian(zigzag), n_angle / 2 * zigzag, atol=1e-12)


def test_a_bend_changes_the_energy_release_rate_as_the_kernel_of_gao_and_rice_says():
    """SI I D: Xi = sqrt(8 / pi) K / E', G = pi / 16 E' Xi^2, and the kernel with 1 / 2 pi."""
    n_angle, order, radius = 512, 5, 1.7
    equilibrium = np.sqrt(16 * WORK_OF_ADHESION / (np.pi * CONTACT_MODULUS))
    # No angle of the integral is at a site, where the kernel diverges.
    between = angles(n_angle) + np.pi / n_angle
    for site in (0, 3, 100):
        angle = angles(n_angle)[site]
        bend = np.cos(order * between) - np.cos(order * angle)
        distance = 2 * radius * np.sin((between - angle) / 2)
        integral = np.mean(radius * bend / distance**2)
        intensity_change = -equilibrium * integral
        change = np.pi / 8 * CONTACT_MODULUS * equilibrium * intensity_change
        line = WORK_OF_ADHESION / radius * half_laplacian(np.cos(order * angles(n_angle)))
        assert change == pytest.approx(line[site], abs=1e-12)


@pytest.mark.parametrize("n_angle", COUNTS)
def test_advancing_one_site_pulls_no_other_site_back(n_angle):
    # The M-matrix property on which no passing rests.
    matrix = stiffness_matrix(n_angle)
    np.fill_diagonal(matrix, 0.0)
    assert np.all(matrix <= 1e-13)


@pytest.mark.parametrize("n_angle", COUNTS)
def test_the_stiffness_is_symmetric(n_angle):
    matrix = stiffness_matrix(n_angle)
    assert np.allclose(matrix, matrix.T, atol=1e-12)


@given(fronts(), st.floats(-1, 1))
def test_moving_the_whole_line_costs_no_line_energy(front, distance):
    assert line_energy(front + distance) == pytest.approx(line_energy(front), abs=1e-11)
    assert np.allclose(half_laplacian(front + distance), half_laplacian(front), atol=1e-11)


@pytest.mark.parametrize("order", [1, 3, 7])
def test_one_wave_costs_half_its_order_times_the_square_of_its_amplitude(order):
    # |a_n|^2 + |a_-n|^2 = A^2 / 2, hence pi w_int n A^2 / 2.
    front = 1.0 + 0.3 * np.cos(order * angles(16))
    assert line_energy(front) == pytest.approx(np.pi * WORK_OF_ADHESION * order * 0.3**2 / 2)


@given(fronts())
def test_the_gradient_of_the_line_energy_is_the_line_force(front):
    # The energy is quadratic, so a central difference is exact for any step.
    expected = 2 * np.pi / front.size * WORK_OF_ADHESION * half_laplacian(front)
    for site in (0, front.size // 2, front.size - 1):
        step = np.zeros(front.size)
        step[site] = 0.5
        slope = line_energy(front + step) - line_energy(front - step)
        assert slope == pytest.approx(expected[site], rel=1e-10, abs=1e-10)


def test_a_band_limited_front_has_the_same_force_on_every_grid():
    def front(n_angle):
        angle = angles(n_angle)
        return 1 + 0.1 * np.cos(angle) - 0.2 * np.sin(3 * angle)

    coarse, fine = half_laplacian(front(8)), half_laplacian(front(24))
    assert np.allclose(coarse, fine[::3], atol=1e-13)
    assert line_energy(front(8)) == pytest.approx(line_energy(front(24)), rel=1e-13)
