"""Figures of one loop: what is drawn where."""

import numpy as np
import pytest

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.run import run_cycle
from crackfront.core.geometry.line import LineState
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.solver.relax import Newton
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.loop_figures import draw_loop, draw_pinning
from crackfront.plots.style import COLUMN, blank_figure, house_style


@pytest.fixture(scope="module")
def record():
    """A cycle over a small pinning field, on a tile, for which every environment has kernels."""
    x, y = np.meshgrid(*[np.arange(64) * np.pi / 16] * 2, indexing="ij")
    adhesion = chemical_adhesion(0.2 * WORK_OF_ADHESION * np.sin(2 * x) * np.cos(2 * y), 4.8 / 64)
    field = contact_field(adhesion, 1.0, n_site=32, spacing=0.02)
    return run_cycle(field, LoadSchedule(1.0, 0.05), Newton(1e-6))


def drawn(draw, *states, **options):
    """Axes of one column, drawn on."""
    with house_style():
        axes = blank_figure(COLUMN, 0.8 * COLUMN).add_subplot()
        draw(axes, *states, **options)
    return axes


def line_labelled(axes, words):
    """The line whose label holds the words."""
    return next(line for line in axes.get_lines() if words in str(line.get_label()))


def line_states(n_step=9):
    """A front that pins by 0.2 forward and 0.1 back once it has forgotten its start."""
    load = np.arange(float(n_step))
    pinning = np.where(load < 4, 0.0, 0.2)
    zero = np.zeros(2 * n_step)
    return LineState(
        spring_position=np.concatenate([load, load[::-1]]),
        direction=np.repeat([1, -1], n_step),
        mean_position=zero,
        rms_position=zero,
        pinning_force=np.concatenate([pinning, -pinning / 2]),
        least_travel=zero,
        iterations=zero,
        updates=zero,
        residual=zero,
    )


def test_the_pinning_force_is_averaged_over_the_last_period_of_each_branch():
    axes = drawn(draw_pinning, line_states(), 5, elastic_energy=0.1)
    forward, back = (line_labelled(axes, words) for words in ("k=2.00", "k=1.00"))
    np.testing.assert_allclose(forward.get_data(), ([4, 8], [0.2, 0.2]))
    np.testing.assert_allclose(back.get_data(), ([4, 0], [-0.1, -0.1]))
    assert axes.get_legend() is not None


def measured(steady):
    """Works of adhesion and their window, as a loop is drawn with them."""
    return (steady.w_appr, steady.w_retr), (steady.lowest_radius, steady.highest_radius)


def test_the_loop_lies_between_its_curves(record):
    steady = steady_adhesion(record, correlation_length=0.1)
    axes = drawn(draw_loop, record.states, *measured(steady), elastic_energy=0.01)
    for words, adhesion in (("appr", steady.w_appr), ("retr", steady.w_retr)):
        force, radius = line_labelled(axes, f"\\mathrm{{{words}}}").get_data()
        np.testing.assert_allclose(force, jkr.equilibrium_force(radius, adhesion))
    places = line_labelled(axes, "approach").get_ydata()
    np.testing.assert_array_equal(places, record.states.mean_radius[record.states.direction > 0])
