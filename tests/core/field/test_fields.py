import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core.adhesion import AdhesionMap
from crackfront.core.field.fields import first_place, last_place, tile_field
from crackfront.core.field.rays import front_adhesion, sampled_on_rays, swept_adhesion
from crackfront.core.field.samples import evaluate, sample_place
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.units import WORK_OF_ADHESION


def tile(values, pixel=0.1):
    return AdhesionMap(np.asarray(values, dtype=float), pixel, 0.0, 0.0)


def noisy_polar(seed=1, n_angle=8, n_sample=40, spacing=0.05):
    rng = np.random.default_rng(seed)
    radii = np.cumsum(spacing * rng.uniform(0.5, 1.5, n_sample))
    adhesion = WORK_OF_ADHESION * (1 + 0.4 * rng.standard_normal((n_sample, n_angle)))
    return radii, adhesion


def wavy(x, y, period):
    """A band-limited periodic field, three waves long at most."""
    q = 2 * np.pi / period
    return 1 + 0.3 * np.cos(q * x + 0.4) + 0.2 * np.sin(q * (2 * x - 3 * y) + 0.1)


@st.composite
def fronts_in_pairs(draw):
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 1.2, 8), rng.uniform(0.1, 1.2, 8)


# --- polar samples


def test_radius_times_adhesion_is_linear_between_the_samples_of_a_ray():
    radii, adhesion = noisy_polar()
    field = polar_field(radii, adhesion)
    front = np.random.default_rng(2).uniform(radii[0], radii[-1], 8)
    products = [np.interp(front[ray], radii, radii * adhesion[:, ray]) for ray in range(front.size)]
    assert np.allclose(front * front_adhesion(front, field), products, rtol=1e-13)


def test_a_field_keeps_its_values_when_the_arrays_it_was_made_of_change():
    radii, adhesion = noisy_polar()
    field = polar_field(radii, adhesion)
    before = front_adhesion(np.full(8, 0.5), field)
    radii[:] = 7.0
    adhesion[:] = 7.0
    assert np.array_equal(front_adhesion(np.full(8, 0.5), field), before)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_refused_with_its_place(value):
    radii, adhesion = noisy_polar()
    adhesion[7, 3] = value
    with pytest.raises(
        ValueError,
        match=rf"work of adhesion is {value} at radius index 7, angle index 3; replace it",
    ):
        polar_field(radii, adhesion)


@pytest.mark.parametrize(
    "radii", [[0.1, 0.1, 0.2], [0.1, 0.3, 0.2], [-0.1, 0.1, 0.2], [0.1, np.nan, 0.3]]
)
def test_radii_that_do_not_increase_are_refused(radii):
    with pytest.raises(ValueError, match="not negative and strictly increasing; sort them"):
        polar_field(np.array(radii), np.ones((3, 8)))


# --- periodic tiles


def test_a_tile_is_met_at_its_own_points_along_both_axes(rng):
    values = 1 + 0.3 * rng.standard_normal((10, 10))
    field = tile_field(tile(values), geometry=sphere(4), spacing=0.1, largest_place=1.2)
    for sample in range(12):
        ahead, behind = (5 + sample + 1) % 10, (5 - sample - 1) % 10
        met = [values[ahead, 5], values[5, ahead], values[behind, 5], values[5, behind]]
        evaluated = [evaluate(field, ray, sample)[0] for ray in range(4)]
        assert np.allclose(evaluated, 0.1 * (sample + 1) * np.array(met), rtol=1e-12)


def test_the_apex_is_half_a_side_from_the_first_point_on_even_and_odd_tiles():
    for n_point in (24, 25):
        period = n_point * 0.1
        x = 0.1 * np.arange(n_point)
        values = 1 + 0.3 * np.cos(2 * np.pi * (x - period / 2) / period)[:, None] * np.ones(n_point)
        field = tile_field(tile(values), sphere(4), spacing=0.01, largest_place=0.2)
        # The field is symmetric about the apex, and highest there.
        assert evaluate(field, 0, 9)[0] == pytest.approx(evaluate(field, 2, 9)[0], rel=1e-13)
        assert evaluate(field, 0, 0)[0] / 0.01 == pytest.approx(1.3, abs=1e-3)


def test_interpolation_of_a_tile_converges_with_fourth_order():
    errors = []
    for n_point in (16, 32, 64):
        pixel = 1.0 / n_point
        x = pixel * np.arange(n_point) - 0.5
        field = tile_field(tile(wavy(x[:, None], x[None, :], 1.0), pixel), sphere(32), 0.0173, 1.6)
        angle = 2 * np.pi * np.arange(32) / 32
        error = 0.0
        for sample in range(0, 90, 3):
            radius = sample_place(field, sample)
            exact = wavy(radius * np.cos(angle), radius * np.sin(angle), 1.0)
            values = [evaluate(field, ray, sample)[0] / radius for ray in range(32)]
            error = max(error, np.abs(values - exact).max())
        errors.append(error)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.7), (errors, orders)
    assert errors[-1] < 1e-4


def test_a_tile_may_have_sides_of_different_length(rng):
    values = 1 + 0.3 * rng.standard_normal((8, 12))
    field = tile_field(tile(values), sphere(4), 0.1, 2.0)
    for step in (0, 3, 11, 17):
        radius = 0.1 * (step + 1)
        along_x = values[(4 + step + 1) % 8, 6]
        along_y = values[4, (6 + step + 1) % 12]
        assert evaluate(field, 0, step)[0] == pytest.approx(radius * along_x)
        assert evaluate(field, 1, step)[0] == pytest.approx(radius * along_y)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_the_rays_of_a_tile_sampled_beforehand_are_the_same_field(rng, interpolation):
    values = 1 + 0.3 * rng.standard_normal((16, 16))
    field = tile_field(tile(values), sphere(12), 0.04, 1.5, interpolation)
    polar = sampled_on_rays(field)
    front = rng.uniform(0.05, 1.45, 12)
    assert np.allclose(front_adhesion(front, polar), front_adhesion(front, field), rtol=1e-13)
    assert last_place(polar) == last_place(field) >= 1.5
    assert first_place(polar) == first_place(field) == 0.04


@pytest.mark.parametrize(("interpolation", "order"), [("linear", 2), ("cubic", 4)])
def test_pieces_converge_to_the_tile_with_their_order(interpolation, order):
    n_point = 32
    x = 1.6 / n_point * np.arange(n_point)
    smooth = tile(wavy(x[:, None], x[None, :], 1.6), 1.6 / n_point)
    fine = tile_field(smooth, sphere(16), 1e-4, 1.5)
    front = np.random.default_rng(3).uniform(0.3, 1.4, 16)
    expected = front_adhesion(front, fine)
    spacings = np.array([0.04, 0.02, 0.01])
    errors = [
        np.sqrt(
            np.mean(
                [
                    (front_adhesion(front + shift, field) - front_adhesion(front + shift, fine))
                    ** 2
                    for shift in np.linspace(0, 0.05, 40)
                ]
            )
        )
        for spacing in spacings
        for field in [tile_field(smooth, sphere(16), spacing, 1.5, interpolation)]
    ]
    assert np.all(np.isfinite(expected))
    observed = np.polyfit(np.log(spacings), np.log(errors), 1)[0]
    assert observed == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("kind", ["tile", "polar"])
def test_cubic_pieces_have_one_slope_where_they_meet(rng, kind):
    if kind == "tile":
        field = tile_field(tile(1 + 0.3 * rng.standard_normal((16, 16))), sphere(8), 0.05, 1.5)
    else:
        radii = 0.05 * np.arange(1, 31)
        field = polar_field(radii, 1 + 0.3 * rng.standard_normal((30, 8)), "cubic")
    for sample in (3, 11, 20):
        radius, step = sample_place(field, sample), 1e-7
        inner, at, outer = (
            (radius + way) * front_adhesion(np.full(8, radius + way), field)
            for way in (-step, 0.0, step)
        )
        assert np.allclose((outer - at) / step, (at - inner) / step, rtol=0, atol=1e-3)
        slopes = [evaluate(field, ray, sample)[1] for ray in range(8)]
        assert np.allclose((outer - inner) / (2 * step), slopes, rtol=0, atol=1e-3)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_tile_with_a_value_that_is_not_finite_is_refused_with_its_place(value):
    values = np.ones((8, 8))
    values[2, 5] = value
    with pytest.raises(ValueError, match=f"work of adhesion is {value} at x index 2, y index 5"):
        tile_field(tile(values), sphere(8), 0.1, 1.0)


@pytest.mark.parametrize("spacing", [0.0, -0.1, 0.5, float("nan")])
def test_a_sample_spacing_that_cannot_resolve_the_ray_is_refused(spacing):
    with pytest.raises(ValueError, match=f"sample spacing is {spacing}; it must be positive"):
        tile_field(tile(np.ones((8, 8))), sphere(8), spacing, 1.0)


# --- swept adhesion


@given(fronts_in_pairs(), fronts_in_pairs())
def test_swept_adhesion_does_not_depend_on_the_way(pair, threads):
    (before, after), (between, _) = pair, threads
    field = polar_field(*noisy_polar())
    direct = swept_adhesion(before, after, field)
    detour = swept_adhesion(before, between, field) + swept_adhesion(between, after, field)
    assert direct == pytest.approx(detour, rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_swept_adhesion_of_a_tile_is_the_integral_of_its_products(rng, interpolation):
    field = tile_field(
        tile(1 + 0.3 * rng.standard_normal((16, 16))), sphere(8), 0.04, 1.5, interpolation
    )
    before, after = rng.uniform(0.1, 1.4, 8), rng.uniform(0.1, 1.4, 8)
    share = np.linspace(0, 1, 20001)
    fronts = before[:, None] + (after - before)[:, None] * share
    products = np.array([front * front_adhesion(front, field) for front in fronts.T])
    expected = 2 * np.pi / 8 * np.sum((after - before) * np.trapezoid(products, share, axis=0))
    assert swept_adhesion(before, after, field) == pytest.approx(expected, rel=1e-7)


def test_splines_of_a_band_limited_tile_keep_the_amplitudes_of_its_modes():
    n_point, pixel = 32, 0.1
    x = pixel * np.arange(n_point)
    q = 2 * np.pi / (4 * pixel)
    wave = tile(1 + 0.5 * np.cos(q * x)[:, None] * np.ones(n_point), pixel)
    amplitudes = {}
    for band_limited in (False, True):
        field = tile_field(wave, sphere(4), 0.001, 3.2, band_limited=band_limited)
        radii = np.array([sample_place(field, k) for k in range(3200)])
        values = np.array([evaluate(field, 0, k)[0] for k in range(3200)]) / radii
        # The apex is 16 points, four waves, from the first point.
        amplitudes[band_limited] = 2 * np.mean((values - 1) * np.cos(q * radii)) / 0.5
    assert amplitudes[True] == pytest.approx(1, abs=1e-5)
    assert amplitudes[False] == pytest.approx(0.986, abs=1e-3)
