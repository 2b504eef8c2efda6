"""Perimeters of discs in the frames of a video."""

import numpy as np
import pytest

import crackfront as cf

pytest.importorskip("skimage")

RADII = (20.0, 35.0, 50.0, 70.0)
SIDE = 160
BRIGHT, DARK = 200.0, 50.0


def discs(radii=RADII, centre=(0.0, 0.0)):
    """Bright discs of radii in pixels, with edges that pixels share, around a place (x, y)."""
    row, column = np.mgrid[:SIDE, :SIDE] - (SIDE - 1) / 2
    distance = np.hypot(column - centre[0], row + centre[1])
    return np.array([DARK + (BRIGHT - DARK) * np.clip(r - distance + 0.5, 0, 1) for r in radii])


def radius(perimeter):
    """Radius of the circle of the same area, positive if the curve winds anticlockwise."""
    x, y = perimeter.T
    area = np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2
    return np.sign(area) * np.sqrt(abs(area) / np.pi)


def test_discs_have_their_radii_and_the_reference_is_empty():
    *perimeters, last = cf.contact_perimeters(discs(), 0.5e-6)
    assert last.shape == (0, 2)
    for perimeter, expected in zip(perimeters, RADII, strict=False):
        assert np.array_equal(perimeter[0], perimeter[-1])
        # A filter of a variance of 2 pixels moves a circle inward by 1 / radius.
        assert abs(radius(perimeter)) / 0.5e-6 == pytest.approx(expected - 1 / expected, abs=0.04)


def test_noise_of_a_fifth_of_the_contrast_moves_the_radii_by_less_than_a_tenth_of_a_pixel(rng):
    images = discs() + 30 * rng.standard_normal((len(RADII), SIDE, SIDE))
    for perimeter, expected in zip(cf.contact_perimeters(images, 1.0), RADII[:-1], strict=False):
        assert abs(radius(perimeter)) == pytest.approx(expected, abs=0.1)
        assert np.std(np.hypot(*perimeter.T)) < 0.5


def test_a_pattern_that_all_frames_share_is_subtracted(rng):
    pattern = 60 * rng.standard_normal((SIDE, SIDE))
    with_pattern = cf.contact_perimeters(discs() + pattern, 1.0, level=-75.0)
    without = cf.contact_perimeters(discs(), 1.0, level=-75.0)
    for first, second in zip(with_pattern[:-1], without[:-1], strict=True):
        np.testing.assert_allclose(
            first - first.mean(axis=0), second - second.mean(axis=0), atol=1e-9
        )


def test_places_are_relative_to_the_contact_of_the_reference_with_y_upwards():
    shifted = discs()
    shifted[0] = discs((20.0,), centre=(12.0, 7.0))[0]
    first, second, *_ = cf.contact_perimeters(shifted, 2.0)
    np.testing.assert_allclose(first[:-1].mean(axis=0), [24.0, 14.0], atol=0.1)
    np.testing.assert_allclose(second[:-1].mean(axis=0), [0.0, 0.0], atol=0.1)


def test_the_reference_may_be_chosen_and_frames_beyond_it_are_empty():
    perimeters = cf.contact_perimeters(discs(), 1.0, reference=2)
    assert [len(perimeter) > 0 for perimeter in perimeters] == [True, True, False, False]


def test_a_level_closer_to_the_contact_gives_a_smaller_perimeter():
    inner, outer = (
        abs(radius(cf.contact_perimeters(discs(), 1.0, level=level)[0])) for level in (-30, -120)
    )
    assert RADII[0] - 2 < inner < RADII[0] < outer < RADII[0] + 2


@pytest.mark.parametrize(
    ("images", "options", "words"),
    [
        (discs()[0], {}, "two frames or more"),
        (discs()[:1], {}, "two frames or more"),
        (np.full((2, 8, 8), 3.0), {}, "grey level 3 everywhere"),
        (np.where(discs() == BRIGHT, np.nan, discs()), {}, "frame 0 .* not finite"),
        (discs(), {"reference": 4}, "reference is 4; .* 0 to 3"),
        (discs(), {"level": 10.0}, "level is 10; .* below zero"),
        (discs(), {"variance": -1.0}, "variance is -1"),
        (discs(), {"pixel": 0.0}, "pixel"),
    ],
)
def test_what_has_no_perimeters_names_the_value_and_the_remedy(images, options, words):
    with pytest.raises(ValueError, match=words):
        cf.contact_perimeters(images, **{"pixel": 1.0} | options)
