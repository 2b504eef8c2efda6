"""The mapping whose crack turns with the angle: against brute force and the mapping of a tile."""

import itertools

import numpy as np
import pytest

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from studies.boundary_elements.rotated import adhesion_on_rays

PIXEL = 0.3


def brute_force(heights, angle, radius):
    """SI Eq. (KR-from-h-Fourier) in coordinates that turn with the front, mode by mode."""
    n_x, n_y = heights.shape
    modes = np.fft.fft2(heights) / heights.size
    along, across = (
        np.array([np.cos(angle), np.sin(angle)]),
        np.array([-np.sin(angle), np.cos(angle)]),
    )
    place = radius * along + PIXEL * np.array([n_x, n_y]) / 2
    stress = 0.0
    for k, m in itertools.product(
        range(-(n_x // 2), n_x // 2 + 1), range(-(n_y // 2), n_y // 2 + 1)
    ):
        q = 2 * np.pi * np.array([k, m]) / (PIXEL * np.array([n_x, n_y]))
        kernel = -CONTACT_MODULUS / np.sqrt(2) * np.sqrt(1j * (q @ along) + abs(q @ across))
        stress += (kernel * modes[k, m] * np.exp(1j * (q @ place))).real
    energy = rough_adhesion(heights, PIXEL).e_el * WORK_OF_ADHESION
    return WORK_OF_ADHESION - energy - np.sqrt(2 * WORK_OF_ADHESION / CONTACT_MODULUS) * stress


@pytest.mark.parametrize("shape", [(9, 9), (7, 11)])
def test_every_angle_has_the_kernel_of_its_own_crack_to_round_off(rng, shape):
    heights = 1e-3 * rng.standard_normal(shape)
    angles = np.array([0.0, 0.3, 2.2, 4.0])
    adhesion = adhesion_on_rays(heights, PIXEL, angles, 0.1, 7)
    expected = np.array(
        [[brute_force(heights, a, 0.1 * (m + 1)) for a in angles] for m in range(7)]
    )
    np.testing.assert_allclose(adhesion, expected, atol=1e-13)
    assert np.std(expected) > 1e-4


def test_a_crack_that_does_not_turn_has_the_field_of_the_tile(rng):
    spectrum = SelfAffineSpectrum(1.0, 2.0, hurst=0.8).with_elastic_energy(0.02)
    heights = gaussian_field(spectrum, 16, 16 * PIXEL, rng)
    tile = rough_adhesion(heights, PIXEL).work_of_adhesion
    adhesion = adhesion_on_rays(heights, PIXEL, np.array([0, np.pi / 2]), PIXEL, 7, rotated=False)
    np.testing.assert_allclose(adhesion[:, 0], tile[9:, 8], atol=1e-13)
    np.testing.assert_allclose(adhesion[:, 1], tile[8, 9:], atol=1e-13)


def test_turning_the_surface_turns_the_field_of_cracks_that_turn(rng):
    heights = 1e-3 * rng.standard_normal((15, 15))
    angles = np.array([0.4, 1.9])
    # The first point is the corner of the tile: turn about the middle of the periodic tile.
    turned = np.roll(np.rot90(heights), 1, axis=0)
    before = adhesion_on_rays(heights, PIXEL, angles, 0.1, 9)
    after = adhesion_on_rays(turned, PIXEL, angles + np.pi / 2, 0.1, 9)
    assert not np.allclose(before, adhesion_on_rays(heights, PIXEL, angles + np.pi / 2, 0.1, 9))
    np.testing.assert_allclose(after, before, atol=1e-13)
