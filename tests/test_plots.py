"""Figures: what they show, that they leave no trace and are equal when drawn again."""

from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex

from crackfront.analysis.steady import steady_adhesion
from crackfront.analysis.sweep import fit_sweep
from crackfront.analysis.table import SweepTable
from crackfront.core import jkr
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import polar_field
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.loop import loop_figure
from crackfront.plots.style import COLOURS, MARKERS, save_figure
from crackfront.plots.sweep import factor_figure, hysteresis_figure


@pytest.fixture
def table(rng):
    """A sweep over the four spectra of SI Fig. S-5 with k = 2.5 and one cell below zero."""
    cutoff = np.array([0.005, 0.000625, 0.000625, 0.005])
    roll_off = np.array([0.005, 0.01, 0.1, 0.1])
    hurst = np.array([0.8, 0.8, 0.3, 0.3])
    spectra = [SelfAffineSpectrum(*row) for row in zip(cutoff, roll_off, hurst, strict=True)]
    amplitudes = np.array([0.002, 0.01, 0.05, 0.15])
    energy = np.broadcast_to(amplitudes[:, None], (4, 4, 3)).copy()
    factor = 2.5 + 0.1 * rng.standard_normal(energy.shape)
    factor[3, 0] = -0.1
    w_appr, w_retr = 1 - energy - factor * energy, 1 - energy + factor * energy
    w_appr[2, 3] = np.nan
    return SweepTable(
        spectrum=np.array(["a", "b", "c", "d"]),
        short_cutoff=cutoff,
        roll_off=roll_off,
        hurst=hurst,
        correlation_length=np.array([spectrum.correlation_length for spectrum in spectra]),
        e_el_requested=amplitudes,
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


@pytest.fixture
def fit(table):
    """Its fit without the weakest amplitude."""
    return fit_sweep(table, lowest_elastic_energy=0.01, highest_elastic_energy=0.15)


@pytest.fixture(scope="module")
def record():
    """A cycle over a small pinning field."""
    radii = np.linspace(0.02, 2.2, 110)
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    bumps = 1 + 0.2 * np.sin(8 * np.pi * radii)[:, None] * np.cos(4 * angle)
    return run_cycle(
        polar_field(radii, WORK_OF_ADHESION * bumps), LoadSchedule(1.0, 0.05), Newton(1e-6)
    )


def line_labelled(axes, words):
    """The line whose label holds the words."""
    return next(line for line in axes.get_lines() if words in str(line.get_label()))


def test_the_theory_lines_lie_where_theory_says(table, fit):
    axes = hysteresis_figure(table, fit).axes[0]
    for factor, words in ((3, "paper"), (4, "perturbation"), (fit.pooled.factor.value, "fit")):
        variance, hysteresis = line_labelled(axes, words).get_data()
        np.testing.assert_allclose(hysteresis, factor * variance / 2)
    np.testing.assert_allclose(line_labelled(axes, "fit").get_xdata(), [0.04, 0.6])


def test_points_are_the_means_over_realisations(table, fit):
    axes = hysteresis_figure(table, fit).axes[0]
    drawn = axes.containers[0].lines[0]
    np.testing.assert_allclose(drawn.get_xdata(), 4 * np.array([0.01, 0.05, 0.15]))
    expected = np.mean(table.w_retr - table.w_appr, axis=-1)[0, 1:]
    np.testing.assert_allclose(drawn.get_ydata(), expected)


def test_every_positive_mean_lies_within_the_axes_and_others_are_arrows(table, fit):
    axes = hysteresis_figure(table, fit).axes[0]
    low, high = axes.get_ylim()
    values = fit.cells.hysteresis.value
    shown = values[np.isfinite(values) & (values > 0)]
    assert low < shown.min() < shown.max() < high
    assert len(axes.texts) == 1


def test_spectra_differ_by_colour_and_marker(table, fit):
    axes = factor_figure(table, fit).axes[0]
    filled = [c.lines[0] for c in axes.containers if c.lines[0].get_markerfacecolor() != "white"]
    assert [to_hex(line.get_color()).upper() for line in filled] == list(COLOURS[:4])
    assert [line.get_marker() for line in filled] == list(MARKERS[:4])


def test_the_inset_compares_spectra_of_equal_elastic_energy(table, fit):
    (inset,) = hysteresis_figure(table, fit).axes[0].child_axes
    for index, line in enumerate(inset.get_lines()):
        wavevector, density = (np.asarray(values)[:-1] for values in line.get_data())
        spectrum = SelfAffineSpectrum(
            table.short_cutoff[index], table.roll_off[index], table.hurst[index]
        ).with_elastic_energy(1.0)
        np.testing.assert_allclose(density, spectrum.density(wavevector))


def measured(steady):
    """Works of adhesion and their window, as a loop is drawn with them."""
    return (steady.w_appr, steady.w_retr), (steady.lowest_radius, steady.highest_radius)


def test_the_loop_lies_between_its_curves(record):
    steady = steady_adhesion(record, correlation_length=0.1)
    axes = loop_figure(record.states, *measured(steady), elastic_energy=0.01, title="loop").axes[0]
    assert axes.get_title() == "loop"
    for words, adhesion in (("appr", steady.w_appr), ("retr", steady.w_retr)):
        radius, force = line_labelled(axes, f"\\mathrm{{{words}}}").get_data()
        np.testing.assert_allclose(force, jkr.equilibrium_force(radius, adhesion))
    drawn = line_labelled(axes, "approach").get_xdata()
    np.testing.assert_array_equal(drawn, record.states.mean_radius[record.states.direction > 0])


def test_a_loop_without_steady_states_is_drawn_without_curves(record):
    steady = steady_adhesion(record, correlation_length=10.0)
    axes = loop_figure(record.states, *measured(steady)).axes[0]
    assert not [line for line in axes.get_lines() if "JKR" in str(line.get_label())]


def test_an_empty_record_is_refused(record):
    empty = replace(record.states, mean_radius=np.array([]))
    with pytest.raises(ValueError, match="holds no state"):
        loop_figure(empty, *measured(steady_adhesion(record, 0.1)))


def test_a_figure_is_the_same_file_again_whatever_the_user_settings(table, fit, record, tmp_path):
    steady = steady_adhesion(record, correlation_length=0.1)
    makers = (
        lambda: hysteresis_figure(table, fit),
        lambda: loop_figure(record.states, *measured(steady), elastic_energy=0.01),
    )
    for number, make in enumerate(makers):
        first = save_figure(make(), tmp_path / "one" / f"figure.{number}")
        with matplotlib.rc_context({"font.size": 20.0, "lines.linewidth": 9.0}):
            second = save_figure(make(), tmp_path / "two" / f"figure.{number}")
            assert matplotlib.rcParams["font.size"] == 20.0
        assert [path.name for path in first] == [f"figure.{number}.pdf", f"figure.{number}.png"]
        for one, two in zip(first, second, strict=True):
            assert one.read_bytes() == two.read_bytes()
            assert one.stat().st_size > 1000


def test_k_is_shown_against_disorder_and_size(table, fit):
    left, right = factor_figure(table, fit).axes
    np.testing.assert_allclose(
        left.containers[0].lines[0].get_ydata(), fit.cells.factor.value[0, 1:]
    )
    lengths = [container.lines[0].get_xdata()[0] for container in right.containers]
    np.testing.assert_array_equal(lengths, table.correlation_length)
    assert left.get_ylim()[1] > 4
    assert left.get_ylim() == right.get_ylim()
