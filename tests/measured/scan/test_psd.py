"""Spectral densities as other programs export them: one surface in the convention of each."""

from pathlib import Path

import numpy as np
import pytest

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.measured.options import PsdOptions
from crackfront.measured.scan.psd import read_psd_file
from tests.measured.made import read

SURFACE = SelfAffineSpectrum(50e-9, 2e-6, hurst=0.8, plateau=1e-26)
Q = 2 * np.pi / np.geomspace(10e-6, 60e-9, 40)
"""Wavevectors of less than one value a bin, so that none are averaged."""


def columns(first, second, between=",", form="{:.9e}"):
    """Rows of two columns."""
    return "".join(
        between.join((form.format(a), form.format(b))) + "\n"
        for a, b in zip(first, second, strict=True)
    )


def profile(q=Q):
    """C_1D of the surface."""
    return SURFACE.profile_density(q)


def isotropic(q=Q):
    """C of the surface."""
    return SURFACE.density(q)


def contact_engineering():
    """Its text of several series, each with a standard error."""
    series = {"1D PSD along x": profile(), "q/π × 2D PSD": Q / np.pi * isotropic()}
    text = "# Power-spectral density (PSD)\n# ============\n# IF YOU USE THIS DATA, CITE IT\n#\n"
    for name, value in series.items():
        head = "# Columns: Wavevector (µm⁻¹), PSD (µm³), standard error of average PSD (µm³)"
        text += f"# {name}\n# {'-' * len(name)}\n{head}\n"
        rows = zip(Q * 1e-6, value * 1e18, strict=True)
        text += "".join(f"{a:.9e} {b:.9e} nan\n" for a, b in rows) + "\n"
    return text


EXPORTS = {
    "contact.engineering, profiles": (contact_engineering(), {"psd_series": "1D PSD along x"}),
    "contact.engineering, radial": (contact_engineering(), {"psd_series": "2"}),
    "Gwyddion, profiles": (
        "PSDF\nk       W_1\n[1/m]     [m<sup>3</sup>]\n"
        + columns([0, *Q], [0, *profile() / (2 * np.pi)], "  "),
        {},
    ),
    "Gwyddion, radial": (
        "Radial PSDF;\nk;W_r;\n[1/µm];[µm^3];\n"
        + columns(Q * 1e-6, 1e18 * Q * isotropic() / (2 * np.pi), ";"),
        {},
    ),
    "MountainsMap": (
        "Power spectral density\nFrequency (1/µm);PSD (nm²·µm)\n"
        + columns(Q * 1e-6 / (2 * np.pi), 1e24 * profile(), ";").replace(".", ","),
        {"psd_sides": "two"},
    ),
    "one-sided": (
        "wavevector [1/m],one-sided PSD [m^3]\n" + columns(Q, 2 * profile()),
        {},
    ),
    "wavelengths": (
        "wavelength (nm)\tC2D (um^4)\n" + columns(2e9 * np.pi / Q, 1e24 * isotropic(), "\t"),
        {},
    ),
    "without heads": (
        columns(Q * 1e-6, 1e24 * isotropic(), " "),
        {"psd_units": "1/um,um^4", "psd_abscissa": "wavevector"},
    ),
}


@pytest.mark.parametrize("name", EXPORTS)
def test_the_exports_of_programs_give_the_same_density(tmp_path, name):
    text, options = EXPORTS[name]
    path = tmp_path / "psd.txt"
    path.write_text(text, encoding="utf-8")
    density = read_psd_file(path, PsdOptions(**options))
    np.testing.assert_allclose(density.wavevector, Q, rtol=1e-6)
    expected = profile() if density.is_profile else isotropic()
    np.testing.assert_allclose(density.value, expected, rtol=1e-6)
    assert density.assumptions == ()


FREQUENCIES = (
    *("f (cycles/um)", "f (cycle/um)", "f [turns/um]", "k (cycles/um)", "q (revolutions/um)"),
    *("f (1/um)", "spatial frequency (1/um)", "angular frequency (cycles/um)"),
)
WAVEVECTORS = (
    *("q (rad/um)", "f (rad/um)", "spatial frequency (radians/um)", "k (rad µm⁻¹)"),
    *("Angular spatial frequency (1/um)", "angular frequency (rad/um)"),
)


@pytest.mark.parametrize("head", FREQUENCIES + WAVEVECTORS)
def test_cycles_and_radians_decide_and_count_2_pi_once(tmp_path, head):
    path = tmp_path / "psd.csv"
    first = Q * 1e-6 / (2 * np.pi if head in FREQUENCIES else 1)
    path.write_text(f"{head},C (um^4)\n" + columns(first, 1e24 * isotropic()), encoding="utf-8")
    density = read_psd_file(path, PsdOptions())
    np.testing.assert_allclose(density.wavevector, Q, rtol=1e-6)
    np.testing.assert_allclose(density.value, isotropic(), rtol=1e-6)


F = Q / (2 * np.pi)
RADIAL = Q * isotropic() / (2 * np.pi)
"""Density of which the integral over wavevectors is the mean square."""


@pytest.mark.parametrize(
    ("head", "first", "density", "norm"),
    [
        ("q (1/m),radial PSD (m^3)", Q, RADIAL, "1"),
        ("q (1/m),radial PSD (m^3)", Q, 2 * np.pi * RADIAL, "2pi"),
        ("k (1/m),W_r (m^3)", Q, 2 * np.pi * RADIAL, "2pi"),
        ("wavelength (m),radial PSD (m^3)", 1 / F, RADIAL, "1"),
        ("f (1/m),radial PSD (m^3)", F, 2 * np.pi * RADIAL, "2pi"),
        ("f (1/m),C2D (m^4)", F, isotropic(), "2pi"),
        ("wavelength (m),C2D (m^4)", 1 / F, isotropic() / (2 * np.pi) ** 2, "1"),
        ("k (1/m),W (m^4)", Q, isotropic() / (2 * np.pi) ** 2, "1"),
    ],
)
def test_a_named_norm_counts_for_every_kind_and_first_column(tmp_path, head, first, density, norm):
    path = tmp_path / "psd.csv"
    path.write_text(f"{head}\n" + columns(first, density))
    psd = read_psd_file(path, PsdOptions(psd_norm=norm))
    np.testing.assert_allclose(np.sort(psd.wavevector), Q, rtol=1e-6)
    np.testing.assert_allclose(psd.value, isotropic(), rtol=1e-6)
    assert "mean square its integral over" in psd.convention


@pytest.mark.parametrize(
    ("head", "options", "sentence"),
    [
        ("f (1/m),PSD (m^3)", {}, "frequency, and --psd-norm 1 makes .*; give --psd-norm 2pi if"),
        ("f (1/m),C2D (m^4)", {}, "frequency, and --psd-norm 1 makes .*; give --psd-norm 2pi if"),
        ("f (1/m),radial PSD (m^3)", {}, "or convert the first column to wavevectors"),
        ("q (1/m),PSD (m^3)", {"psd_kind": "q2d"}, "kind q2d over .* leave --psd-norm 1 out, or"),
        ("q (1/m),q/pi x 2D PSD (m^3)", {"psd_norm": "2pi"}, "q2d .* leave --psd-norm 2pi out"),
    ],
)
def test_a_norm_that_contradicts_the_kind_or_the_first_column_is_refused(
    tmp_path, head, options, sentence
):
    path = tmp_path / "psd.csv"
    path.write_text(f"{head}\n" + columns(Q, profile()))
    with pytest.raises(ValueError, match=sentence):
        read_psd_file(path, PsdOptions(**{"psd_norm": "1", **options}))


def test_a_density_that_does_not_say_its_sides_is_taken_as_two_sided_with_a_sentence(tmp_path):
    path = tmp_path / "psd.csv"
    path.write_text("q (1/m),PSD (m^3)\n" + columns(Q, profile()))
    density = read_psd_file(path, PsdOptions())
    [sentence] = density.assumptions
    assert "one-sided" in sentence
    half = read_psd_file(path, PsdOptions(psd_sides="one"))
    np.testing.assert_allclose(half.value, density.value / 2)


@pytest.mark.parametrize(
    ("text", "options", "sentence"),
    [
        ("x,y\n" + columns(Q, profile()), {}, "whether its first column is a wavevector"),
        ("q,PSD\n" + columns(Q, profile()), {}, "no unit of its first column; name both"),
        ("q (m),PSD (m^3)\n" + columns(Q, profile()), {}, "'m', which is not one of a wavevector"),
        (
            "frequency (1/um),PSD (um^3/rad)\n" + columns(Q, profile()),
            {},
            "per radian, and the first column is a frequency; name both units",
        ),
        (
            "q (cycles/m),PSD (m^3)\n" + columns(Q, profile()),
            {"psd_abscissa": "wavevector"},
            "one of a frequency; leave --psd-abscissa wavevector out",
        ),
        ("q (1/m),PSD (m^3)\n" + columns(Q, -profile()), {}, "line 2: the density is -"),
        ("q (1/m),PSD (m^3)\n" + columns(Q[:2], profile(Q[:2])), {}, "2 values of the density"),
        (contact_engineering(), {}, "2 series; choose one .*1 '1D PSD along x'; 2 'q/π"),
        ("nothing\n", {}, "lacks rows of numbers"),
        (
            'q (1/m),PSD (m^3)\n"1","2"\n"3","4"\n"' + "5," * 70_000,
            {},
            "line 4: .*70000 numbers.*nan",
        ),
    ],
)
def test_what_is_no_density_is_refused_with_a_sentence(tmp_path, text, options, sentence):
    path = tmp_path / "psd.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=sentence):
        read_psd_file(path, PsdOptions(**options))


@pytest.mark.parametrize(
    "text",
    [
        contact_engineering(),
        "q,C2D\n" + columns(Q, isotropic()),
        "k;W_1;k;W_1;\n[1/m];[m^3];[1/m];[m^3];\n"
        + "".join(f"{a};{b};{a};{b};\n" for a, b in zip(Q, profile(), strict=True)),
        "1/m  m^3\n" + columns(Q, profile(), " "),
        columns(Q, profile(), " "),
        columns(Q[0] * np.arange(200), 1e-20 / (1 + np.arange(200)) ** 2.6, " "),
    ],
)
def test_a_density_is_never_taken_for_a_line_scan(tmp_path, text):
    path = tmp_path / "psd.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"contains a spectral density, not a line scan: .* --psd"):
        read(path, unit="um")


def test_the_example_of_the_page_has_the_rms_height_of_its_scan():
    psd = read_psd_file(Path(__file__).parents[3] / "examples/density.csv", PsdOptions())
    assert not psd.is_profile
    assert psd.assumptions == ()
    q, density = psd.wavevector, psd.value
    assert np.sqrt(np.trapezoid(q * density, q) / (2 * np.pi)) == pytest.approx(105e-9, rel=0.1)
