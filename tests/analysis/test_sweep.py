"""The fit of planted laws, and what its pages say."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import stdtr

from crackfront.analysis.estimate import Estimate, mean_estimate
from crackfront.analysis.fit_text import fit_notes, fit_table, trend_sentence
from crackfront.analysis.law import law_value, shipped_law, spectral_breadth
from crackfront.analysis.result import HALF_WIDTHS, SweepFit
from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.sweep_law import SweepLaw
from crackfront.analysis.table import REALISATION, SweepTable
from crackfront.core.variables import variables

AMPLITUDES = np.array([0.005, 0.01, 0.02, 0.05, 0.1])
LENGTHS = np.array([0.02, 0.04, 0.08])
LAW = ("factor", "factor_by_sums", "exponent", "midpoint_slope", "disorder_slope")


def synthetic_table(
    rng, law, *, noise=0.1, n_realisation=4, lengths=LENGTHS, amplitudes=AMPLITUDES
):
    """A sweep over flat spectra with k = law(e_el, spectrum) and noise shared by amplitudes."""
    n_spectrum = len(lengths)
    column = (n_spectrum, 1, n_realisation)
    whole = (n_spectrum, amplitudes.size, n_realisation)
    energy = amplitudes[:, None] * (1 + 0.02 * rng.standard_normal(column))
    planted = np.array([law(amplitudes, index) for index in range(n_spectrum)])[..., None]
    factor = planted + noise * (
        0.8 * rng.standard_normal(column) + 0.6 * rng.standard_normal(whole)
    )
    midpoint = 1 - energy + 0.2 * noise * np.sqrt(energy) * rng.standard_normal(whole)
    w_appr, w_retr = midpoint - factor * energy, midpoint + factor * energy
    return SweepTable(
        spectrum=np.array([f"flat-{length}" for length in lengths]),
        short_cutoff=np.array(lengths),
        roll_off=np.array(lengths),
        hurst=np.full(n_spectrum, 0.8),
        correlation_length=np.array(lengths),
        amplitude=amplitudes,
        e_el=energy,
        w_rms=2 * np.sqrt(energy),
        w_appr=w_appr,
        w_retr=w_retr,
        w_appr_from_force=w_appr + 0.001,
        w_retr_from_force=w_retr - 0.002,
        w_appr_numerical_error=0.01 * energy,
        w_retr_numerical_error=0.02 * energy,
        contact_radius=np.full(whole, 1.9),
        spring=np.full(whole[:2], np.nan),
    )


def constant(energy, _):
    """k = 3 everywhere."""
    return np.full(energy.shape, 3.0)


def fit_all(table, **options) -> SweepFit:
    """Fit over all amplitudes, with few bootstrap samples."""
    options = {"n_bootstrap": 400, "seed": 0} | options
    return fit_sweep(table, lowest_elastic_energy=0.005, highest_elastic_energy=0.1, **options)


def with_gaps(table, gaps):
    """The table with NaN where simulations failed."""
    columns = ("w_appr", "w_retr", "w_appr_from_force", "w_retr_from_force")
    return replace(
        table, **{name: np.where(gaps, np.nan, getattr(table, name)) for name in columns}
    )


def covered(estimate: Estimate, truth):
    """Whether the interval holds the truth."""
    return (estimate.low <= truth) & (truth <= estimate.high)


def test_without_noise_the_fit_returns_the_planted_law_to_round_off(rng):
    fit = fit_all(synthetic_table(rng, constant, noise=0.0))
    for law, shape in ((fit.spectra, (3,)), (fit.pooled, ())):
        for name, truth in zip(LAW, (3.0, 3.0, 2.0, 1.0, 0.0), strict=True):
            estimate = getattr(law, name)
            np.testing.assert_allclose(estimate.value, np.full(shape, truth), atol=1e-11)
            np.testing.assert_allclose(estimate.high - estimate.low, np.zeros(shape), atol=1e-9)
    for branch, drift in (("approach", 0.001), ("retraction", -0.002)):
        for name, expected in ((branch, drift), (f"{branch}_largest", abs(drift))):
            assert getattr(fit.from_force, name) == pytest.approx([expected] * 3)
    assert fit.pooled_size_slope.value == pytest.approx(0.0, abs=1e-11)
    assert any("Numerical errors: up to 0.015 of k" in note for note in fit_notes(fit))


def test_planted_trends_with_disorder_and_size_are_recovered(rng):
    table = synthetic_table(
        rng, lambda energy, index: 3 - 0.3 * np.log2(2 * np.sqrt(energy)) - 0.5 * index, noise=0.0
    )
    fit = fit_all(table)
    np.testing.assert_allclose(fit.spectra.disorder_slope.value, -0.3, rtol=1e-9)
    # One spectrum more is one doubling of the correlation length.
    np.testing.assert_allclose(fit.size_slope.value, -0.5, rtol=1e-9)
    np.testing.assert_allclose(fit.pooled_size_slope.value, -0.5, rtol=1e-9)
    np.testing.assert_allclose(fit.pooled.factor.value, np.mean(fit.cells.factor.value))


@pytest.mark.slow
def test_intervals_cover_the_truth_as_often_as_they_say(rng):
    n_table = 200
    hits = dict.fromkeys(LAW, 0.0)
    pooled = dict.fromkeys((*LAW, "size"), 0.0)
    for seed in range(n_table):
        fit = fit_all(synthetic_table(rng, constant), n_bootstrap=200, seed=seed)
        for name, truth in zip(LAW, (3.0, 3.0, 2.0, 1.0, 0.0), strict=True):
            hits[name] += np.mean(covered(getattr(fit.spectra, name), truth)) / n_table
            pooled[name] += covered(getattr(fit.pooled, name), truth) / n_table
        pooled["size"] += covered(fit.pooled_size_slope, 0.0) / n_table
    # Three standard deviations of a binomial around 0.95 are 0.046.
    assert all(0.90 <= share <= 0.99 for share in hits.values()), hits
    assert all(0.90 <= share <= 1.0 for share in pooled.values()), pooled


def test_realisations_are_resampled_with_all_their_amplitudes(rng):
    # The realisations differ by one number that all their amplitudes share.
    shared = synthetic_table(rng, constant, noise=0.0, n_realisation=6)
    offset = rng.standard_normal((3, 1, 6)) * shared.e_el
    shared = replace(shared, w_retr=shared.w_retr + offset, w_appr=shared.w_appr - offset)
    fit = fit_all(shared, n_bootstrap=4000)
    single = mean_estimate((3 * shared.e_el + offset)[:, 0] / shared.e_el[:, 0])[0]
    np.testing.assert_allclose(fit.spectra.factor.standard_error, single.standard_error, rtol=0.06)
    # Resampled apart, the noise would average out over five amplitudes.
    assert np.all(fit.spectra.factor.standard_error > 2 * single.standard_error / np.sqrt(5))


def test_intervals_are_those_of_the_seed_and_point_estimates_do_not_depend_on_it_or_the_order(rng):
    table = synthetic_table(rng, constant)
    order = [2, 0, 3, 1]
    cells = [item.name for item in variables(SweepTable) if REALISATION in item.dims]
    shuffled = replace(table, **{name: getattr(table, name)[..., order] for name in cells})
    first, second = fit_all(table), fit_all(shuffled, seed=5)
    np.testing.assert_array_equal(first.pooled.factor.low, fit_all(table).pooled.factor.low)
    for name in LAW:
        for first_estimates, second_estimates in (
            (first.spectra, second.spectra),
            (first.pooled, second.pooled),
        ):
            np.testing.assert_allclose(
                getattr(first_estimates, name).value,
                getattr(second_estimates, name).value,
                rtol=1e-11,
            )
    assert not np.array_equal(
        first.spectra.factor.standard_error, second.spectra.factor.standard_error
    )


def test_a_constant_midpoint_shift_is_found_and_is_improbable():
    table = synthetic_table(np.random.default_rng(1), constant, noise=0.01)
    shifted = replace(table, w_appr=table.w_appr - 0.05, w_retr=table.w_retr - 0.05)
    as_planted, fit = fit_all(table), fit_all(shifted)
    assert as_planted.midpoint_probability > 0.01
    assert fit.midpoint_probability < 1e-4
    assert fit.midpoint_largest > as_planted.midpoint_largest
    # Of 15 independent cells with four realisations each.
    by_chance = 1 - (1 - 2 * stdtr(3, -fit.midpoint_largest)) ** 15
    assert fit.midpoint_probability == pytest.approx(by_chance)
    assert np.all(fit.spectra.midpoint_slope.low > 1)
    # A shift at an amplitude that the fit leaves out is not found.
    shift = np.where(AMPLITUDES[-1] == AMPLITUDES, 0.05, 0.0)[:, None]
    outside = replace(table, w_appr=table.w_appr - shift, w_retr=table.w_retr - shift)
    ends = {"lowest_elastic_energy": AMPLITUDES[0], "highest_elastic_energy": AMPLITUDES[-2]}
    assert fit_sweep(outside, **ends, n_bootstrap=400).midpoint_probability > 0.01


def test_the_probability_of_a_midpoint_is_uniform_if_the_law_is_exact(rng):
    tables = (synthetic_table(rng, constant, lengths=LENGTHS[:1]) for _ in range(100))
    probabilities = [fit_all(table, n_bootstrap=2).midpoint_probability for table in tables]
    # Three standard errors of the mean of so many uniform numbers are 0.09.
    assert np.mean(probabilities) == pytest.approx(0.5, abs=0.09)
    assert np.max(probabilities) < 1


def test_so_many_realisations_as_a_fit_names_give_the_interval_that_it_names(rng):
    few = fit_all(synthetic_table(rng, constant, noise=0.2, n_realisation=12))
    for index, half_width in enumerate(HALF_WIDTHS[1:], start=1):
        number = int(few.pooled_n_needed[index])
        fit = fit_all(synthetic_table(rng, constant, noise=0.2, n_realisation=number))
        pooled = fit.pooled.factor
        assert (pooled.high - pooled.low) / 2 == pytest.approx(half_width, rel=0.3)
        assert fit.pooled_n_needed[index] == pytest.approx(number, rel=0.6)
    # An interval that is narrow enough needs no further ones.
    assert few.pooled_n_needed[0] == 12
    assert np.all(few.n_needed[:, 2] > few.pooled_n_needed[2])


def test_a_fit_without_an_interval_names_no_number_of_realisations(rng):
    fit = fit_all(synthetic_table(rng, constant, n_realisation=1))
    assert np.isnan(fit.pooled_n_needed).all()
    assert "nan" not in fit_table(fit)


def test_the_exponent_by_the_law_is_the_measured_one_of_fronts_that_obey_it():
    table, _, _ = by_the_law(straight=True)
    fit = fit_all(table)
    np.testing.assert_allclose(fit.law_exponent, fit.spectra.exponent.value, rtol=1e-9)
    assert fit.pooled_law_exponent == pytest.approx(float(fit.pooled.exponent.value))
    assert np.ptp(fit.law_exponent) > 0.05
    # It is of the amplitudes that are measured.
    gaps = np.zeros(table.e_el.shape, bool)
    gaps[0, 2:] = True
    fewer = fit_all(with_gaps(table, gaps))
    np.testing.assert_allclose(fewer.law_exponent, fewer.spectra.exponent.value, rtol=1e-9)
    assert fewer.law_exponent[0] != pytest.approx(fit.law_exponent[0], rel=1e-3)


def test_k_by_the_law_has_the_powers_of_the_law_in_disorder_and_size():
    table, _, _ = by_the_law(straight=True)
    powers = fit_all(table).powers
    assert powers.disorder_power.value == pytest.approx(float(powers.law_disorder_power))
    assert powers.size_power.value == pytest.approx(float(powers.law_size_power))
    assert powers.disorder_power.high < 0 < powers.size_power.low
    assert "k_m" in fit_table(fit_all(table))


def test_a_chemical_field_leaves_the_midpoint_at_w_int():
    table = synthetic_table(np.random.default_rng(1), constant, noise=0.01)
    chemical = replace(table, w_appr=table.w_appr + table.e_el, w_retr=table.w_retr + table.e_el)
    fit = fit_all(chemical, kind="chemical")
    assert covered(fit.pooled.midpoint_slope, 0.0)
    assert fit.midpoint_probability > 0.01
    assert fit_all(chemical).midpoint_probability < 1e-4
    assert "| paper |  |  | 3 | 3 | 2 | 2 | 0 | 0 |" in fit_table(fit)


def test_failed_simulations_are_left_out_and_told(rng):
    table = synthetic_table(rng, constant, noise=0.0)
    gaps = np.zeros(table.e_el.shape, dtype=bool)
    gaps[0, 4, :3] = gaps[1, 0, :] = gaps[2] = True
    fit = fit_all(with_gaps(table, gaps))
    np.testing.assert_allclose(fit.spectra.factor.value, [3, 3, np.nan], rtol=1e-11)
    assert fit.pooled.factor.value == pytest.approx(3.0)
    np.testing.assert_array_equal(fit.n_failed, [3, 4, 20])
    np.testing.assert_array_equal(fit.n_realisation, [4, 4, 0])
    np.testing.assert_array_equal(fit.cells.count[0], [4, 4, 4, 4, 1])
    notes = "\n".join(fit_notes(fit))
    assert "flat-0.02: 3 simulations in the range have no value" in notes
    assert "flat-0.04: no value at e_el = 0.005 w_int" in notes
    assert "flat-0.08: no simulation in the range has a value" in notes


def test_one_realisation_gives_values_but_no_intervals_and_says_so(rng):
    fit = fit_all(synthetic_table(rng, constant, n_realisation=1))
    assert np.isfinite(fit.spectra.factor.value).all()
    for law in (fit.spectra, fit.pooled):
        for name in LAW:
            estimate = getattr(law, name)
            assert np.isnan([estimate.low, estimate.high, estimate.standard_error]).all()
    assert np.isnan(fit.midpoint_largest)
    assert any("one realisation gives no interval" in note for note in fit_notes(fit))
    assert "(no interval)" in fit_table(fit)


@pytest.mark.parametrize("n_realisation", [2, 3])
def test_spectra_lack_an_interval_with_two_realisations_and_a_note_says_how_many_give_one(
    rng, n_realisation
):
    fit = fit_all(synthetic_table(rng, constant, n_realisation=n_realisation))
    lacking = n_realisation == 2
    assert np.all(np.isnan(fit.spectra.factor.low) == lacking)
    assert np.isfinite(fit.pooled.factor.low)
    notes = [note for note in fit_notes(fit) if "no interval" in note]
    assert len(notes) == lacking
    assert all(name in note for note in notes for name in (*fit.table.spectrum, "to 3 or more"))


def test_a_single_amplitude_and_a_single_spectrum_give_k_but_no_trend(rng):
    table = synthetic_table(rng, constant, lengths=LENGTHS[:1], amplitudes=AMPLITUDES[-1:])
    fit = fit_all(table)
    assert covered(fit.pooled.factor, 3.0)
    assert np.isnan(fit.pooled.exponent.value)
    assert np.isnan(fit.pooled.disorder_slope.value)
    assert np.isnan(fit.pooled_size_slope.value)
    sentence = trend_sentence(fit)
    assert "its trend with w_rms needs two amplitudes" in sentence
    assert "its trend with size needs two spectra of one shape" in sentence


def on_springs(table, springs):
    """The spectra of a table, each on springs of so many correlation lengths."""
    number, columns = len(springs), {}
    for item in variables(SweepTable):
        values = getattr(table, item.name)
        if item.dims and item.dims[0] == "spectrum" and values is not None:
            columns[item.name] = np.repeat(values, number, axis=0)
    lengths = np.tile(springs, table.spectrum.size) * columns["correlation_length"]
    spring = np.repeat(lengths[:, None], table.amplitude.size, axis=1)
    return replace(table, **columns | {"spring": spring})


def test_size_is_compared_only_among_equal_springs_in_correlation_lengths(rng):
    table = synthetic_table(rng, lambda energy, index: constant(energy, 0) - index, noise=0.0)
    fronts = on_springs(table, [1.0, 4.0, 16.0])
    assert np.unique(fronts.family).size == 3
    # k rises with the springs, and of the longest the largest spectrum has no value.
    rising = np.tile([0.0, 2.0, 4.0], 3)[:, None, None] * fronts.e_el
    fronts = replace(fronts, w_appr=fronts.w_appr - rising, w_retr=fronts.w_retr + rising)
    gaps = np.zeros(fronts.e_el.shape, bool)
    gaps[8] = True
    assert fit_all(with_gaps(fronts, gaps)).pooled_size_slope.value == pytest.approx(-1.0)


def by_the_law(*, straight, spread=0.05):
    """A sweep whose k is that of the law in spheres, or in straight fronts on three springs."""
    table = synthetic_table(np.random.default_rng(3), constant, noise=0.0)
    if straight:
        spring = np.repeat(np.array([0.5, 2.0, 8.0])[:, None], AMPLITUDES.size, axis=1)
        table = replace(table, spring=spring, contact_radius=np.full(table.e_el.shape, np.nan))
    energy = np.broadcast_to(AMPLITUDES[:, None], table.e_el.shape)
    table = replace(table, e_el=energy, w_rms=2 * np.sqrt(energy))
    k, size = SweepLaw(table, "roughness").cells()
    scatter = 1 + spread * np.array([-1, 1, -1, 1]) / np.sqrt(4 / 3)
    reach = np.nan_to_num(k.value)[..., None] * energy * scatter
    return replace(table, w_appr=1 - energy - reach, w_retr=1 - energy + reach), k, size


@pytest.mark.parametrize("straight", [False, True])
def test_a_sweep_by_the_law_departs_from_it_by_nothing_and_extrapolates_to_its_limit(straight):
    table, k, size = by_the_law(straight=straight)
    fit = fit_all(table)
    np.testing.assert_allclose(fit.cells.size, size)
    np.testing.assert_allclose(fit.cells.factor.value, k.value)
    assert fit.law_departure == pytest.approx(0, abs=1e-12)
    assert fit.n_large == np.count_nonzero(size > 1) > 3
    law = shipped_law()
    measured = size >= law.size[0]
    breadth = spectral_breadth("roughness", table.shape_of(0))
    limit = law_value(law.coefficients, fit.cells.w_rms, np.inf, breadth)
    infinite = fit.cells.infinite_factor
    # The branches of a sphere have two sizes, whose mean k is not quite that of their mean size.
    tolerance = 1e-9 if straight else 0.01
    np.testing.assert_allclose(infinite.value[measured], limit[measured], rtol=tolerance)
    assert np.all(np.isnan(infinite.value[~measured]))
    # The scatter of the realisations is carried along, and what the law does not know is added.
    relative = fit.cells.factor.standard_error / fit.cells.factor.value
    assert np.all(infinite.standard_error[measured] > (relative * limit)[measured])
    assert np.all(covered(fit.cells.law_factor, k.value))


def test_uncorrelated_sites_are_the_limit_of_weak_disorder_at_any_amplitude():
    table, _, size = by_the_law(straight=True)
    fit = fit_all(table, uncorrelated=True)
    coefficients = shipped_law().coefficients
    breadth = spectral_breadth("roughness", table.shape_of(0))
    expected = law_value(coefficients, 0.0, size, breadth)
    np.testing.assert_allclose(fit.cells.law_factor.value, expected, rtol=1e-6)
    assert fit.k_0.value == pytest.approx(coefficients[0], rel=1e-6)
    assert fit.k_0.low < coefficients[0] < fit.k_0.high


def test_a_range_below_the_onset_of_hysteresis_is_pointed_out(rng):
    table = synthetic_table(rng, lambda energy, _: np.where(energy > 0.01, 3.0, -0.3), noise=0.0)
    fit = fit_all(table)
    notes = "\n".join(fit_notes(fit))
    assert "below the onset of" in notes
    assert "mean hysteresis at e_el = 0.005, 0.01 w_int is not positive" in notes
    assert np.isfinite(fit.pooled.exponent.value)


def test_a_sweep_in_which_everything_failed_is_refused(rng):
    table = synthetic_table(rng, constant)
    with pytest.raises(ValueError, match=r"all 60 simulations .* failed"):
        fit_all(with_gaps(table, np.ones(table.e_el.shape, dtype=bool)))
