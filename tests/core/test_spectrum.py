import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum, TabulatedSpectrum
from crackfront.core.units import Scales

# SI Fig. S-5, reduced units: shortest wavelength, roll-off, Hurst exponent.
PAPER = [(0.005, 0.005, 0.8), (0.000625, 0.01, 0.8), (0.000625, 0.1, 0.3), (0.005, 0.1, 0.3)]

# E = 0.7 MPa, nu = 0.5, R = 1.25 mm, w_int = 63 mJ/m2 (facts.md).
NANODIAMOND_SCALES = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
NANODIAMOND = SelfAffineSpectrum(short_cutoff=1e-10, roll_off=2.1e-6, hurst=1.0, plateau=8.4e-27)


@st.composite
def spectra(draw):
    short = draw(st.floats(1e-3, 0.1))
    return SelfAffineSpectrum(
        short_cutoff=short,
        roll_off=short * draw(st.floats(1.0, 200.0)),
        hurst=draw(st.one_of(st.floats(0.05, 1.0), st.just(0.5))),
        plateau=draw(st.floats(1e-8, 1e2)),
    )


def mean_square_by_quadrature(spectrum, order):
    """Integral of q^(2 order) C(q) q / 2 pi, piece by piece in log q."""
    knee, cutoff = 2 * np.pi / spectrum.roll_off, 2 * np.pi / spectrum.short_cutoff

    def integrand(log_q):
        q = math.exp(log_q)
        return q ** (2 + 2 * order) * float(spectrum.density(q)) / (2 * np.pi)

    scale = integrand(math.log(knee))
    flat = quad(lambda s: integrand(s) / scale, math.log(knee) - 40, math.log(knee))[0]
    tail = quad(lambda s: integrand(s) / scale, math.log(knee), math.log(cutoff))[0]
    return scale * (flat + tail)


@given(spectra(), st.sampled_from([0.0, 0.5, 1.0, 2.0]))
def test_mean_square_is_the_integral_of_the_density(spectrum, order):
    expected = mean_square_by_quadrature(spectrum, order)
    assert spectrum.mean_square(order) == pytest.approx(expected, rel=1e-6)


def test_density_is_flat_to_the_roll_off_falls_to_the_cutoff_and_is_zero_beyond():
    spectrum = SelfAffineSpectrum(0.01, 0.1, 0.7, plateau=5.0)
    knee, cutoff = 2 * np.pi / 0.1, 2 * np.pi / 0.01
    assert np.all(spectrum.density(np.array([0.0, 0.5 * knee, knee])) == pytest.approx(5.0))
    assert spectrum.density(3 * knee) == pytest.approx(5.0 * 3 ** (-2 - 1.4))
    assert spectrum.density(cutoff) == pytest.approx(5.0 * 10 ** (-2 - 1.4))
    assert spectrum.density(1.0001 * cutoff) == 0


@given(spectra(), st.floats(1e-4, 0.9))
def test_scaling_to_an_elastic_energy_changes_nothing_but_the_height(spectrum, energy):
    scaled = spectrum.with_elastic_energy(energy)
    assert scaled.elastic_energy == pytest.approx(energy, rel=1e-12)
    assert scaled.correlation_length == pytest.approx(spectrum.correlation_length, rel=1e-12)
    assert (scaled.short_cutoff, scaled.roll_off, scaled.hurst) == (
        spectrum.short_cutoff,
        spectrum.roll_off,
        spectrum.hurst,
    )


def test_correlation_length_of_a_flat_spectrum_is_four_thirds_of_its_cutoff():
    # <q> of q C(q) ~ q is 3/4 of the cutoff.
    assert SelfAffineSpectrum(0.03, 0.03, 1.0).correlation_length == pytest.approx(0.04, rel=1e-13)


def test_nanodiamond_needs_the_published_energy_to_conform():
    in_si = NANODIAMOND_SCALES.contact_modulus / 4 * NANODIAMOND.mean_square(0.5)
    assert in_si == pytest.approx(11.1e-3, abs=0.05e-3)


def test_nanodiamond_has_the_published_height():
    assert math.sqrt(NANODIAMOND.mean_square(0.0)) == pytest.approx(109e-9, abs=1e-9)


@pytest.mark.parametrize("hurst", [0.0, -0.1, 1.0001, float("nan")])
def test_a_hurst_exponent_outside_its_range_is_refused(hurst):
    with pytest.raises(ValueError, match=rf"hurst is {hurst}; it must lie in \(0, 1\]"):
        SelfAffineSpectrum(0.01, 0.1, hurst)


def test_a_roll_off_below_the_cutoff_is_refused_with_what_to_do():
    with pytest.raises(
        ValueError, match=r"roll_off 0\.1 is shorter than short_cutoff 0\.2; lower the cutoff"
    ):
        SelfAffineSpectrum(0.2, 0.1, 0.8)


@pytest.mark.parametrize("name", ["short_cutoff", "roll_off", "plateau"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_lengths_and_plateau_must_be_positive_and_finite(name, value):
    shape = {"short_cutoff": 0.1, "roll_off": 0.1, "plateau": 1.0, name: value}
    with pytest.raises(ValueError, match=f"{name} is {value}; it must be positive and finite"):
        SelfAffineSpectrum(hurst=0.8, **shape)


@pytest.mark.parametrize("shape", [*PAPER, (0.01, 0.1, 0.5), (0.01, 0.1, 1.0)])
def test_the_density_of_a_profile_is_the_projection_of_the_two_dimensional_one(shape):
    spectrum = SelfAffineSpectrum(*shape)
    knee, cutoff = 2 * math.pi / spectrum.roll_off, 2 * math.pi / spectrum.short_cutoff
    for q in (0.01 * knee, 0.9 * knee, 1.1 * knee, 0.5 * cutoff, 0.99 * cutoff):
        inner, outer = (math.sqrt(max(limit**2 - q**2, 0.0)) for limit in (knee, cutoff))
        projected = sum(
            quad(lambda k, q=q: float(spectrum.density(math.hypot(q, k))), *ends, epsrel=1e-11)[0]
            for ends in ((0.0, inner), (inner, outer * (1 - 1e-13)))
        )
        assert spectrum.profile_density(q) == pytest.approx(projected / math.pi, rel=1e-8)
    assert spectrum.profile_density(1.01 * cutoff) == 0


@pytest.mark.parametrize(("order", "factor"), [(0, math.pi / 2), (0.5, 1.0), (1, math.pi / 4)])
def test_a_profile_taken_for_isotropic_is_right_for_the_half_derivative_alone(order, factor):
    # The paper's C(q) = (pi / q) C_1D(q): mean of abs(cos)^(2 alpha) times pi / 2.
    spectrum = SelfAffineSpectrum(0.01, 0.1, 0.8)
    q = np.geomspace(1e-4 * 2 * np.pi / 0.1, 2 * np.pi / 0.01, 200_001)
    density = np.pi / q * spectrum.profile_density(q)
    taken = np.trapezoid(q ** (2 + 2 * order) * density, np.log(q)) / (2 * np.pi)
    assert taken / spectrum.mean_square(order) == pytest.approx(factor, rel=2e-4)


@pytest.mark.parametrize("order", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("shape", PAPER)
def test_the_dominant_wavelengths_leave_a_tenth_on_either_side(shape, order):
    spectrum = SelfAffineSpectrum(*shape)
    shortest, longest = spectrum.dominant_wavelengths(order)
    ends = [0.0, 2 * np.pi / longest, 2 * np.pi / shortest, 2 * np.pi / spectrum.short_cutoff]
    knee = 2 * np.pi / spectrum.roll_off
    shares = [
        quad(
            lambda q: q ** (1 + 2 * order) * float(spectrum.density(q)) / (2 * np.pi),
            low,
            high * (1 - 1e-13),
            points=[knee] if low < knee < high else None,
        )[0]
        / spectrum.mean_square(order)
        for low, high in pairwise(ends)
    ]
    assert shares == pytest.approx([0.1, 0.8, 0.1], abs=1e-6)


def test_the_part_of_long_wavelengths_is_flat_when_it_ends_above_the_roll_off():
    spectrum = SelfAffineSpectrum(0.01, 0.1, 0.8, plateau=2.0)
    assert spectrum.longer_than(0.2) == SelfAffineSpectrum(0.2, 0.2, 0.8, plateau=2.0)
    assert spectrum.longer_than(0.05) == SelfAffineSpectrum(0.05, 0.1, 0.8, plateau=2.0)


def tabulated(spectrum, n_point=9):
    """A table of a self-affine spectrum."""
    lengths = np.geomspace(spectrum.roll_off, spectrum.short_cutoff, n_point)
    return TabulatedSpectrum(tuple(lengths), tuple(spectrum.density(2 * np.pi / lengths)))


@pytest.mark.parametrize("hurst", [0.3, 0.5, 0.8, 1.0])
def test_a_table_of_a_self_affine_spectrum_is_that_spectrum(hurst):
    exact = SelfAffineSpectrum(0.02, 0.5, hurst, plateau=3.0)
    table = tabulated(exact)
    q = 2 * np.pi / np.geomspace(5.0, 0.02, 40)
    assert table.density(q) == pytest.approx(exact.density(q), rel=1e-12)
    assert table.density(1.01 * q[-1]) == 0
    for order in (-0.5, 0.0, 0.5, 1.0, 2.0):
        assert table.mean_square(order) == pytest.approx(exact.mean_square(order), rel=1e-12)
        ends = order, 0.03, 0.2
        assert table.mean_square_between(*ends) == pytest.approx(exact.mean_square_between(*ends))
    for wavelength in (0.05, 0.7):
        longer, expected = (spectrum.longer_than(wavelength) for spectrum in (table, exact))
        assert longer.elastic_energy == pytest.approx(expected.elastic_energy, rel=1e-12)
    assert table.dominant_wavelengths(0.5) == pytest.approx(exact.dominant_wavelengths(0.5))


SHAPES = [
    SelfAffineSpectrum(0.02, 0.5, 0.8),
    TabulatedSpectrum((0.5, 0.1, 0.02), (1.0, 0.02, 0.001)),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_a_shape_keeps_its_identity_whatever_its_amplitude(shape):
    assert shape.amplified(2.0).identity == shape.identity
    assert shape.in_units(2.0).identity != shape.identity
    assert shape.with_elastic_energy(0.05).elastic_energy == pytest.approx(0.05)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_a_shape_is_made_again_of_its_parameters(shape):
    assert Spectrum.stated(shape.parameters) == shape
    assert shape.parameters.keys() & Spectrum.length_names()


@pytest.mark.parametrize(
    ("lengths", "densities", "sentence"),
    [
        ((1.0,), (1.0,), "make no table; give two or more"),
        ((1.0, 0.5), (1.0,), "make no table"),
        ((0.5, 1.0), (1.0, 1.0), "must fall; order them"),
        ((1.0, -0.5), (1.0, 1.0), "wavelengths contain -0.5"),
        ((1.0, 0.5), (1.0, float("nan")), "densities contain nan"),
    ],
)
def test_tables_that_are_none_are_refused(lengths, densities, sentence):
    with pytest.raises(ValueError, match=sentence):
        TabulatedSpectrum(lengths, densities)
