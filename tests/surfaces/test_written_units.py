"""Quantities with units: what is read, and one sentence for what is not."""

import numpy as np
import pytest

from crackfront.surfaces.written_units import is_unit, si_value, unit_value


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.7MPa", "Pa", 0.7e6),
        ("700 kPa", "Pa", 0.7e6),
        ("63mJ/m2", "J/m^2", 0.063),
        ("63 mJ/m^2", "J/m^2", 0.063),
        ("63mJ/m²", "J/m^2", 0.063),
        ("0.063N/m", "J/m^2", 0.063),
        ("1.25e-3m", "m", 1.25e-3),
        ("5µm", "m", 5e-6),
        ("5\u03bcm", "m", 5e-6),
        ("5\u00a0µm", "m", 5e-6),
        ("5 micron", "m", 5e-6),
        ("5\u212b", "m", 5e-10),
        ("384 \u03bcN", "N", 384e-6),
        ("63 mJ m-2", "J/m^2", 0.063),
        ("63 mJ m\u22122", "J/m^2", 0.063),
        ("63 mJ m⁻²", "J/m^2", 0.063),
        ("63 mJ·m^-2", "J/m^2", 0.063),
        ("63 mJ.m-2", "J/m^2", 0.063),
        ("63 mJ/m**2", "J/m^2", 0.063),
        ("63 erg cm-2", "J/m^2", 0.063),
        ("0.063 N m-1", "J/m^2", 0.063),
        ("0.7 N mm-2", "Pa", 0.7e6),
    ],
)
def test_a_quantity_is_converted_to_si(text, unit, value):
    assert si_value(text, unit, name="it") == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("0.7", "without a unit"),
        ("0.7mm", "not a unit of pressure"),
        ("0.7Pa)", "unknown"),
        ("", "not a number"),
        ("MPa", "not a number"),
        ("-0.7MPa", "positive"),
        ("0MPa", "positive"),
        ("nanMPa", "not a number"),
        ("0.7%", "not a unit of pressure"),
        ("0,7MPa", "write '0.7MPa' if"),
        ("0.7 N/m-2", "not a unit of pressure"),
        ("0.7//Pa", "unknown"),
        ("0.7 MPa(", "unknown"),
        ("0.7 px", "pixels, which have no length"),
        ("0.7 N/pixel2", "pixels, which have no length"),
    ],
)
def test_a_missing_or_absurd_unit_is_refused_with_the_value_and_an_example(text, sentence):
    with pytest.raises(ValueError, match="modulus is") as caught:
        si_value(text, "Pa", name="modulus")
    assert sentence in str(caught.value)
    assert repr(text) in str(caught.value)


@pytest.mark.parametrize("unit", ["px", "1/px", "pixels", "dot", "dots", "css_pixel", "Mpx"])
def test_pixels_are_no_unit_of_length(unit):
    with pytest.raises(ValueError, match="cannot be converted to m: it is one of pixels"):
        unit_value(unit, "m")
    assert not is_unit(unit, "m")


def test_any_text_is_a_unit_or_refused_in_a_sentence(rng):
    signs = np.array([*map(chr, range(32, 127)), "um", "m", "/", "^", "("])
    refused = []
    for _ in range(300):
        text = "2" + "".join(rng.choice(signs, rng.integers(1, 6)))
        try:
            assert si_value(text, "m", name="it") > 0
        except ValueError as error:
            refused.append(str(error))
    assert refused
    assert all(sentence.startswith(("it is '2", 'it is "2')) for sentence in refused)
