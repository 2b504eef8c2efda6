"""Figures of sweeps: what is drawn where."""

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex

from crackfront.analysis.law import law_value, shipped_law, spectral_breadth
from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.table import SweepTable
from crackfront.core.adhesion import larkin_length
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.plots.style import COLOURS, save_figure
from crackfront.plots.sweep_figures import factor_figure, hysteresis_figure


@pytest.fixture(scope="module")
def table():
    """A sweep over the four spectra of SI Fig. S-5 with k = 2.5 and one cell below zero."""
    cutoff = np.array([0.005, 0.000625, 0.000625, 0.005])
    roll_off = np.array([0.005, 0.01, 0.1, 0.1])
    hurst = np.array([0.8, 0.8, 0.3, 0.3])
    spectra = [SelfAffineSpectrum(*row) for row in zip(cutoff, roll_off, hurst, strict=True)]
    amplitudes = np.array([0.002, 0.01, 0.05, 0.15])
    energy = np.broadcast_to(amplitudes[:, None], (4, 4, 3)).copy()
    factor = 2.5 + 0.1 * np.random.default_rng(1).standard_normal(energy.shape)
    factor[3, 0] = -0.1
    w_appr, w_retr = 1 - energy - factor * energy, 1 - energy + factor * energy
    w_appr[2, 3] = np.nan
    return SweepTable(
        spectrum=np.array(["a", "b", "c", "d"]),
        short_cutoff=cutoff,
        roll_off=roll_off,
        hurst=hurst,
        correlation_length=np.array([spectrum.correlation_length for spectrum in spectra]),
        amplitude=amplitudes,
        e_el=energy,
        w_rms=2 * np.sqrt(energy),
        w_appr=w_appr,
        w_retr=w_retr,
        w_appr_from_force=w_appr,
        w_retr_from_force=w_retr,
        w_appr_numerical_error=np.zeros_like(w_retr),
        w_retr_numerical_error=np.zeros_like(w_retr),
        contact_radius=np.full(energy.shape, 1.9),
        spring=np.full((4, 4), np.nan),
    )


@pytest.fixture(scope="module")
def fit(table):
    """Its fit without the weakest amplitude."""
    return fit_sweep(table, lowest_elastic_energy=0.01, highest_elastic_energy=0.15)


def line_labelled(axes, words):
    """The line whose label holds the words."""
    return next(line for line in axes.get_lines() if words in str(line.get_label()))


def test_the_theory_lines_lie_where_theory_says(table, fit):
    axes = hysteresis_figure(fit).axes[0]
    for factor, words in ((3, "paper"), (4, "perturbation")):
        variance, hysteresis = line_labelled(axes, words).get_data()
        np.testing.assert_allclose(hysteresis, factor * variance / 2)
    pooled = line_labelled(factor_figure(fit).axes[0], "pooled")
    np.testing.assert_allclose(pooled.get_data(), ([0.01, 0.15], [fit.pooled.factor.value] * 2))
    variance, hysteresis = line_labelled(axes, "pooled").get_data()
    np.testing.assert_allclose(variance, [0.04, 0.6])
    np.testing.assert_allclose(hysteresis, fit.pooled.factor.value * variance / 2)


@pytest.mark.parametrize("draw", [hysteresis_figure, factor_figure])
def test_the_legend_names_every_spectrum_as_the_configuration_does(table, fit, draw):
    [legend] = draw(fit).legends
    texts = [entry.get_text() for entry in legend.get_texts()]
    for name in table.spectrum:
        assert sum(text.startswith(f"{name}: ") for text in texts) == 1


def curves(axes, colour):
    """Lines of a colour without an entry in the legend or markers, the curves of the law."""
    lines = [line for line in axes.get_lines() if to_hex(line.get_color()) == colour.lower()]
    return [
        line
        for line in lines
        if str(line.get_label()).startswith("_") and line.get_marker() == "None"
        if len(line.get_xdata()) > 10
    ]


def test_the_law_is_drawn_for_every_spectrum_through_its_values_at_the_amplitudes(table, fit):
    hysteresis, factor = hysteresis_figure(fit).axes[0], factor_figure(fit).axes[0]
    for index, colour in enumerate(COLOURS[:4]):
        ((variance, jump),) = (line.get_data() for line in curves(hysteresis, colour))
        ((energy, k),) = (line.get_data() for line in curves(factor, colour))
        np.testing.assert_allclose(variance, 4 * energy)
        np.testing.assert_allclose(jump, 2 * k * energy)
        np.testing.assert_allclose(
            energy[-1], fit.cells.e_el[index, np.isfinite(fit.cells.e_el[index])][-1]
        )
        last = np.flatnonzero(np.isfinite(fit.cells.law_factor.value[index]))[-1]
        assert k[-1] == pytest.approx(fit.cells.law_factor.value[index, last])
        # Below the smallest size that was measured nothing is drawn.
        least = shipped_law().size[0]
        assert np.isfinite(k[0]) == (fit.cells.size[index, 0] >= least)


@pytest.fixture(scope="module")
def line_table():
    """Straight fronts of two spectra on three springs each, with the k of the law."""
    energy = np.array([0.01, 0.04])
    lengths, springs = np.array([1.0, 2.0]), np.array([2.0, 20.0, 200.0])
    cutoff = np.repeat(lengths, 3)
    spectra = [SelfAffineSpectrum(cutoff_length, cutoff_length, 1.0) for cutoff_length in cutoff]
    length = np.array([spectrum.correlation_length for spectrum in spectra])
    spring = np.repeat((np.tile(springs, 2) * length)[:, None], 2, axis=1)
    whole = np.broadcast_to(energy[:, None], (6, 2, 2)).copy()
    unknown = np.full(whole.shape, np.nan)
    rms = 2 * np.sqrt(energy)
    larkin = [
        [larkin_length("roughness", cutoff_length, rms_value) for rms_value in rms]
        for cutoff_length in spectra
    ]
    k = law_value(shipped_law().coefficients, rms, spring / np.array(larkin))
    k = k[..., None] * np.array([0.99, 1.01])
    return SweepTable(
        spectrum=np.array(
            [f"flat{cutoff_length:g}-L{two:g}" for cutoff_length in lengths for two in springs]
        ),
        short_cutoff=cutoff,
        roll_off=cutoff,
        hurst=np.ones(6),
        correlation_length=length,
        amplitude=energy,
        e_el=whole,
        w_rms=2 * np.sqrt(whole),
        w_appr=1 - whole - k * whole,
        w_retr=1 - whole + k * whole,
        w_appr_from_force=unknown,
        w_retr_from_force=unknown,
        w_appr_numerical_error=np.zeros_like(whole),
        w_retr_numerical_error=np.zeros_like(whole),
        contact_radius=unknown,
        spring=spring,
    )


def test_k_of_straight_fronts_is_shown_against_their_size_beside_the_law(line_table):
    fit = fit_sweep(line_table, lowest_elastic_energy=0.01, highest_elastic_energy=0.04)
    left, right = factor_figure(fit).axes
    points = [container.lines[0].get_data() for container in left.containers]
    sizes, factors = (np.sort(np.concatenate(column)) for column in zip(*points, strict=True))
    np.testing.assert_allclose(sizes, np.sort(fit.cells.size, axis=None))
    np.testing.assert_allclose(factors, np.sort(fit.cells.factor.value, axis=None))
    size, k = line_labelled(left, "s=0.2").get_data()
    flat = spectral_breadth("roughness", SelfAffineSpectrum(1.0, 1.0, 1.0))
    np.testing.assert_allclose(k, law_value(shipped_law().coefficients, 0.2, size, flat))
    drawn = np.concatenate([container.lines[0].get_xydata() for container in right.containers])
    drawn = drawn[np.isfinite(drawn[:, 1])]
    # The points are those of a typical breadth, and gain what a flat spectrum does.
    limit = line_labelled(right, "infty")
    np.testing.assert_allclose(drawn[:, 1], np.interp(drawn[:, 0], *limit.get_data()), rtol=0.01)
    assert len(drawn) == np.count_nonzero(fit.cells.size > 1)


def test_points_are_the_means_over_realisations(table, fit):
    axes = hysteresis_figure(fit).axes[0]
    drawn = axes.containers[0].lines[0]
    np.testing.assert_allclose(drawn.get_xdata(), 4 * np.array([0.01, 0.05, 0.15]))
    expected = np.mean(table.w_retr - table.w_appr, axis=-1)[0, 1:]
    np.testing.assert_allclose(drawn.get_ydata(), expected)


def test_spectra_are_compared_at_equal_elastic_energy(table, fit):
    for index, line in enumerate(hysteresis_figure(fit).axes[1].get_lines()):
        wavevector, density = (np.asarray(values)[:-1] for values in line.get_data())
        spectrum = SelfAffineSpectrum(
            table.short_cutoff[index], table.roll_off[index], table.hurst[index]
        ).with_elastic_energy(1.0)
        np.testing.assert_allclose(density, spectrum.density(wavevector))


@pytest.mark.look
@pytest.mark.slow
def test_a_figure_is_the_same_file_again_whatever_the_user_settings(fit, tmp_path):
    first = save_figure(hysteresis_figure(fit), tmp_path / "one" / "figure.0")
    with matplotlib.rc_context({"font.size": 20.0, "lines.linewidth": 9.0}):
        second = save_figure(hysteresis_figure(fit), tmp_path / "two" / "figure.0")
        assert matplotlib.rcParams["font.size"] == 20.0
    assert [path.name for path in first] == ["figure.0.pdf", "figure.0.png"]
    for first_file, two in zip(first, second, strict=True):
        assert first_file.read_bytes() == two.read_bytes()
        assert first_file.stat().st_size > 1000


def test_k_is_shown_against_disorder_and_size(table, fit):
    left, right = factor_figure(fit).axes
    np.testing.assert_allclose(
        left.containers[0].lines[0].get_ydata(), fit.cells.factor.value[0, 1:]
    )
    lengths = [container.lines[0].get_xdata()[0] for container in right.containers]
    np.testing.assert_array_equal(lengths, table.correlation_length)
    assert left.get_ylim()[1] > 4
    assert left.get_ylim() == right.get_ylim()
