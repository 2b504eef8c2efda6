"""Spectra and spheres as people state them in Python."""

import numpy as np
import pytest

import crackfront as cf


def test_a_tabulated_spectrum_takes_arrays_lists_and_tuples_alike():
    wavelengths, densities = [2e-6, 5e-7, 1e-7], [1e-27, 2e-29, 3e-32]
    expected = cf.TabulatedSpectrum(tuple(wavelengths), tuple(densities))
    for kind in (list, np.array):
        table = cf.TabulatedSpectrum(kind(wavelengths), kind(densities))
        assert table == expected
        assert hash(table) == hash(expected)
        assert table.longer_than(3e-7).mean_square(0.5) < table.mean_square(0.5)
    surface = cf.random_surface(cf.TabulatedSpectrum(np.array([0.8, 0.4]), np.ones(2)), 0.05)
    assert surface.dims == ("x", "y")


@pytest.mark.parametrize(
    ("wavelengths", "error"),
    [
        (np.ones((2, 2)), TypeError),
        ("0.5, 0.02", TypeError),
        (0.5, TypeError),
        (np.array([0.02, 0.5]), ValueError),
        (np.array([0.5, np.nan]), ValueError),
    ],
)
def test_a_table_that_is_not_a_sequence_of_falling_wavelengths_is_named(wavelengths, error):
    with pytest.raises(error, match="wavelengths"):
        cf.TabulatedSpectrum(wavelengths, np.ones(2))


SPHERE = {"radius": "1.25mm", "work_of_adhesion": "63mJ/m2"}


def test_young_s_modulus_and_poisson_s_ratio_are_the_contact_modulus():
    expected = cf.Scales(**SPHERE, contact_modulus=0.7e6 / 0.75)
    assert cf.Scales(**SPHERE, modulus="0.7MPa", poisson=0.5) == expected
    assert cf.Scales("1.25mm", "63mJ/m2", 0.7e6 / 0.75) == expected


@pytest.mark.parametrize(
    ("moduli", "remedy"),
    [
        ({"contact_modulus": "0.7MPa", "modulus": "0.7MPa"}, "modulus is '0.7MPa'; give the con"),
        ({"contact_modulus": "0.7MPa", "poisson": 0.5}, "poisson is 0.5; give the contact"),
        ({"modulus": "0.7MPa"}, "poisson is None; give both"),
        ({}, "give both, or contact_modulus"),
        ({"modulus": "0.7MPa", "poisson": 0.6}, "poisson is 0.6; it must lie between"),
    ],
)
def test_a_modulus_that_is_stated_twice_or_by_half_is_named(moduli, remedy):
    with pytest.raises(ValueError, match=remedy):
        cf.Scales(**SPHERE, **moduli)
